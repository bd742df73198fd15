// What differs between two takes is named, and where they begin to differ is found.

import { expect, test } from "vitest";
import type { Keyframe, Story } from "../src/api";
import { align, differences, firstApart, shared } from "../src/differences";

const moment = (given: Partial<Keyframe>): Keyframe => ({ skill: "loco", caption: "walk", emotion: "neutral", object_id: null, furniture: "floor", room: null, ...given }) as Keyframe;
const WALK = moment({});
const SIT = moment({ skill: "sitdown", caption: "sitting still", object_id: "0/sofa_1" });
const RISE = moment({ skill: "standup", caption: "stand up", object_id: "0/sofa_1" });
const story = (given: Partial<Story>): Story => ({ keyframes: [WALK, SIT, RISE], seed: 3, backend: "procedural", report: null, home: { rooms: [{ layout_id: "study-0001" }] }, character: { name: "Sam", member: "", age: "adult", height: 1.7, outfit: "office" }, ...given }) as Story;

test("a moment that is changed is one moment, and one that is left out shifts no others", () => {
  const other = [WALK, moment({ ...SIT, caption: "legs crossed" }), RISE];
  expect(align([WALK, SIT, RISE], other)).toEqual([{ one: 0, other: 0, same: true }, { one: 1, other: 1, same: false }, { one: 2, other: 2, same: true }]);
  expect(shared(align([WALK, SIT, RISE], [WALK, RISE]))).toEqual([[0, 0], [2, 1]]);
  expect(shared(align([WALK], [SIT, WALK]))).toEqual([[0, 1]]);
  expect(align([], [WALK])).toEqual([{ one: null, other: 0, same: false }]);
});

test("a comparison begins at the moment that is another, or before the one that is left out", () => {
  const crossed = moment({ ...SIT, caption: "legs crossed" });
  expect(firstApart(align([WALK, SIT, RISE], [WALK, crossed, RISE]))).toBe(1);
  expect(firstApart(align([WALK, SIT, RISE], [WALK, RISE]))).toBe(0);
  expect(firstApart(align([WALK, SIT], [WALK, SIT]))).toBe(0);
});

test("who moved the body is the same while one of them has no report yet", () => {
  const report = { moved_by: { procedural: "rules (procedural): no learned model" } } as unknown as Story["report"];
  expect(differences(story({ report }), story({}))).toEqual([]);
});

test("whatever differs is named with what it is in each, and nothing else is", () => {
  expect(differences(story({}), story({}))).toEqual([]);
  const told = { moved_by: { procedural: "rules (procedural): no learned model", diffusion: "a motion diffusion model (diffusion)" } };
  expect(differences(story({}), story({ backend: "diffusion" }))).toEqual([["Moved by", "procedural", "diffusion"]]);
  expect(differences(story({ report: told } as unknown as Story), story({ report: told, backend: "diffusion" } as unknown as Story))).toEqual([["Moved by", "rules", "a motion diffusion model"]]);
  expect(differences(story({}), story({ seed: 4, home: { rooms: [{ layout_id: "page-den" }] } } as unknown as Story)).map(([what]) => what)).toEqual(["Seed", "Played in"]);
  const keyframes = [WALK, moment({ ...SIT, caption: "legs crossed", emotion: "sad" }), RISE];
  expect(differences(story({}), story({ keyframes }))).toEqual([["Moment 2, how", "sitting still", "legs crossed"], ["Moment 2, mood", "neutral", "sad"]]);
  expect(differences(story({}), story({ keyframes: [WALK, RISE] }))).toEqual([["Moment 2", "Sit down, sitting still, neutral, sofa", "is not in it"]]);
});
