/** A room of one's own: a file and its format go to the service, and what it made of them is told. */

import "./style/upload.css";
import { ApiError } from "./api";
import { fill, h } from "./dom";
import { listing } from "./furniture-words";
import { announce } from "./live";
import { postRooms, ROOM_TYPES, roomAddress, type Imported, type Room } from "./room-api";
import { capital, count, plain } from "./words";

const FORMATS: readonly (readonly [string, string])[] = [
  ["native", "a room in our own JSON"],
  ["3d-front", "a 3D-FRONT house"],
  ["procthor", "ProcTHOR houses"],
  ["virtualhome", "a VirtualHome graph"],
  ["glb", "a GLB scene"],
  ["obj", "an OBJ scene"],
];
/** What the service takes, bytes. */
const LARGEST: Readonly<Record<string, number>> = { native: 4 << 20 };
const LARGEST_OTHER = 32 << 20;
const LONGEST_NAME = 120;
/** How much of a file is read to tell its format. */
const GLANCE = 1 << 16;

export class Upload {
  readonly element: HTMLDetailsElement;
  readonly #added: (ids: readonly string[]) => void;
  readonly #file = h("input", { id: "scene", name: "scene", type: "file", required: true, accept: ".json,.jsonl,.gz,.glb,.obj" });
  readonly #format = h("select", { id: "format", name: "format" }, ...FORMATS.map(([value, words]) => h("option", { value }, words)));
  readonly #axes: HTMLElement;
  readonly #send = h("button", { type: "submit", class: "primary" }, "Bring it in");
  readonly #answer = h("div", { class: "import-answer", role: "status" });
  readonly #form: HTMLFormElement;

  /** `added` is told which rooms are new in the library. */
  constructor(added: (ids: readonly string[]) => void) {
    this.#added = added;
    const choose = (name: string, words: string, options: readonly (readonly [string, string])[]): HTMLElement =>
      h("div", { class: "field" }, h("label", { for: `scene-${name}` }, words), h("select", { id: `scene-${name}`, name }, ...options.map(([value, said]) => h("option", { value }, said))));
    this.#axes = h(
      "div",
      { class: "fields axes" },
      choose("up", "Up is", [["y", "y"], ["z", "z"]]),
      choose("front", "Fronts look to", [["+z", "+z"], ["-z", "−z"], ["+x", "+x"], ["-x", "−x"]]),
      choose("unit", "Lengths are in", [["1", "metres"], ["0.01", "centimetres"], ["0.001", "millimetres"], ["0.0254", "inches"], ["0.3048", "feet"]]),
      choose("room", "The room is a", [["", "say nothing"], ...ROOM_TYPES.map((type) => [type, plain(type)] as const)]),
    );
    this.#form = h(
      "form",
      { class: "upload" },
      h("div", { class: "fields" }, h("div", { class: "field" }, h("label", { for: "scene" }, "File"), this.#file), h("div", { class: "field" }, h("label", { for: "format" }, "It is"), this.#format)),
      this.#axes,
      h("div", { class: "row" }, this.#send, h("span", { class: "hint" }, "It stays with this service. Up to 32 MB, our own format up to 4 MB.")),
    );
    this.element = h("details", { class: "options bring" }, h("summary", {}, "Bring a room of your own"), this.#form, this.#answer);
    this.#format.addEventListener("change", () => this.#show());
    this.#file.addEventListener("change", () => void this.#guess());
    this.#form.addEventListener("submit", (event) => {
      event.preventDefault();
      void this.#post();
    });
    this.#show();
  }

