/** The line of keyframes: as wide as they last, coloured by how they feel; a click goes there. */

import type { Keyframe } from "./api";
import { fill, h } from "./dom";
import { EMOTIONS } from "./emotions";
import { placeWords } from "./furniture-words";
import { blocks, clock, placeOf, type Block } from "./timing";
import { SKILL_WORDS } from "./words";

/** Steps of the slider along the whole line. */
const STEPS = 2000;

export class Timeline {
  readonly element: HTMLElement;
  readonly #line = h("ol", { class: "blocks", "aria-label": "Moments of the story" });
  readonly #head = h("div", { class: "playhead", "aria-hidden": "true" });
  readonly #slider = h("input", { type: "range", class: "scrub", min: 0, max: STEPS, value: 0, "aria-label": "Position in the film" });
  readonly #legend = h("ul", { class: "legend", "aria-label": "Colours of the moments" });
  readonly #fps: number;
  #keyframes: readonly Keyframe[] = [];
  #laid: Block[] = [];
  #items: HTMLElement[] = [];
  #buttons: HTMLButtonElement[] = [];
  #current: number | null = null;

  /** `seek` goes to a frame, `pick` to where a keyframe begins. */
  constructor(seek: (frame: number) => void, pick: (keyframe: number) => void, fps = 30) {
    this.#fps = fps;
    this.#slider.addEventListener("input", () => seek(this.#frameAt(Number(this.#slider.value) / STEPS)));
    this.#line.addEventListener("keydown", (event) => this.#onKey(event));
    this.#line.addEventListener("click", (event) => {
      const button = (event.target as Element).closest("button");
      if (button) pick(this.#buttons.indexOf(button));
    });
    this.element = h("div", { class: "timeline" }, h("div", { class: "lights" }, this.#line, this.#head), this.#slider, this.#legend);
  }

  update(keyframes: readonly Keyframe[]): void {
    this.#keyframes = keyframes;
    this.#laid = blocks(keyframes);
    this.element.classList.toggle("blank", keyframes.length === 0);
    for (const item of this.#items.splice(keyframes.length)) item.remove();
    this.#buttons.splice(keyframes.length);
    for (const [index, keyframe] of keyframes.entries()) this.#block(index, keyframe);
    const felt = EMOTIONS.filter((emotion) => keyframes.some((keyframe) => keyframe.mood === emotion));
    if (felt.length !== this.#legend.children.length) {
      fill(this.#legend, ...felt.map((emotion) => h("li", { "data-emotion": emotion }, h("i", {}), emotion)));
    }
    const first = this.#buttons[this.#current ?? 0];
    if (first) first.tabIndex = 0;
  }

  #block(index: number, keyframe: Keyframe): void {
    const button = (this.#buttons[index] ??= h("button", { type: "button", tabindex: -1 }));
    const item = (this.#items[index] ??= h("li", { style: `--n: ${index}` }, button));
    if (!item.parentElement) this.#line.append(item);
    const { width, made } = this.#laid[index]!;
    item.style.flexGrow = String(width * 1000);
    item.dataset["emotion"] = keyframe.mood;
    item.classList.toggle("made", made);
    item.classList.toggle("missed", keyframe.reached === false);
    const time = keyframe.start === null ? "not made yet" : `at ${clock(keyframe.start / this.#fps)}`;
    const words = `${index + 1}: ${SKILL_WORDS[keyframe.skill]}, ${keyframe.caption}, ${keyframe.emotion}, ${placeWords(keyframe)}, ${time}`;
    button.setAttribute("aria-label", words);
    button.setAttribute("aria-disabled", String(!made));
    button.title = `${index + 1} · ${keyframe.caption} · ${keyframe.emotion}`;
  }

  /** Move the head. */
  tick(frame: number, keyframe: number | null): void {
    const place = placeOf(this.#keyframes, this.#laid, frame);
    this.#head.style.left = `${100 * place}%`;
    this.#slider.style.setProperty("--at", `${100 * place}%`);
    this.#slider.style.setProperty("--ready", `${100 * this.#ready()}%`);
    if (document.activeElement !== this.#slider || Math.abs(Number(this.#slider.value) / STEPS - place) > 1 / STEPS) {
      this.#slider.value = String(Math.round(place * STEPS));
    }
    if (keyframe === this.#current) return;
    this.#buttons[this.#current ?? -1]?.removeAttribute("aria-current");
    this.#current = keyframe;
    this.#buttons[keyframe ?? -1]?.setAttribute("aria-current", "true");
    if (!this.#line.contains(document.activeElement)) this.#rove(keyframe ?? 0);
    const said = keyframe === null ? "" : `, moment ${keyframe + 1} of ${this.#keyframes.length}: ${this.#keyframes[keyframe]?.caption ?? ""}`;
    this.#slider.setAttribute("aria-valuetext", `${clock(frame / this.#fps)}${said}`);
  }

  #ready(): number {
    const made = this.#laid.filter((block) => block.made);
    const last = made.at(-1);
    return last ? last.left + last.width : 0;
  }

  #frameAt(place: number): number {
    const made = this.#keyframes.filter((keyframe) => keyframe.end !== null);
    const frames = made.at(-1)?.end ?? 0;
    return this.#ready() > 0 ? (place / this.#ready()) * frames : 0;
  }

  #onKey(event: KeyboardEvent): void {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    const at = this.#buttons.indexOf(document.activeElement as HTMLButtonElement);
    if (step === undefined || at < 0) return;
    event.preventDefault();
    event.stopPropagation();
    const next = this.#buttons[at + step];
    if (!next) return;
    this.#rove(at + step);
    next.focus();
  }

  #rove(index: number): void {
    for (const [other, button] of this.#buttons.entries()) button.tabIndex = other === index ? 0 : -1;
  }
}
