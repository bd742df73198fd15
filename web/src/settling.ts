/** When a body has come to do what a keyframe is about: what is said of it then is what is seen. */

import type { Skill } from "./api";
import type { Track } from "./motion";
import { jointPositions } from "./pose";

/** Share of a keyframe after which it is done what it is about: one sits and lies for long, and touches half-way. */
const DONE: Readonly<Record<Skill, number>> = { loco: 0.5, sitdown: 0.67, standup: 0.95, getup: 0.95, liedown: 0.67, touch: 0.5 };
/** Metres, root mean square over the joints' heights, that a pose may be from the one in which it is done. */
const NEAR = 0.07;

/** The first frame of a keyframe from `start` to `end` (exclusive) in which the body is about as high, joint by joint, as
 * when it is done; Infinity as long as its frames are not there. Where on the floor and which way it faces is all the same. */
export function settledAt(track: Track, skill: Skill, start: number, end: number): number {
  const aim = start + Math.floor((end - start) * DONE[skill]);
  if (aim >= track.ready) return Infinity;
  const wanted = heights(track, aim);
  for (let frame = start; frame < aim; frame++) {
    if (distance(heights(track, frame), wanted) < NEAR) return frame;
  }
  return aim;
}

function heights(track: Track, frame: number): number[] {
  const pose = track.poseAt(frame / track.fps);
  return pose && track.skeleton ? jointPositions(track.skeleton, pose).map(([, y]) => y) : [];
}

const distance = (one: readonly number[], other: readonly number[]): number => Math.sqrt(one.reduce((sum, height, joint) => sum + (height - other[joint]!) ** 2, 0) / one.length);
