/** The library of rooms: looked through by type, searched by furniture, and added to. */

import { ApiError } from "./api";
import { fill, h } from "./dom";
import { announce } from "./live";
import { legend, matchView, roomsOf } from "./match-view";
import { readQuery } from "./query";
import { findRooms, getRoom, listRooms, ROOM_TYPES, type Query } from "./room-api";
import { RoomCards } from "./room-cards";
import { Upload } from "./upload";
import { capital, count, plain } from "./words";

const EXAMPLES: readonly string[] = ["sofa:sit + coffee table, tv stand, lamp", "double bed:lie + 2 nightstands, wardrobe, desk", "dining table + 6 dining chairs:sit, wine cabinet"];

export class Library {
  readonly element = h("div", { class: "library" });
  /** How far the page was scrolled when it was left. */
  scroll = 0;
  /** What is shown, as the page's address. */
  address = "";
  readonly #types = h("div", { class: "segment types", role: "group", "aria-label": "Room type" });
  readonly #words = h("input", { id: "furniture", name: "furniture", type: "search", maxlength: 600, placeholder: EXAMPLES[0]!, autocomplete: "off", "aria-describedby": "furniture-hint furniture-error" });
  readonly #most = h("select", { id: "most", name: "most" }, ...[1, 2, 3, 4].map((most) => h("option", { value: most }, most === 1 ? "one room" : `a home of up to ${most}`)));
  readonly #wrong = h("p", { class: "wrong", id: "furniture-error", role: "alert", hidden: true });
  readonly #cards = new RoomCards();
  readonly #note = h("p", { class: "hint", hidden: true });
  readonly #more = h("button", { type: "button", class: "plain", hidden: true, onclick: () => void this.#load() }, "More rooms");
  readonly #found = h("section", { class: "found-rooms", "aria-label": "Rooms found", hidden: true });
  readonly #all = h("section", { "aria-label": "All rooms" });
  #cursor: string | null = null;
  #type = "";
  /** End what is being fetched when something else is wanted: the page of rooms, the search. */
  #asked = new AbortController();
  #sought = new AbortController();

