/** What the fields of a keyframe may be, as the service lists them; asked for once. */

import { json, type Home, type Skill } from "./api";
import { nameOf, namesIn } from "./furniture-words";
import { plain } from "./words";

export interface Backend {
  readonly backend: string;
  readonly about: string;
  readonly default: boolean;
}

interface Furniture {
  readonly category: string;
  readonly affords: readonly string[];
}

/** An object of a home that can be named. */
export interface Thing {
  readonly id: string;
  readonly name: string;
  /** The room it stands in: "living room". */
  readonly room: string;
  readonly affords: readonly string[];
  /** Whether one can walk up to it: what hangs on the ceiling or high on a wall is over other things. */
  readonly near: boolean;
}

/** Metres above the floor under which what one walks to begins. */
const REACH = 1.1;

export class Vocabulary {
  readonly backends: readonly Backend[];
  readonly #captions: ReadonlyMap<Skill, readonly string[]>;
  readonly #skills: ReadonlyMap<Skill, { readonly needs: string | null; readonly usual: string }>;
  readonly #affords: ReadonlyMap<string, readonly string[]>;

  private constructor(
    captions: readonly { readonly caption: string; readonly skill: Skill }[],
    skills: readonly { readonly skill: Skill; readonly needs: string | null; readonly usual: string }[],
    furniture: readonly Furniture[],
    backends: readonly Backend[],
  ) {
    this.backends = backends;
    this.#skills = new Map(skills.map((one) => [one.skill, one]));
    this.#captions = new Map(skills.map(({ skill }) => [skill, captions.filter((one) => one.skill === skill).map(({ caption }) => caption)]));
    this.#affords = new Map(furniture.map(({ category, affords }) => [category, affords]));
  }

  /** ApiError where the service does not answer; the next call asks again. */
  static load(): Promise<Vocabulary> {
    known ??= ask().catch((error: unknown) => {
      known = null;
      throw error;
    });
    return known;

    async function ask(): Promise<Vocabulary> {
      const [captions, skills, furniture, backends] = await Promise.all([items<{ caption: string; skill: Skill }>("captions"), items<{ skill: Skill; needs: string | null; usual: string }>("skills"), items<Furniture>("furniture"), items<Backend>("backends")]);
      return new Vocabulary(captions, skills, furniture, backends);
    }
  }

  captions(skill: Skill): readonly string[] {
    return this.#captions.get(skill) ?? [];
  }

  /** The caption of a skill where nothing else is said. */
  usual(skill: Skill): string {
    return this.#skills.get(skill)?.usual ?? "";
  }

  /** What furniture must afford for a skill; null: nothing. */
  needs(skill: Skill): string | null {
    return this.#skills.get(skill)?.needs ?? null;
  }

  /** All that can be named in a home, room after room; `rooms` are what those are called in the story. */
  things(home: Home, rooms: readonly string[]): Thing[] {
    const all = home.rooms.flatMap(({ layout }, place) => layout.objects.map(({ id, category, position }) => ({ id: `${place}/${id}`, category, room: rooms[place] ?? plain(layout.room_type), near: position[1] < REACH })));
    const names = namesIn(all);
    return all.map(({ id, category, room, near }) => ({ id, name: names.get(id) ?? nameOf(category), room, near, affords: this.#affords.get(category) ?? [] }));
  }
}

let known: Promise<Vocabulary> | null = null;

async function items<T>(name: string): Promise<readonly T[]> {
  return (await json<{ items: T[] }>(`v1/${name}`)).items;
}
