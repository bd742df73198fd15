/** Names on a plan: the larger a piece the sooner it is named, and what would lie over another name is left out. */

import type { Point2 } from "./api";
import { s } from "./dom";

export interface Name {
  readonly id: string;
  readonly words: string;
  readonly at: Point2;
  /** How much it matters that it is shown; 0: not at all. */
  readonly weight: number;
}

/** How tall letters are, and how wide one is on average, pixels. */
const HEIGHT = 12.5;
const WIDTH = 6.6;
/** Half of a sign's width. */
const SIGN = 11;

/**
 * Texts for all names; those that find no free place have the class "crowded". `unit` is one pixel in the plan's measure,
 * `signs` are middles of signs that names do not lie over.
 */
export function placeNames(names: readonly Name[], unit: number, signs: readonly Point2[] = []): SVGTextElement[] {
  const taken = signs.map(([x, y]) => ({ x, y, half: SIGN * unit }));
  const lift = HEIGHT * 1.15 * unit;
  return [...names]
    .sort((a, b) => b.weight - a.weight)
    .map(({ id, words, at: [x, y], weight }) => {
      const half = (words.length * WIDTH * unit) / 2;
      const free = (weight > 0 ? [0, lift, -lift] : []).find((shift) => taken.every((other) => Math.abs(other.x - x) > other.half + half || Math.abs(other.y - y - shift) > lift));
      if (free !== undefined) taken.push({ x, y: y + free, half });
      return s("text", { x, y: y + (free ?? 0), class: free === undefined ? "crowded" : "", "data-object": id }, words);
    });
}

/** The same points, those that are nearer to each other than `gap` pushed apart. */
export function apart(points: readonly Point2[], gap: number): Point2[] {
  const moved = points.map(([x, y]) => [x, y] as [number, number]);
  for (let round = 0; round < 30; round++) {
    for (const [i, a] of moved.entries()) {
      for (const b of moved.slice(i + 1)) {
        const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
        const distance = Math.hypot(dx, dy);
        if (distance >= gap) continue;
        // What lies in one place is parted sidewards.
        const [ux, uy] = distance > 1e-6 ? [dx / distance, dy / distance] : [1, 0];
        const push = (gap - distance) / 2;
        a[0] -= ux * push;
        a[1] -= uy * push;
        b[0] += ux * push;
        b[1] += uy * push;
      }
    }
  }
  return moved;
}
