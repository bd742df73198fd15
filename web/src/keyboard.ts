/** Keys that work anywhere on the page of a story, unless something is being written. */

import { show } from "./dialog";
import { h } from "./dom";

export interface Keys {
  toggle(): void;
  /** Seconds. */
  skip(by: number): void;
  step(by: -1 | 1): void;
  start(): void;
  end(): void;
  follow(): void;
  turn(around: number, up: number, zoom: number): void;
}

const HELP: readonly (readonly [string, string])[] = [
  ["Space", "play or pause"],
  ["← →", "two seconds back or on"],
  ["Shift + ← →", "the moment before or after"],
  ["Home, End", "beginning and end"],
  ["F", "follow the body, or see all of the home"],
  ["A D W S", "turn the camera"],
  ["+ −", "nearer, farther"],
  ["?", "this list"],
];

/** The last key that was obeyed: two films on a page both obey it. */
let last: KeyboardEvent | null = null;

/** Listen until the answer is called. */
export function listenKeys(keys: Keys): () => void {
  const acts: Readonly<Record<string, (shift: boolean) => void>> = {
    " ": () => keys.toggle(),
    ArrowLeft: (shift) => (shift ? keys.step(-1) : keys.skip(-2)),
    ArrowRight: (shift) => (shift ? keys.step(1) : keys.skip(2)),
    Home: () => keys.start(),
    End: () => keys.end(),
    f: () => keys.follow(),
    "?": () => showHelp(),
    a: () => keys.turn(-0.15, 0, 1),
    d: () => keys.turn(0.15, 0, 1),
    w: () => keys.turn(0, -0.08, 1),
    s: () => keys.turn(0, 0.08, 1),
    "+": () => keys.turn(0, 0, 0.88),
    "-": () => keys.turn(0, 0, 1.14),
  };
  const listener = (event: KeyboardEvent): void => {
    const act = acts[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act || event.ctrlKey || event.metaKey || event.altKey || (event.defaultPrevented && event !== last) || busy(event)) return;
    event.preventDefault();
    last = event;
    act(event.shiftKey);
  };
  document.addEventListener("keydown", listener);
  return () => document.removeEventListener("keydown", listener);
}

/** Whether the key belongs to what has the focus: writing, choosing, pressing, or a question in front. */
function busy(event: KeyboardEvent): boolean {
  const target = event.target as Element;
  if (document.querySelector("dialog[open]:not(.player)") || target.closest("textarea, select, input:not([type=range])")) return true;
  if (event.key === " ") return target.closest("button, a, summary, [role=button]") !== null;
  return target.closest("input[type=range]") !== null && /^(Arrow|Home|End)/.test(event.key);
}

export function showHelp(): void {
  show("Keys", h("dl", { class: "keys" }, ...HELP.flatMap(([key, words]) => [h("dt", {}, key), h("dd", {}, words)])));
}
