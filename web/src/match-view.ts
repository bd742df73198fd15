/** A room that was found beside what was looked for: each piece has the number and colour of what stands for it. */

import type { Point2 } from "./api";
import { fill, h, s } from "./dom";
import { nameOf, namesIn } from "./furniture-words";
import { apart, placeNames } from "./names";
import { boxOf, centreOf, keepUnits, pieces, shell, type Box } from "./plan";
import { roomAddress, type Level, type Match, type Query, type Room } from "./room-api";
import { capital, count, plain } from "./words";

export const LEVEL_WORDS: Readonly<Record<Level, string>> = { same: "what was asked for", class: "of the same class", group: "of the same group" };
const COST_WORDS: Readonly<Record<string, string>> = {
  substitutions: "for what stands in",
  missing: "for what is missing",
  lost_relations: "for what is not side by side",
  extra: "for furniture not used",
  extra_relations: "for neighbours not asked for",
  more_rooms: "for more than one room",
};
/** Between rooms of a home, and below them for what is missing, centimetres. */
const APART = 40;
const BELOW = 110;
/** How far signs are from each other, pixels. */
const SIGN = 22;

/** Where a room is drawn: its rectangle, and how far it is moved. */
interface Hung {
  readonly room: Room;
  readonly box: Box;
  readonly shift: Point2;
}

/** The ids of the rooms that a match is of. */
export const roomsOf = (match: Match): string[] => match.rooms?.map((room) => room.layout_id) ?? [match.layout_id ?? ""];

/** The whole comparison. `rooms` are those of `roomsOf`, in its order. */
export function matchView(query: Query, match: Match, rooms: readonly Room[], rank: number): HTMLElement {
  const hung = hang(rooms);
  const wide = Math.max(...hung.map(({ box, shift }) => shift[0] + box[2]));
  const high = Math.max(...hung.map(({ box, shift }) => shift[1] + box[3]));
  const given = new Map(match.mapping.map((one) => [one.node, one]));
  const places = query.nodes.map((_, node): Point2 => {
    const id = given.get(node)?.object_id;
    return (id === undefined ? null : placeOf(hung, match, id)) ?? below(match, node, wide, high);
  });
  const level = (node: number): string => given.get(node)?.level ?? "missing";
  const box: Box = [0, 0, wide, high + (match.reasons.length ? BELOW : 0)];
  const asked = figure(box, "What was looked for, every piece where the room has it", (unit) => {
    const spread = apart(places, SIGN * unit);
    const names = query.nodes.map(({ category }, node) => ({ id: "", words: category, at: [spread[node]![0], spread[node]![1] + SIGN * unit] as const, weight: 1 / (node + 1) }));
    return [...lines(query, match, spread), ...spread.map((at, node) => number(node, at, level(node))), s("g", { class: "names" }, ...placeNames(names, unit, spread))];
  }, ...hung.map((one) => s("g", { class: "ghost", transform: moved(one) }, shell(one.room))));
  const found = figure(box, "What was found, from above", (unit) => {
    const spread = apart(match.mapping.map(({ node }) => places[node]!), SIGN * unit);
    return match.mapping.map(({ node }, place) => number(node, spread[place]!, level(node)));
  }, ...hung.map((one, place) => hungRoom(one, place, match)));
  const ids = roomsOf(match);
  const list = h("ol", { class: "standing" }, ...query.nodes.map((_, node) => row(query, match, node, rooms)));
  return h(
    "li",
    { class: "match" },
    h("h3", {}, `${rank}. `, ...ids.flatMap((id, place) => [place ? " and " : null, h("a", { href: roomAddress(id) }, id)])),
    h("p", { class: "match-sum" }, ...sum(match)),
    h("div", { class: "side-by-side" }, h("figure", {}, asked, h("figcaption", {}, "Looked for")), h("figure", {}, found, h("figcaption", {}, "Found"))),
    list,
    lost(query, match),
    h("a", { class: "button plain small", href: `#/?${ids.map((id) => `in=${encodeURIComponent(id)}`).join("&")}` }, "Play a story here"),
  );
}

/** What the colours mean. */
export function legend(): HTMLElement {
  const entry = (name: string, words: string): HTMLElement => h("li", {}, h("i", { class: `sign ${name}` }), words);
  return h("ul", { class: "match-legend", "aria-label": "Colours" }, ...Object.entries(LEVEL_WORDS).map(([level, words]) => entry(level, words)), entry("missing", "missing"), entry("dashed", "not side by side in the room"));
}

/** Rooms in rows of two. */
function hang(rooms: readonly Room[]): Hung[] {
  const boxes = rooms.map(boxOf);
  const columns = [0, 1].map((column) => Math.max(0, ...boxes.filter((_, place) => place % 2 === column).map((box) => box[2])));
  const rows = [0, 1].map((row) => Math.max(0, ...boxes.filter((_, place) => Math.floor(place / 2) === row).map((box) => box[3])));
  return rooms.map((room, place) => ({ room, box: boxes[place]!, shift: [place % 2 ? columns[0]! + APART : 0, place > 1 ? rows[0]! + APART : 0] }));
}

/** An object's room, by place, and its id there. */
function split(match: Match, id: string): [number, string] {
  const slash = id.indexOf("/");
  return match.rooms ? [Number(id.slice(0, slash)), id.slice(slash + 1)] : [0, id];
}

