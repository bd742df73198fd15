/** Which furniture stands between an onlooker and the body: boxes on the floor of the home, and lines through them. */

import type { Home, Point2 } from "./api";
import type { Point3 } from "./pose";
import { contains, distance, outlines, toHome, wallSides, type WallSide } from "./walls";

/** An upright box. */
export interface Box {
  /** Middle of the bottom. */
  readonly at: Point3;
  readonly size: readonly [number, number, number];
  readonly yaw: number;
  /** The box that this one stands on. */
  readonly on: number | null;
}

/** Metres around furniture that count as furniture: near the eye it takes much of the picture, near the body little. */
const WIDE = 0.3;
const TIGHT = 0.06;
/** Share of the way from the eye that is near it. */
const NEAR = 0.6;
/** What is this near to the body is what it uses, metres. */
const USED = 0.5;
const SAT_ON = 0.16;
/** Metres from the pelvis to the points that must be seen. */
const SEEN = [0.1, 0.55] as const;
const FLAT = 0.03;

/** The furniture of all rooms, in the home's frame. */
export function boxesOf(home: Home): Box[] {
  const plain = home.rooms.flatMap((room) =>
    room.layout.objects.filter(({ size }) => size[1] > FLAT).map(({ position: [x, y, z], size, yaw }) => {
      const [homeX, homeZ] = toHome([x, z], room);
      return { at: [homeX, y + room.offset[1], homeZ] as Point3, size, yaw: yaw + room.yaw };
    }),
  );
  return plain.map((box) => {
    const below = plain.findIndex((other) => other !== box && Math.abs(other.at[1] + other.size[1] - box.at[1]) < 0.1 && gap(other, box.at) < 0.02);
    return { ...box, on: below < 0 ? null : below };
  });
}

/** Distance from a point to a box, 0 inside. */
export function gap({ at, size, yaw }: Omit<Box, "on">, point: Point3): number {
  const [x, y, z] = toBox(at, yaw, point);
  return Math.hypot(Math.max(Math.abs(x) - size[0] / 2, 0), Math.max(-y, y - size[1], 0), Math.max(Math.abs(z) - size[2] / 2, 0));
}

/** The box a point belongs to: the least of those that hold it, else the nearest; -1 without boxes. */
export function boxAt(boxes: readonly Box[], point: Point3): number {
  let best = -1;
  let least: readonly [number, number] = [Infinity, Infinity];
  for (const [index, box] of boxes.entries()) {
    const rank = [Math.max(gap(box, point) - 0.02, 0), box.size[0] * box.size[1] * box.size[2]] as const;
    if (rank[0] < least[0] || (rank[0] === least[0] && rank[1] < least[1])) [best, least] = [index, rank];
  }
  return best;
}

/** Whether a box is in the way from an eye to a body, whose pelvis is given; what the body sits or lies on is not. */
export function stands(box: Box, eye: Point3, body: Point3): boolean {
  if (gap(box, body) < SAT_ON) return false;
  return SEEN.some((up) => {
    const aim: Point3 = [body[0], body[1] + up, body[2]];
    const length = Math.hypot(aim[0] - eye[0], aim[1] - eye[1], aim[2] - eye[2]);
    return crosses(box, eye, aim, NEAR, WIDE) || crosses(box, eye, aim, 1 - USED / length, TIGHT);
  });
}

/** Whether the first share of the way from `from` to `to` meets the box with a margin around it. */
function crosses({ at, size, yaw }: Box, from: Point3, to: Point3, share: number, margin: number): boolean {
  const start = toBox(at, yaw, from);
  const end = toBox(at, yaw, to);
  const low = [-size[0] / 2 - margin, -margin, -size[2] / 2 - margin];
  const high = [size[0] / 2 + margin, size[1] + margin, size[2] / 2 + margin];
  let enter = 0;
  let leave = share;
  for (let axis = 0; axis < 3; axis++) {
    const way = end[axis]! - start[axis]!;
    const a = (low[axis]! - start[axis]!) / (way || 1e-9);
    const b = (high[axis]! - start[axis]!) / (way || 1e-9);
    enter = Math.max(enter, Math.min(a, b));
    leave = Math.min(leave, Math.max(a, b));
  }
  return enter < leave;
}

/** A point of the home in a box's own frame. */
function toBox(at: Point3, yaw: number, [x, y, z]: Point3): Point3 {
  const cos = Math.cos(yaw);
  const sin = Math.sin(yaw);
  const [dx, dz] = [x - at[0], z - at[2]];
  return [dx * cos - dz * sin, y - at[1], dx * sin + dz * cos];
}

/** What a place to look from costs: furniture and walls in the way, and being out of doors. */
export class Lookout {
  readonly #boxes: readonly Box[];
  readonly #walls: readonly WallSide[];
  readonly #rooms: readonly Point2[][];

  constructor(home: Home) {
    this.#boxes = boxesOf(home).filter((box) => box.at[1] < 1.3);
    this.#walls = wallSides(home);
    this.#rooms = outlines(home);
  }

  /** 0 where the body is seen best; a wardrobe in the way costs 1. */
  cost(eye: Point3, body: Point3): number {
    const furniture = this.#boxes.filter((box) => stands(box, eye, body)).reduce((sum, { size }) => sum + Math.min(0.3 + size[1] * 0.4, 1), 0);
    const floor: Point2 = [eye[0], eye[2]];
    const outdoors = this.#rooms.some((room) => contains(room, floor)) ? 0 : 0.25;
    const behind = this.#walls.filter((wall) => crossed(wall, floor, [body[0], body[2]])).length;
    const grazing = this.#walls.some((wall) => distance(floor, wall.a, wall.b) < 0.25) ? 0.3 : 0;
    return furniture + outdoors + grazing + 0.2 * behind;
  }
}

function crossed({ a, b }: WallSide, eye: Point2, body: Point2): boolean {
  const side = (p: Point2, q: Point2, r: Point2): number => (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
  return side(eye, body, a) * side(eye, body, b) < 0 && side(a, b, eye) * side(a, b, body) < 0;
}
