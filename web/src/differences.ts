/** What two tellings of a story have in common, moment by moment, and what differs. */

import type { Keyframe, Story } from "./api";
import { placeWords } from "./furniture-words";
import { capital, SKILL_WORDS } from "./words";

/** A moment of both: its place in each, null where only the other has it. */
export interface Pair {
  readonly one: number | null;
  readonly other: number | null;
  /** Whether both say the same. */
  readonly same: boolean;
}

/** What differs, and what it is in each. */
export type Difference = readonly [what: string, one: string, other: string];

const FIELDS: readonly (readonly [string, (keyframe: Keyframe) => string])[] = [
  ["what is done", ({ skill }) => SKILL_WORDS[skill]],
  ["how", ({ caption }) => caption],
  ["mood", ({ emotion }) => emotion],
  ["where", placeWords],
];
/** What stands where a moment is missing. */
export const NOT_IN_IT = "is not in it";
/** What leaving a moment out costs beside changing all of one: two that differ in half of their words are still one. */
const LEFT_OUT = 0.6;

const apart = (one: Keyframe, other: Keyframe): number => FIELDS.filter(([, read]) => read(one) !== read(other)).length / FIELDS.length;

/** The moments of both in order, paired so that as little as possible is another: the least edit distance. */
export function align(one: readonly Keyframe[], other: readonly Keyframe[]): Pair[] {
  const costs = Array.from({ length: one.length + 1 }, (_, i) => Array.from({ length: other.length + 1 }, (_, j) => (i && j ? 0 : (i + j) * LEFT_OUT)));
  const cost = (i: number, j: number): number => costs[i]![j]!;
  const pairing = (i: number, j: number): number => cost(i - 1, j - 1) + apart(one[i - 1]!, other[j - 1]!);
  for (let i = 1; i <= one.length; i++) {
    for (let j = 1; j <= other.length; j++) costs[i]![j] = Math.min(pairing(i, j), cost(i - 1, j) + LEFT_OUT, cost(i, j - 1) + LEFT_OUT);
  }
  const pairs: Pair[] = [];
  let [i, j] = [one.length, other.length];
  while (i || j) {
    if (i && j && cost(i, j) === pairing(i, j)) pairs.unshift({ one: --i, other: --j, same: apart(one[i]!, other[j]!) === 0 });
    else if (i && cost(i, j) === cost(i - 1, j) + LEFT_OUT) pairs.unshift({ one: --i, other: null, same: false });
    else pairs.unshift({ one: null, other: --j, same: false });
  }
  return pairs;
}

/** Those that are in both. */
export const shared = (pairs: readonly Pair[]): (readonly [number, number])[] => pairs.flatMap(({ one, other }) => (one === null || other === null ? [] : [[one, other] as const]));

/** Where among those in both a comparison begins: at the first that differs, or before one that only one of them has. */
export function firstApart(pairs: readonly Pair[]): number {
  const at = pairs.findIndex(({ same }) => !same);
  if (at < 0) return 0;
  const whole = pairs[at]!.one !== null && pairs[at]!.other !== null;
  return Math.max(shared(pairs.slice(0, at)).length - (whole ? 0 : 1), 0);
}

/** All that differs in what was asked for: who moves the body, seed, person, home, then moment by moment. */
export function differences(one: Story, other: Story): Difference[] {
  const of = (what: string, read: (story: Story) => string): Difference[] => (read(one) === read(other) ? [] : [[what, read(one), read(other)]]);
  return [
    ...(one.backend === other.backend ? [] : of("Moved by", moverOf)),
    ...of("Seed", ({ seed }) => String(seed)),
    ...of("Played by", ({ character }) => `${character.name}, ${character.member || character.age}, ${character.height.toFixed(2)} m, ${character.outfit}`),
    ...of("Played in", ({ home }) => home?.rooms.map(({ layout_id }) => layout_id).join(", ") ?? "…"),
    ...align(one.keyframes, other.keyframes).flatMap((pair) => ofMoment(pair, one, other)),
  ];
}

/** A backend in words where the report has them, "rules" for "rules (procedural): …". */
const moverOf = ({ backend, report }: Story): string => (report?.moved_by?.[backend] ?? backend).split(/ ?[(:]/, 1)[0]!;

function ofMoment({ one, other, same }: Pair, left: Story, right: Story): Difference[] {
  if (same) return [];
  const [mine, theirs] = [left.keyframes[one ?? -1], right.keyframes[other ?? -1]];
  const numbers = [...new Set([one, other])].flatMap((index) => (index === null ? [] : [index + 1]));
  const number = `Moment ${numbers.join(" → ")}`;
  if (!mine || !theirs) return [[number, told(mine), told(theirs)]];
  return FIELDS.filter(([, read]) => read(mine) !== read(theirs)).map(([what, read]) => [`${number}, ${what}`, read(mine), read(theirs)]);
}

const told = (keyframe: Keyframe | undefined): string => (keyframe ? capital(FIELDS.map(([, read]) => read(keyframe)).join(", ")) : NOT_IN_IT);
