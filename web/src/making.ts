/** How a story was made: the beats of its theme, the scripts that were found, the rooms, what was put in. */

import type { Beat, FoundRoom, FoundScript, Story } from "./api";
import { fill, h } from "./dom";
import { drawGraph } from "./graph";
import { badge, lacking, outcomeOf } from "./outcomes";
import { beatsWords, capital, noteWords, plain } from "./words";

/** Fill a section; false while nothing is known. */
export function showMaking(section: HTMLElement, story: Story): boolean {
  if (!story.beats.length && !story.home && !story.repairs.length) return false;
  fill(
    section,
    h("h2", {}, "How it was made"),
    ...player(story),
    ...beats(story),
    ...rooms(story),
    ...list("Put right", "What the script needed so that a body can act it.", story.repairs.map(noteWords)),
  );
  return true;
}

function player({ character }: Story): HTMLElement[] {
  if (!character.member) return [];
  const worn = character.outfit.replaceAll("_", " ");
  return [h("p", { class: "player" }, `Played by ${capital(character.member)}: ${character.age}, ${character.height.toFixed(2)} m; wears: ${worn}.`)];
}

function beats(story: Story): HTMLElement[] {
  // What became of them is in the report; here is what was found for them.
  if (!story.beats.length || (story.report && !story.short_scripts.length)) return [];
  const asked = story.beats.map((beat, index) => ({ beat, index })).filter(({ beat }) => beat.kind !== "undone");
  const undone = story.beats.filter((beat) => beat.kind === "undone");
  const loose = story.short_scripts.filter((script) => !story.beats[script.beat]);
  return [
    h("h3", {}, "Beats"),
    h("p", { class: "hint" }, `${beatsWords(story.beats)} Where a short script was taken for one, its score is how near in meaning it is, at most 1.`),
    h("ol", { class: "beats" }, ...asked.map(({ beat, index }) => told(beat, story.short_scripts.filter((script) => script.beat === index))), ...loose.map((script) => h("li", {}, found(script)))),
    ...list("Left undone", "What the theme says is not done.", undone.map((beat) => beat.text)),
  ];
}

function told(beat: Beat, scripts: readonly FoundScript[]): HTMLElement {
  return h(
    "li",
    { "data-emotion": beat.emotion },
    h("p", { class: "beat" }, h("i", {}), `“${beat.text}”`),
    h("p", { class: "became" }, badge(outcomeOf(beat)), lacking(beat) ? ` ${lacking(beat)}` : null),
    ...scripts.map(found),
  );
}

function found(script: FoundScript): HTMLElement {
  const score = Math.min(Math.max(script.score, 0), 1);
  return h(
    "p",
    { class: "found" },
    h("span", { class: "score", style: `--score: ${score}`, title: "How near in meaning" }, script.score.toFixed(2)),
    h("span", {}, script.summary, " ", h("code", {}, script.id)),
  );
}

function rooms(story: Story): HTMLElement[] {
  if (!story.home?.rooms.length) return [];
  const graph = story.graph && story.graph.nodes.length > 1 ? drawGraph(story.graph) : null;
  return [
    h("h3", {}, "Rooms"),
    h("p", { class: "hint" }, "The distance counts the changes between the furniture that the script asks for and what the room has; 0 is a perfect fit."),
    h("ul", { class: "rooms" }, ...story.home.rooms.map(room)),
    ...(graph ? [h("figure", { class: "graph" }, graph, h("figcaption", {}, "The furniture that the script asks for, and what is used together."))] : []),
  ];
}

function room(found: FoundRoom): HTMLElement {
  const swaps = found.substitutions.map(({ asked, given, level }) => h("li", {}, `${plain(asked)} → ${plain(given)} `, h("small", {}, LEVELS[level] ?? level)));
  const lacks = found.missing.map((name) => h("li", {}, `${plain(name)} is missing`));
  return h(
    "li",
    {},
    h("b", {}, capital(plain(found.room_type))),
    h("span", { class: "hint" }, ` ${found.layout_id} · distance ${found.distance}${found.exact ? "" : ", perhaps not the least"}`),
    swaps.length + lacks.length ? h("ul", {}, ...swaps, ...lacks) : null,
  );
}

const LEVELS: Readonly<Record<string, string>> = {
  class: "much the same",
  group: "of the same kind",
  affordance: "serves the same purpose",
};

function list(title: string, hint: string, lines: readonly string[]): HTMLElement[] {
  if (!lines.length) return [];
  return [h("h3", {}, title), h("p", { class: "hint" }, hint), h("ul", { class: "lines" }, ...lines.map((line) => h("li", {}, capital(line))))];
}
