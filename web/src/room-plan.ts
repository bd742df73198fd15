/** A room's large plan: pointing at a piece, or going there with arrow keys, shows what it stands near and where a body can be. */

import { fill, h, s } from "./dom";
import { namesIn } from "./furniture-words";
import { CM } from "./glyphs";
import { placeNames } from "./names";
import { boxOf, centreOf, isHanging, keepUnits, pieces, shell } from "./plan";
import type { Piece, Room, Spot } from "./room-api";

/** `rest` is where a body sits and lies. */
export type Layer = "names" | "graph" | "rest" | "touch";

export class RoomPlan {
  readonly element: HTMLElement;
  readonly #svg: SVGSVGElement;
  readonly #room: Room;
  readonly #pieces: Map<string, SVGGElement>;
  readonly #names: Map<string, string>;
  readonly #texts = s("g", { class: "names", "aria-hidden": "true" });
  readonly #marked: (id: string | null) => void;
  readonly #ended: () => void;
  #chosen: string | null = null;
  #pointed: string | null = null;

  /** `told` says a piece in words; `marked` hears which object is pointed at or chosen. */
  constructor(room: Room, told: (piece: Piece) => string, marked: (id: string | null) => void) {
    this.#room = room;
    this.#marked = marked;
    this.#names = namesIn(room.objects);
    this.#pieces = pieces(room);
    this.#svg = s(
      "svg",
      { class: "room-plan large", viewBox: boxOf(room).join(" "), role: "listbox", "aria-label": `Plan of the room: ${room.objects.length} pieces of furniture` },
      shell(room),
      s("g", { role: "presentation" }, ...this.#pieces.values()),
      this.#graph(),
      this.#places(),
      this.#texts,
    );
    // What listens for the focus is a place for it in an SVG, so its frame listens.
    this.element = h("div", { class: "plan-frame" }, this.#svg);
    for (const piece of room.objects) {
      const said = { role: "option", tabindex: "-1", "aria-selected": "false", "aria-label": told(piece) };
      for (const [name, value] of Object.entries(said)) this.#pieces.get(piece.id)?.setAttribute(name, value);
    }
    this.#ordered[0]?.setAttribute("tabindex", "0");
    this.#svg.addEventListener("pointerover", (event) => event.pointerType === "mouse" && this.point(idAt(event)));
    this.#svg.addEventListener("pointerleave", () => this.point(null));
    this.#svg.addEventListener("click", (event) => this.choose(idAt(event)));
    this.element.addEventListener("focusin", (event) => this.point(idAt(event)));
    this.element.addEventListener("focusout", () => this.point(null));
    this.element.addEventListener("keydown", (event) => this.#press(event));
    this.#ended = keepUnits(this.#svg, (unit) => this.#name(unit));
  }

  /** Whether a layer is seen of all pieces, not only of the one that is pointed at. */
  show(layer: Layer, shown: boolean): void {
    this.#svg.classList.toggle(`no-${layer}`, !shown);
  }

  point(id: string | null): void {
    if (id === this.#pointed) return;
    this.#pointed = id;
    this.#mark();
  }

  /** Keep an object marked; the same once more, or none, lets it go. */
  choose(id: string | null): void {
    this.#chosen = id === this.#chosen ? null : id;
    for (const [name, piece] of this.#pieces) piece.setAttribute("aria-selected", String(name === this.#chosen));
    this.#mark();
  }

  get chosen(): string | null {
    return this.#chosen;
  }

  dispose(): void {
    this.#ended();
  }

  /** In the room's order, which is that of the list beside the plan. */
  get #ordered(): SVGGElement[] {
    return this.#room.objects.map(({ id }) => this.#pieces.get(id)).filter((piece) => piece !== undefined);
  }

  #mark(): void {
    const id = this.#pointed ?? this.#chosen;
    this.#svg.classList.toggle("marking", id !== null);
    const near = new Set([id]);
    for (const line of this.#svg.querySelectorAll<SVGElement>("[data-ends]")) {
      const ends = JSON.parse(line.dataset["ends"] ?? "[]") as string[];
      const touches = id !== null && ends.includes(id);
      line.classList.toggle("marked", touches);
      if (touches) for (const end of ends) near.add(end);
    }
    for (const element of this.#svg.querySelectorAll<SVGElement>("[data-object]")) {
      const name = element.dataset["object"] ?? "";
      element.classList.toggle("marked", name === id);
      element.classList.toggle("near", name !== id && near.has(name));
    }
    this.#marked(id);
  }

  #press(event: KeyboardEvent): void {
    const all = this.#ordered;
    const at = all.findIndex((piece) => piece.contains(event.target as Node));
    const steps: Readonly<Record<string, number>> = { ArrowRight: at + 1, ArrowDown: at + 1, ArrowLeft: at - 1, ArrowUp: at - 1, Home: 0, End: all.length - 1 };
    const next = all[((steps[event.key] ?? at) + all.length) % all.length];
    if (event.key in steps && next) {
      for (const piece of all) piece.setAttribute("tabindex", piece === next ? "0" : "-1");
      next.focus();
    } else if (event.key === "Enter" || event.key === " ") this.choose(idAt(event));
    else if (event.key === "Escape") this.choose(null);
    else return;
    event.preventDefault();
  }

  #graph(): SVGGElement {
    const { nodes, edges } = this.#room.graph;
    const centres = new Map(this.#room.objects.map((piece) => [piece.id, centreOf(piece)]));
    const lines = edges.flatMap(([a, b]) => {
      const ends = [nodes[a]!.object_id, nodes[b]!.object_id] as const;
      const [from, to] = [centres.get(ends[0]), centres.get(ends[1])];
      return from && to ? [s("line", { x1: from[0], y1: from[1], x2: to[0], y2: to[1], "data-ends": JSON.stringify(ends) })] : [];
    });
    const dots = nodes.flatMap(({ object_id, minor }) => {
      const at = centres.get(object_id);
      return at ? [s("circle", { cx: at[0], cy: at[1], class: minor ? "minor" : "", "data-object": object_id })] : [];
    });
    return s("g", { class: "plan-graph", "aria-hidden": "true" }, ...lines, ...dots);
  }

  /** Where a body can be; the first of an object and a deed is the best, the others are seen when the object is marked. */
  #places(): SVGGElement {
    const seen = new Set<string>();
    const drawn = this.#room.spots.map((spot) => {
      const key = `${spot.affordance} ${spot.object_id}`;
      const best = !seen.has(key);
      seen.add(key);
      return place(spot, best);
    });
    return s("g", { class: "places", "aria-hidden": "true" }, ...drawn);
  }

  #name(unit: number): void {
    const names = this.#room.objects.map((piece) => ({
      id: piece.id,
      words: this.#names.get(piece.id) ?? piece.id,
      at: centreOf(piece),
      // What hangs on walls and ceilings is named when it is pointed at.
      weight: isHanging(piece) ? 0 : piece.size[0] * piece.size[2],
    }));
    fill(this.#texts, ...placeNames(names, unit));
    this.#mark();
  }
}

function place({ object_id, affordance, point: [x, , z], standing, approach, usable }: Spot, best: boolean): SVGGElement {
  const [px, pz, sx, sz] = [x * CM, z * CM, standing[0] * CM, standing[1] * CM];
  const ahead = [sx + 16 * Math.sin(approach), sz + 16 * Math.cos(approach)];
  return s(
    "g",
    { class: `place ${affordance}${usable ? "" : " out"}${best ? " best" : ""}`, "data-object": object_id },
    s("line", { x1: px, y1: pz, x2: sx, y2: sz }),
    s("circle", { class: "on", cx: px, cy: pz }),
    s("line", { class: "ahead", x1: sx, y1: sz, x2: ahead[0], y2: ahead[1] }),
    s("circle", { class: "body", cx: sx, cy: sz }),
  );
}

function idAt(event: Event): string | null {
  return (event.target as Element).closest<SVGElement>(".piece")?.dataset["object"] ?? null;
}
