/** Furniture in the words that people use. */

import names from "../../scene_graphs/data/furniture_names.json";
import type { Keyframe, Story } from "./api";
import { plain } from "./words";

const NAMES: Readonly<Record<string, string>> = names;

/** "loveseat_sofa" as "loveseat". */
export const nameOf = (category: string): string => NAMES[category] ?? plain(category);

/** "0/l_shaped_sofa_1" as "corner sofa": the piece of that id. */
export const pieceName = (id: string): string => nameOf(id.replace(/^\d+\//, "").replace(/_\d+$/, ""));

/** Where a keyframe plays: "at the cabinet, living room". */
export function placeWords({ object_id, furniture, room }: Pick<Keyframe, "object_id" | "furniture" | "room">): string {
  const piece = object_id ? pieceName(object_id) : plain(furniture);
  return room ? `${piece}, ${plain(room)}` : piece;
}

/** What the rooms of a story's home are called, in their order: the same wherever a room is named. */
export const roomNames = (story: Pick<Story, "home"> | null): string[] => story?.home?.rooms.map(({ room_type }) => plain(room_type)) ?? [];

/** "2 bookshelves", "a desk" as "desk". */
export function several(count: number, name: string): string {
  if (count === 1) return name;
  const many = /(?:ch|sh|s|x)$/.test(name) ? `${name}es` : name.endsWith("shelf") ? name.replace(/f$/, "ves") : `${name}s`;
  return `${count} ${many}`;
}

/** Counts by category as a list, in the order given; what has the same name is counted together. */
export function listing(furniture: Readonly<Record<string, number>>): string {
  const counts = new Map<string, number>();
  for (const [category, count] of Object.entries(furniture)) counts.set(nameOf(category), (counts.get(nameOf(category)) ?? 0) + count);
  return [...counts].map(([name, count]) => several(count, name)).join(", ");
}

/** The names of a room's objects by their ids; where several have one, they are counted: "dining chair 2". */
export function namesIn(objects: readonly { readonly id: string; readonly category: string }[]): Map<string, string> {
  const all = new Map<string, string[]>();
  for (const { id, category } of objects) all.set(nameOf(category), [...(all.get(nameOf(category)) ?? []), id]);
  return new Map([...all].flatMap(([name, ids]) => ids.map((id, place) => [id, ids.length > 1 ? `${name} ${place + 1}` : name] as const)));
}
