/** The service's resources, and the calls that the page makes. */

import type { Emotion } from "./emotions";
import type { Phase } from "./movers";
import type { Letters, Span } from "./spans";

export type State = "queued" | "running" | "succeeded" | "failed" | "cancelled";
export type Stage = "plan" | "furnish" | "narrate" | "act" | "move" | "judge" | "film";
export type Skill = "loco" | "sitdown" | "standup" | "getup" | "liedown" | "touch";

export interface Failure {
  readonly title: string;
  readonly detail: string;
}

export interface Summary {
  readonly id: string;
  readonly kind: "story" | "motion";
  readonly state: State;
  readonly stage: Stage | null;
  readonly progress: number;
  readonly created: string;
  readonly theme: string | null;
  readonly title: string | null;
  readonly seed: number;
  readonly backend: string;
  readonly duration: number | null;
  readonly error: Failure | null;
  /** The story that this one is a take of. */
  readonly derived_from: string | null;
}

export interface Keyframe {
  readonly index: number;
  /** Which beat of the theme it serves. */
  readonly beat: number | null;
  /** Further beats that it shows. */
  readonly also: readonly number[];
  readonly skill: Skill;
  /** As it was written. */
  readonly emotion: string;
  /** What that means. */
  readonly mood: Emotion;
  readonly caption: string;
  readonly furniture: string;
  readonly object_id: string | null;
  readonly room: string | null;
  readonly start: number | null;
  readonly end: number | null;
  readonly short_script_id: string | null;
  readonly reached: boolean | null;
  /** Whether the eyes are shut. */
  readonly asleep: boolean;
  /** Whether its frames are those of the story that this one derives from. */
  readonly reused: boolean;
}

/** One thing that the theme says, and what became of it. */
export interface Beat {
  readonly text: string;
  /** "undone" for what the theme says is not done; "other" of nobody for what is told and is no deed. */
  readonly kind: string;
  /** Who does it, where it is somebody else. */
  readonly who: string;
  readonly emotion: Emotion;
  /** As planned, while nothing is moved. */
  readonly acted: boolean;
  /** Why it is not acted. */
  readonly why: string;
  /** Whether it is not acted, but something else is seen in its place. */
  readonly stood_for: boolean;
  /** What of it no keyframe shows; its whole text where something only stands for it. */
  readonly unshown: readonly string[];
}

export interface FoundScript {
  readonly id: string;
  readonly summary: string;
  readonly score: number;
  readonly beat: number;
}

export interface FoundRoom {
  readonly layout_id: string;
  readonly room_type: string;
  readonly distance: number;
  readonly exact: boolean;
  readonly substitutions: readonly { readonly asked: string; readonly given: string; readonly level: string }[];
  readonly missing: readonly string[];
}

export interface KeyframeFigures {
  readonly keyframe: number;
  readonly skill: Skill;
  readonly seconds: number;
  readonly reached: boolean;
  readonly reason: string;
  readonly contact_error: number | null;
  readonly pen_max: number;
  /** What was done otherwise than the caption says; stories made by earlier versions have none. */
  readonly notes?: readonly string[];
  /** The known caption that was acted where the body knows no word of its own. */
  readonly performed_as?: string | null;
  readonly phases?: readonly Phase[];
}

export interface Report {
  readonly planner: string | null;
  readonly encoder: string | null;
  readonly backend: string;
  readonly physics_mode: string;
  /** Share of the film in which no beat of the theme is acted, 0 to 1; null where there is no theme. */
  readonly screen_time_not_acted: number | null;
  /** Who moved the body, in words by backend; stories made by earlier versions have none, and no words beside limits. */
  readonly moved_by?: Readonly<Record<string, string>>;
  /** Of every figure that has a limit whether it is kept, and what it means if it is not. */
  readonly limits?: readonly { readonly figure: string; readonly kept: boolean; readonly words?: string | null }[];
  readonly motion: {
    readonly reached: number;
    readonly keyframes: number;
    readonly contact_error: number | null;
    readonly pen_mean: number;
    readonly pen_share: number;
    readonly slip: number | null;
    readonly seconds: number;
  };
  readonly keyframes: readonly KeyframeFigures[];
}

export interface FurnitureGraph {
  readonly nodes: readonly { readonly category: string; readonly instance: number; readonly room: string | null }[];
  readonly edges: readonly (readonly [number, number])[];
}

