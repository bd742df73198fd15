// What became of beats is told by a word as well as by a colour, and only what is used is explained.

import { beforeAll, describe, expect, test } from "vitest";
import type { Beat, KeyframeFigures, Story } from "../src/api";
import { badge, lacking, legend, marks, outcomeOf } from "../src/outcomes";
import { standsOut } from "../src/report";
import { beatsWords } from "../src/words";

/** As much of a document as making elements asks for. */
class Plain {
  readonly children: (Plain | string)[] = [];
  readonly attributes = new Map<string, string>();
  constructor(readonly tag: string) {}
  setAttribute(name: string, value: string): void {
    this.attributes.set(name, value);
  }
  addEventListener(): void {
    throw new Error("nothing here listens");
  }
  append(...children: (Plain | string)[]): void {
    this.children.push(...children);
  }
  get textContent(): string {
    return this.children.map((child) => (typeof child === "string" ? child : child.textContent)).join("");
  }
}

beforeAll(() => {
  Object.assign(globalThis, { document: { createElement: (tag: string) => new Plain(tag) } });
});

const beat = (given: Partial<Beat>): Beat => ({ text: "dances", kind: "deed", who: "", emotion: "neutral", acted: true, stood_for: false, why: "", unshown: [], ...given });
const figures = (given: Partial<KeyframeFigures>): KeyframeFigures => ({ keyframe: 0, skill: "loco", seconds: 1, reached: true, reason: "", contact_error: null, pen_max: 0, notes: [], performed_as: null, ...given });
const ACTED = beat({});
const STOOD = beat({ text: "conducts an orchestra", acted: false, why: "the body is seen doing something else in its place", stood_for: true, unshown: ["conducts an orchestra"] });
const MISSING = beat({ acted: false, why: "no keyframe is left that shows it" });
const TOLD = beat({ text: "Laundry day", kind: "other", acted: false, why: "it is no deed" });
const THEIRS = beat({ text: "the bell rings", kind: "other", who: "the bell", acted: false, why: "somebody or something else does it" });
const UNDONE = beat({ kind: "undone", acted: false, why: "left undone, as the theme asks" });

describe("outcomes", () => {
  test("each beat has one, and what only stands for it is not called acted", () => {
    expect([ACTED, STOOD, MISSING, UNDONE].map(outcomeOf)).toEqual(["acted", "stands", "missing", "undone"]);
    expect(beatsWords([ACTED, STOOD, MISSING, UNDONE])).toBe("1 of 3 beats of your theme are acted, something stands for 1 more.");
  });

  test("what is told and nobody does is not counted, and what somebody else does is", () => {
    expect(beatsWords([ACTED, TOLD, THEIRS])).toBe("1 of 2 beats of your theme are acted.");
  });

  test("every one has its own word, so that colour alone tells nothing", () => {
    const words = (["acted", "stands", "otherwise", "missing", "undone"] as const).map((outcome) => badge(outcome).textContent);
    expect(new Set(words).size).toBe(5);
    expect(words.every((word) => /[A-Z][a-z]/.test(word))).toBe(true);
  });

  test("the mark is hidden from a screen reader, which reads the word", () => {
    const [mark, word] = (badge("stands") as unknown as Plain).children as [Plain, string];
    expect(mark.attributes.get("aria-hidden")).toBe("true");
    expect(word).toBe("Stands for it");
  });

  test("what is not shown of an acted beat is named, and why a missing one is missing", () => {
    expect(lacking(beat({ unshown: ["for her ladyship"] }))).toBe("not shown of it: “for her ladyship”");
    expect(lacking(MISSING)).toBe("no keyframe is left that shows it");
    expect([lacking(ACTED), lacking(STOOD)]).toEqual(["", ""]);
    expect(lacking({ ...STOOD, why: "the body is seen doing something else in its place, no window that can be got to: it is done without one" })).toBe("no window that can be got to: it is done without one");
  });

  test("the legend explains what is used and nothing else; there is none where all is acted", () => {
    const terms = (legend([ACTED, STOOD], [figures({ notes: ["the desk is out of reach"] })]) as unknown as Plain).children
      .filter((child) => typeof child !== "string" && child.tag === "dt")
      .map((child) => (child as Plain).textContent.slice(1));
    expect(terms).toEqual(["Acted", "Stands for it", "Done otherwise"]);
    expect(legend([ACTED, ACTED], [figures({})])).toBeNull();
    expect(legend([], [])).toBeNull();
  });

  test("moments are marked by what they show", () => {
    const keyframes = [{ index: 0, beat: 0 }, { index: 1, beat: 1 }, { index: 2, beat: null }];
    const story = { keyframes, beats: [ACTED, STOOD], report: { keyframes: [figures({}), figures({ keyframe: 1 }), figures({ keyframe: 2, performed_as: "walk slowly" })] } };
    expect([...marks(story as unknown as Story)]).toEqual([[1, { outcome: "stands", words: `“${STOOD.text}”` }], [2, { outcome: "otherwise", words: "done as “walk slowly”, which the body knows" }]]);
    expect(marks({ ...story, report: null } as unknown as Story).size).toBe(1);
  });

  test("that nothing stands out is said only where all is acted and every limit is kept", () => {
    const kept = [{ kept: true }];
    expect(standsOut([ACTED, UNDONE, TOLD], kept)).toBeNull();
    expect(standsOut([ACTED, MISSING], kept)).toBe("What stands out, as told above: 1 beat of your theme is not acted.");
    expect(standsOut([beat({ unshown: ["for her ladyship"] })], [...kept, { kept: false }])).toBe("What stands out, as told above: something of 1 beat is not shown; 1 limit of how well it moves is missed.");
  });
});
