import { expect, test } from "vitest";
import { sideOf } from "../src/words";

test.each([
  ["walk while talking on the phone with the right hand", -1],
  ["Left arm behind the head", 1],
  ["side lie on left, right hand on belly", -1],
  ["left hand on the right hand", 0],
  ["walk to the front right", 0],
])("the side on which “%s” has a hand do something", (caption, side) => {
  expect(sideOf(caption)).toBe(side);
});
