/** The quiet line that says what is being done now. */

import type { Stage, Story } from "./api";
import { fill, h } from "./dom";
import { announce } from "./live";
import { capital, STAGE_SHORT, STAGE_WORDS, STAGES } from "./words";

/** Milliseconds of waiting after which it is said why it may take long. */
const LONG_WAIT_MS = 6000;
const WAITING = "waiting for a free worker";
const STARTING = "waiting; a worker needs up to a minute to start";

export class Steps {
  readonly element = h("div", { class: "steps", hidden: true });
  readonly #words = h("p", { class: "steps-words" });
  readonly #line = h("ol", { class: "steps-line", "aria-hidden": "true" });
  readonly #bar = h("progress", { class: "visually-hidden", max: 1, value: 0, "aria-label": "How far the story is" });
  readonly #cancel: HTMLButtonElement;
  #broken = false;
  /** The stage that is shown, of STAGES. */
  #at = -1;
  #story: Story | null = null;
  readonly #born = performance.now();
  /** Whether it will be looked again. */
  #looks = false;

  constructor(cancel: () => void) {
    this.#cancel = h("button", { type: "button", class: "plain small", onclick: cancel }, "Stop");
    fill(this.#line, ...STAGES.map((stage) => h("li", { "data-stage": stage }, STAGE_SHORT[stage])));
    fill(this.element, h("div", { class: "steps-head" }, this.#words, this.#cancel), this.#bar, this.#line);
  }

  update(story: Story): void {
    this.#story = story;
    const making = story.state === "queued" || story.state === "running";
    this.element.hidden = !making;
    if (making) this.show(story.stage, story.progress);
  }

  /** Say what is being done; what a late message tells of an earlier stage is passed over. */
  show(stage: Stage | null, progress: number): void {
    const at = stage === null ? -1 : STAGES.indexOf(stage);
    if (at < this.#at) return;
    this.#at = at;
    const words = stage === null ? this.#waitWords() : STAGE_WORDS[stage];
    const where = stage === "move" ? this.#moments() : "";
    this.#words.textContent = this.#broken ? "The connection is lost; trying again …" : `${capital(words)}${where} …`;
    this.#bar.value = progress;
    for (const [index, item] of [...this.#line.children].entries()) {
      item.classList.toggle("past", index < at);
      item.classList.toggle("now", index === at);
    }
    this.#line.style.setProperty("--share", String(stage === "move" ? this.#made() : 0.5));
    if (!this.#broken) announce(capital(words));
  }

  #waitWords(): string {
    const left = LONG_WAIT_MS - (performance.now() - this.#born);
    if (left <= 0) return STARTING;
    if (!this.#looks) window.setTimeout(() => this.#at < 0 && !this.element.hidden && this.show(null, 0), left + 50);
    this.#looks = true;
    return WAITING;
  }

  /** Say that nothing is heard, or is heard again. */
  setBroken(broken: boolean): void {
    if (broken === this.#broken) return;
    this.#broken = broken;
    if (this.#story) this.show(this.#story.stage, this.#story.progress);
  }

  setStopping(): void {
    this.#cancel.disabled = true;
    this.#cancel.textContent = "Stopping …";
  }

  /** Share of the moments whose motion is made. */
  #made(): number {
    const all = this.#story?.keyframes ?? [];
    return all.length ? all.filter((keyframe) => keyframe.start !== null).length / all.length : 0;
  }

  #moments(): string {
    const all = this.#story?.keyframes ?? [];
    return all.length ? `, moment ${Math.min(Math.round(this.#made() * all.length) + 1, all.length)} of ${all.length}` : "";
  }
}
