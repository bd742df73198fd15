/** Which backends moved the body of a story, for how much of its film, and why another did than the one that was asked for. */

import { h } from "./dom";
import { noteWords, percent } from "./words";

/** A piece of the film that one backend made, from frame to frame. */
export interface Phase {
  readonly start: number;
  readonly stop: number;
  readonly backend: string;
  /** Why it is not, or not wholly, what the backend that was asked for makes. */
  readonly fallback: string | null;
}

export interface Mover {
  readonly backend: string;
  /** Of the film, 0 to 1. */
  readonly share: number;
  /** Why it moved the body, or what was laid over it, the most frequent first; each for how much of the film. */
  readonly reasons: readonly { readonly words: string; readonly share: number }[];
}

/** The backends, whoever moved it longest first. */
export function moversOf(phases: readonly Phase[]): Mover[] {
  const frames = phases.reduce((sum, { start, stop }) => sum + stop - start, 0);
  const found = new Map<string, { frames: number; reasons: Map<string, number> }>();
  for (const { start, stop, backend, fallback } of phases) {
    const mover = found.get(backend) ?? { frames: 0, reasons: new Map<string, number>() };
    found.set(backend, mover);
    mover.frames += stop - start;
    if (fallback) mover.reasons.set(fallback, (mover.reasons.get(fallback) ?? 0) + stop - start);
  }
  return [...found]
    .map(([backend, mover]) => ({
      backend,
      share: mover.frames / frames,
      reasons: [...mover.reasons].map(([words, length]) => ({ words: noteWords(words), share: length / frames })).sort((a, b) => b.share - a.share),
    }))
    .sort((a, b) => b.share - a.share);
}

/** "Moved by rules (procedural): no learned model, no simulation; 76.3 % of the film". */
const moverWords = ({ backend, share }: Mover, words: Readonly<Record<string, string>>): string => `Moved by ${words[backend] ?? backend}; ${percent(share)} of the film`;

/** "diffusion: it floated" as "instead of diffusion, since it floated". */
const sinceWords = (words: string): string => words.replace(/^(\w+): /, "instead of $1, since ");

/** All of them as a list, each backend in the words given for it; null while nothing is known. */
export function moverList(phases: readonly Phase[], words: Readonly<Record<string, string>> = {}): HTMLElement | null {
  const movers = moversOf(phases);
  if (!movers.length) return null;
  const reasons = ({ reasons: all }: Mover): HTMLElement | null =>
    all.length ? h("ul", {}, ...all.map(({ words, share }) => h("li", {}, `${percent(share)}: ${sinceWords(words)}`))) : null;
  return h("ul", { class: "movers", "aria-label": "What moved the body" }, ...movers.map((mover) => h("li", {}, moverWords(mover, words), reasons(mover))));
}
