/** The theme box: what shall be played, by whom and where; what is wrong is said at the field it is about. */

import { ApiError, getCast, newKey, postStory, type NewStory, type Story } from "./api";
import { fill, h } from "./dom";
import { announce } from "./live";
import { capital } from "./words";

const LONGEST = 2000;
const SUGGESTIONS: readonly (readonly [string, string])[] = [
  ["A lazy weekend", "A person relaxes at home at the weekend, drinks something cold and reads books."],
  ["The phone call", "A person is happy at first, but hears on the phone that the job interview went wrong and becomes very sad."],
  ["Picnic tomorrow", "A person is dressing up and feels excited about the picnic tomorrow."],
  ["A lottery win", "A person sits on the chair, finds out about winning the lottery, runs excitedly around the room and relaxes on the sofa."],
  ["The lost ring", "A person searches for a ring under the bed, finds it, is excited, drinks wine to celebrate and rests on the sofa, drunk."],
  ["An old photograph", "A person looks at an old photograph in the living room, becomes sad, drinks a bottle of wine and falls asleep on the sofa."],
];
const ROOMS: readonly (readonly [string, string])[] = [
  ["bedroom", "bedroom"],
  ["living_room", "living room"],
  ["dining_room", "dining room"],
  ["study", "study"],
];

export class ThemeForm {
  readonly element = h("form", { class: "theme-form", novalidate: true });
  readonly #started: (story: Story) => void;
  readonly #theme = h("textarea", { id: "theme", name: "theme", rows: 3, maxlength: LONGEST, required: true, "aria-describedby": "theme-hint theme-error", placeholder: "Somebody comes home tired, reads a book on the sofa and falls asleep.", enterkeyhint: "go" });
  readonly #submit = h("button", { type: "submit", class: "primary" }, "Raise the curtain");
  readonly #problem = h("div", { class: "problem", role: "alert", hidden: true });
  /** Pointer in the request to the control that it is about. */
  readonly #fields = new Map<string, HTMLElement>();
  #layouts: readonly string[];
  #key = newKey();
  #timer = 0;

