/** What a list or a text scrolls to by itself: what is acted now stays in sight, unless somebody has just scrolled. */

import { isStill } from "./appearance";

/** Milliseconds after a reader's own scrolling before it follows the film again. */
const READING_MS = 6000;

export class Reading {
  readonly #box: HTMLElement;
  #read = -Infinity;

  constructor(box: HTMLElement) {
    this.#box = box;
    for (const name of ["wheel", "touchmove", "pointerdown"]) box.addEventListener(name, () => (this.#read = performance.now()), { passive: true });
  }

  /** Scroll the box, never the page, until what is in it stands a little above its middle. */
  reveal(part: HTMLElement): void {
    if (performance.now() - this.#read < READING_MS) return;
    const box = this.#box.getBoundingClientRect();
    const place = part.getBoundingClientRect();
    const middle = place.top + place.height / 2 - box.top - this.#box.clientHeight * 0.42;
    if (Math.abs(middle) > 24) this.#box.scrollBy({ top: middle, behavior: isStill() ? "auto" : "smooth" });
  }
}
