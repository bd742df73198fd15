import { describe, expect, test } from "vitest";
import { Track, type Frames } from "../src/motion";
import { JOINTS, JOINT_NAMES, type Skeleton } from "../src/pose";
import { settledAt } from "../src/settling";

const skeleton: Skeleton = {
  names: [...JOINT_NAMES],
  parents: Int32Array.from({ length: JOINTS }, (_, i) => i - 1),
  offsets: new Float32Array(JOINTS * 3),
};

/** A body as high as that, frame by frame, that moves on and turns meanwhile. */
function track(heights: readonly number[]): Track {
  const roots = Float32Array.from(heights.flatMap((height, at) => [at, height, -at]));
  const rotations = new Float32Array(heights.length * JOINTS * 4);
  for (let at = 0; at < rotations.length; at += 4) rotations[at + 3] = 1;
  const frames: Frames = { from: 0, count: heights.length, roots, rotations, skeleton };
  const grown = new Track();
  grown.append(frames);
  return grown;
}

/** Stands, comes down from the 20th frame to the 40th, and stays. */
const DOWN = Array.from({ length: 120 }, (_, at) => 0.95 - 0.5 * Math.min(Math.max((at - 20) / 20, 0), 1));

describe("settledAt", () => {
  test("who sits down is said to sit so once it is about as low as it will be", () => {
    const seen = settledAt(track(DOWN), "sitdown", 0, 120);
    expect(seen).toBeGreaterThan(34);
    expect(seen).toBeLessThanOrEqual(40);
  });

  test("who walks does so at once, wherever it goes", () => {
    expect(settledAt(track(new Array<number>(90).fill(0.95)), "loco", 0, 90)).toBe(0);
  });

  test("a rise is seen only when it is over", () => {
    expect(settledAt(track([...DOWN].reverse()), "standup", 0, 120)).toBeGreaterThan(90);
  });

  test("it is seen at the latest where it is told by, and never before its frames are there", () => {
    const restless = Array.from({ length: 90 }, (_, at) => 0.3 + at / 30);
    expect(settledAt(track(restless), "touch", 0, 90)).toBeLessThanOrEqual(45);
    expect(settledAt(track(DOWN.slice(0, 30)), "sitdown", 0, 120)).toBe(Infinity);
  });
});