  #show(): void {
    this.#axes.hidden = this.#format.value !== "glb" && this.#format.value !== "obj";
  }

  /** Choose the format that a file most likely has. */
  async #guess(): Promise<void> {
    const file = this.#file.files?.[0];
    fill(this.#answer);
    if (!file) return;
    this.#format.value = formatOf(file.name, await file.slice(0, GLANCE).text());
    this.#show();
  }

  async #post(): Promise<void> {
    const file = this.#file.files?.[0];
    const format = this.#format.value;
    const most = LARGEST[format] ?? LARGEST_OTHER;
    if (!file) return;
    if (file.size > most) {
      this.#fail("The file is too large", [`It has ${Math.ceil(file.size / (1 << 20))} MB; of this format ${most >> 20} MB are taken.`]);
      return;
    }
    const said = this.#axes.hidden ? [] : [...new FormData(this.#form)].filter(([name, value]) => ["up", "front", "unit", "room"].includes(name) && value !== "");
    this.#send.disabled = true;
    this.#send.textContent = "Being read …";
    try {
      const name = format === "native" ? {} : { name: file.name.slice(0, LONGEST_NAME) || "scene" };
      const answer = await postRooms(file, format, { ...name, ...(Object.fromEntries(said) as Record<string, string>) });
      fill(this.#answer, ...("items" in answer ? report(answer) : welcome(answer)));
      announce("It is in the library");
      this.#added("items" in answer ? answer.items.map(({ id }) => id) : [answer.id]);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      if (error.status === 401) window.dispatchEvent(new Event("sims-login"));
      this.#fail(error.passing ? error.title : "It was not taken in", [
        ...(error.errors.length ? error.errors.map(({ pointer, detail }) => (pointer ? `${pointer}: ${detail}` : detail)) : [error.detail]),
        ...(error.status === 409 && !this.#axes.hidden ? ["Give the file another name: its room is called by it."] : []),
      ]);
    }
    this.#send.disabled = false;
    this.#send.textContent = "Bring it in";
    this.#answer.scrollIntoView({ block: "nearest" });
  }

  #fail(title: string, details: readonly string[]): void {
    fill(this.#answer, h("div", { class: "problem", role: "alert" }, h("div", {}, h("p", {}, h("b", {}, capital(title))), h("ul", { class: "lines" }, ...details.map((detail) => h("li", {}, detail))))));
  }
}

/** The format that a file has by its name and its first letters. */
export function formatOf(name: string, start: string): string {
  if (/\.glb$/i.test(name) || start.startsWith("glTF")) return "glb";
  if (/\.obj$/i.test(name)) return "obj";
  if (start.includes('"floor_polygon"')) return "native";
  if (/"(?:class_name|nodes)"/.test(start)) return "virtualhome";
  if (/"(?:furniture|jid|uid)"/.test(start)) return "3d-front";
  return /"(?:assetId|roomSpec|proceduralParameters|doors)"/.test(start) || /\.jsonl/i.test(name) ? "procthor" : "native";
}

function welcome(room: Room): HTMLElement[] {
  return [
    h("p", {}, h("b", {}, h("a", { href: roomAddress(room.id) }, room.id)), ` is in the library: ${count(room.objects.length, "piece")} of furniture.`),
    ...(room.problems.length ? [problems("What is wrong with it", room.problems)] : []),
  ];
}

function report({ items, problems: wrong, report: { rooms, objects, dropped, estimated } }: Imported): HTMLElement[] {
  const pieces = Object.values(objects).reduce((sum, number) => sum + number, 0);
  const left = dropped.map(({ why, count: times, examples }) => `${times}: ${why}${examples.length ? ` (${examples.join(", ")})` : ""}`);
  const guessed = Object.entries(estimated).map(([what, times]) => `${what}: ${times}`);
  return [
    h("p", {}, h("b", {}, `${capital(count(rooms, "room"))} came in`), `, with ${count(pieces, "piece")} of furniture${pieces ? `: ${listing(objects)}` : ""}.`),
    h("ul", { class: "lines" }, ...items.map(({ id }) => h("li", {}, h("a", { href: roomAddress(id) }, id), wrong[id]?.length ? `: ${count(wrong[id].length, "problem")}` : null))),
    ...(left.length ? [problems("What was left out", left)] : []),
    ...(guessed.length ? [problems("What was guessed", guessed)] : []),
  ];
}

const problems = (title: string, lines: readonly string[]): HTMLElement => h("div", {}, h("h3", {}, title), h("ul", { class: "lines" }, ...lines.map((line) => h("li", {}, line))));
