/** Play, speed and camera: the row of buttons under the film. */

import type { CameraMode } from "./camera";
import { fill, h, icon } from "./dom";
import { SPEEDS, type Player } from "./player";
import { clock } from "./timing";

export interface Wishes {
  toggle(): void;
  /** To the moment before or after this one. */
  step(by: -1 | 1): void;
  speed(speed: number): void;
  camera(mode: CameraMode): void;
  map(): void;
  full(): void;
  help(): void;
}

/** Two rows of buttons on one page choose each for itself. */
let rows = 0;

export class Controls {
  readonly element: HTMLElement;
  readonly #play: HTMLButtonElement;
  readonly #time = h("span", { class: "time" });
  readonly #speeds: HTMLInputElement[];
  readonly #cameras: HTMLInputElement[];
  readonly #cameraChoice: HTMLElement;
  readonly #map: HTMLButtonElement;

  constructor(wishes: Wishes) {
    const button = (name: string, picture: Parameters<typeof icon>[0], act: () => void, shown = "quiet round"): HTMLButtonElement =>
      h("button", { type: "button", class: shown, "aria-label": name, title: name, onclick: act }, icon(picture));
    this.#play = button("Play", "play", () => wishes.toggle(), "primary round");
    this.#map = button("Plan of the home", "map", () => wishes.map());
    this.#map.setAttribute("aria-pressed", "true");
    const row = ++rows;
    const speeds = SPEEDS.map((speed) => radio(`speed-${row}`, String(speed), `${speed === 0.5 ? "½" : speed}×`, `${speed} times as fast`, () => wishes.speed(speed)));
    const cameras = ([["follow", "Follow"], ["orbit", "Overview"]] as const).map(([mode, words]) => radio(`camera-${row}`, mode, words, null, () => wishes.camera(mode)));
    this.#speeds = speeds.map(({ input }) => input);
    this.#cameras = cameras.map(({ input }) => input);
    this.#cameraChoice = h("div", { class: "segment cameras", role: "radiogroup", "aria-label": "Camera" }, ...cameras.map(({ label }) => label));
    const keys = button("Keys", "help", () => wishes.help());
    keys.dataset["keys"] = "";
    this.element = h(
      "div",
      { class: "controls", role: "group", "aria-label": "Film" },
      h("div", { class: "transport" }, button("Moment before", "back", () => wishes.step(-1)), this.#play, button("Next moment", "next", () => wishes.step(1)), this.#time),
      h("div", { class: "segment speeds", role: "radiogroup", "aria-label": "Speed" }, ...speeds.map(({ label }) => label)),
      this.#cameraChoice,
      h("div", { class: "extras" }, this.#map, button("Full screen", "full", () => wishes.full()), keys),
    );
  }

  /** Without WebGL there is no camera to choose. */
  hideCameras(): void {
    this.#cameraChoice.hidden = true;
  }

  showMode(mode: CameraMode): void {
    for (const input of this.#cameras) input.checked = input.value === mode;
  }

  showMap(shown: boolean): void {
    this.#map.setAttribute("aria-pressed", String(shown));
  }

  update(player: Player): void {
    const look = player.running ? "pause" : player.state === "ended" ? "again" : "play";
    const name = { pause: "Pause", again: "Play again", play: "Play" }[look];
    if (this.#play.getAttribute("aria-label") !== name) {
      this.#play.setAttribute("aria-label", name);
      this.#play.title = name;
      fill(this.#play, icon(look));
    }
    for (const input of this.#speeds) input.checked = Number(input.value) === player.speed;
  }

  tick(time: number, duration: number, growing: boolean): void {
    const words = `${clock(time)} / ${clock(duration)}${growing ? " +" : ""}`;
    if (this.#time.textContent !== words) this.#time.textContent = words;
  }
}

function radio(name: string, value: string, words: string, spoken: string | null, act: () => void): { label: HTMLLabelElement; input: HTMLInputElement } {
  const input = h("input", { type: "radio", name, value, "aria-label": spoken, onchange: act });
  return { label: h("label", {}, input, h("span", {}, words)), input };
}
