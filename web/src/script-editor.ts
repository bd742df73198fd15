/** The script as a form: every moment's words and object can be changed, moments dropped, moved and put in, and played. */

import { ApiError, getHome, newKey, postTake, type Skill, type Story } from "./api";
import { fill, h, icon, type Icon } from "./dom";
import { EMOTIONS } from "./emotions";
import { roomNames } from "./furniture-words";
import { announce } from "./live";
import { allRooms } from "./room-api";
import { added, changed, draftOf, dropped, firstChange, moved, placed, roomsNamed, sent, type Draft, type Script } from "./script-draft";
import { Upload } from "./upload";
import { Vocabulary, type Thing } from "./vocabulary";
import { capital, SKILL_WORDS } from "./words";

const SKILLS: readonly Skill[] = ["loco", "sitdown", "standup", "getup", "liedown", "touch"];
const FLOOR = "";

/** What is wanted: the script, and how it is staged. */
interface Wanted {
  readonly script: Script;
  readonly seed: string;
  readonly backend: string;
  /** Rooms of the library to play in, as they are written; empty: the home that it has. */
  readonly rooms: string;
}

/** What comes of it: the take, its first moment that is another, and whether it plays in another home. */
type Played = (take: Story, from: number, elsewhere: boolean) => void;

export class ScriptEditor {
  readonly element: HTMLElement = h("div", { class: "editor", role: "group", "aria-label": "Change the script" });
  readonly #story: Story;
  readonly #words: Vocabulary;
  readonly #things: readonly Thing[];
  readonly #before: Wanted;
  readonly #past: Wanted[] = [];
  readonly #played: Played;
  readonly #left: () => void;
  readonly #list = h("ol", { class: "drafts" });
  readonly #problem = h("p", { class: "wrong", role: "alert", hidden: true });
  readonly #undo = h("button", { type: "button", class: "plain", onclick: () => this.#back() }, "Undo");
  readonly #play = h("button", { type: "button", class: "primary", onclick: () => void this.#send() }, "Play this");
  readonly #seed: HTMLInputElement;
  readonly #backend: HTMLSelectElement;
  readonly #mover = h("p", { id: "take-mover", class: "fine" });
  readonly #rooms: HTMLInputElement;
  readonly #known = h("datalist", { id: "take-rooms" });
  readonly #offers = new Map<Skill, HTMLElement>();
  #now: Wanted;
  #key = newKey();

  /** `played` is told of the take that was begun; `left` when all stays as it is. */
  static async open(story: Story, played: Played, left: () => void): Promise<ScriptEditor> {
    const [words, home] = await Promise.all([Vocabulary.load(), getHome(story.id)]);
    return new ScriptEditor(story, words, words.things(home, roomNames(story)), played, left);
  }

