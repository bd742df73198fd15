/** A story and a take of it, beside each other: they play in step, moment by moment, and what differs is said. */

import { ApiError, getStory, type Story } from "./api";
import { align, differences, firstApart, shared, type Pair } from "./differences";
import { fill, h } from "./dom";
import { follow } from "./events";
import { Film } from "./film";
import { InStep, type Stepping } from "./in-step";
import { moverList } from "./movers";
import { figureList, phasesOf } from "./report";
import { beatsWords, takeWords } from "./words";

const LOOK_MS = 50;

interface Side {
  readonly id: string;
  readonly film: Film;
  readonly head: HTMLElement;
  /** Figures and what moved the body, once they are known. */
  readonly facts: HTMLElement;
  story: Story | null;
  /** Whether there is nothing of it to see, nor will be. */
  lost: boolean;
  end: (() => void) | null;
}

export class SideBySide {
  readonly element = h("article", { class: "pair" });
  readonly #sides: readonly [Side, Side];
  readonly #differs = h("section", { class: "differs", hidden: true });
  readonly #title = h("h1", {}, "Side by side");
  readonly #timer: number;
  readonly #step: InStep;
  /** The moment, of those in both, that both films begin with; null while it is not known. */
  #from: number | null = null;
  #begun = false;
  #pairs: readonly Pair[] = [];

  /** Both films begin with the keyframe `from`, or with the first moment that differs; keys are for both. */
  constructor([left, right]: readonly [string, string], from: number | null) {
    document.title = "Side by side · SIMS stories";
    const side = (id: string): Side => ({ id, film: new Film(id, () => undefined), head: h("h2", {}, "…"), facts: h("div", { class: "facts" }), story: null, lost: false, end: null });
    this.#sides = [side(left), side(right)];
    fill(
      this.element,
      this.#title,
      h("div", { class: "sides" }, ...this.#sides.map(({ head, film, facts }) => h("section", { class: "side" }, head, film.element, facts))),
      this.#differs,
    );
    for (const one of this.#sides) void this.#refresh(one);
    this.#step = new InStep([stepping(this.#sides[0].film), stepping(this.#sides[1].film)]);
    // The one that is there first waits for the other.
    this.#timer = window.setInterval(() => this.#tick(from), LOOK_MS);
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

  #tick(from: number | null): void {
    if (this.#sides.some(({ lost }) => lost)) {
      this.#step.release();
      return;
    }
    if (!this.#pairs.length || this.films.some(({ opened }) => !opened)) return;
    if (this.#begun) {
      this.#step.tick();
      return;
    }
    const moments = shared(this.#pairs);
    this.#from ??= from === null ? firstApart(this.#pairs) : Math.max(moments.findLastIndex(([, keyframe]) => keyframe <= from), 0);
    // Where it never comes so far, from the beginning.
    if (!this.#step.reaches(this.#from)) {
      if (this.#sides.every(({ story }) => story?.motion.complete)) this.#from = 0;
      return;
    }
    this.#begun = true;
    this.#step.seek(this.#from);
  }

  async #refresh(side: Side): Promise<void> {
    try {
      side.story = await getStory(side.id);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      side.lost ||= side.story === null && !error.passing;
      side.film.notice(h("div", { class: "outcome" }, h("p", {}, error.detail)));
      return;
    }
    const { story, film, head, facts } = side;
    fill(head, h("a", { href: `#/stories/${story.id}` }, takeWords(story)), ` · ${story.backend}, seed ${story.seed}`);
    if (story.title) this.#title.textContent = `${story.title}, side by side`;
    if (story.report) fill(facts, story.beats.length ? h("p", {}, beatsWords(story.beats)) : null, figureList(story.report), moverList(phasesOf(story.report), story.report.moved_by));
    film.update(story);
    // Where it has to wait is known before more of it is there.
    if (this.#begun) this.#step.tick();
    const again = (): void => void this.#refresh(side);
    const making = story.state === "queued" || story.state === "running";
    side.lost = !making && story.motion.frames === 0;
    if (making) side.end ??= follow(side.id, { stage: again, progress: () => undefined, segment: again, ended: again, broken: () => undefined });
    this.#tell();
  }

  /** All that differs, one beside the other. */
  #tell(): void {
    const [one, other] = this.#sides.map(({ story }) => story);
    if (!one || !other) return;
    this.#pairs = one.keyframes.length && other.keyframes.length ? align(one.keyframes, other.keyframes) : [];
    this.#step.pair(shared(this.#pairs));
    this.#differs.hidden = false;
    const rows = differences(one, other);
    const head = (words: string): HTMLElement => h("th", { scope: "col" }, words);
    const table = (): HTMLElement =>
      h("table", {}, h("thead", {}, h("tr", {}, h("td", {}), head(takeWords(one)), head(takeWords(other)))), h("tbody", {}, ...rows.map(([what, left, right]) => h("tr", {}, h("th", { scope: "row" }, what), h("td", {}, left), h("td", {}, right)))));
    fill(this.#differs, h("h2", {}, "What differs"), rows.length ? table() : h("p", { class: "hint" }, "Nothing: script, seed, person, home and what moves the body are the same."));
  }
}

/** A film as what is kept in step. */
const stepping = (film: Film): Stepping => ({
  get time() {
    return film.player.time;
  },
  get ready() {
    return film.reel.track.readyTime;
  },
  get running() {
    return film.player.running;
  },
  get ended() {
    return film.player.state === "ended";
  },
  get seeks() {
    return film.player.seeks;
  },
  play: () => film.player.play(),
  seek: (time) => film.player.seek(time),
  bar: (time) => film.player.bar(time),
  startOf: (keyframe) => film.beginOf(keyframe),
});
