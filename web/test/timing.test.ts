import { describe, expect, test } from "vitest";
import { Player } from "../src/player";
import { paragraphs, spanOf } from "../src/spans";
import { blocks, clock, keyframeAt, placeOf } from "../src/timing";

const none = { start: null, end: null };

describe("blocks", () => {
  test("before motion all are as wide and fill the line", () => {
    const laid = blocks([none, none, none, none]);
    expect(laid.map((b) => b.width)).toEqual([0.25, 0.25, 0.25, 0.25]);
    expect(laid.every((b) => !b.made)).toBe(true);
  });

  test("widths follow frames and always fill the line", () => {
    const laid = blocks([{ start: 0, end: 30 }, { start: 30, end: 120 }, none]);
    expect(laid[1]!.width / laid[0]!.width).toBeCloseTo(3);
    expect(laid.reduce((sum, b) => sum + b.width, 0)).toBeCloseTo(1);
    expect(laid[2]!.left + laid[2]!.width).toBeCloseTo(1);
  });

  test("a frame's place runs evenly through its block", () => {
    const frames = [{ start: 0, end: 30 }, { start: 30, end: 120 }];
    const laid = blocks(frames);
    expect(placeOf(frames, laid, 0)).toBe(0);
    expect(placeOf(frames, laid, 75)).toBeCloseTo(75 / 120);
    expect(placeOf(frames, laid, 500)).toBeCloseTo(1);
    expect(placeOf([none], blocks([none]), 3)).toBe(0);
  });

  test("the keyframe at a frame is the one that has begun and not ended", () => {
    const frames = [{ start: 0, end: 30 }, { start: 30, end: 60 }, none];
    expect([0, 29, 30, 59, 400].map((f) => keyframeAt(frames, f))).toEqual([0, 0, 1, 1, 1]);
    expect(keyframeAt([none], 0)).toBeNull();
    expect(keyframeAt([], 0)).toBeNull();
  });
});

describe("spans", () => {
  const text = "One day. She sat down.\n\nThen she slept.";
  const spans = [{ start: 9, end: 22, keyframes: [1, 2] }, { start: 24, end: 39, keyframes: [4] }];

  test("a keyframe is told by its span, one without by the last before it", () => {
    expect([0, 1, 2, 3, 4, 9].map((k) => spanOf(spans, k))).toEqual([null, 0, 0, 0, 1, 1]);
  });

  test("pieces put together are the text, cut at paragraphs and spans", () => {
    const cut = paragraphs(text, spans);
    expect(cut.map((p) => p.map((piece) => piece.text).join(""))).toEqual(["One day. She sat down.", "Then she slept."]);
    expect(cut[0]!.map((piece) => piece.span)).toEqual([null, 0]);
  });

  test("what is not seen is cut out of spans and of the words between them", () => {
    const cut = paragraphs("One day he ran, it rained, and fell.", [{ start: 11, end: 25, keyframes: [0] }], [{ start: 16, end: 25 }]);
    expect(cut[0]!.map((piece) => piece.text)).toEqual(["One day he ", "ran, ", "it rained", ", and fell."]);
    expect(cut[0]!.map((piece) => piece.thought)).toEqual([false, false, true, false]);
    expect(cut[0]!.map((piece) => piece.span)).toEqual([null, 0, 0, null]);
  });

  test("characters beyond the basic plane count once", () => {
    const cut = paragraphs("🙂 ok. Sat.", [{ start: 6, end: 10, keyframes: [0] }]);
    expect(cut[0]!.map((piece) => piece.text)).toEqual(["🙂 ok. ", "Sat."]);
  });

  test("spans out of bounds or overlapping lose no words", () => {
    const cut = paragraphs("abc def", [{ start: 2, end: 99, keyframes: [0] }, { start: 0, end: 3, keyframes: [1] }, { start: 1, end: 5, keyframes: [2] }]);
    expect(cut[0]!.map((piece) => piece.text).join("")).toBe("abc def");
  });
});

describe("player", () => {
  test("it waits at the end of what is ready, goes on when more comes, and ends at the end", () => {
    const player = new Player();
    player.feed(1, false);
    player.play();
    player.advance(2);
    expect([player.time, player.state]).toEqual([1, "waiting"]);
    player.feed(3, false);
    expect(player.state).toBe("playing");
    player.advance(1);
    player.feed(2, true);
    player.advance(1);
    expect([player.time, player.state]).toEqual([2, "ended"]);
    player.play();
    expect([player.time, player.state]).toEqual([0, "playing"]);
  });

  test("play before anything is ready waits; speed scales time", () => {
    const player = new Player();
    player.play();
    expect(player.state).toBe("waiting");
    player.feed(10, true);
    player.setSpeed(2);
    player.advance(1.5);
    expect(player.time).toBe(3);
  });

  test("seeking is kept within what is ready and does not start a pause", () => {
    const player = new Player();
    player.feed(5, false);
    player.seek(9);
    expect([player.time, player.state]).toEqual([5, "paused"]);
    player.seek(-1);
    expect(player.time).toBe(0);
  });

  test("a wait ends when nothing more will come", () => {
    const player = new Player();
    player.feed(1, false);
    player.play();
    player.advance(5);
    player.feed(1, true);
    expect(player.state).toBe("ended");
  });
});

test("a clock shows minutes and two digits of seconds", () => {
  expect([0, 59.99, 60, 127, -3].map(clock)).toEqual(["0:00", "0:59", "1:00", "2:07", "0:00"]);
});
