/** The told story: the words that are being acted are lit and kept in sight; words lead back to their moment. */

import type { Story } from "./api";
import { fill, h } from "./dom";
import { Reading } from "./reading";
import { paragraphs, spanOf, type Piece, type Span } from "./spans";

/** Told words; slanted where the body is not seen doing what they say. */
function words({ text, thought }: Piece): string | HTMLElement {
  return thought ? h("em", { class: "unseen", title: "told, and not seen: the body does not show it" }, text) : text;
}

export class Telling {
  readonly element: HTMLElement;
  readonly #told: HTMLElement;
  /** Says what slanted words are, where there are any. */
  readonly #note = h("p", { class: "fine told-note", hidden: true }, h("em", { class: "unseen" }, "Slanted words"), " are told and not seen: the film does not show them.");
  readonly #reading: Reading;
  readonly #seek: (keyframe: number) => void;
  #text: string | null = null;
  #spans: readonly Span[] = [];
  #sentences = new Map<number, HTMLElement[]>();
  #current: number | null = null;

  constructor(seek: (keyframe: number) => void) {
    this.#seek = seek;
    this.#told = h("div", { class: "told", role: "group", "aria-label": "The story as it is told. Arrow up and down go from moment to moment", onkeydown: (event: KeyboardEvent) => this.#onKey(event) });
    this.#reading = new Reading(this.#told);
    this.element = h("div", { class: "telling" }, this.#told, this.#note);
  }

  update(story: Story): void {
    if (story.text === this.#text && story.spans.length === this.#spans.length) return;
    this.#text = story.text;
    this.#spans = story.spans;
    this.#sentences.clear();
    this.#current = null;
    const cut = story.text ? paragraphs(story.text, story.spans, story.thoughts) : [];
    fill(this.#told, ...cut.map((pieces) => h("p", {}, ...pieces.map((piece) => (piece.span === null ? words(piece) : this.#sentence(words(piece), piece.span))))));
    const first = this.#told.querySelector<HTMLElement>(".moment");
    if (first) first.tabIndex = 0;
    this.#note.hidden = !cut.some((pieces) => pieces.some(({ thought }) => thought));
  }

  /** Light the words of a keyframe. */
  show(keyframe: number | null): void {
    const span = keyframe === null ? null : spanOf(this.#spans, keyframe);
    if (span === this.#current) return;
    for (const sentence of this.#sentencesOf(this.#current)) sentence.removeAttribute("aria-current");
    this.#current = span;
    const now = this.#sentencesOf(span);
    for (const sentence of now) sentence.setAttribute("aria-current", "true");
    if (!now[0]) return;
    this.#rove(now[0]);
    this.#reading.reveal(now[0]);
  }

  #sentencesOf(span: number | null): HTMLElement[] {
    return span === null ? [] : (this.#sentences.get(span) ?? []);
  }

  #sentence(text: string | HTMLElement, span: number): HTMLElement {
    const go = (): void => {
      const keyframe = this.#spans[span]?.keyframes[0];
      if (keyframe !== undefined) this.#seek(keyframe);
    };
    // Not a button element: its words must wrap like the others.
    const sentence = h("span", { class: "moment", role: "button", tabindex: -1, onclick: go }, text);
    sentence.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      event.stopPropagation();
      go();
    });
    this.#sentences.set(span, [...this.#sentencesOf(span), sentence]);
    return sentence;
  }

  #onKey(event: KeyboardEvent): void {
    if (event.key !== "ArrowDown" && event.key !== "ArrowUp") return;
    const all = [...this.#told.querySelectorAll<HTMLElement>(".moment")];
    const at = all.indexOf(document.activeElement as HTMLElement);
    const next = all[at + (event.key === "ArrowDown" ? 1 : -1)];
    if (at < 0 || !next) return;
    event.preventDefault();
    this.#rove(next);
    next.focus();
  }

  /** One of the words is a tab stop, not all of them. */
  #rove(sentence: HTMLElement): void {
    for (const other of this.#told.querySelectorAll<HTMLElement>(".moment[tabindex='0']")) other.tabIndex = -1;
    sentence.tabIndex = 0;
  }
}
