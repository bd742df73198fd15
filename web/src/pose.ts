/** A body at one moment: interpolation of poses and world positions of joints. Quaternions are xyzw, metres, Y up. */

export const JOINTS = 22;
export const JOINT_NAMES = [
  "pelvis", "left_hip", "right_hip", "spine1", "left_knee", "right_knee", "spine2", "left_ankle", "right_ankle", "spine3",
  "left_foot", "right_foot", "neck", "left_collar", "right_collar", "head", "left_shoulder", "right_shoulder",
  "left_elbow", "right_elbow", "left_wrist", "right_wrist",
] as const;

export interface Pose {
  /** World position of the pelvis, 3 numbers. */
  readonly root: Float32Array;
  /** Turn of every joint in its parent's frame, 22 × 4 numbers. */
  readonly rotations: Float32Array;
}

export interface Skeleton {
  readonly names: readonly string[];
  /** Index of every joint's parent, -1 for the pelvis; parents come before children. */
  readonly parents: Int32Array;
  /** Position of every joint in its parent's frame, 22 × 3 numbers. */
  readonly offsets: Float32Array;
}

export type Point3 = [number, number, number];

export function emptyPose(): Pose {
  const rotations = new Float32Array(JOINTS * 4);
  for (let joint = 0; joint < JOINTS; joint++) rotations[joint * 4 + 3] = 1;
  return { root: new Float32Array(3), rotations };
}

/** Spherical interpolation of the quaternions at `a` and `b`, the short way round, written to `out`. */
export function slerp(from: Float32Array, a: number, b: number, share: number, out: Float32Array, at: number): void {
  const ax = from[a]!, ay = from[a + 1]!, az = from[a + 2]!, aw = from[a + 3]!;
  let bx = from[b]!, by = from[b + 1]!, bz = from[b + 2]!, bw = from[b + 3]!;
  let cosine = ax * bx + ay * by + az * bz + aw * bw;
  if (cosine < 0) {
    cosine = -cosine;
    bx = -bx; by = -by; bz = -bz; bw = -bw;
  }
  let wa = 1 - share;
  let wb = share;
  if (cosine < 0.9995) {
    const angle = Math.acos(cosine);
    const sine = Math.sin(angle);
    wa = Math.sin((1 - share) * angle) / sine;
    wb = Math.sin(share * angle) / sine;
  }
  const x = wa * ax + wb * bx, y = wa * ay + wb * by, z = wa * az + wb * bz, w = wa * aw + wb * bw;
  const length = Math.hypot(x, y, z, w) || 1;
  out[at] = x / length; out[at + 1] = y / length; out[at + 2] = z / length; out[at + 3] = w / length;
}

/** Turn a vector by the quaternion at `at`. */
export function turn(quaternions: Float32Array | number[], at: number, [vx, vy, vz]: Point3): Point3 {
  const x = quaternions[at]!, y = quaternions[at + 1]!, z = quaternions[at + 2]!, w = quaternions[at + 3]!;
  const tx = 2 * (y * vz - z * vy), ty = 2 * (z * vx - x * vz), tz = 2 * (x * vy - y * vx);
  return [vx + w * tx + y * tz - z * ty, vy + w * ty + z * tx - x * tz, vz + w * tz + x * ty - y * tx];
}

/** World positions of all joints. */
export function jointPositions(skeleton: Skeleton, pose: Pose): Point3[] {
  const places: Point3[] = [];
  const turns: number[] = [];
  for (let joint = 0; joint < JOINTS; joint++) {
    const parent = skeleton.parents[joint]!;
    const local = Array.from(pose.rotations.subarray(joint * 4, joint * 4 + 4));
    if (parent < 0) {
      places.push([pose.root[0]!, pose.root[1]!, pose.root[2]!]);
      turns.push(...local);
      continue;
    }
    const offset: Point3 = [skeleton.offsets[joint * 3]!, skeleton.offsets[joint * 3 + 1]!, skeleton.offsets[joint * 3 + 2]!];
    const [x, y, z] = turn(turns, parent * 4, offset);
    const from = places[parent]!;
    places.push([from[0] + x, from[1] + y, from[2] + z]);
    turns.push(...multiply(turns, parent * 4, local));
  }
  return places;
}

function multiply(a: number[], at: number, b: number[]): number[] {
  const ax = a[at]!, ay = a[at + 1]!, az = a[at + 2]!, aw = a[at + 3]!;
  const [bx, by, bz, bw] = b as [number, number, number, number];
  return [
    aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw,
    aw * bw - ax * bx - ay * by - az * bz,
  ];
}

/** Where the body faces on the floor, radians about +Y, 0 towards +Z; lying down, where the head points. */
export function heading(pose: Pose): number {
  const [fx, , fz] = turn(pose.rotations, 0, [0, 0, 1]);
  if (Math.hypot(fx, fz) > 0.5) return Math.atan2(fx, fz);
  const [ux, , uz] = turn(pose.rotations, 0, [0, 1, 0]);
  return Math.atan2(ux, uz);
}
