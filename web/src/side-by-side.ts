/** A story and a take of it, beside each other: they play together, and what differs is said. */

import { ApiError, getStory, type Keyframe, type Story } from "./api";
import { fill, h } from "./dom";
import { follow } from "./events";
import { Film } from "./film";
import { placeWords } from "./furniture-words";
import { moverList } from "./movers";
import { figureList, phasesOf } from "./report";
import { beatsWords, SKILL_WORDS, takeWords } from "./words";

const LOOK_MS = 100;

interface Side {
  readonly id: string;
  readonly film: Film;
  readonly head: HTMLElement;
  /** Figures and what moved the body, once they are known. */
  readonly facts: HTMLElement;
  story: Story | null;
  end: (() => void) | null;
}

export class SideBySide {
  readonly element = h("article", { class: "pair" });
  readonly #sides: readonly Side[];
  readonly #differs = h("section", { class: "differs", hidden: true });
  readonly #title = h("h1", {}, "Side by side");
  readonly #timer: number;

  /** Both films begin with the keyframe `from`, or at their beginning; keys are for both. */
  constructor(ids: readonly string[], from: number | null) {
    document.title = "Side by side · SIMS stories";
    this.#sides = ids.map((id) => ({ id, film: new Film(id, () => undefined, from), head: h("h2", {}, "…"), facts: h("div", { class: "facts" }), story: null, end: null }));
    fill(
      this.element,
      this.#title,
      h("div", { class: "sides" }, ...this.#sides.map(({ head, film, facts }) => h("section", { class: "side" }, head, film.element, facts))),
      this.#differs,
    );
    for (const side of this.#sides) void this.#refresh(side);
    // The one that is there first waits for the other.
    this.#timer = window.setInterval(() => this.#begin(from), LOOK_MS);
  }

  /** Those that are drawn and can be played. */
  get films(): readonly Film[] {
    return this.#sides.map(({ film }) => film);
  }

  dispose(): void {
    window.clearInterval(this.#timer);
    for (const { film, end } of this.#sides) {
      end?.();
      film.dispose();
    }
  }

  #begin(from: number | null): void {
    if (this.films.some(({ player, keyframe }) => keyframe === null || player.state === "waiting")) return;
    window.clearInterval(this.#timer);
    const playing = this.films.some(({ player }) => player.running);
    for (const film of this.films) {
      film.seekKeyframe(from ?? 0);
      if (playing && !film.player.running) film.player.play();
    }
  }

  async #refresh(side: Side): Promise<void> {
    try {
      side.story = await getStory(side.id);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      side.film.notice(h("div", { class: "outcome" }, h("p", {}, error.detail)));
      return;
    }
    const { story, film, head, facts } = side;
    fill(head, h("a", { href: `#/stories/${story.id}` }, takeWords(story)), ` · ${story.backend}, seed ${story.seed}`);
    if (story.title) this.#title.textContent = `${story.title}, side by side`;
    if (story.report) fill(facts, story.beats.length ? h("p", {}, beatsWords(story.beats)) : null, figureList(story.report), moverList(phasesOf(story.report), story.report.moved_by));
    film.update(story);
    const again = (): void => void this.#refresh(side);
    const making = story.state === "queued" || story.state === "running";
    if (making) side.end ??= follow(side.id, { stage: again, progress: () => undefined, segment: again, ended: again, broken: () => undefined });
    this.#tell();
  }

  /** The moments that are in one of them alone. */
  #tell(): void {
    const [one, other] = this.#sides.map(({ story }) => (story ? story.keyframes.map(told) : null));
    if (!one || !other) return;
    const lines = (mine: readonly string[], theirs: readonly string[]): HTMLElement =>
      h("ul", { class: "lines" }, ...mine.flatMap((words, at) => (theirs.includes(words) ? [] : [h("li", {}, `Moment ${at + 1}: ${words}`)])));
    this.#differs.hidden = false;
    const [left, right] = [lines(one, other), lines(other, one)];
    const none = left.childElementCount + right.childElementCount === 0;
    fill(this.#differs, h("h2", {}, "What differs"), none ? h("p", { class: "hint" }, "The scripts are the same; seed, backend or person are not.") : h("div", { class: "sides" }, left, right));
  }
}

const told = (keyframe: Keyframe): string => `${SKILL_WORDS[keyframe.skill]}, ${keyframe.caption}, ${keyframe.emotion}, ${placeWords(keyframe)}`;
