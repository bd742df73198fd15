/** What is in the hands: nodes of a props.glb, put where they are at a moment by the film's own clock. */

import type { AnimationClip, Interpolant, Object3D } from "three";
import { isMesh } from "./pieces";

const PATHS = ["position", "quaternion", "scale"] as const;

interface Mover {
  readonly node: Object3D;
  readonly path: (typeof PATHS)[number];
  readonly interpolant: Interpolant;
}

export class Props {
  readonly root: Object3D;
  readonly #movers: Mover[] = [];

  /** A loaded scene, and the clip that moves its nodes. */
  constructor(root: Object3D, clip: AnimationClip | undefined) {
    this.root = root;
    for (const track of clip?.tracks ?? []) {
      const [name, moved] = track.name.split(".");
      const node = root.getObjectByName(name ?? "");
      const path = PATHS.find((one) => one === moved);
      if (node && path) this.#movers.push({ node, path, interpolant: track.InterpolantFactoryMethodLinear() });
    }
    root.traverse((object) => (object.castShadow = object.receiveShadow = true));
  }

  /** Show a moment, in seconds. */
  seek(time: number): void {
    for (const { node, path, interpolant } of this.#movers) {
      const values = interpolant.evaluate(time) as ArrayLike<number>;
      node[path].fromArray(Array.from(values));
      // A matrix of no size cannot be inverted, which lighting wants.
      if (path === "scale") node.visible = node.scale.x > 0;
    }
  }

  dispose(): void {
    this.root.removeFromParent();
    this.root.traverse((object) => {
      if (!isMesh(object)) return;
      object.geometry.dispose();
      for (const material of [object.material].flat()) material.dispose();
    });
  }
}
