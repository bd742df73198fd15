/** Furniture as plans show it: its outline, and lines that tell a bed from a table and its front from its back. */

import { s } from "./dom";
import type { Piece } from "./room-api";

export type Kind = "sit" | "bed" | "surface" | "storage" | "media" | "light" | "decor" | "rug" | "other";

const KINDS: readonly (readonly [Kind, RegExp])[] = [
  ["rug", /^rug$|carpet/],
  ["decor", /vase|plant|picture|mirror|curtain|clock|statue|trash|pet_bed|book$|pillow/],
  ["storage", /nightstand|wardrobe|cabinet|dresser|chest|shelf|refrigerator|stove|dishwasher|machine|microwave/],
  ["media", /tv|monitor/],
  ["light", /lamp/],
  ["bed", /bed/],
  ["sit", /chair|sofa|stool|ottoman|bench/],
  ["surface", /table|desk|counter|^bar$/],
];

/** What a piece is like, for its colour. */
export const kindOf = (category: string): Kind => KINDS.find(([, words]) => words.test(category))?.[0] ?? "other";

const RANK: readonly Kind[] = ["bed", "sit", "surface", "storage", "media", "other", "rug", "light", "decor"];

/** The same counts, with what a room is for first. */
export const ranked = (furniture: Readonly<Record<string, number>>): Record<string, number> =>
  Object.fromEntries(Object.entries(furniture).sort(([a], [b]) => RANK.indexOf(kindOf(a)) - RANK.indexOf(kindOf(b))));

/** Centimetres, so that letters keep sizes that browsers can draw. */
export const CM = 100;

/** The piece in its own frame, front downwards; the group that holds it moves and turns it. */
export function glyph(piece: Piece): SVGElement[] {
  const [w, , d] = piece.size.map((length) => length * CM) as [number, number, number];
  if (piece.shape?.length) return measured(piece.shape, w, d);
  const { category } = piece;
  const kind = kindOf(category);
  if (/stool|^plant$|^vase$|lamp|round/.test(category)) return [disc("outline", w, d), ...(kind === "light" || category === "plant" ? [disc("detail", w / 2.2, d / 2.2)] : [])];
  if (kind === "rug") return [box("outline", -w / 2, -d / 2, w, d), box("detail", -w / 2 + 8, -d / 2 + 8, w - 16, d - 16)];
  if (kind === "bed") return bed(w, d);
  if (category.includes("sofa")) return sofa(category, w, d);
  if (kind === "sit") return chair(category, w, d);
  const outline = box("outline", -w / 2, -d / 2, w, d);
  // Doors and drawers, and the face of a screen, are where the front is.
  if (kind === "storage" || kind === "media") return [outline, line(-w / 2, d / 2 - Math.min(5, d / 4), w / 2, d / 2 - Math.min(5, d / 4))];
  return [outline];
}

function bed(w: number, d: number): SVGElement[] {
  const [beside, pillows] = [w * 0.06, w > 115 ? 2 : 1];
  const width = (w - beside * (pillows + 1)) / pillows;
  return [
    box("outline", -w / 2, -d / 2, w, d, 6),
    ...Array.from({ length: pillows }, (_, place) => box("detail", -w / 2 + beside + place * (width + beside), -d / 2 + d * 0.05, width, d * 0.15, 5)),
    line(-w / 2, -d / 2 + d * 0.27, w / 2, -d / 2 + d * 0.27),
  ];
}

function sofa(category: string, w: number, d: number): SVGElement[] {
  if (category === "lazy_sofa" || d > 1.3 * w) return [box("outline", -w / 2, -d / 2, w, d, Math.min(w, d) / 3)];
  const corner = category === "l_shaped_sofa" && d >= 120 && w >= 170;
  const depth = corner ? Math.min(98, 0.62 * d) : d;
  const [back, arm] = [Math.min(20, depth * 0.26), Math.min(16, w * 0.11)];
  const [left, top, front] = [-w / 2, -d / 2, -d / 2 + depth];
  const inner = corner ? w / 2 - arm - Math.min(78, 0.38 * w) : w / 2;
  const outline = corner ? `M${left} ${top}H${w / 2}V${d / 2}H${inner}V${front}H${left}Z` : `M${left} ${top}H${w / 2}V${front}H${left}Z`;
  const lines = `M${left + arm} ${front}V${top + back}H${w / 2 - arm}V${front}`;
  const seats = Math.max(1, Math.round((w - 2 * arm) / 75));
  const seams = Array.from({ length: seats - 1 }, (_, place) => {
    const x = left + arm + ((place + 1) * (w - 2 * arm)) / seats;
    return line(x, top + back, x, front);
  });
  return [s("path", { d: outline, class: "outline" }), s("path", { d: lines, class: "detail" }), ...seams];
}

function chair(category: string, w: number, d: number): SVGElement[] {
  const outline = box("outline", -w / 2, -d / 2, w, d, 5);
  if (/bench|ottoman/.test(category)) return [outline];
  const back = Math.min(14, d * 0.2);
  const arms = /armchair|lounge/.test(category) ? [line(-w / 2 + w * 0.15, -d / 2 + back, -w / 2 + w * 0.15, d / 2), line(w / 2 - w * 0.15, -d / 2 + back, w / 2 - w * 0.15, d / 2)] : [];
  return [outline, line(-w / 2, -d / 2 + back, w / 2, -d / 2 + back), ...arms];
}

/** The boxes that were measured from a mesh: what is sat or lain on, and what rises behind and beside it. */
function measured(shape: NonNullable<Piece["shape"]>, w: number, d: number): SVGElement[] {
  const seen = shape.filter(([role]) => /back|arm|seat|mattress|top|pillow/.test(role));
  return [box("outline", -w / 2, -d / 2, w, d), ...seen.map(([, low, high]) => box("detail", low[0] * CM, low[2] * CM, (high[0] - low[0]) * CM, (high[2] - low[2]) * CM))];
}

const box = (name: string, x: number, y: number, width: number, height: number, rx = 0): SVGElement =>
  s("rect", { class: name, x, y, width: Math.max(width, 0), height: Math.max(height, 0), ...(rx ? { rx: Math.min(rx, width / 2, height / 2) } : {}) });
const disc = (name: string, w: number, d: number): SVGElement => s("ellipse", { class: name, rx: w / 2, ry: d / 2 });
const line = (x1: number, y1: number, x2: number, y2: number): SVGElement => s("line", { class: "detail", x1, y1, x2, y2 });
