/** A room from above as SVG, in centimetres: x to the right, z downwards, so that left and right are not mirrored. */

import type { Opening, Point2 } from "./api";
import { s } from "./dom";
import { CM, glyph, kindOf } from "./glyphs";
import type { Piece, Room } from "./room-api";
import { contains } from "./walls";

/** Left, top, width and height. */
export type Box = readonly [number, number, number, number];

/** What hangs higher than this is drawn as an outline, metres. */
const HANGING = 1.3;
const MARGIN = 22;
const r = (value: number): number => Math.round(value * 10) / 10;

/** The rectangle around a room and its walls. */
export function boxOf(room: Room): Box {
  const xs = [...room.floor_polygon.map(([x]) => x), ...room.objects.map(({ position }) => position[0])];
  const zs = [...room.floor_polygon.map(([, z]) => z), ...room.objects.map(({ position }) => position[2])];
  const [left, top] = [Math.min(...xs) * CM - MARGIN, Math.min(...zs) * CM - MARGIN];
  return [r(left), r(top), r(Math.max(...xs) * CM + MARGIN - left), r(Math.max(...zs) * CM + MARGIN - top)];
}

export const isHanging = (piece: Piece): boolean => piece.position[1] >= HANGING;

/** Where an object's middle is. */
export const centreOf = ({ position: [x, , z] }: Piece): Point2 => [r(x * CM), r(z * CM)];

/** Floor, walls, doors and windows. */
export function shell(room: Room): SVGGElement {
  const outline = room.floor_polygon.map(([x, z]) => `${r(x * CM)},${r(z * CM)}`).join(" ");
  return s(
    "g",
    { class: "shell", "aria-hidden": "true" },
    s("polygon", { class: "floor", points: outline }),
    ...room.windows.map((window) => s("g", { class: "window" }, stretch(window, "gap"), stretch(window, "glass"))),
    ...room.doors.map((door) => s("g", { class: "door" }, stretch(door, "gap"), swing(door, room.floor_polygon))),
  );
}

/** Every object by its id, in the order in which they lie over each other. */
export function pieces(room: Room): Map<string, SVGGElement> {
  const top = ({ position, size }: Piece): number => position[1] + size[1];
  const ordered = [...room.objects].sort((a, b) => top(a) - top(b));
  return new Map(ordered.map((piece) => [piece.id, drawn(piece)]));
}

function drawn(piece: Piece): SVGGElement {
  const [x, z] = centreOf(piece);
  const hanging = isHanging(piece) ? " hanging" : "";
  const turn = r((-piece.yaw * 180) / Math.PI);
  return s("g", { class: `piece ${kindOf(piece.category)}${hanging}`, "data-object": piece.id, transform: `translate(${x} ${z}) rotate(${turn})` }, ...glyph(piece));
}

/** A whole room without words: for a card. */
export function thumbnail(room: Room): SVGSVGElement {
  return s("svg", { class: "room-plan", viewBox: boxOf(room).join(" "), "aria-hidden": "true", focusable: "false" }, shell(room), ...pieces(room).values());
}

/** Keep what is measured in pixels as large as it is, whatever the plan's size: `--unit` is one pixel in centimetres. */
export function keepUnits(plan: SVGSVGElement, changed: (unit: number) => void = () => undefined): () => void {
  const observer = new ResizeObserver(() => {
    const { width, height } = plan.viewBox.baseVal;
    if (!plan.clientWidth || !plan.clientHeight) return;
    const unit = Math.max(width / plan.clientWidth, height / plan.clientHeight);
    plan.style.setProperty("--unit", `${unit.toFixed(3)}px`);
    changed(unit);
  });
  observer.observe(plan);
  return () => observer.disconnect();
}

function stretch({ segment: [a, b] }: Opening, name: string): SVGLineElement {
  return s("line", { class: name, x1: r(a[0] * CM), y1: r(a[1] * CM), x2: r(b[0] * CM), y2: r(b[1] * CM) });
}

/** The leaf and the quarter of a circle that it opens through, into the room. */
function swing({ segment: [a, b] }: Opening, floor: readonly Point2[]): SVGPathElement {
  const [dx, dz] = [b[0] - a[0], b[1] - a[1]];
  const length = Math.hypot(dx, dz) || 1;
  const ahead: Point2 = [(a[0] + b[0]) / 2 - (0.1 * dz) / length, (a[1] + b[1]) / 2 + (0.1 * dx) / length];
  const side = contains(floor, ahead) ? 1 : -1;
  const leaf: Point2 = [a[0] - side * dz, a[1] + side * dx];
  const at = (point: Point2): string => `${r(point[0] * CM)} ${r(point[1] * CM)}`;
  return s("path", { class: "swing", d: `M${at(a)}L${at(leaf)}A${r(length * CM)} ${r(length * CM)} 0 0 ${side > 0 ? 0 : 1} ${at(b)}` });
}
