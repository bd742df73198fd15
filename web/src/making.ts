/** How a story was made: the scripts that were found, the rooms, what was put in, what was left out. */

import type { FoundRoom, FoundScript, Story } from "./api";
import { fill, h } from "./dom";
import { drawGraph } from "./graph";
import { capital, count, noteWords, plain } from "./words";

/** Fill a section; false while nothing is known. */
export function showMaking(section: HTMLElement, story: Story): boolean {
  if (!story.short_scripts.length && !story.home && !story.repairs.length) return false;
  fill(
    section,
    h("h2", {}, "How it was made"),
    ...scripts(story),
    ...rooms(story),
    ...list("Put right", "What the script needed so that a body can act it.", story.repairs.map(noteWords)),
    ...list("Left out", "Parts of the theme for which no short script was found.", story.uncovered),
  );
  return true;
}

function scripts(story: Story): HTMLElement[] {
  if (!story.short_scripts.length) return [];
  const events = story.events.map((event, index) =>
    h(
      "li",
      { "data-emotion": event.emotion },
      h("p", { class: "event" }, h("i", {}), `“${event.text}”`),
      ...story.short_scripts.filter((script) => script.event === index).map(found),
    ),
  );
  const loose = story.short_scripts.filter((script) => !story.events[script.event]);
  return [
    h("h3", {}, "Short scripts"),
    h("p", { class: "hint" }, `The theme was read as ${count(story.events.length, "event")}; for each the nearest scripts were taken. The score is how near in meaning, at most 1.`),
    h("ol", { class: "events" }, ...events, ...loose.map((script) => h("li", {}, found(script)))),
  ];
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
