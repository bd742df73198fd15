/** A story's script while it is being changed: plain values, and every change a new list. */

import type { Keyframe, NewTake, Skill } from "./api";

/** A keyframe as somebody wants it. */
export interface Draft {
  /** The story's keyframe that it is, changed or not; null: a new one. */
  readonly index: number | null;
  readonly skill: Skill;
  readonly emotion: string;
  readonly caption: string;
  readonly furniture: string;
  readonly object_id: string | null;
}

/** The same as the service is told it. */
export type Wanted = NewTake["keyframes"][number];

export type Script = readonly Draft[];

const RISES: readonly Skill[] = ["standup", "getup"];

export const draftOf = (keyframes: readonly Keyframe[]): Script =>
  keyframes.map(({ index, skill, emotion, caption, furniture, object_id }) => ({ index, skill, emotion, caption, furniture, object_id }));

/** With something else at one place. */
export function changed(script: Script, at: number, change: Partial<Draft>): Script {
  return script.map((draft, place) => (place === at ? { ...draft, ...change } : draft));
}

/** At another object, or on the floor (null); walks that lead to the old one and risings from it go along. */
export function placed(script: Script, at: number, object: string | null): Script {
  const old = script[at]?.object_id;
  const along = new Set([at]);
  const same = (place: number, skills: readonly Skill[]): boolean => {
    const draft = script[place];
    return draft !== undefined && old !== null && draft.object_id === old && skills.includes(draft.skill);
  };
  for (let place = at - 1; same(place, ["loco"]); place--) along.add(place);
  for (let place = at + 1; same(place, RISES); place++) along.add(place);
  // Which word names it is for the service to say.
  return script.map((draft, place) => (along.has(place) && draft.object_id !== object ? { ...draft, object_id: object, furniture: "floor" } : draft));
}

export const dropped = (script: Script, at: number): Script => script.filter((_, place) => place !== at);

/** One place earlier (-1) or later (1). */
export function moved(script: Script, at: number, by: -1 | 1): Script {
  const [one, other] = [script[at], script[at + by]];
  if (!one || !other) return script;
  return script.map((draft, place) => (place === at ? other : place === at + by ? one : draft));
}

/** With a new keyframe behind a place. */
export const added = (script: Script, behind: number, draft: Draft): Script => [...script.slice(0, behind + 1), draft, ...script.slice(behind + 1)];

/** The rooms that a line of text names. */
export const roomsNamed = (line: string): readonly string[] => line.split(/[\s,]+/).filter(Boolean);

/** What a keyframe is sent as: in another home (`elsewhere`) by words alone, since no object is there; `nameOf` has them. */
export function sent({ index, object_id, furniture, ...words }: Draft, elsewhere: boolean, nameOf: (id: string) => string): Wanted {
  const there = object_id === null || elsewhere ? {} : { object_id };
  // What was put at another object has no word yet.
  const named = elsewhere && object_id !== null && furniture === "floor" ? nameOf(object_id) : furniture;
  return { ...words, furniture: named, ...(index === null ? {} : { index }), ...there };
}

/** The first place at which two scripts differ; null where they are the same. */
export function firstChange(script: Script, before: Script): number | null {
  const count = Math.max(script.length, before.length);
  for (let place = 0; place < count; place++) if (!same(script[place], before[place])) return place;
  return null;
}

function same(one: Draft | undefined, other: Draft | undefined): boolean {
  if (!one || !other) return one === other;
  return (["index", "skill", "emotion", "caption", "furniture", "object_id"] as const).every((name) => one[name] === other[name]);
}
