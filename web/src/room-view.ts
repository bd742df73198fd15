/** One room on the page: its plan, what can be done at its furniture, and where to take it. */

import { ApiError } from "./api";
import { confirm } from "./dialog";
import { fill, h, icon } from "./dom";
import { namesIn } from "./furniture-words";
import { AFFORDANCES, deleteRoom, getRoom, roomUrl, type Piece, type Room } from "./room-api";
import { kinds, square } from "./room-cards";
import { RoomPlan, type Layer } from "./room-plan";
import { capital, count } from "./words";

const LAYERS: readonly (readonly [Layer, string, boolean])[] = [
  ["names", "Names", true],
  ["graph", "Neighbours", false],
  ["rest", "Sitting and lying", true],
  ["touch", "Touching", false],
];

export class RoomView {
  readonly element = h("article", { class: "room" });
  readonly #id: string;
  readonly #back: string;
  readonly #left: () => void;
  readonly #title = h("h1", {}, "…");
  readonly #caption = h("p", { class: "plan-caption hint" });
  readonly #rows = new Map<string, HTMLButtonElement>();
  #plan: RoomPlan | null = null;
  #room: Room | null = null;
  #live = true;

  /** `back` is the address of the library as it was left; `left` is called when the room is no more. */
  constructor(id: string, back: string, left: () => void) {
    this.#id = id;
    this.#back = back;
    this.#left = left;
    fill(this.element, this.#head());
    void this.#load();
  }

  dispose(): void {
    this.#live = false;
    this.#plan?.dispose();
  }

  #head(...more: HTMLElement[]): HTMLElement {
    return h("header", { class: "room-head" }, h("p", { class: "trail" }, h("a", { href: this.#back }, "Rooms")), this.#title, ...more);
  }

  async #load(): Promise<void> {
    try {
      const room = await getRoom(this.#id);
      if (this.#live) this.#show(room);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      if (error.status === 401) return void window.dispatchEvent(new Event("sims-login"));
      if (!this.#live) return;
      this.#title.textContent = error.status === 404 ? "No such room" : error.title;
      fill(this.element, this.#head(h("p", { class: "hint" }, error.status === 404 ? `There is no room called ${this.#id}.` : error.detail)));
    }
  }

  #show(room: Room): void {
    this.#room = room;
    this.#title.textContent = room.id;
    document.title = `${room.id} · SIMS stories`;
    this.#plan = new RoomPlan(room, (piece) => told(room, piece), (id) => this.#mark(id));
    fill(
      this.element,
      this.#head(h("p", { class: "hint" }, facts(room))),
      h("section", { class: "plan-panel", "aria-label": "Plan" }, this.#toggles(), this.#plan.element, this.#caption, signs()),
      h("div", { class: "column" }, this.#deeds(room), this.#furniture(room), problems(room), files(room), this.#origin(room)),
    );
    this.#mark(null);
  }

  #toggles(): HTMLElement {
    const buttons = LAYERS.map(([layer, words, shown]) => {
      this.#plan?.show(layer, shown);
      const button = h("button", { type: "button", class: "plain small", "aria-pressed": String(shown), "data-layer": layer }, words);
      button.addEventListener("click", () => {
        const now = button.getAttribute("aria-pressed") !== "true";
        button.setAttribute("aria-pressed", String(now));
        this.#plan?.show(layer, now);
      });
      return button;
    });
    return h("div", { class: "row toggles", role: "group", "aria-label": "What the plan shows" }, ...buttons);
  }

  #deeds(room: Room): HTMLElement {
    const remove = room.built_in ? null : h("button", { type: "button", class: "plain", onclick: () => void this.#remove() }, icon("trash"), "Remove this room");
    return h("div", { class: "row deeds" }, h("a", { class: "button primary", href: `#/?in=${encodeURIComponent(room.id)}` }, "Play a story here"), remove);
  }

  #furniture(room: Room): HTMLElement {
    const names = namesIn(room.objects);
    const rows = room.objects.map((piece) => {
      const button = h("button", { type: "button", class: "piece-row", "aria-pressed": "false" }, h("span", {}, capital(names.get(piece.id) ?? piece.id)), h("span", { class: "deeds-there" }, ...doable(room, piece)));
      button.addEventListener("click", () => this.#plan?.choose(piece.id));
      button.addEventListener("pointerenter", (event) => event.pointerType === "mouse" && this.#plan?.point(piece.id));
      button.addEventListener("pointerleave", () => this.#plan?.point(null));
      button.addEventListener("focus", () => this.#plan?.point(piece.id));
      button.addEventListener("blur", () => this.#plan?.point(null));
      this.#rows.set(piece.id, button);
      return h("li", {}, button);
    });
    return h("section", {}, h("h2", {}, "Furniture, and what can be done there"), rows.length ? h("ul", { class: "piece-rows" }, ...rows) : h("p", { class: "hint" }, "The room is empty."));
  }

  /** Say in words what the plan marks. */
  #mark(id: string | null): void {
    const room = this.#room;
    if (!room) return;
    for (const [name, row] of this.#rows) {
      row.classList.toggle("marked", name === id);
      row.setAttribute("aria-pressed", String(name === this.#plan?.chosen));
    }
    const piece = room.objects.find((object) => object.id === id);
    this.#caption.textContent = piece ? told(room, piece) : "Point at a piece, or go from piece to piece with the arrow keys, to see what stands near it and where a body can be.";
  }

  #origin(room: Room): HTMLElement {
    const entry = (term: string, words: string): HTMLElement[] => [h("dt", {}, term), h("dd", {}, words)];
    return h("section", {}, h("h2", {}, "Where it comes from"), h("dl", { class: "origin" }, ...entry("Source", room.source), ...entry("Licence", room.licence), ...entry("Kept", room.built_in ? "comes with the service" : "added here")));
  }

  async #remove(): Promise<void> {
    if (!(await confirm("Remove this room?", `“${this.#id}” will be gone from the library. Stories that play there keep their own copy.`, "Remove it"))) return;
    try {
      await deleteRoom(this.#id);
      this.#left();
    } catch (error) {
      this.element.querySelector(".deeds")?.append(h("p", { class: "wrong", role: "alert" }, error instanceof Error ? error.message : String(error)));
    }
  }
}

function facts(room: Room): string {
  return `${capital(kinds(room))}. ${square(room.area)}, ${room.height.toFixed(2)} m high, ${some(room.doors.length, "door")}, ${some(room.windows.length, "window")}, ${count(room.objects.length, "piece")} of furniture.`;
}

const some = (number: number, noun: string): string => (number ? count(number, noun) : `no ${noun}`);

/** A word for everything that a body might do at a piece; struck out where it cannot get there. */
function doable(room: Room, piece: Piece): HTMLElement[] {
  return AFFORDANCES.flatMap((affordance) => {
    const spots = room.spots.filter((spot) => spot.object_id === piece.id && spot.affordance === affordance);
    if (!spots.length) return [];
    return [spots.some((spot) => spot.usable) ? h("span", { class: `deed ${affordance}` }, affordance) : h("span", { class: "deed out" }, h("s", {}, affordance), h("span", { class: "visually-hidden" }, " (nobody gets there)"))];
  });
}

function told(room: Room, piece: Piece): string {
  const names = namesIn(room.objects);
  const size = piece.size.map((length) => length.toFixed(2)).join(" × ");
  const { nodes, edges } = room.graph;
  const near = edges.flatMap(([a, b]) => (nodes[a]?.object_id === piece.id ? [nodes[b]!.object_id] : nodes[b]?.object_id === piece.id ? [nodes[a]!.object_id] : [])).map((id) => names.get(id) ?? id);
  const free = AFFORDANCES.map((affordance) => [affordance, room.spots.filter((spot) => spot.object_id === piece.id && spot.affordance === affordance && spot.usable).length] as const).filter(([, number]) => number);
  const places = free.map(([affordance, number]) => `${count(number, "place")} to ${affordance}${affordance === "touch" ? " it" : ""}`).join(", ");
  return `${capital(names.get(piece.id) ?? piece.id)}, ${size} m (wide, high, deep). ${near.length ? `Near it: ${near.join(", ")}. ` : ""}${places ? `${capital(places)}.` : "Nothing that a body does is done there."}`;
}

function signs(): HTMLElement {
  const entry = (name: string, words: string): HTMLElement => h("li", {}, h("i", { class: `sign ${name}` }), words);
  return h("ul", { class: "match-legend", "aria-label": "Signs" }, entry("sit", "sit"), entry("lie", "lie"), entry("touch", "touch"), entry("ring", "the body before it does so"), entry("dashed", "nobody gets there"));
}

function problems(room: Room): HTMLElement {
  const list = room.problems.length ? h("ul", { class: "lines" }, ...room.problems.map((problem) => h("li", {}, capital(problem)))) : h("p", { class: "hint" }, "Nothing: no two pieces overlap, doors are free, and what a body needs can be reached.");
  return h("section", {}, h("h2", {}, "What is wrong with it"), list);
}

function files(room: Room): HTMLElement {
  const stem = room.id.replaceAll("/", "-");
  const all: readonly (readonly [string, string, string])[] = [
    [`${stem}.svg`, roomUrl(room.id, "/drawing.svg"), "a drawing with names, neighbours, places and a way from the door"],
    [`${stem}.png`, roomUrl(room.id, "/drawing.png"), "the same as pixels"],
    [`${stem}.glb`, roomUrl(room.id, "/scene.glb"), "the room in three dimensions, for any glTF viewer"],
    [`${stem}.json`, roomUrl(room.id), "the room in our own format, with its places and its graph"],
  ];
  return h("section", {}, h("h2", {}, "Download"), h("ul", { class: "files" }, ...all.map(([name, url, words]) => h("li", {}, h("a", { href: url, download: name }, icon("down"), name), h("span", { class: "hint" }, words)))));
}
