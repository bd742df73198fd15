import { expect, test } from "vitest";
import { moversOf } from "../src/movers";

const PHASES = [
  { start: 0, stop: 60, backend: "diffusion", fallback: null },
  { start: 60, stop: 80, backend: "procedural", fallback: "diffusion: the liedown was up to 0.02 m deep in furniture" },
  { start: 80, stop: 90, backend: "procedural", fallback: "diffusion: it did not look like 'walk'" },
  { start: 90, stop: 100, backend: "procedural", fallback: "diffusion: it did not look like 'walk'" },
  { start: 100, stop: 120, backend: "procedural", fallback: "diffusion: it makes walks" },
];

test("every frame of a film has one mover, and whoever moved longest is first", () => {
  const movers = moversOf(PHASES);
  expect(movers.map(({ backend }) => backend)).toEqual(["diffusion", "procedural"]);
  expect(movers.reduce((sum, { share }) => sum + share, 0)).toBeCloseTo(1);
});

test("reasons are told once, in plain words, and make up what they are reasons of", () => {
  const [, { share, reasons } = { share: 0, reasons: [] }] = moversOf(PHASES);
  expect(new Set(reasons.map(({ words }) => words)).size).toBe(3);
  expect(reasons.reduce((sum, reason) => sum + reason.share, 0)).toBeCloseTo(share);
  expect(reasons.map(({ words }) => words)).toContain("diffusion: the lie down was up to 0.02 m deep in furniture");
});

test("a film that is not made has none", () => {
  expect(moversOf([])).toEqual([]);
});
