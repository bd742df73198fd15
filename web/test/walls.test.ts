import { describe, expect, test } from "vitest";
import type { Home, Point2 } from "../src/api";
import { contains, hides, outlines, stumps, WALL_DEPTH, wallSides } from "../src/walls";

const square: Point2[] = [[-2, -2], [-2, 2], [2, 2], [2, -2]];
const sides = (x: number): { segment: [Point2, Point2]; height: number; openings: [] }[] =>
  square.map((corner, i) => {
    const next = square[(i + 1) % 4]!;
    return { segment: [[corner[0] + x, corner[1]], [next[0] + x, next[1]]], height: 2.5, openings: [] };
  });
const room = (x: number, yaw: number): Home["rooms"][number] => ({
  layout: { id: "r", room_type: "study", floor_polygon: square, objects: [] },
  offset: [x, 0, 0],
  yaw,
});
/** Two rooms side by side with a gap of 12 cm. */
const home: Home = { rooms: [room(0, 0), room(4.12, Math.PI / 2)], walls: [...sides(0), ...sides(4.12)], doorways: [] };

describe("walls", () => {
  test("every wall looks away from its own room", () => {
    const rooms = outlines(home);
    for (const [index, wall] of wallSides(home).entries()) {
      const middle: Point2 = [(wall.a[0] + wall.b[0]) / 2, (wall.a[1] + wall.b[1]) / 2];
      const own = rooms[index < 4 ? 0 : 1]!;
      expect(contains(own, [middle[0] - 0.1 * wall.out[0], middle[1] - 0.1 * wall.out[1]])).toBe(true);
      expect(contains(own, [middle[0] + 0.1 * wall.out[0], middle[1] + 0.1 * wall.out[1]])).toBe(false);
    }
  });

  test("from inside no wall of the body's room is lowered, from outside those towards the eye are", () => {
    const first = wallSides(home).slice(0, 4);
    expect(first.filter((wall) => hides(wall, [0.5, 0.5], [-1, 0]))).toHaveLength(0);
    expect(first.filter((wall) => hides(wall, [-5, 0], [-1, 0]))).toHaveLength(1);
    expect(first.filter((wall) => hides(wall, [-5, 5], [-1, 0]))).toHaveLength(2);
  });

  test("both walls between two rooms are lowered when the body is in the other room", () => {
    const lowered = wallSides(home).filter((wall) => hides(wall, [0, 0.3], [4, 0]));
    expect(lowered).toHaveLength(2);
  });

  test("a wall beside the way to the body is lowered, one that the body stands close to is not", () => {
    const side = wallSides(home)[3]!;
    expect(hides(side, [0, 1.9], [0.5, -1.7])).toBe(false);
    const beside = { ...side, a: [0.3, -0.2] as Point2, b: [3, -0.2] as Point2, out: [0, -1] as Point2 };
    expect(hides(beside, [0, 2], [0, -2])).toBe(true);
    expect(hides({ ...beside, a: [0.6, -0.2] }, [0, 2], [0, -2])).toBe(false);
  });

  test("stumps leave doors free, whichever way their ends are given, and go under windows", () => {
    const wall = { ...wallSides(home)[0]!, openings: [
      { segment: [[-2, 1], [-2, 0]] as [Point2, Point2], bottom: 0, top: 2 },
      { segment: [[-2, -1.5], [-2, -0.5]] as [Point2, Point2], bottom: 0.9, top: 2 },
    ] };
    expect(stumps(wall)).toEqual([[-WALL_DEPTH, 2], [3, 4 + WALL_DEPTH]]);
  });
});
