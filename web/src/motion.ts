/** A motion that grows: frames are appended as they are made, and can be sampled at any time that is ready. */

import { readNpz, type NpyArray } from "./npz";
import { emptyPose, JOINTS, slerp, type Pose, type Skeleton } from "./pose";

export interface Frames {
  /** First frame. */
  readonly from: number;
  readonly count: number;
  /** (count, 3). */
  readonly roots: Float32Array;
  /** (count, 22, 4). */
  readonly rotations: Float32Array;
  readonly skeleton: Skeleton;
}

const ARRAYS = ["root_positions", "local_rotations", "joint_names", "joint_parents", "joint_offsets"] as const;

/** The frames of a motion's npz that begins at frame `from`. NpzError, or Error if an array is missing. */
export async function readFrames(buffer: ArrayBuffer, from: number): Promise<Frames> {
  const arrays = await readNpz(buffer, ARRAYS);
  const get = (name: (typeof ARRAYS)[number]): NpyArray => {
    const array = arrays.get(name);
    if (!array) throw new Error(`the motion has no ${name}`);
    return array;
  };
  const rotations = get("local_rotations");
  if (rotations.shape[1] !== JOINTS) throw new Error(`the motion has ${rotations.shape[1]} joints, ${JOINTS} are played`);
  return {
    from,
    count: rotations.shape[0] ?? 0,
    roots: Float32Array.from(get("root_positions").values as Float32Array),
    rotations: Float32Array.from(rotations.values as Float32Array),
    skeleton: {
      names: Array.from(get("joint_names").values, String),
      parents: Int32Array.from(get("joint_parents").values as Int32Array),
      offsets: Float32Array.from(get("joint_offsets").values as Float64Array),
    },
  };
}

export class Track {
  readonly fps: number;
  #ready = 0;
  #roots = new Float32Array(0);
  #rotations = new Float32Array(0);
  #skeleton: Skeleton | null = null;

  constructor(fps = 30) {
    this.fps = fps;
  }

  /** Frames that can be sampled. */
  get ready(): number {
    return this.#ready;
  }

  /** Seconds that can be sampled; the last frame is the last moment. */
  get readyTime(): number {
    return Math.max(this.#ready - 1, 0) / this.fps;
  }

  /** Known from the first frames on. */
  get skeleton(): Skeleton | null {
    return this.#skeleton;
  }

  /** Put frames at the end; what overlaps is kept as it is, a gap is an Error. */
  append(frames: Frames): void {
    if (frames.from > this.#ready) throw new Error(`frames ${this.#ready} to ${frames.from} are missing`);
    const skip = this.#ready - frames.from;
    if (skip >= frames.count) return;
    const count = frames.count - skip;
    this.#reserve(this.#ready + count);
    this.#roots.set(frames.roots.subarray(skip * 3), this.#ready * 3);
    this.#rotations.set(frames.rotations.subarray(skip * JOINTS * 4), this.#ready * JOINTS * 4);
    this.#ready += count;
    this.#skeleton ??= frames.skeleton;
  }

  /** The pose at a time in seconds, clamped to what is ready; false if nothing is. */
  sample(time: number, out: Pose): boolean {
    if (this.#ready === 0) return false;
    const place = Math.min(Math.max(time * this.fps, 0), this.#ready - 1);
    const frame = Math.floor(place);
    const next = Math.min(frame + 1, this.#ready - 1);
    const share = place - frame;
    for (let axis = 0; axis < 3; axis++) {
      const a = this.#roots[frame * 3 + axis]!;
      out.root[axis] = a + (this.#roots[next * 3 + axis]! - a) * share;
    }
    for (let joint = 0; joint < JOINTS; joint++) {
      slerp(this.#rotations, (frame * JOINTS + joint) * 4, (next * JOINTS + joint) * 4, share, out.rotations, joint * 4);
    }
    return true;
  }

  /** The pose at a time in seconds as a new value; null if nothing is ready. */
  poseAt(time: number): Pose | null {
    const pose = emptyPose();
    return this.sample(time, pose) ? pose : null;
  }

  /** Where the pelvis is on the floor at a frame that is ready, [x, z]. */
  floorPoint(frame: number): [number, number] {
    return [this.#roots[frame * 3]!, this.#roots[frame * 3 + 2]!];
  }

  /** Room for that many frames, doubled each time so that growing stays cheap. */
  #reserve(frames: number): void {
    if (frames * 3 <= this.#roots.length) return;
    const capacity = Math.max(frames, (this.#roots.length / 3) * 2, 900);
    const roots = new Float32Array(capacity * 3);
    const rotations = new Float32Array(capacity * JOINTS * 4);
    roots.set(this.#roots.subarray(0, this.#ready * 3));
    rotations.set(this.#rotations.subarray(0, this.#ready * JOINTS * 4));
    this.#roots = roots;
    this.#rotations = rotations;
  }
}
