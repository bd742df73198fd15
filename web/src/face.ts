/** The face of the body on stage: what it shows of a feeling, passing softly into the next, and its blinks. */

import { SkinnedMesh, type Object3D } from "three";
import type { Emotion } from "./emotions";

/** Seconds: from one feeling to the next, of a blink, and between two. */
const CHANGE = 0.7;
const BLINK = 0.24;
const BETWEEN = [2.1, 3.4, 2.6, 4.7, 1.9] as const;

export class Face {
  readonly #meshes: SkinnedMesh[];
  readonly #expressions: Readonly<Record<string, readonly number[]>>;
  readonly #lids: number;
  #shares: number[];
  #clock = 0;
  #next: number = BETWEEN[0];
  #blinks = 0;

  private constructor(meshes: SkinnedMesh[], expressions: Readonly<Record<string, readonly number[]>>, lids: number) {
    this.#meshes = meshes;
    this.#expressions = expressions;
    this.#lids = lids;
    this.#shares = [...(expressions["neutral"] ?? [])];
  }

  /** The face of a body's glb; null where it has none. */
  static of(root: Object3D): Face | null {
    const meshes: SkinnedMesh[] = [];
    root.traverse((object) => {
      if (object instanceof SkinnedMesh && object.morphTargetInfluences?.length) meshes.push(object as SkinnedMesh);
    });
    const first = meshes[0];
    const lids = first?.morphTargetDictionary?.["lids_down"];
    const expressions: unknown = first?.userData["expressions"];
    if (lids === undefined || typeof expressions !== "object" || expressions === null) return null;
    return new Face(meshes, expressions as Record<string, number[]>, lids);
  }

  /** Show a feeling, or sleep; seconds since the last call. True where the face has moved. */
  update(seconds: number, emotion: Emotion, asleep: boolean, still: boolean): boolean {
    const wanted = this.#expressions[emotion] ?? [];
    const step = still ? 1 : Math.min(1, (3 * seconds) / CHANGE);
    let moved = false;
    this.#shares = this.#shares.map((share, unit) => {
      const to = asleep && unit === this.#lids ? 1 : (wanted[unit] ?? 0);
      const next = Math.abs(to - share) < 1e-3 ? to : share + step * (to - share);
      moved ||= next !== share;
      return next;
    });
    const shut = still ? 0 : this.#blink(seconds);
    moved ||= shut > 0 || this.#meshes[0]?.morphTargetInfluences?.[this.#lids] !== this.#shares[this.#lids];
    if (!moved) return false;
    for (const { morphTargetInfluences } of this.#meshes) {
      if (!morphTargetInfluences) continue;
      for (const [unit, share] of this.#shares.entries()) morphTargetInfluences[unit] = unit === this.#lids ? share + shut * (1 - share) : share;
    }
    return true;
  }

  /** How far a blink closes the eyes now, 0 to 1. */
  #blink(seconds: number): number {
    this.#clock += seconds;
    if (this.#clock > this.#next + BLINK) {
      this.#blinks += 1;
      this.#next = this.#clock + BETWEEN[this.#blinks % BETWEEN.length]!;
    }
    const share = (this.#clock - this.#next) / BLINK;
    return share <= 0 || share >= 1 ? 0 : Math.min(1, 3 * share, 3 * (1 - share));
  }
}
