/** What became of a theme's beats: a mark, a word and a colour for each, the same wherever it is shown, and what they mean. */

import type { Beat, KeyframeFigures, Story } from "./api";
import { h } from "./dom";

export type Outcome = "acted" | "stands" | "otherwise" | "missing" | "undone";

interface Shown {
  readonly mark: string;
  readonly word: string;
  readonly meaning: string;
}

const OUTCOMES: Readonly<Record<Outcome, Shown>> = {
  acted: { mark: "✓", word: "Acted", meaning: "the body is seen doing it" },
  stands: { mark: "≈", word: "Stands for it", meaning: "the body is seen doing something else in its place" },
  otherwise: { mark: "↷", word: "Done otherwise", meaning: "it is done in another way than its caption says, since the body or the place allows no more" },
  missing: { mark: "–", word: "Not shown", meaning: "words of the theme that nothing in the film shows" },
  undone: { mark: "∅", word: "Left undone", meaning: "the theme says that it does not happen" },
};

/** What the mark of a beat that something stands for says already; why that is may stand behind it. */
const IN_ITS_PLACE = /^the body is seen doing something else in its place(, )?/;

export function outcomeOf(beat: Beat): Outcome {
  if (beat.kind === "undone") return "undone";
  if (beat.acted) return "acted";
  return beat.stood_for ? "stands" : "missing";
}

/** Whether a moment was done in another way than its caption says. */
export const isOtherwise = (figures: KeyframeFigures): boolean => Boolean(figures.performed_as ?? figures.notes?.length);

/** A mark and its word; the mark alone says nothing to a screen reader. */
export function badge(outcome: Outcome): HTMLElement {
  const { mark, word, meaning } = OUTCOMES[outcome];
  return h("span", { class: "outcome-badge", "data-outcome": outcome, title: meaning }, h("i", { "aria-hidden": "true" }, mark), word);
}

/** What is not shown of a beat, or why something else is, in words; empty where there is nothing to say. */
export function lacking(beat: Beat): string {
  if (beat.stood_for) return beat.why.replace(IN_ITS_PLACE, "");
  if (!beat.acted) return beat.why;
  if (!beat.unshown.length) return "";
  return `not shown of it: ${beat.unshown.map((part) => `“${part}”`).join(", ")}`;
}

/** What the marks mean, those that are used first told; none where everything is acted as it was asked. */
export function legend(beats: readonly Beat[], figures: readonly KeyframeFigures[]): HTMLElement | null {
  const used = new Set<Outcome>(beats.map(outcomeOf));
  if (figures.some(isOtherwise)) used.add("otherwise");
  if (beats.some((beat) => beat.acted && lacking(beat))) used.add("missing");
  if ([...used].every((outcome) => outcome === "acted")) return null;
  const order = (Object.keys(OUTCOMES) as Outcome[]).filter((outcome) => used.has(outcome));
  return h("dl", { class: "outcome-legend", "aria-label": "What these words mean" }, ...order.flatMap((outcome) => [h("dt", {}, badge(outcome)), h("dd", {}, OUTCOMES[outcome].meaning)]));
}

/** What a moment shows instead of what was asked for, and why or for what. */
export interface Mark {
  readonly outcome: Outcome;
  readonly words: string;
}

/** What is done in another way than a caption says. */
export const otherwiseWords = ({ performed_as: as, notes }: KeyframeFigures): string[] => [...(as ? [`done as “${as}”, which the body knows`] : []), ...(notes ?? [])];

/** The moments that show something else than was asked for: what stands for a beat, and what is done in another way. */
export function marks({ keyframes, beats, report }: Story): Map<number, Mark> {
  const found = new Map<number, Mark>();
  for (const { index, beat } of keyframes) {
    const asked = beat === null ? undefined : beats[beat];
    if (asked?.stood_for) found.set(index, { outcome: "stands", words: `“${asked.text}”` });
  }
  for (const figures of report?.keyframes ?? []) if (isOtherwise(figures)) found.set(figures.keyframe, { outcome: "otherwise", words: otherwiseWords(figures).join(", ") });
  return found;
}
