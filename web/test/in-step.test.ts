// Two films play in step: each new moment begins together, and what is sent elsewhere is followed.

import { expect, test } from "vitest";
import { InStep, type Stepping } from "../src/in-step";
import { Player } from "../src/player";

const ALL: [number, number][] = [[0, 0], [1, 1], [2, 2]];

/** A film with moments that begin at so many seconds, all of it made. */
function film(starts: readonly number[], length: number): Stepping & { readonly player: Player } {
  const player = new Player();
  player.feed(length, true);
  return {
    player,
    ready: length,
    get time() {
      return player.time;
    },
    get ended() {
      return player.state === "ended";
    },
    get running() {
      return player.running;
    },
    get seeks() {
      return player.seeks;
    },
    seek: (time) => player.seek(time),
    play: () => player.play(),
    bar: (time) => player.bar(time),
    startOf: (keyframe) => starts[keyframe] ?? Infinity,
  };
}

function pair(moments = ALL) {
  const [short, long] = [film([0, 1, 3], 4), film([0, 2, 3], 6)];
  const step = new InStep([short, long]);
  step.pair(moments);
  step.seek(0);
  for (const { player } of [short, long]) player.play();
  const pass = (seconds: number): [number, number] => {
    for (let gone = 0; gone < seconds - 1e-9; gone += 0.125) {
      for (const { player } of [short, long]) player.advance(0.125);
      step.tick();
    }
    return [short.time, long.time];
  };
  return { short, long, step, pass };
}

test("the one that is ready for the next moment waits for the other, then both begin it", () => {
  const { short, pass } = pair();
  expect(pass(1.5)).toEqual([1, 1.5]);
  expect(short.player.held).toBe(true);
  expect(pass(0.5)).toEqual([1, 2]);
  expect(pass(0.5)).toEqual([1.5, 2.5]);
  expect(pass(1)).toEqual([2.5, 3]);
  expect(pass(0.5)).toEqual([3, 3]);
  expect(pass(0.5)).toEqual([3.5, 3.5]);
});

test("after one has ended the other goes on to its own end", () => {
  const { short, long, pass } = pair();
  expect(pass(10)).toEqual([4, 6]);
  expect([short.player.state, long.player.state]).toEqual(["ended", "ended"]);
});

test("moments that only one has are played while the other waits", () => {
  const { pass } = pair([[0, 0], [2, 1]]);
  expect(pass(2.5)).toEqual([2.5, 2]);
  expect(pass(1)).toEqual([3.5, 2.5]);
});

test("where one is sent the other goes along, into the same moment", () => {
  const { short, long, step, pass } = pair();
  short.player.seek(1.25);
  step.tick();
  expect(long.time).toBe(2.25);
  long.player.seek(0.5);
  step.tick();
  expect(short.time).toBe(0.5);
  long.player.seek(1.75);
  step.tick();
  expect(short.time).toBeLessThan(1);
  expect(short.time).toBeGreaterThan(0.99);
  pass(0.25);
  expect([short.time, long.time]).toEqual([1, 2]);
});

test("a key that moves both moves neither twice", () => {
  const { short, long, step } = pair();
  for (const { player } of [short, long]) player.seek(player === short.player ? 1 : 2);
  step.tick();
  expect([short.time, long.time]).toEqual([1, 2]);
});
