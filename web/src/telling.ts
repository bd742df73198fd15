/** The told story: the words that are being acted are lit and kept in sight; words lead back to their moment. */

import type { Story } from "./api";
import { isStill } from "./appearance";
import { fill, h } from "./dom";
import { paragraphs, spanOf, type Piece, type Span } from "./spans";

/** Milliseconds after a reader's own scrolling before the text follows the film again. */
const READING_MS = 6000;

/** Told words; slanted where the body is not seen doing what they say. */
function words({ text, thought }: Piece): string | HTMLElement {
  return thought ? h("em", { class: "unseen", title: "told, and not seen: the body does not show it" }, text) : text;
}

export class Telling {
  readonly element: HTMLElement;
  readonly #seek: (keyframe: number) => void;
  #text: string | null = null;
  #spans: readonly Span[] = [];
  #sentences = new Map<number, HTMLElement[]>();
  #current: number | null = null;
  #read = -Infinity;

  constructor(seek: (keyframe: number) => void) {
    this.#seek = seek;
    this.element = h("div", { class: "told", role: "group", "aria-label": "The story as it is told. Arrow up and down go from moment to moment", onkeydown: (event: KeyboardEvent) => this.#onKey(event) });
    for (const name of ["wheel", "touchmove", "pointerdown"]) {
      this.element.addEventListener(name, () => (this.#read = performance.now()), { passive: true });
    }
  }

  update(story: Story): void {
    if (story.text === this.#text && story.spans.length === this.#spans.length) return;
    this.#text = story.text;
    this.#spans = story.spans;
    this.#sentences.clear();
    this.#current = null;
    const cut = story.text ? paragraphs(story.text, story.spans, story.thoughts) : [];
    fill(this.element, ...cut.map((pieces) => h("p", {}, ...pieces.map((piece) => (piece.span === null ? words(piece) : this.#sentence(words(piece), piece.span))))));
    const first = this.element.querySelector<HTMLElement>(".moment");
    if (first) first.tabIndex = 0;
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
    this.#reveal(now[0]);
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
    const all = [...this.element.querySelectorAll<HTMLElement>(".moment")];
    const at = all.indexOf(document.activeElement as HTMLElement);
    const next = all[at + (event.key === "ArrowDown" ? 1 : -1)];
    if (at < 0 || !next) return;
    event.preventDefault();
    this.#rove(next);
    next.focus();
  }

  /** One of the words is a tab stop, not all of them. */
  #rove(sentence: HTMLElement): void {
    for (const other of this.element.querySelectorAll<HTMLElement>(".moment[tabindex='0']")) other.tabIndex = -1;
    sentence.tabIndex = 0;
  }

  /** Scroll the text, never the page. */
  #reveal(sentence: HTMLElement): void {
    if (performance.now() - this.#read < READING_MS) return;
    const box = this.element.getBoundingClientRect();
    const place = sentence.getBoundingClientRect();
    const middle = place.top + place.height / 2 - box.top - this.element.clientHeight * 0.42;
    if (Math.abs(middle) > 24) this.element.scrollBy({ top: middle, behavior: isStill() ? "auto" : "smooth" });
  }
}
