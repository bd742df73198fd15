import { describe, expect, test } from "vitest";
import { readFrames, Track, type Frames } from "../src/motion";
import { emptyPose, heading, jointPositions, JOINTS, JOINT_NAMES, slerp, turn, type Skeleton } from "../src/pose";
import { codesOf, npy, zip } from "./archive";

const skeleton: Skeleton = {
  names: [...JOINT_NAMES],
  parents: Int32Array.from({ length: JOINTS }, (_, i) => i - 1),
  offsets: Float32Array.from({ length: JOINTS * 3 }, (_, i) => (i % 3 === 1 && i > 2 ? 0.1 : 0)),
};

/** Frames whose pelvis walks a metre a frame along x while it turns a tenth of a radian a frame about y. */
function walk(from: number, count: number): Frames {
  const roots = new Float32Array(count * 3);
  const rotations = new Float32Array(count * JOINTS * 4);
  for (let i = 0; i < count; i++) {
    roots[i * 3] = from + i;
    for (let j = 0; j < JOINTS; j++) rotations[(i * JOINTS + j) * 4 + 3] = 1;
    rotations[i * JOINTS * 4 + 1] = Math.sin((from + i) / 20);
    rotations[i * JOINTS * 4 + 3] = Math.cos((from + i) / 20);
  }
  return { from, count, roots, rotations, skeleton };
}

describe("slerp", () => {
  test("half way between two turns is half the turn, also where signs differ", () => {
    const out = new Float32Array(4);
    const quarter = [0, Math.sin(Math.PI / 4), 0, Math.cos(Math.PI / 4)];
    for (const sign of [1, -1]) {
      slerp(Float32Array.from([0, 0, 0, 1, ...quarter.map((v) => sign * v)]), 0, 4, 0.5, out, 0);
      expect(2 * Math.atan2(out[1]!, out[3]!)).toBeCloseTo(Math.PI / 4, 5);
    }
  });

  test("the result has unit length at every share", () => {
    const two = Float32Array.from([0.5, 0.5, 0.5, 0.5, 0.1, -0.7, 0.1, 0.7]);
    const out = new Float32Array(4);
    for (let share = 0; share <= 1; share += 0.125) {
      slerp(two, 0, 4, share, out, 0);
      expect(Math.hypot(...out)).toBeCloseTo(1, 5);
    }
  });
});

describe("track", () => {
  test("segments in any overlap give one motion", () => {
    const track = new Track();
    track.append(walk(0, 10));
    track.append(walk(5, 10));
    track.append(walk(3, 4));
    expect(track.ready).toBe(15);
    for (let frame = 0; frame < 15; frame++) expect(track.floorPoint(frame)[0]).toBe(frame);
  });

  test("a gap is refused", () => {
    const track = new Track();
    expect(() => track.append(walk(3, 2))).toThrow(/0 to 3/);
  });

  test("growing past its capacity keeps what was there", () => {
    const track = new Track();
    for (let from = 0; from < 4000; from += 250) track.append(walk(from, 250));
    expect(track.ready).toBe(4000);
    expect(track.floorPoint(3999)[0]).toBe(3999);
    expect(track.poseAt(100 / 30)?.root[0]).toBeCloseTo(100, 3);
  });

  test("between two frames place and turn are between theirs; beyond the end it stands still", () => {
    const track = new Track();
    track.append(walk(0, 3));
    const pose = emptyPose();
    expect(track.sample(0.5 / 30, pose)).toBe(true);
    expect(pose.root[0]).toBeCloseTo(0.5, 5);
    expect(heading(pose)).toBeCloseTo(0.05, 4);
    track.sample(99, pose);
    expect(pose.root[0]).toBe(2);
    track.sample(-1, pose);
    expect(pose.root[0]).toBe(0);
  });

  test("nothing can be sampled before something is there", () => {
    expect(new Track().poseAt(0)).toBeNull();
  });

  test("an npz of the service becomes frames", async () => {
    const one = walk(0, 2);
    const codes = new Uint32Array(JOINTS * 14);
    for (const [i, name] of JOINT_NAMES.entries()) codes.set(codesOf(name), i * 14);
    const file = await zip(
      {
        "root_positions.npy": npy("<f4", [2, 3], one.roots as Float32Array<ArrayBuffer>),
        "local_rotations.npy": npy("<f4", [2, JOINTS, 4], one.rotations as Float32Array<ArrayBuffer>),
        "joint_names.npy": npy("<U14", [JOINTS], codes),
        "joint_parents.npy": npy("<i4", [JOINTS], skeleton.parents as Int32Array<ArrayBuffer>),
        "joint_offsets.npy": npy("<f8", [JOINTS, 3], Float64Array.from(skeleton.offsets)),
      },
      true,
    );
    const frames = await readFrames(file, 7);
    expect([frames.from, frames.count]).toEqual([7, 2]);
    expect(frames.skeleton.names).toEqual([...JOINT_NAMES]);
    expect([...frames.rotations]).toEqual([...one.rotations]);
  });
});

describe("joints", () => {
  test("bones keep their length however the body is turned", () => {
    const pose = emptyPose();
    pose.rotations.set([0.5, 0.5, -0.5, 0.5], 0);
    pose.rotations.set([0, 0, Math.sin(0.4), Math.cos(0.4)], 12);
    const places = jointPositions(skeleton, pose);
    for (let joint = 1; joint < JOINTS; joint++) {
      const a = places[joint]!, b = places[joint - 1]!;
      expect(Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2])).toBeCloseTo(0.1, 5);
    }
  });

  test("a quarter turn about y takes z to x", () => {
    const [x, y, z] = turn([0, Math.SQRT1_2, 0, Math.SQRT1_2], 0, [0, 0, 1]);
    expect(x).toBeCloseTo(1);
    expect(Math.hypot(y, z)).toBeCloseTo(0);
  });
});