export interface Story extends Summary {
  readonly method: string;
  readonly character: Character;
  readonly planner: string | null;
  readonly encoder: string | null;
  readonly text: string | null;
  readonly spans: readonly Span[];
  readonly thoughts: readonly Letters[];
  readonly beats: readonly Beat[];
  readonly repairs: readonly string[];
  readonly keyframes: readonly Keyframe[];
  readonly short_scripts: readonly FoundScript[];
  readonly graph: FurnitureGraph | null;
  readonly home: { readonly rooms: readonly FoundRoom[] } | null;
  readonly motion: { readonly frames: number; readonly fps: number; readonly duration: number; readonly complete: boolean };
  readonly report: Report | null;
  /** Moments, from the first on, whose motion was taken over from the story it derives from. */
  readonly reused: number;
  /** Which take it is of the story it derives from; 0 for one of its own, and before that is known. */
  readonly take: number;
}

export type Point2 = readonly [number, number];

export interface Opening {
  readonly segment: readonly [Point2, Point2];
  readonly bottom: number;
  readonly top: number;
}

export interface Placed {
  readonly id: string;
  readonly category: string;
  readonly position: readonly [number, number, number];
  readonly size: readonly [number, number, number];
  readonly yaw: number;
}

export interface Home {
  readonly rooms: readonly {
    readonly layout: { readonly id: string; readonly room_type: string; readonly floor_polygon: readonly Point2[]; readonly objects: readonly Placed[] };
    readonly offset: readonly [number, number, number];
    readonly yaw: number;
  }[];
  readonly walls: readonly { readonly segment: readonly [Point2, Point2]; readonly height: number; readonly openings: readonly Opening[] }[];
  readonly doorways: readonly Opening[];
}

export interface NewStory {
  theme: string;
  seed: number;
  method: string;
  rooms?: string[];
  /** Ids of rooms to play in. */
  layouts?: readonly string[];
  character: { name: string; pronouns: string; height: number; member?: string };
}

/** Who acts, and how they look; words are empty in stories of old. */
export interface Character {
  readonly name: string;
  readonly pronouns: string;
  readonly height: number;
  readonly member: string;
  readonly age: string;
  readonly outfit: string;
}

/** One of those who can play. */
export interface Member {
  readonly name: string;
  readonly pronouns: string;
  readonly age: string;
}

/** An answer that is not the one hoped for; status 0 when there was no answer at all. */
export class ApiError extends Error {
  constructor(
    readonly status: number,
    readonly title: string,
    readonly detail: string,
    readonly errors: readonly { readonly pointer: string; readonly detail: string }[] = [],
    /** Seconds after which to ask again. */
    readonly retryAfter: number | null = null,
  ) {
    super(detail || title);
  }

  /** Whether the same call may well succeed later. */
  get passing(): boolean {
    return this.status === 0 || this.status === 429 || this.status >= 500;
  }
}

/** Ask the service; ApiError for every answer that is an error. */
export async function call(path: string, init: RequestInit = {}): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(path, { credentials: "same-origin", ...init });
  } catch (cause) {
    if (cause instanceof DOMException && cause.name === "AbortError") throw cause;
    throw new ApiError(0, "No answer", "The service does not answer. Is it still running, and are you connected to it?");
  }
  if (response.ok) return response;
  throw await problem(response);
}

async function problem(response: Response): Promise<ApiError> {
  const wait = Number(response.headers.get("Retry-After"));
  const retryAfter = Number.isFinite(wait) && wait > 0 ? wait : null;
  const said: unknown = await response.json().catch(() => null);
  const body = (said !== null && typeof said === "object" ? said : {}) as Record<string, unknown>;
  const title = typeof body["title"] === "string" ? body["title"] : `The service answered ${response.status}`;
  const detail = typeof body["detail"] === "string" ? body["detail"] : "";
  const errors = Array.isArray(body["errors"]) ? (body["errors"] as ApiError["errors"]) : [];
  return new ApiError(response.status, title, detail, errors, retryAfter);
}

/** The same, where the answer is JSON. */
export async function json<T>(path: string, init?: RequestInit): Promise<T> {
  return (await (await call(path, init)).json()) as T;
}

const story = (id: string): string => `v1/stories/${encodeURIComponent(id)}`;

/** Start a story. The same key posted again makes no second one. */
/** Makes a post that is tried again the same post. randomUUID is missing where the page is not served securely. */
export function newKey(): string {
  return Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, "0")).join("");
}

