/** What somebody looks for, in a line of words, as the graph that the service is asked for. */

import { AFFORDANCES, type Affordance, type Query } from "./room-api";

/** As many as the service takes. */
const MOST = 52;

interface Node {
  readonly category: string;
  readonly instance: number;
  needs: readonly Affordance[];
}

/**
 * Read "sofa:sit + coffee table, sofa + tv stand, 2 armchairs": commas part pieces, a plus joins the two beside it, a word
 * that comes again means the same piece, a number means so many, and what a body shall do there stands behind a colon.
 * Throws with a sentence for whoever wrote it.
 */
export function readQuery(text: string): Query {
  const nodes: Node[] = [];
  const edges = new Map<string, readonly [number, number]>();
  for (const chain of text.split(",")) {
    const links = chain.split("+").map((words) => words.trim());
    if (links.length > 1 && links.includes("")) throw new Error("A plus stands between two pieces: sofa + coffee table.");
    let before: number | null = null;
    for (const link of links.filter(Boolean)) {
      const places = placesOf(link, nodes);
      for (const place of places) {
        if (place === before) throw new Error(`“${link}” cannot stand beside itself; for two of them write 2 ${link}.`);
        if (before !== null) edges.set(`${Math.min(before, place)} ${Math.max(before, place)}`, [before, place]);
      }
      before = places[0]!;
    }
  }
  if (!nodes.length) throw new Error("Write which furniture there shall be, with commas between.");
  return { nodes, edges: [...edges.values()] };
}

/** Where in `nodes` the pieces are that a few words name; those that are new are added. */
function placesOf(link: string, nodes: Node[]): number[] {
  const [, number = "1", name = "", said = ""] = /^(?:(\d+)\s*(?:x\s+)?)?([^:]*)(?::(.*))?$/i.exec(link) ?? [];
  const [category, wanted] = [name.trim(), Number(number)];
  if (!category || !wanted) throw new Error(`“${link}” names no furniture.`);
  const needs = said.toLowerCase().split(/[\s/&]+/).filter(Boolean);
  const wrong = needs.find((need) => !AFFORDANCES.includes(need as Affordance));
  if (wrong) throw new Error(`“${wrong}” is not known behind a colon; write sit, lie or touch.`);
  const same = (other: string): boolean => one(other) === one(category);
  const there = nodes.filter((node) => same(node.category)).length;
  if (nodes.length + wanted - there > MOST) throw new Error(`At most ${MOST} pieces are looked for at once.`);
  for (let instance = there + 1; instance <= wanted; instance++) nodes.push({ category, instance, needs: [] });
  const places = nodes.flatMap((node, place) => (same(node.category) ? [place] : [])).slice(0, wanted);
  for (const place of places) nodes[place]!.needs = [...new Set([...nodes[place]!.needs, ...(needs as Affordance[])])];
  return places;
}

/** A word as it is for one of a kind: "Armchairs" as "armchair". */
const one = (category: string): string => category.toLowerCase().replace(/\s+/g, " ").replace(/([^s])s$/, "$1");
