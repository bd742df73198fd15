import { describe, expect, test } from "vitest";
import type { Home, Placed, Point2 } from "../src/api";
import { boxAt, boxesOf, gap, Lookout, stands } from "../src/sight";

const floor: Point2[] = [[-3, -3], [-3, 3], [3, 3], [3, -3]];
const placed = (id: string, position: [number, number, number], size: [number, number, number], yaw = 0): Placed => ({ id, category: id, position, size, yaw });
const wardrobe = placed("wardrobe_1", [0, 0, 1], [1.4, 2.1, 0.6], Math.PI / 2);
const table = placed("table_1", [-2, 0, -2], [1, 0.7, 0.6]);
const lamp = placed("lamp_1", [-2, 0.7, -2], [0.3, 0.4, 0.3]);
const rug = placed("rug_1", [0, 0, 0], [2, 0.012, 2]);
const home = (yaw: number): Home => ({
  rooms: [{ layout: { id: "r", room_type: "study", floor_polygon: floor, objects: [wardrobe, table, lamp, rug] }, offset: [0, 0, 0], yaw }],
  walls: [],
  doorways: [],
});

describe("sight", () => {
  const boxes = boxesOf(home(0));

  test("what lies flat on the floor hides nothing, and a lamp stands on its table", () => {
    expect(boxes.map((box) => box.on)).toEqual([null, null, 1]);
  });

  test("a turned box is as wide as it is turned", () => {
    expect(gap(boxes[0]!, [0.29, 1, 1.69])).toBe(0);
    expect(gap(boxes[0]!, [0.5, 1, 1])).toBeCloseTo(0.2);
    expect(gap(boxes[0]!, [0, 2.4, 1])).toBeCloseTo(0.3);
  });

  test("a room that is turned takes its furniture along", () => {
    const turned = boxesOf(home(Math.PI / 2))[0]!;
    expect(gap(turned, [1.6, 1, 0])).toBe(0);
    expect(gap(turned, [1, 1, 0.6])).toBeGreaterThan(0);
  });

  test("a point belongs to the least box that holds it, else to the nearest", () => {
    expect(boxAt(boxes, [-2, 0.8, -2])).toBe(2);
    expect(boxAt(boxes, [-2, 0.3, -2.1])).toBe(1);
    expect(boxAt(boxes, [2, 1, 2])).toBe(0);
    expect(boxAt([], [0, 0, 0])).toBe(-1);
  });

  test("a wardrobe between eye and body is in the way; beside the way, behind the body or used by it, it is not", () => {
    const box = boxes[0]!;
    expect(stands(box, [0, 1.8, 4], [0, 0.95, -1])).toBe(true);
    expect(stands(box, [2.5, 1.8, 4], [2, 0.95, -1])).toBe(false);
    expect(stands(box, [0, 1.8, -3.5], [0, 0.95, 0])).toBe(false);
    expect(stands(boxes[1]!, [-2, 2.6, 2], [-2, 0.95, -1.5])).toBe(false);
  });

  test("what the body sits on is not in the way, though it is around it", () => {
    const sofa = boxesOf({ ...home(0), rooms: [{ ...home(0).rooms[0]!, layout: { ...home(0).rooms[0]!.layout, objects: [placed("sofa_1", [0, 0, 0], [2, 0.85, 0.9])] } }] })[0]!;
    expect(stands(sofa, [0, 1.6, 3], [0, 0.55, 0.1])).toBe(false);
    expect(stands(sofa, [0, 0.9, 3], [0, 0.55, -2])).toBe(true);
  });

  test("of two places to look from the free one is the better", () => {
    const lookout = new Lookout(home(0));
    const body: [number, number, number] = [0, 0.95, -1];
    expect(lookout.cost([0, 2, 2.8], body)).toBeGreaterThan(lookout.cost([2.5, 2, 1.5], body));
    expect(lookout.cost([9, 2, -1], body)).toBeGreaterThan(lookout.cost([2.5, 2, -1], body));
  });
});
