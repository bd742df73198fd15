/** What a take was made from, what was changed for it, and from where on it is acted again. */

import type { Story } from "./api";
import { align, differences, NOT_IN_IT } from "./differences";
import { fill, h } from "./dom";
import { takeWords } from "./words";

/** What is said of a story as a whole, where it differs. */
const WHOLE: Readonly<Record<string, string>> = { "Moved by": "what moves the body", Seed: "the seed", "Played by": "who plays", "Played in": "the home" };

/** "the seed, moment 6 (how, mood)": all that was changed. */
export function changeWords(origin: Story, take: Story): string {
  const named = new Map<string, string[]>();
  const found = differences(origin, take);
  const elsewhere = found.some(([head]) => head === "Played in");
  for (const [head, before, now] of found) {
    // In another home all furniture is another.
    if (elsewhere && head.endsWith(", where")) continue;
    const [what = head, field] = head.split(", ");
    const how = field ?? (before === NOT_IN_IT ? "new" : now === NOT_IN_IT ? "left out" : "");
    named.set(what, [...(named.get(what) ?? []), ...(how ? [how] : [])]);
  }
  return [...named].map(([what, how]) => `${WHOLE[what] ?? what.toLowerCase()}${how.length ? ` (${how.join(", ")})` : ""}`).join(", ");
}

/**
 * From where on the body moves anew: `reused` moments are kept, frame for frame. What comes right before the first change is
 * acted again too, since its ending leads to what follows. Null while it is not known.
 */
export function againWords({ reused, take, keyframes }: Story, origin: Story | null): string | null {
  if (!take || !keyframes.length) return null;
  if (reused >= keyframes.length) return "Nothing had to be acted again.";
  if (!reused) return "All of it is acted again.";
  // All pairs before the first that differs are in both.
  const first = origin ? align(origin.keyframes, keyframes).findIndex(({ same }) => !same) : -1;
  const leads = first > reused ? ", so that it leads to what follows now" : "";
  return `Acted again from moment ${reused + 1} on${leads}; before it, the body does the same.`;
}

/** Fill a line with it; `origin` is null while it is not there, or no more. */
export function showOrigin(line: HTMLElement, take: Story, origin: Story | null): void {
  line.hidden = !take.derived_from;
  if (!take.derived_from) return;
  const changed = origin && take.keyframes.length ? changeWords(origin, take) : "";
  const again = againWords(take, origin);
  fill(
    line,
    `${takeWords(take)}, made from `,
    h("a", { href: `#/stories/${take.derived_from}` }, "the one before"),
    changed ? `; changed: ${changed}. ` : ". ",
    again ? `${again} ` : null,
    h("a", { href: `#/stories/${take.id}?beside=${take.derived_from}` }, "See both side by side"),
  );
}