  private constructor(story: Story, words: Vocabulary, things: readonly Thing[], played: Played, left: () => void) {
    [this.#story, this.#words, this.#things, this.#played, this.#left] = [story, words, things, played, left];
    this.#now = this.#before = { script: draftOf(story.keyframes), seed: String(story.seed), backend: story.backend, rooms: "" };
    this.#seed = h("input", { id: "take-seed", type: "number", min: 0, step: 1, inputmode: "numeric", oninput: () => (this.#play.disabled = this.#from({ ...this.#now, seed: this.#seed.value }) === null), onchange: () => this.#stage({ seed: this.#seed.value }) });
    this.#backend = h("select", { id: "take-backend", "aria-describedby": this.#mover.id, onchange: () => this.#stage({ backend: this.#backend.value }) }, ...words.backends.map((one) => h("option", { value: one.backend, title: one.about }, one.about.split(/ ?[(:]/, 1)[0])));
    this.#rooms = h("input", { id: "take-home", class: "home", list: "take-rooms", placeholder: "its own home", autocomplete: "off", spellcheck: false, onfocus: () => void this.#name(), oninput: () => (this.#play.disabled = false), onchange: () => this.#stage({ rooms: this.#rooms.value.trim() }) });
    const upload = new Upload((ids) => this.#stage({ rooms: ids.join(", ") }));
    const leave = h("button", { type: "button", class: "plain small", onclick: () => this.#left() }, "Close");
    fill(
      this.element,
      h("div", { class: "row editor-head" }, h("h2", {}, "Change the script"), leave),
      this.#list,
      h("div", { class: "staging" }, staged("Seed", this.#seed), staged("Moved by", this.#backend), staged("Played in", this.#rooms, this.#known)),
      this.#mover,
      upload.element,
      h("div", { class: "editor-foot" }, this.#problem, h("div", { class: "row" }, this.#play, this.#undo)),
    );
    this.element.addEventListener("keydown", (event) => {
      if (event.key !== "z" || !(event.ctrlKey || event.metaKey) || event.shiftKey || event.target === this.#seed || event.target === this.#rooms || isBeingTyped(event.target)) return;
      event.preventDefault();
      this.#back();
    });
    this.#show();
  }

  focus(): void {
    this.#list.querySelector("select")?.focus({ preventScroll: true });
  }

  /** Offer the rooms there are. */
  async #name(): Promise<void> {
    if (this.#known.childElementCount) return;
    fill(this.#known, ...(await allRooms()).map((id) => h("option", { value: id })));
  }

  /** Another script, said aloud; the place that has the focus keeps it. */
  #do(script: Script, said: string, focus?: string): void {
    if (firstChange(script, this.#now.script) === null) return;
    this.#past.push(this.#now);
    this.#now = { ...this.#now, script };
    this.#show(focus);
    announce(said);
  }

  #stage(change: Partial<Wanted>): void {
    this.#past.push(this.#now);
    this.#now = { ...this.#now, ...change };
    this.#show();
  }

  #back(): void {
    const before = this.#past.pop();
    // What was changed before this take began is in the story that it is a take of.
    if (!before && this.#story.derived_from) location.hash = `#/stories/${this.#story.derived_from}`;
    if (!before) return;
    this.#now = before;
    this.#show();
    announce("Undone");
    if (!this.#past.length && document.activeElement === document.body) this.#play.focus();
  }

  #show(focus?: string): void {
    const held = focus ?? (document.activeElement instanceof HTMLElement && this.#list.contains(document.activeElement) ? document.activeElement.dataset["at"] : undefined);
    fill(this.#list, ...this.#now.script.map((draft, at) => this.#row(draft, at)));
    this.#state();
    if (held) this.#at(held)?.focus();
  }

  /** What stands below the rows, and which buttons do something. */
  #state(): void {
    this.#seed.value = this.#now.seed;
    this.#backend.value = this.#now.backend;
    const { about = "" } = this.#words.backends.find((one) => one.backend === this.#backend.value) ?? {};
    this.#mover.textContent = about && `Moved by ${about}.`;
    this.#rooms.value = this.#now.rooms;
    const untouched = this.#from() === null;
    this.#undo.disabled = this.#past.length === 0 && !this.#story.derived_from;
    this.#play.disabled = untouched;
    this.#problem.hidden = true;
    this.#key = newKey();
  }

  /** Another caption: the rows stay, since whoever leaves the field is about to use another control. */
  #recaption(at: number, caption: string): void {
    const script = changed(this.#now.script, at, { caption });
    if (firstChange(script, this.#now.script) === null) return;
    this.#past.push(this.#now);
    this.#now = { ...this.#now, script };
    const draft = script[at];
    if (draft) this.#list.children[at]?.classList.toggle("other", this.#isOther(draft));
    this.#state();
    announce(`Moment ${at + 1}: ${caption}`);
  }

  /** Whether a moment is not as it was. */
  #isOther(draft: Draft): boolean {
    return firstChange([draft], this.#before.script.filter(({ index }) => index === draft.index)) !== null;
  }

  /** A control by its place and name, "3 caption". */
  #at(name: string): HTMLElement | null {
    const found = this.#list.querySelector<HTMLElement>(`[data-at="${name}"]`);
    return found?.matches(":disabled") ? (found.closest("li")?.querySelector("select") ?? null) : found;
  }

  #row(draft: Draft, at: number): HTMLElement {
    const { script } = this.#now;
    const name = `Moment ${at + 1}`;
    const choose = (field: string, words: string, options: readonly (readonly [string, string])[], value: string, act: (value: string) => void): HTMLElement => {
      const known = options.some(([one]) => one === value) ? options : [[value, value] as const, ...options];
      const select: HTMLSelectElement = h("select", { "data-at": `${at} ${field}`, "data-field": field, "aria-label": `${name}: ${words}`, onchange: () => act(select.value) }, ...known.map(([one, told]) => h("option", { value: one, selected: one === value }, told)));
      return select;
    };
    const button = (field: string, words: string, picture: Icon, disabled: boolean, act: () => void): HTMLElement =>
      h("button", { type: "button", class: "quiet round", "data-at": `${at} ${field}`, "aria-label": `${name}: ${words}`, title: capital(words), disabled, onclick: act }, icon(picture));
    return h(
      "li",
      { class: this.#isOther(draft) ? "draft other" : "draft", "data-emotion": this.#mood(draft) },
      h("span", { class: "cue-number" }, String(at + 1)),
      h(
        "div",
        { class: "draft-fields" },
        choose("skill", "what is done", SKILLS.map((skill) => [skill, capital(SKILL_WORDS[skill])] as const), draft.skill, (value) => this.#reskill(at, value as Skill)),
        choose("object_id", "where", this.#places(draft), draft.object_id ?? FLOOR, (value) => this.#do(placed(this.#now.script, at, value || null), `${name}: ${this.#nameOf(value)}`)),
        choose("emotion", "in which mood", EMOTIONS.map((emotion) => [emotion, emotion] as const), draft.emotion, (emotion) => this.#do(changed(this.#now.script, at, { emotion }), `${name}: ${emotion}`)),
        captionField(`${name}: how`, at, draft, this.#captionsOf(draft.skill).id, () => (this.#play.disabled = false), (caption) => this.#recaption(at, caption)),
        h(
          "div",
          { class: "draft-moves" },
          button("up", "earlier", "up", at === 0, () => this.#do(moved(this.#now.script, at, -1), `${name} is now moment ${at}`, `${at - 1} up`)),
          button("down", "later", "downward", at === script.length - 1, () => this.#do(moved(this.#now.script, at, 1), `${name} is now moment ${at + 2}`, `${at + 1} down`)),
          button("add", "put another behind it", "plus", false, () => this.#do(added(this.#now.script, at, this.#fresh(draft)), `Moment ${at + 2} is new`, `${at + 1} skill`)),
          button("drop", "leave it out", "trash", script.length === 1, () => this.#do(dropped(this.#now.script, at), `${name} is left out`, `${Math.min(at, script.length - 2)} drop`)),
        ),
      ),
      h("p", { class: "wrong", hidden: true }),
    );
  }

  /** The captions of a skill to choose from, made once and looked through by typing. */
  #captionsOf(skill: Skill): HTMLElement {
    const made = this.#offers.get(skill) ?? h("datalist", { id: `captions-${skill}` }, ...this.#words.captions(skill).map((caption) => h("option", { value: caption })));
    if (!this.#offers.has(skill)) this.element.append(made);
    this.#offers.set(skill, made);
    return made;
  }

  /** What its emotion means, where it is in words of its own. */
  #mood({ index, emotion }: Draft): string {
    const before = this.#story.keyframes.find((keyframe) => keyframe.index === index);
    return before?.emotion === emotion ? before.mood : emotion;
  }

  /** A walk about, in the mood of the moment before. */
  #fresh(behind: Draft): Draft {
    return { index: null, skill: "loco", emotion: behind.emotion, caption: this.#words.usual("loco"), furniture: "floor", object_id: null };
  }

  /** Something else is done: as usual, and where that can be. */
  #reskill(at: number, skill: Skill): void {
    const { script } = this.#now;
    const draft = script[at];
    if (!draft) return;
    const fits = this.#places({ ...draft, skill }).map(([id]) => id);
    const object = fits.includes(draft.object_id ?? FLOOR) ? draft.object_id : fits.find(Boolean) ?? null;
    const next = changed(script, at, { skill, caption: this.#words.usual(skill) });
    this.#do(object === draft.object_id ? next : placed(next, at, object), `Moment ${at + 1}: ${SKILL_WORDS[skill]}`);
  }

  /** Where a moment may be: the objects that serve for what is done, and the floor for all but touching. */
  #places(draft: Draft): (readonly [string, string])[] {
    const needs = this.#words.needs(draft.skill);
    const serve = this.#things.filter(({ id, affords, near }) => id === draft.object_id || (needs === null ? near : affords.includes(needs)));
    const several = new Set(this.#things.map(({ room }) => room)).size > 1;
    const named = serve.map(({ id, name, room }) => [id, several ? `${name}, ${room}` : name] as const);
    return needs === "touch" ? named : [[FLOOR, "the floor"], ...named];
  }

  #nameOf(id: string): string {
    return this.#things.find((thing) => thing.id === id)?.name ?? "the floor";
  }

  /** The first moment that is another; 0 where the staging is; null where nothing is. */
  #from(wanted: Wanted = this.#now): number | null {
    const staged = wanted.seed !== this.#before.seed || wanted.backend !== this.#before.backend || wanted.rooms !== "";
    return staged ? 0 : firstChange(wanted.script, this.#before.script);
  }

  async #send(): Promise<void> {
    const from = this.#from();
    if (from === null) return;
    this.#play.disabled = true;
    try {
      const { script, seed, backend } = this.#now;
      const layouts = roomsNamed(this.#now.rooms);
      const keyframes = script.map((draft) => sent(draft, layouts.length > 0, (id) => this.#nameOf(id)));
      const take = await postTake(this.#story.id, { keyframes, seed: Number(seed || 0), backend, ...(layouts.length ? { layouts } : {}) }, this.#key);
      this.#played(take, Math.min(from, script.length - 1), layouts.length > 0);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      this.#explain(error);
    }
    this.#play.disabled = false;
  }

  /** What is wrong is said at its field, with what would be right. */
  #explain(error: ApiError): void {
    let first: HTMLElement | null = null;
    const left: string[] = [];
    this.#rooms.removeAttribute("aria-invalid");
    for (const { pointer, detail } of error.errors) {
      if (pointer.startsWith("/layouts")) {
        this.#rooms.setAttribute("aria-invalid", "true");
        first ??= this.#rooms;
      }
      const [, at, field] = /^\/keyframes\/(\d+)\/(\w+)$/.exec(pointer) ?? [];
      const row = at === undefined ? undefined : this.#list.children[Number(at)];
      const control = row?.querySelector<HTMLElement>(`[data-field="${field === "furniture" ? "object_id" : field}"]`) ?? row?.querySelector("select");
      const place = row?.querySelector<HTMLElement>(".wrong");
      if (!control || !place) {
        left.push(detail);
        continue;
      }
      place.id = `draft-${at}-wrong`;
      place.hidden = false;
      place.textContent = `${place.textContent ? `${place.textContent} ` : ""}${capital(detail)}.`;
      control.setAttribute("aria-invalid", "true");
      control.setAttribute("aria-describedby", place.id);
      first ??= control;
    }
    if (!error.errors.length || left.length) {
      this.#problem.hidden = false;
      this.#problem.textContent = left.length ? left.map(capital).join(". ") : capital(error.detail || error.title);
    }
    first?.focus();
    // What is wrong stands under the field, where a long script may have its edge.
    first?.closest("li")?.scrollIntoView({ block: "nearest" });
    announce(error.detail);
  }
}

/**
 * A caption, looked for by typing some of it: what is listed holds what is typed, and all of them are listed before that.
 * It is taken on Enter, on leaving, or when it is picked from the list; `typed` is told of every letter before that.
 */
function captionField(label: string, at: number, draft: Draft, list: string, typed: () => void, act: (caption: string) => void): HTMLInputElement {
  let { caption } = draft;
  const take = (): void => {
    if (!field.value || field.value === caption) return;
    caption = field.dataset["had"] = field.title = field.value;
    act(caption);
  };
  // A list beside a field holds only what is like its words: an empty one shows all, what it had stands behind.
  const clear = (): void => {
    if (field.value !== caption) return;
    field.placeholder = caption;
    field.value = "";
  };
  const field: HTMLInputElement = h("input", {
    "data-at": `${at} caption`, "data-field": "caption", "data-had": caption, "aria-label": label, list, value: caption, title: caption, autocomplete: "off", spellcheck: false, maxlength: 200,
    onfocus: () => field.select(),
    onmousedown: clear,
    onkeydown: (event: KeyboardEvent) => {
      if (event.key === "ArrowDown") clear();
      if (event.key === "Escape") field.value = caption;
    },
    onblur: () => (field.value ||= caption),
    onchange: take,
    // Picked from the list: other than letters that are typed.
    oninput: (event: Event) => {
      if (!(event instanceof InputEvent) || event.inputType === "insertReplacementText") take();
      else typed();
    },
  });
  return field;
}

/** Whether letters of a caption are being typed, which the browser takes back by itself. */
const isBeingTyped = (target: EventTarget | null): boolean => target instanceof HTMLInputElement && target.dataset["had"] !== undefined && target.value !== target.dataset["had"];

/** What a take is made with, and its name beside it. */
function staged(name: string, control: HTMLElement, ...more: HTMLElement[]): HTMLElement {
  return h("div", { class: "staged" }, h("label", { for: control.id }, name), control, ...more);
}
