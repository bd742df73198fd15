/** The library's resources, and the calls that the page makes about rooms. */

import { call, json, type Opening, type Placed, type Point2 } from "./api";

export type Affordance = "sit" | "lie" | "touch";
export type Level = "same" | "class" | "group";
export const AFFORDANCES: readonly Affordance[] = ["sit", "lie", "touch"];
export const ROOM_TYPES: readonly string[] = ["bedroom", "living_room", "dining_room", "study"];

export interface RoomSummary {
  readonly id: string;
  readonly room_type: string;
  /** Every type that it can serve as. */
  readonly tags: readonly string[];
  readonly source: string;
  readonly licence: string;
  readonly built_in: boolean;
  /** Square metres. */
  readonly area: number;
  readonly objects: number;
  readonly furniture: Readonly<Record<string, number>>;
}

export interface Spot {
  readonly object_id: string;
  readonly affordance: Affordance;
  readonly point: readonly [number, number, number];
  readonly standing: Point2;
  /** Yaw of the body at `standing`. */
  readonly approach: number;
  readonly usable: boolean;
}

/** A solid measured from a mesh, in the piece's own frame: role, lowest corner, highest corner. */
export type Part = readonly [string, readonly [number, number, number], readonly [number, number, number]];

export interface Piece extends Placed {
  readonly shape?: readonly Part[];
}

export interface Room extends Omit<RoomSummary, "objects" | "furniture"> {
  readonly floor_polygon: readonly Point2[];
  readonly height: number;
  readonly doors: readonly Opening[];
  readonly windows: readonly Opening[];
  readonly objects: readonly Piece[];
  readonly problems: readonly string[];
  readonly spots: readonly Spot[];
  readonly graph: { readonly nodes: readonly { readonly object_id: string; readonly minor: boolean }[]; readonly edges: readonly (readonly [number, number])[] };
}

export interface Query {
  readonly nodes: readonly { readonly category: string; readonly instance: number; readonly needs: readonly Affordance[] }[];
  /** Pairs of places in `nodes` that belong together. */
  readonly edges: readonly (readonly [number, number])[];
}

export interface Match {
  /** One room; or, where several were allowed, `rooms`. */
  readonly layout_id?: string;
  readonly room_type?: string;
  readonly rooms?: readonly { readonly layout_id: string; readonly room_type: string }[];
  readonly distance: number;
  readonly exact: boolean;
  readonly lower_bound: number;
  /** `object_id` is the room's; of several rooms "place/object". */
  readonly mapping: readonly { readonly node: number; readonly object_id: string; readonly given: string; readonly level: Level; readonly cost: number }[];
  readonly reasons: readonly { readonly node: number; readonly why: "absent" | "unfit" | "taken" | "spare"; readonly nearest: string | null; readonly unmet: readonly Affordance[] }[];
  readonly extra: readonly string[];
  readonly lost: readonly (readonly [number, number])[];
  readonly costs: Readonly<Record<string, number>>;
}

export interface Imported {
  readonly items: readonly RoomSummary[];
  readonly problems: Readonly<Record<string, readonly string[]>>;
  readonly report: {
    readonly rooms: number;
    readonly objects: Readonly<Record<string, number>>;
    readonly dropped: readonly { readonly why: string; readonly count: number; readonly examples: readonly string[] }[];
    readonly estimated: Readonly<Record<string, number>>;
  };
}

const path = (id: string): string => id.split("/").map(encodeURIComponent).join("/");

/** The service's address of a room, or of something that belongs to it. */
export const roomUrl = (id: string, of = ""): string => `v1/layouts/${path(id)}${of}`;

/** The page's address of a room. */
export const roomAddress = (id: string): string => `#/rooms/${path(id)}`;

export function listRooms(type: string, cursor: string | null, signal: AbortSignal): Promise<{ items: RoomSummary[]; next: string | null }> {
  const query = new URLSearchParams({ limit: "24", ...(type ? { room: type } : {}), ...(cursor ? { cursor } : {}) });
  return json(`v1/layouts?${query}`, { signal });
}

/** The ids of all rooms. */
export async function allRooms(): Promise<readonly string[]> {
  const ids: string[] = [];
  for (let next: string | null = ""; next !== null; ) {
    const page: { items: RoomSummary[]; next: string | null } = await json(`v1/layouts?limit=100${next ? `&cursor=${encodeURIComponent(next)}` : ""}`);
    ids.push(...page.items.map(({ id }) => id));
    next = page.next;
  }
  return ids;
}

export const getRoom = (id: string, signal?: AbortSignal): Promise<Room> => json(roomUrl(id), signal ? { signal } : {});

export async function findRooms(graph: Query, rooms: readonly string[], most: number, signal: AbortSignal): Promise<readonly Match[]> {
  const body = JSON.stringify({ graph, k: 6, rooms, max_rooms: most });
  return (await json<{ matches: Match[] }>("v1/layouts/retrieve", { method: "POST", headers: { "Content-Type": "application/json" }, body, signal })).matches;
}

/** Add the rooms of a file; one in our own format is answered with the room itself. */
export function postRooms(file: Blob, format: string, options: Readonly<Record<string, string>>): Promise<Room | Imported> {
  const query = new URLSearchParams({ format, ...options });
  const type = format === "native" ? "application/json" : "application/octet-stream";
  return json(`v1/layouts?${query}`, { method: "POST", headers: { "Content-Type": type }, body: file });
}

export async function deleteRoom(id: string): Promise<void> {
  await call(roomUrl(id), { method: "DELETE" });
}