function placeOf(hung: readonly Hung[], match: Match, id: string): Point2 | null {
  const [place, own] = split(match, id);
  const one = hung[place];
  const piece = one?.room.objects.find((object) => object.id === own);
  if (!one || !piece) return null;
  const [x, z] = centreOf(piece);
  return [x - one.box[0] + one.shift[0], z - one.box[1] + one.shift[1]];
}

function below(match: Match, node: number, wide: number, high: number): Point2 {
  const missing = match.reasons.map((reason) => reason.node);
  return [(wide * (missing.indexOf(node) + 1)) / (missing.length + 1), high + BELOW / 2];
}

function hungRoom(one: Hung, place: number, match: Match): SVGGElement {
  const { room } = one;
  const drawn = pieces(room);
  const used = new Set<string>();
  for (const { object_id, level } of match.mapping) {
    const [where, id] = split(match, object_id);
    if (where !== place) continue;
    used.add(id);
    drawn.get(id)?.classList.add("stands", level);
  }
  for (const [id, piece] of drawn) if (!used.has(id)) piece.classList.add("unused");
  return s("g", { transform: moved(one) }, shell(room), ...drawn.values());
}

const moved = ({ box, shift }: Hung): string => `translate(${shift[0] - box[0]} ${shift[1] - box[1]})`;

function lines(query: Query, match: Match, places: readonly Point2[]): SVGLineElement[] {
  const gone = new Set(match.lost.map(([a, b]) => `${Math.min(a, b)} ${Math.max(a, b)}`));
  return query.edges.map(([a, b]) => {
    const [from, to] = [places[a]!, places[b]!];
    return s("line", { class: gone.has(`${Math.min(a, b)} ${Math.max(a, b)}`) ? "relation lost" : "relation", x1: from[0], y1: from[1], x2: to[0], y2: to[1] });
  });
}

/** What lies over it is drawn anew when it becomes larger or smaller, for signs and letters do not. */
function figure(box: Box, label: string, over: (unit: number) => SVGElement[], ...under: SVGElement[]): SVGSVGElement {
  const signs = s("g");
  const svg = s("svg", { class: "room-plan", viewBox: box.join(" "), role: "img", "aria-label": label }, ...under, signs);
  keepUnits(svg, (unit) => fill(signs, ...over(unit)));
  return svg;
}

const number = (node: number, [x, y]: Point2, level: string): SVGGElement =>
  s("g", { class: `number ${level}`, transform: `translate(${x.toFixed(1)} ${y.toFixed(1)})` }, s("circle"), s("text", { "text-anchor": "middle", dy: "0.36em" }, String(node + 1)));

function row(query: Query, match: Match, node: number, rooms: readonly Room[]): HTMLElement {
  const { category, needs } = query.nodes[node]!;
  const asked = `${category}${needs.length ? ` to ${needs.join(" and ")}` : ""}`;
  const pair = match.mapping.find((one) => one.node === node);
  const sign = h("i", { class: `sign ${pair?.level ?? "missing"}`, "aria-hidden": "true" }, String(node + 1));
  if (!pair) return h("li", { class: "gone" }, sign, h("span", {}, h("b", {}, capital(asked)), " ", h("small", {}, `missing: ${why(match, node)}`)));
  const [place, id] = split(match, pair.object_id);
  const name = namesIn(rooms[place]?.objects ?? []).get(id) ?? nameOf(pair.given);
  const where = rooms.length > 1 ? ` in the ${plain(rooms[place]?.room_type ?? "room")}` : "";
  return h("li", {}, sign, h("span", {}, h("b", {}, capital(asked)), " ", h("small", {}, `→ ${name}${where}${pair.level === "same" ? "" : `, ${LEVEL_WORDS[pair.level]} (${pair.cost})`}`)));
}

function why(match: Match, node: number): string {
  const reason = match.reasons.find((one) => one.node === node);
  const near = reason?.nearest ? nameOf(reason.nearest) : "what is there";
  switch (reason?.why) {
    case "unfit":
      return `nobody can ${reason.unmet.join(" or ")} at the ${near}`.replace("the what", "what");
    case "taken":
      return `the ${near} stands for another piece already`.replace("the what", "what");
    case "spare":
      return `the ${near} could stand in, but nothing would be gained`.replace("the what", "what");
    default:
      return "there is nothing of its kind";
  }
}

function lost(query: Query, match: Match): HTMLElement | null {
  if (!match.lost.length) return null;
  const pairs = match.lost.map(([a, b]) => `${query.nodes[a]!.category} and ${query.nodes[b]!.category}`);
  return h("p", { class: "hint" }, `Not side by side here: ${pairs.join("; ")}.`);
}

function sum(match: Match): (HTMLElement | string)[] {
  const parts = Object.entries(match.costs).filter(([, cost]) => cost);
  const split = parts.map(([name, cost]) => `${cost} ${COST_WORDS[name] ?? plain(name)}`).join(" + ");
  const proof = match.exact
    ? "Nothing nearer is possible: this is proven."
    : match.lower_bound < match.distance
      ? `The search ended early; the true distance is at least ${match.lower_bound}.`
      : "The search ended early; something nearer may have been passed over.";
  const unused = match.extra.length ? ` ${capital(count(match.extra.length, "piece"))} of furniture not used.` : "";
  return [h("b", {}, `Distance ${match.distance}`), split ? ` = ${split}. ` : ". ", h("span", { class: match.exact ? "proven" : "unproven" }, proof), unused];
}