  constructor() {
    for (const type of ["", ...ROOM_TYPES]) {
      const choice = h("input", { type: "radio", name: "type", value: type, checked: type === "", onchange: () => this.#choose(type) });
      this.#types.append(h("label", {}, choice, h("span", {}, type ? plain(type) : "all")));
    }
    const form = h(
      "form",
      { class: "find", role: "search", "aria-label": "Rooms by furniture" },
      h("div", { class: "field grow" }, h("label", { for: "furniture" }, "Find rooms by furniture"), this.#words, this.#wrong),
      h("div", { class: "field" }, h("label", { for: "most" }, "In"), this.#most),
      h("button", { type: "submit", class: "primary" }, "Find"),
      h("p", { class: "hint", id: "furniture-hint" }, "Commas between pieces, a plus for two that stand side by side, and after a colon what a body does there: sit, lie or touch. For instance ", ...this.#examples()),
    );
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.#save();
      // Somebody who pressed Find wants to see what came of it.
      void this.#search().then(() => this.#found.hidden || this.#found.scrollIntoView({ block: "start" }));
    });
    fill(this.#all, this.#cards.element, this.#note, this.#more);
    fill(this.element, h("header", { class: "library-head" }, h("h1", {}, "Rooms"), h("p", { class: "hint" }, "Where stories can be played. Look through them, look for what a story needs, or bring your own.")), form, new Upload(() => this.#refresh()).element, this.#types, this.#found, this.#all);
  }

  /** Show what an address asks for: `type` of room, `with` furniture, `most` rooms; what is shown already stays as it is. */
  open(address: string): void {
    document.title = "Rooms · SIMS stories";
    if (this.address === address) return;
    this.address = address;
    const asked = new URLSearchParams(address.split("?")[1]);
    const type = asked.get("type") ?? "";
    const most = asked.get("most") ?? "1";
    this.#type = ROOM_TYPES.includes(type) ? type : "";
    for (const choice of this.#types.querySelectorAll("input")) choice.checked = choice.value === this.#type;
    this.#words.value = asked.get("with") ?? "";
    this.#most.value = /^[1-4]$/.test(most) ? most : "1";
    this.#refresh();
  }

  #examples(): Node[] {
    return EXAMPLES.flatMap((words, place) => {
      const use = (): void => {
        this.#words.value = words;
        this.#words.form?.requestSubmit();
      };
      return [...(place ? [document.createTextNode(place + 1 < EXAMPLES.length ? ", " : " or ")] : []), h("button", { type: "button", class: "link", onclick: use }, words)];
    });
  }

  #choose(type: string): void {
    this.#type = type;
    this.#save();
    this.#refresh();
  }

  /** Keep in the address what is shown, so that it can be sent to somebody. */
  #save(): void {
    const kept = new URLSearchParams({ ...(this.#type ? { type: this.#type } : {}), ...(this.#words.value.trim() ? { with: this.#words.value.trim(), most: this.#most.value } : {}) });
    this.address = `#/rooms${kept.size ? `?${kept}` : ""}`;
    history.replaceState(null, "", this.address);
  }

  #refresh(): void {
    this.#asked.abort();
    this.#asked = new AbortController();
    this.#cards.clear();
    this.#cursor = null;
    this.#more.hidden = true;
    void this.#load();
    void this.#search();
  }

  async #load(): Promise<void> {
    const { signal } = this.#asked;
    this.#more.disabled = true;
    const before = this.#cards.element.children.length;
    try {
      const page = await listRooms(this.#type, this.#cursor, signal);
      if (signal.aborted) return;
      this.#cursor = page.next;
      this.#cards.add(page.items);
      this.#note.hidden = before + page.items.length > 0;
      this.#note.textContent = "There is no room of this type.";
      this.#more.textContent = "More rooms";
      this.#more.hidden = page.next === null;
      // The button that was pressed may be gone; what it brought is there.
      if (before) this.#cards.focus(before);
    } catch (error) {
      if (!failed(error)) return;
      this.address = "";
      this.#note.hidden = false;
      this.#note.textContent = `Rooms cannot be shown: ${sentence(error)}`;
      this.#more.hidden = false;
      this.#more.textContent = "Try again";
    }
    this.#more.disabled = false;
  }

  async #search(): Promise<void> {
    this.#sought.abort();
    this.#sought = new AbortController();
    const { signal } = this.#sought;
    this.#wrong.hidden = true;
    this.#words.removeAttribute("aria-invalid");
    if (!this.#words.value.trim()) {
      this.#found.hidden = true;
      return;
    }
    try {
      const query = readQuery(this.#words.value);
      this.#found.setAttribute("aria-busy", "true");
      const matches = await findRooms(query, this.#type ? [this.#type] : [], Number(this.#most.value), signal);
      const rooms = await Promise.all(matches.map((match) => Promise.all(roomsOf(match).map((id) => getRoom(id, signal)))));
      if (signal.aborted) return;
      this.#show(query, matches.map((match, place) => matchView(query, match, rooms[place]!, place + 1)));
    } catch (error) {
      if (!failed(error)) return;
      this.#found.hidden = true;
      this.#wrong.hidden = false;
      this.#wrong.textContent = sentence(error);
      this.#words.setAttribute("aria-invalid", "true");
      this.#words.focus();
    }
    this.#found.removeAttribute("aria-busy");
  }

  #show(query: Query, matches: readonly HTMLElement[]): void {
    const clear = h("button", { type: "button", class: "plain small", onclick: () => this.#clear() }, "Clear");
    const head = h("h2", {}, `The ${count(matches.length, Number(this.#most.value) > 1 ? "home" : "room")} that ${matches.length === 1 ? "comes" : "come"} nearest`);
    fill(this.#found, h("div", { class: "row spread" }, head, clear), legend(), h("ol", { class: "matches" }, ...matches));
    this.#found.hidden = false;
    announce(`${capital(count(matches.length, "answer"))} for ${count(query.nodes.length, "piece")} of furniture`);
  }

  #clear(): void {
    this.#words.value = "";
    this.#save();
    this.#found.hidden = true;
    this.#words.focus();
  }
}

/** Whether there is something to tell: what was called off is none, and without a key one is asked for. */
function failed(error: unknown): boolean {
  if (error instanceof DOMException && error.name === "AbortError") return false;
  if (error instanceof ApiError && error.status === 401) window.dispatchEvent(new Event("sims-login"));
  return true;
}

function sentence(error: unknown): string {
  if (error instanceof ApiError && error.errors[0]) return `${capital(error.errors[0].detail)} (${error.errors[0].pointer})`;
  return error instanceof Error ? error.message : String(error);
}