  /** `layouts` are the ids of rooms to play in; without any they are found for the story. */
  constructor(started: (story: Story) => void, layouts: readonly string[] = []) {
    this.#started = started;
    this.#layouts = layouts;
    const chips = SUGGESTIONS.map(([name, theme]) => h("button", { type: "button", class: "chip", title: theme, onclick: () => this.#suggest(theme) }, name));
    fill(
      this.element,
      h("h1", {}, h("label", { for: "theme" }, "What shall be played?")),
      h("div", { class: "theme-box" }, this.#theme, this.#error("/theme", this.#theme)),
      h("div", { class: "chips", role: "group", "aria-label": "Suggestions" }, ...chips),
      this.#stage(),
      this.#options(),
      this.#problem,
      h("div", { class: "row send" }, this.#submit, h("span", { class: "hint", id: "theme-hint" }, "In English, a few sentences. Enter starts, Shift + Enter is a new line.")),
    );
    this.element.addEventListener("submit", (event) => {
      event.preventDefault();
      void this.#send();
    });
    this.#theme.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" || event.shiftKey || event.isComposing) return;
      event.preventDefault();
      this.element.requestSubmit();
    });
    this.element.addEventListener("input", () => (this.#key = newKey()));
  }

  focus(): void {
    this.#theme.focus();
  }

  #suggest(theme: string): void {
    this.#theme.value = theme;
    this.#key = newKey();
    this.#clear();
    this.#theme.focus();
  }

  /** The rooms that were chosen from the library, and a way to do without them. */
  #stage(): HTMLElement | null {
    if (!this.#layouts.length) return null;
    const names = this.#layouts.flatMap((id, place) => [place ? " and " : null, h("a", { href: `#/rooms/${encodeURI(id)}` }, id)]);
    const drop = h("button", { type: "button", class: "plain small" }, "Play anywhere");
    const stage = h("div", { class: "stage-chosen", tabindex: -1 }, h("p", {}, "Played in ", ...names, "."), drop, this.#error("/layouts"));
    drop.addEventListener("click", () => {
      this.#layouts = [];
      this.#key = newKey();
      stage.remove();
      for (const choice of this.element.querySelectorAll<HTMLFieldSetElement>("fieldset:disabled")) choice.disabled = false;
      this.#theme.focus();
    });
    this.#fields.set("/layouts", stage);
    return stage;
  }

  #options(): HTMLElement {
    const name = h("input", { id: "name", name: "name", value: "Sam", maxlength: 40, autocomplete: "off" });
    const pronouns = choices("pronouns", [["she", "she"], ["he", "he"], ["they", "they"]], "radio", "they");
    const height = h("input", { id: "height", name: "height", type: "number", value: "1.70", min: 1.1, max: 2.2, step: 0.01, inputmode: "decimal" });
    const member = h("select", { id: "member", name: "member" }, h("option", { value: "" }, "as the theme says"));
    void getCast().then((members) => member.append(...members.map((one) => h("option", { value: one.name }, `${capital(one.name)}, ${one.age}, ${one.pronouns}`))), () => undefined);
    const rooms = choices("rooms", ROOMS, "checkbox");
    const seed = h("input", { id: "seed", name: "seed", type: "number", value: 0, min: 0, step: 1, inputmode: "numeric" });
    const method = choices("method", [["auto", "beat by beat"], ["matching", "from short scripts"], ["direct", "at one go"]], "radio", "auto");
    return h(
      "details",
      { class: "options" },
      h("summary", {}, "Who plays, and where"),
      h(
        "div",
        { class: "fields" },
        this.#group("Played by", member, "/character/member"),
        this.#field("Name", name, "/character/name", "Left at Sam, they: named as your theme names its person."),
        this.#group("Pronouns", pronouns, "/character/pronouns"),
        this.#field("Height in metres", height, "/character/height"),
        this.#group("Rooms", rooms, "/rooms", "None chosen: whatever suits the story.", this.#layouts.length > 0),
        this.#group("Planned", method, "/method"),
        this.#field("Seed", seed, "/seed", "Another number, another staging of the same theme."),
      ),
    );
  }

  #field(name: string, control: HTMLInputElement, pointer: string, hint?: string): HTMLElement {
    return h("div", { class: "field" }, h("label", { for: control.id }, name), control, hint ? h("p", { class: "hint" }, hint) : null, this.#error(pointer, control));
  }

  #group(name: string, control: HTMLElement, pointer: string, hint?: string, disabled = false): HTMLElement {
    return h("fieldset", { class: "field", disabled }, h("legend", {}, name), control, hint ? h("p", { class: "hint" }, hint) : null, this.#error(pointer, control));
  }

  /** An empty place for what is wrong with a control. */
  #error(pointer: string, control?: HTMLElement): HTMLElement {
    const id = `${pointer.slice(1).replaceAll("/", "-")}-error`;
    if (control) this.#fields.set(pointer, control);
    if (control && !control.hasAttribute("aria-describedby")) control.setAttribute("aria-describedby", id);
    return h("p", { class: "wrong", id, hidden: true });
  }

  #request(): NewStory {
    const data = new FormData(this.element);
    const text = (name: string): string => {
      const value = data.get(name);
      return typeof value === "string" ? value : "";
    };
    const rooms = data.getAll("rooms").map(String);
    return {
      theme: text("theme").trim(),
      seed: Number(text("seed") || 0),
      method: text("method"),
      ...(rooms.length ? { rooms } : {}),
      ...(this.#layouts.length ? { layouts: this.#layouts } : {}),
      character: { name: text("name").trim() || "Sam", pronouns: text("pronouns"), height: Number(text("height") || 1.7), ...(text("member") ? { member: text("member") } : {}) },
    };
  }

  async #send(): Promise<void> {
    this.#clear();
    const request = this.#request();
    if (!request.theme) return void this.#say("/theme", "Write what shall happen, in a sentence or two.");
    this.#submit.disabled = true;
    this.#submit.textContent = "One moment …";
    try {
      const story = await postStory(request, this.#key);
      this.#key = newKey();
      this.#started(story);
    } catch (error) {
      this.#explain(error);
    }
    this.#submit.disabled = false;
    this.#submit.textContent = "Raise the curtain";
  }

  #explain(error: unknown): void {
    if (!(error instanceof ApiError)) throw error;
    let placed = false;
    for (const { pointer, detail } of error.errors) placed = this.#say(pointer, detail) || placed;
    if (!placed) this.#announce(error);
  }

  /** Show an error at its field; false if there is no such field. */
  #say(pointer: string, detail: string): boolean {
    const found = [...this.#fields.keys()].find((known) => pointer === known || pointer.startsWith(`${known}/`));
    const control = found && this.#fields.get(found);
    const place = found && this.element.querySelector<HTMLElement>(`#${found.slice(1).replaceAll("/", "-")}-error`);
    if (!control || !place) return false;
    place.hidden = false;
    place.textContent = sentence(detail);
    control.setAttribute("aria-invalid", "true");
    const folded = control.closest("details");
    if (folded) folded.open = true;
    const focus = control.matches("input, textarea") ? control : control.querySelector("input");
    focus?.focus();
    announce(sentence(detail));
    return true;
  }

  #announce(error: ApiError): void {
    const again = h("button", { type: "button", class: "plain", onclick: () => void this.#send() }, "Try again");
    fill(this.#problem, h("p", {}, h("b", {}, sentence(error.title)), " ", error.detail && sentence(error.detail)), again);
    this.#problem.hidden = false;
    if (error.retryAfter === null) return;
    let left = Math.ceil(error.retryAfter);
    const tick = (): void => {
      again.disabled = left > 0;
      again.textContent = left > 0 ? `Try again in ${left} s` : "Try again";
      if (left-- > 0) this.#timer = window.setTimeout(tick, 1000);
    };
    tick();
  }

  #clear(): void {
    window.clearTimeout(this.#timer);
    this.#problem.hidden = true;
    for (const place of this.element.querySelectorAll<HTMLElement>(".wrong")) place.hidden = true;
    for (const control of this.#fields.values()) control.removeAttribute("aria-invalid");
  }
}

function choices(name: string, items: readonly (readonly [string, string])[], type: "radio" | "checkbox", chosen?: string): HTMLElement {
  return h(
    "div",
    { class: "choices" },
    ...items.map(([value, words]) => h("label", { class: "choice" }, h("input", { type, name, value, checked: value === chosen }), h("span", {}, words))),
  );
}

function sentence(text: string): string {
  const trimmed = capital(text.trim().replace(/^Input should/, "This should"));
  return /[.!?…]$/.test(trimmed) ? trimmed : `${trimmed}.`;
}