export function postStory(request: NewStory, key: string): Promise<Story> {
  const headers = { "Content-Type": "application/json", "Idempotency-Key": key };
  return json("v1/stories", { method: "POST", headers, body: JSON.stringify(request) });
}

/** What is to be different in a take of a story. */
/** Keyframes to be acted out in a room of the library. */
export interface NewMotion {
  readonly layout_id: string;
  readonly keyframes: readonly { readonly skill: Skill; readonly caption: string }[];
}

/** What acts a caption out: its keyframe is the last. */
export const getExample = (skill: Skill, caption: string, signal?: AbortSignal): Promise<NewMotion> => json(`v1/captions/example?${new URLSearchParams({ skill, caption })}`, signal ? { signal } : {});

export function postMotion(motion: NewMotion, key: string): Promise<Story> {
  return json("v1/motions", { method: "POST", headers: { "Content-Type": "application/json", "Idempotency-Key": key }, body: JSON.stringify(motion) });
}

export interface NewTake {
  keyframes: readonly { index?: number; skill: Skill; emotion: string; caption: string; furniture: string; object_id?: string }[];
  seed: number;
  backend: string;
  /** Rooms of the library to play in instead. */
  layouts?: readonly string[];
}

/** Derive a story from a story. The same key posted again makes no second one. */
export function postTake(id: string, take: NewTake, key: string): Promise<Story> {
  const headers = { "Content-Type": "application/json", "Idempotency-Key": key };
  return json(`${story(id)}/takes`, { method: "POST", headers, body: JSON.stringify(take) });
}

export const getStory = (id: string, signal?: AbortSignal): Promise<Story> => json(story(id), signal ? { signal } : {});

export const getHome = (id: string): Promise<Home> => json(`${story(id)}/home`);

export function listStories(cursor: string | null): Promise<{ items: Summary[]; next: string | null }> {
  return json(`v1/stories?limit=12${cursor ? `&cursor=${encodeURIComponent(cursor)}` : ""}`);
}

export async function cancelStory(id: string): Promise<void> {
  await call(`${story(id)}/cancel`, { method: "POST" });
}

export async function deleteStory(id: string): Promise<void> {
  await call(story(id), { method: "DELETE" });
}

/** Frames [from, to) of a motion as npz. */
export async function getMotion(id: string, from: number, to: number, signal?: AbortSignal): Promise<ArrayBuffer> {
  return (await call(motionUrl(id, "npz", from, to), signal ? { signal } : {})).arrayBuffer();
}

export function motionUrl(id: string, format: string, from?: number, to?: number): string {
  const range = from === undefined ? "" : `&from=${from}${to === undefined ? "" : `&to=${to}`}`;
  return `${story(id)}/motion?format=${format}${range}`;
}

export const sceneUrl = (id: string): string => `${story(id)}/scene.glb`;
export const propsUrl = (id: string): string => `${story(id)}/props.glb`;
export const filmUrl = (id: string): string => `${story(id)}/film.glb`;
export const storyUrl = (id: string): string => story(id);
export const eventsUrl = (id: string): string => `${story(id)}/events`;

/** A story's film.mp4, as far as it is made. */
export interface FilmJob {
  /** "absent" where nobody has asked for it. */
  readonly state: State | "absent";
  readonly progress: number;
  readonly bytes: number | null;
  readonly error: Failure | null;
}

/** The film as USD, made for this call. */
export async function getUsd(id: string): Promise<Blob> {
  return (await call(`${story(id)}/film.usd`)).blob();
}

export const mp4Url = (id: string): string => `${story(id)}/film.mp4`;

/** Have a story filmed; one that is there or under way stays. */
export const makeFilm = (id: string): Promise<FilmJob> => json(`${story(id)}/film`, { method: "POST" });

export async function getCast(): Promise<readonly Member[]> {
  const { members } = await json<{ members: Member[] }>("v1/cast");
  return members;
}

export const getFilm = (id: string): Promise<FilmJob> => json(`${story(id)}/film`);

export async function stopFilm(id: string): Promise<void> {
  await call(`${story(id)}/film`, { method: "DELETE" });
}

/** The bytes of a GLB file. */
export async function getGlb(url: string): Promise<ArrayBuffer> {
  return (await call(url)).arrayBuffer();
}

export const getSession = (): Promise<{ required: boolean; authenticated: boolean }> => json("session");

export async function logIn(key: string): Promise<void> {
  await call("session", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ key }) });
}

export async function logOut(): Promise<void> {
  await call("session", { method: "DELETE" });
}
