/** The page: what the address names is shown, and a key is asked for where one is needed. */

import "./style/page.css";
import { ApiError, getSession, logOut, type Point2 } from "./api";
import { appearanceButton } from "./appearance";
import { fill, framed, h } from "./dom";
import { Gallery } from "./gallery";
import { loginForm } from "./login";
import type { Point3 } from "./pose";
import type { SideBySide } from "./side-by-side";
import { StoryView } from "./story-view";
import { ThemeForm } from "./theme-form";

const main = framed("main");
let view: StoryView | null = null;
/** Leaves the rooms, or two films beside each other, where they are shown. */
let leave: (() => void) | null = null;
/** Two films beside each other, where they are shown. */
let both: SideBySide | null = null;
/** Counts what was shown, so that what comes late is not shown over what was asked for since. */
let turn = 0;

function route(): void {
  const [path = "", query = ""] = location.hash.split("?");
  const id = /^#\/stories\/([\w-]+)$/.exec(path)?.[1];
  const asked = new URLSearchParams(query);
  const beside = /^[\w-]+$/.exec(asked.get("beside") ?? "")?.[0];
  const before = id && !beside && view?.handsOver(id) ? view : null;
  clear();
  const room = /^#\/rooms(?:\/(.*))?$/.exec(path);
  const captions = path === "#/captions";
  storiesLink.ariaCurrent = id || room || captions ? null : "page";
  roomsLink.ariaCurrent = room ? "page" : null;
  captionsLink.ariaCurrent = captions ? "page" : null;
  if (id) {
    const number = /^\d+$/.exec(asked.get("from") ?? "")?.[0];
    const from = number === undefined ? null : Number(number);
    if (beside) void showBoth([beside, id], from);
    else {
      view = new StoryView(id, () => (location.hash = "#/"), from, before);
      fill(main, view.element);
    }
  } else if (room) {
    void showRooms(room[1] ?? "", query);
  } else if (captions) {
    void showCaptions(asked.get("with") ?? "");
  } else {
    showHome(asked.getAll("in"));
  }
  window.scrollTo(0, 0);
}

function clear(): void {
  turn++;
  view?.dispose();
  view = null;
  leave?.();
  leave = both = null;
}

/** The library, or one of its rooms; its code is fetched when it is first asked for. */
async function showRooms(id: string, query: string): Promise<void> {
  const mine = turn;
  fill(main);
  const { rooms } = await import("./rooms");
  if (mine === turn) leave = rooms.show(main, decode(id), query);
}

/** What the body can do, in words. */
async function showCaptions(asked: string): Promise<void> {
  const mine = turn;
  fill(main);
  const { captions } = await import("./captions");
  if (mine === turn) captions.show(main, asked);
}

/** Two stories beside each other; their code is fetched when they are first asked for. */
async function showBoth(ids: readonly [string, string], from: number | null): Promise<void> {
  const mine = turn;
  fill(main);
  const { SideBySide } = await import("./side-by-side");
  if (mine !== turn) return;
  const pair = new SideBySide(ids, from);
  both = pair;
  leave = () => pair.dispose();
  fill(main, pair.element);
}

/** An id from an address; one that is not well written names no room. */
function decode(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/** `layouts` are rooms of the library that were chosen to play in. */
function showHome(layouts: readonly string[] = []): void {
  document.title = "SIMS stories";
  const form = new ThemeForm((story) => (location.hash = `#/stories/${story.id}`), layouts);
  const gallery = new Gallery();
  fill(main, h("div", { class: "front" }, h("section", { class: "arch-panel", "aria-label": "A new story" }, form.element), gallery.element));
  // While a theme is being thought of, the stage is fetched; where it cannot be built, the film will say so.
  const warm = (): void => void import("./stage").then(({ warmUp }) => warmUp()).catch(() => undefined);
  if ("requestIdleCallback" in window) window.requestIdleCallback(warm, { timeout: 4000 });
  else setTimeout(warm, 1500);
  gallery.load().catch((error: unknown) => {
    if (error instanceof ApiError && error.status === 401) askForKey();
    else throw error;
  });
}

function askForKey(): void {
  clear();
  fill(main, h("div", { class: "front" }, loginForm(() => void start())));
}

async function start(): Promise<void> {
  const session = await getSession().catch(() => ({ required: false, authenticated: false }));
  const out = h("button", { type: "button", class: "plain small", onclick: () => void logOut().then(askForKey) }, "Leave");
  fill(framed("tools"), storiesLink, roomsLink, captionsLink, session.authenticated && session.required ? out : null, appearance);
  if (session.required && !session.authenticated) askForKey();
  else route();
}

/** What tests look at; it can be read, not written. */
interface Seen {
  storyId: string | null;
  state: string | null;
  frame: number;
  time: number;
  playing: boolean;
  readyFrames: number;
  framesTotal: number;
  keyframe: number | null;
  /** How many pictures were drawn: it stands still while nothing moves. */
  pictures: number;
  joints(): Point3[];
  pixels(): Point2[];
  camera: { mode: string; position: Point3 | null } | null;
  /** Where two films are that play beside each other. */
  both: { frame: number; playing: boolean }[];
}

function seen(): Seen {
  const film = view?.film;
  return {
    storyId: view?.id ?? null,
    state: view?.story?.state ?? null,
    frame: Math.floor((film?.player.time ?? 0) * 30 + 1e-6),
    time: film?.player.time ?? 0,
    playing: film?.player.state === "playing",
    readyFrames: film?.reel.track.ready ?? 0,
    framesTotal: view?.story?.motion.frames ?? 0,
    keyframe: film?.keyframe ?? null,
    pictures: film?.pictures ?? 0,
    joints: () => film?.joints() ?? [],
    pixels: () => film?.pixels() ?? [],
    camera: film?.camera ?? null,
    both: (both?.films ?? []).map(({ player }) => ({ frame: player.time * 30, playing: player.state === "playing" })),
  };
}

const appearance = appearanceButton();
const storiesLink = h("a", { href: "#/", class: "button quiet small" }, "Stories");
const roomsLink = h("a", { href: "#/rooms", class: "button quiet small" }, "Rooms");
const captionsLink = h("a", { href: "#/captions", class: "button quiet small" }, "Captions");
Object.defineProperty(window, "sims", { value: Object.freeze({ state: seen }) });
// The address behind # names a story, so this link must not go there.
document.querySelector(".skip")?.addEventListener("click", (event) => {
  event.preventDefault();
  main.focus();
});
window.addEventListener("hashchange", route);
window.addEventListener("sims-login", askForKey);
void start();
