// A take says what was changed, and from where on it is acted again: two numbers that need not be the same.

import { expect, test } from "vitest";
import type { Keyframe, Story } from "../src/api";
import { againWords, changeWords } from "../src/origin";

const moment = (caption: string): Keyframe => ({ skill: "loco", caption, emotion: "neutral", object_id: null, furniture: "floor", room: null }) as Keyframe;
const script = (...captions: string[]): Keyframe[] => captions.map(moment);
const story = (given: Partial<Story>): Story => ({ keyframes: script("a", "b", "c", "d", "e", "f", "g"), seed: 3, backend: "procedural", report: null, home: null, character: { name: "Sam", member: "", age: "adult", height: 1.7, outfit: "office" }, take: 0, reused: 0, ...given }) as Story;
const BEFORE = story({});

test("all that was changed is named, moment by moment", () => {
  const take = story({ take: 1, seed: 4, keyframes: script("a", "b", "c", "d", "e", "x", "g").map((one, index) => (index === 5 ? { ...one, emotion: "sad" } : one)) });
  expect(changeWords(BEFORE, take)).toBe("the seed, moment 6 (how, mood)");
  const home = (layout_id: string): Story["home"] => ({ rooms: [{ layout_id }] }) as unknown as Story["home"];
  expect(changeWords(story({ home: home("study-0001") }), story({ take: 1, home: home("bedroom-0002"), keyframes: BEFORE.keyframes.map((one) => ({ ...one, furniture: "bed" })) }))).toBe("the home");
  expect(changeWords(BEFORE, story({ take: 1, keyframes: script("a", "b", "c", "d", "e", "f") }))).toBe("moment 7 (left out)");
  expect(changeWords(BEFORE, story({ take: 1, keyframes: script("a", "z", "b", "c", "d", "e", "f", "g") }))).toBe("moment 2 (new)");
  expect(changeWords(BEFORE, story({ take: 1, keyframes: script("a", "c", "d", "e", "f", "z") }))).toBe("moment 2 (left out), moment 7 → 6 (how)");
  expect(changeWords(BEFORE, BEFORE)).toBe("");
});

test("the moment before the first change is acted again too, and it is said why", () => {
  const take = story({ take: 1, reused: 4, keyframes: script("a", "b", "c", "d", "e", "x", "g") });
  expect(againWords(take, BEFORE)).toBe("Acted again from moment 5 on, so that it leads to what follows now; before it, the body does the same.");
  expect(againWords({ ...take, keyframes: script("a", "b", "c", "d", "e", "g") }, BEFORE)).toContain("so that it leads");
  expect(againWords({ ...take, reused: 5 }, BEFORE)).toBe("Acted again from moment 6 on; before it, the body does the same.");
  expect(againWords(take, null)).toBe("Acted again from moment 5 on; before it, the body does the same.");
});

test("nothing is said while it is not known, and all or none is said as such", () => {
  expect(againWords(story({ take: 0 }), BEFORE)).toBeNull();
  expect(againWords(story({ take: 2 }), BEFORE)).toBe("All of it is acted again.");
  expect(againWords(story({ take: 2, reused: 7 }), BEFORE)).toBe("Nothing had to be acted again.");
});
