/** Which walls stand between an onlooker and the body, as in a doll's house. Points are [x, z] on the floor. */

import type { Home, Opening, Point2 } from "./api";

export interface WallSide {
  readonly a: Point2;
  readonly b: Point2;
  readonly height: number;
  /** Unit vector from the room outwards. */
  readonly out: Point2;
  readonly openings: readonly Opening[];
}

/** How thick walls are, outwards from the room, metres. */
export const WALL_DEPTH = 0.06;

/** A point of a room's own frame in the home: p_home = R_y(yaw) p + offset. */
export function toHome([x, z]: Point2, room: { readonly offset: readonly [number, number, number]; readonly yaw: number }): Point2 {
  const cos = Math.cos(room.yaw);
  const sin = Math.sin(room.yaw);
  return [x * cos + z * sin + room.offset[0], -x * sin + z * cos + room.offset[2]];
}

/** The floors' outlines in the home. */
export function outlines(home: Home): Point2[][] {
  return home.rooms.map((room) => room.layout.floor_polygon.map((corner) => toHome(corner, room)));
}

/** Every wall with the side that looks away from its room. */
export function wallSides(home: Home): WallSide[] {
  const rooms = outlines(home);
  return home.walls.map(({ segment: [a, b], height, openings }) => {
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
    const left: Point2 = [-(b[1] - a[1]) / length, (b[0] - a[0]) / length];
    const middle: Point2 = [(a[0] + b[0]) / 2 + 0.03 * left[0], (a[1] + b[1]) / 2 + 0.03 * left[1]];
    const inside = rooms.some((room) => contains(room, middle));
    return { a, b, height, openings, out: inside ? [-left[0], -left[1]] : left };
  });
}

/** Whether a polygon holds a point. */
export function contains(polygon: readonly Point2[], [x, z]: Point2): boolean {
  let inside = false;
  for (const [index, [x1, z1]] of polygon.entries()) {
    const [x2, z2] = polygon[(index + 1) % polygon.length]!;
    if (z1 > z !== z2 > z && x < ((x2 - x1) * (z - z1)) / (z2 - z1) + x1) inside = !inside;
  }
  return inside;
}

/** Room that the body is given on both sides, metres, and the share of the way to it that must be free there. */
const ELBOW = 0.8;
const BEFORE = 0.8;

/** Whether a wall hides the room or the body from the eye: it is seen from outside, or stands between the two. */
export function hides(wall: WallSide, eye: Point2, body: Point2): boolean {
  const middle: Point2 = [(wall.a[0] + wall.b[0]) / 2, (wall.a[1] + wall.b[1]) / 2];
  if ((eye[0] - middle[0]) * wall.out[0] + (eye[1] - middle[1]) * wall.out[1] > 0.02) return true;
  const sight = Math.hypot(body[0] - eye[0], body[1] - eye[1]) || 1;
  const aside: Point2 = [(-ELBOW * (body[1] - eye[1])) / sight, (ELBOW * (body[0] - eye[0])) / sight];
  // A wall that the body stands close to stays, so beside the body only what is well before it counts.
  return ([[0, 1], [1, BEFORE], [-1, BEFORE]] as const).some(([side, share]) => {
    const aim: Point2 = [body[0] + side * aside[0], body[1] + side * aside[1]];
    return meeting(eye, aim, wall.a, wall.b) < share;
  });
}

/** Share of the way from `from` to `to` at which it meets the segment a b; infinite if it does not. */
function meeting(from: Point2, to: Point2, a: Point2, b: Point2): number {
  const way: Point2 = [to[0] - from[0], to[1] - from[1]];
  const along: Point2 = [b[0] - a[0], b[1] - a[1]];
  const turn = way[0] * along[1] - way[1] * along[0];
  const gap: Point2 = [a[0] - from[0], a[1] - from[1]];
  const share = (gap[0] * along[1] - gap[1] * along[0]) / turn;
  const place = (gap[0] * way[1] - gap[1] * way[0]) / turn;
  return turn !== 0 && share > 0 && place >= 0 && place <= 1 ? share : Infinity;
}

/** Distance from a point to a segment. */
export function distance([x, z]: Point2, a: Point2, b: Point2): number {
  const dx = b[0] - a[0], dz = b[1] - a[1];
  const share = Math.min(Math.max(((x - a[0]) * dx + (z - a[1]) * dz) / (dx * dx + dz * dz || 1), 0), 1);
  return Math.hypot(x - a[0] - share * dx, z - a[1] - share * dz);
}

/** Where along a wall something stands on the floor: all of it but doors and doorways, round the corners at both ends. */
export function stumps({ a, b, openings }: WallSide): [number, number][] {
  const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
  const along = ([x, z]: Point2): number => ((x - a[0]) * (b[0] - a[0]) + (z - a[1]) * (b[1] - a[1])) / length;
  const gaps = openings
    .filter((opening) => opening.bottom < 0.1)
    .map(({ segment }) => [Math.min(...segment.map(along)), Math.max(...segment.map(along))] as [number, number])
    .sort((one, other) => one[0] - other[0]);
  const found: [number, number][] = [];
  let at = -WALL_DEPTH;
  for (const [from, to] of [...gaps, [length + WALL_DEPTH, Infinity]] as [number, number][]) {
    if (from - at > 0.001) found.push([at, from]);
    at = Math.max(at, to);
  }
  return found;
}
