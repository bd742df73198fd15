/** The script, keyframe by keyframe, as it is written and then acted. */

import type { Keyframe } from "./api";
import { h } from "./dom";
import { placeWords } from "./furniture-words";
import { badge, type Mark } from "./outcomes";
import { Reading } from "./reading";
import { clock } from "./timing";
import { SKILL_WORDS } from "./words";

export class ScriptList {
  readonly element = h("ol", { class: "cues" });
  readonly #reading = new Reading(this.element);
  readonly #seek: (keyframe: number) => void;
  #rows: { item: HTMLElement; button: HTMLButtonElement; words: HTMLElement; time: HTMLElement }[] = [];
  #current: number | null = null;

  constructor(seek: (keyframe: number) => void) {
    this.#seek = seek;
  }

  /** `marks` has the moments that show something else than was asked for, as far as that is known. */
  update(keyframes: readonly Keyframe[], fps: number, written: boolean, marks: ReadonlyMap<number, Mark>): void {
    while (this.#rows.length > keyframes.length) this.#rows.pop()?.item.remove();
    const fresh = this.#rows.length;
    for (const [index, keyframe] of keyframes.entries()) {
      if (!this.#rows[index]) this.#add(index, written ? (index - fresh) * 45 : 0);
      this.#show(index, keyframe, fps, marks.get(index));
    }
  }

  #add(index: number, delay: number): void {
    const words = h("span", { class: "cue-words" });
    const time = h("span", { class: "cue-time" });
    const button = h("button", { type: "button", onclick: () => this.#seek(index) }, h("span", { class: "cue-number" }, String(index + 1)), words, time);
    const item = h("li", { class: "cue", style: `animation-delay: ${delay}ms` }, button);
    this.#rows.push({ item, button, words, time });
    this.element.append(item);
  }

  #show(index: number, keyframe: Keyframe, fps: number, mark: Mark | undefined): void {
    const { item, button, words, time } = this.#rows[index]!;
    const made = keyframe.start !== null;
    button.disabled = !made;
    item.dataset["emotion"] = keyframe.mood;
    item.classList.toggle("missed", keyframe.reached === false);
    const missed = keyframe.reached === false ? " · not reached" : "";
    words.replaceChildren(
      h("b", {}, keyframe.caption),
      h("small", {}, `${SKILL_WORDS[keyframe.skill]} · ${placeWords(keyframe)} · ${keyframe.emotion}${missed}`),
      ...(mark ? [h("span", { class: "cue-mark" }, badge(mark.outcome), " ", h("small", {}, mark.words))] : []),
    );
    time.textContent = made ? clock(keyframe.start / fps) : "";
  }

  show(keyframe: number | null): void {
    if (keyframe === this.#current) return;
    this.#rows[this.#current ?? -1]?.button.removeAttribute("aria-current");
    this.#current = keyframe;
    const row = this.#rows[keyframe ?? -1];
    row?.button.setAttribute("aria-current", "true");
    if (row) this.#reading.reveal(row.item);
  }
}
