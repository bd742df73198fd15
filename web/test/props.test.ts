import { describe, expect, test } from "vitest";
import { AnimationClip, Group, Object3D, QuaternionKeyframeTrack, VectorKeyframeTrack } from "three";
import { Props } from "../src/props";

/** A cup that comes after a second, goes a metre up in the next, turning by half a circle, and is gone. */
function cup(): { root: Group; node: Object3D; props: Props } {
  const root = new Group();
  const node = new Object3D();
  node.name = "prop_cup_0";
  root.add(node);
  const clip = new AnimationClip("motion", -1, [
    new VectorKeyframeTrack("prop_cup_0.position", [1, 2], [0, 1, 0, 0, 2, 0]),
    new QuaternionKeyframeTrack("prop_cup_0.quaternion", [1, 2], [0, 0, 0, 1, 0, 1, 0, 0]),
    new VectorKeyframeTrack("prop_cup_0.scale", [0.9, 1, 2, 2.1], [0, 0, 0, 1, 1, 1, 1, 1, 1, 0, 0, 0]),
  ]);
  return { root, node, props: new Props(root, clip) };
}

describe("props", () => {
  test("are not there before they come, nor after they are gone", () => {
    const { node, props } = cup();
    props.seek(0);
    expect(node.visible).toBe(false);
    props.seek(1.5);
    expect(node.visible).toBe(true);
    props.seek(9);
    expect(node.visible).toBe(false);
  });

  test("are where the clock is, whichever way it went", () => {
    const { node, props } = cup();
    for (const time of [1.75, 1.25]) {
      props.seek(time);
      expect(node.position.y).toBeCloseTo(time, 5);
      expect(node.quaternion.length()).toBeCloseTo(1, 5);
      expect(2 * Math.acos(node.quaternion.w)).toBeCloseTo((time - 1) * Math.PI, 4);
    }
  });

  test("of an empty clip stand still", () => {
    const root = new Group();
    expect(() => new Props(root, undefined).seek(3)).not.toThrow();
  });

  test("leave the stage when they are given up", () => {
    const { root, props } = cup();
    const scene = new Group();
    scene.add(root);
    props.dispose();
    expect(scene.children).toEqual([]);
  });
});
