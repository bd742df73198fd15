import { describe, expect, test } from "vitest";
import { added, changed, dropped, firstChange, moved, placed, type Draft, type Script } from "../src/script-draft";

const draft = (index: number, skill: Draft["skill"], object_id: string | null): Draft => ({ index, skill, emotion: "neutral", caption: skill, furniture: object_id ? "sofa" : "floor", object_id });
const script: Script = [draft(0, "loco", null), draft(1, "loco", "0/sofa"), draft(2, "sitdown", "0/sofa"), draft(3, "standup", "0/sofa"), draft(4, "touch", "0/sofa")];

describe("a script that is changed", () => {
  test("stays as it was, and the first change is found", () => {
    expect(firstChange(script, script)).toBeNull();
    expect(firstChange(changed(script, 2, { emotion: "sad" }), script)).toBe(2);
    expect(firstChange(dropped(script, 4), script)).toBe(4);
    expect(firstChange(added(script, 4, draft(9, "loco", null)), script)).toBe(5);
    expect(script[2]!.emotion).toBe("neutral");
  });

  test("moves one step, never over an end, and back again", () => {
    const there = moved(script, 3, -1);
    expect(there.map(({ index }) => index)).toEqual([0, 1, 3, 2, 4]);
    expect(moved(there, 2, 1)).toEqual(script);
    expect(moved(script, 0, -1)).toBe(script);
    expect(moved(script, 4, 1)).toBe(script);
  });

  test("another seat takes the walk to it and the rising from it along, and nothing else", () => {
    const elsewhere = placed(script, 2, "0/chair");
    expect(elsewhere.map(({ object_id }) => object_id)).toEqual([null, "0/chair", "0/chair", "0/chair", "0/sofa"]);
    expect(placed(script, 2, null).map(({ object_id }) => object_id)).toEqual([null, null, null, null, "0/sofa"]);
    expect(placed(script, 0, "0/chair").map(({ object_id }) => object_id)).toEqual(["0/chair", "0/sofa", "0/sofa", "0/sofa", "0/sofa"]);
  });
});
