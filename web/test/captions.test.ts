import { expect, test } from "vitest";
import { found, type CaptionWords } from "../src/captions";

const CLAP: CaptionWords = { caption: "clapping hands", skill: "loco", shows: ["clap", "applaud"], others: ["give a round of applause"] };
const DOZE: CaptionWords = { caption: "lying back in chair", skill: "sitdown", shows: ["sleep", "nap"], others: [] };

test("captions are found by their words, their skill, what is seen in them and other words for them", () => {
  const ask = (words: string): string[] => found([CLAP, DOZE], words).map(({ caption }) => caption);
  expect(ask("")).toEqual([CLAP.caption, DOZE.caption]);
  for (const words of ["clap", "APPLAUD", "round of", "walk hands"]) expect(ask(words)).toEqual([CLAP.caption]);
  for (const words of ["nap", "sit", "chair lying"]) expect(ask(words)).toEqual([DOZE.caption]);
  expect(ask("clap nap")).toEqual([]);
});
