/** Words that a person understands for what the service names in short. */

import type { Beat, Skill, Stage, Story } from "./api";

export const STAGES: readonly Stage[] = ["plan", "furnish", "narrate", "act", "move", "judge", "film"];

export const STAGE_WORDS: Readonly<Record<Stage, string>> = {
  plan: "weaving short scripts",
  furnish: "finding rooms that fit",
  narrate: "telling the story",
  act: "finding where to sit, lie, touch and walk",
  move: "moving the body",
  judge: "measuring the motion",
  film: "writing the film",
};

export const STAGE_SHORT: Readonly<Record<Stage, string>> = {
  plan: "script",
  furnish: "rooms",
  narrate: "story",
  act: "places",
  move: "motion",
  judge: "measure",
  film: "film",
};

export const SKILL_WORDS: Readonly<Record<Skill, string>> = {
  loco: "walk",
  sitdown: "sit down",
  standup: "stand up",
  getup: "get up",
  liedown: "lie down",
  touch: "touch",
};

/** What a body sets out to do, before it is seen how. */
export const BEGUN_WORDS: Readonly<Record<Skill, string>> = {
  loco: "sets off",
  sitdown: "sits down",
  standup: "stands up",
  getup: "gets up",
  liedown: "lies down",
  touch: "reaches out",
};

/** "multi_seat_sofa_1" as "multi seat sofa". */
export function plain(name: string): string {
  return name.replace(/^\d+\//, "").replace(/_\d+$/, "").replaceAll("_", " ");
}

/** A length in centimetres, from metres. */
export function centimetres(metres: number): string {
  return `${(100 * metres).toFixed(1)} cm`;
}

export function percent(share: number): string {
  return `${(100 * share).toFixed(1)} %`;
}

/** "1 room", "2 rooms". */
export function count(number: number, noun: string): string {
  return `${number} ${noun}${number === 1 ? "" : "s"}`;
}

export function capital(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** What the planner noted, in the words and numbers that the page uses: keyframes are counted from 0 there, moments from 1 here. */
export function noteWords(note: string): string {
  return note
    .replace(/keyframe (\d+)/g, (_, index: string) => `moment ${Number(index) + 1}`)
    .replace(/\b(loco|sitdown|standup|getup|liedown)\b/g, (skill) => SKILL_WORDS[skill as Skill]);
}

/** What a story is called beside others of its kind. */
export function takeWords({ take, derived_from }: Pick<Story, "take" | "derived_from">): string {
  if (!derived_from) return "The story";
  return take ? `Take ${take}` : "A take";
}

/** Why what happens, and nobody does, is not acted. */
const REACTED = "the body reacts to it";

/** Whether a beat asks for something to be seen: not what is to be left undone, is told and nobody does, or only happens and is reacted to. */
export const isAsked = ({ kind, who, why }: Beat): boolean => kind !== "undone" && (kind !== "other" || who !== "") && !why.startsWith(REACTED);

/** "6 of 7 beats of your theme are acted."; of what is asked for: not of what is to be left undone, nor of what is told and nobody does. */
export function beatsWords(beats: readonly Beat[]): string {
  const asked = beats.filter(isAsked);
  const stoodFor = asked.filter((beat) => beat.stood_for).length;
  const more = stoodFor ? `, something stands for ${stoodFor} more` : "";
  return `${asked.filter((beat) => beat.acted).length} of ${count(asked.length, "beat")} of your theme ${asked.length === 1 ? "is" : "are"} acted${more}.`;
}

/** The side on which a caption has a hand or an arm do something: 1 left, -1 right, 0 where it names none or both. */
export function sideOf(caption: string): -1 | 0 | 1 {
  const has = (side: string): boolean => new RegExp(`\\b${side} (hand|arm|ear)\\b`, "i").test(caption);
  return has("left") === has("right") ? 0 : has("left") ? 1 : -1;
}
