/** The stories there are, newest first, page by page. */

import { ApiError, deleteStory, listStories, type Summary } from "./api";
import { confirm } from "./dialog";
import { fill, h, icon } from "./dom";
import { announce } from "./live";
import { clock } from "./timing";
import { STAGE_WORDS } from "./words";

export class Gallery {
  readonly element = h("section", { class: "gallery", "aria-labelledby": "gallery-title" });
  readonly #list = h("ul", { class: "bill" });
  readonly #more = h("button", { type: "button", class: "plain", hidden: true, onclick: () => void this.load() }, "More stories");
  readonly #note = h("p", { class: "hint", hidden: true });
  #cursor: string | null = null;

  constructor() {
    fill(this.element, h("h2", { id: "gallery-title" }, "Played before"), this.#list, this.#note, this.#more);
    this.element.hidden = true;
  }

  /** Fetch the next page and show it. */
  async load(): Promise<void> {
    this.#more.disabled = true;
    try {
      const page = await listStories(this.#cursor);
      this.#cursor = page.next;
      this.#list.append(...page.items.map((item) => this.#row(item)));
      this.#more.hidden = page.next === null;
      this.element.hidden = this.#list.children.length === 0;
      this.#note.hidden = true;
    } catch (error) {
      if (error instanceof ApiError && error.status === 401) throw error;
      this.element.hidden = false;
      this.#note.hidden = false;
      this.#note.textContent = `Earlier stories cannot be shown: ${error instanceof Error ? error.message : String(error)}`;
      this.#more.hidden = false;
      this.#more.textContent = "Try again";
    }
    this.#more.disabled = false;
  }

  #row(item: Summary): HTMLElement {
    const title = item.title ?? (item.kind === "motion" ? "A motion" : (item.theme ?? "A story"));
    const row = h(
      "li",
      {},
      h(
        "a",
        { href: `#/stories/${item.id}` },
        h("b", {}, title),
        item.title && item.theme ? h("span", { class: "bill-theme" }, item.theme) : null,
        h("span", { class: "bill-facts" }, h("time", { datetime: item.created }, when(item.created)), ...facts(item)),
      ),
      h("button", { type: "button", class: "quiet round", "aria-label": `Remove “${title}”`, title: "Remove", onclick: () => void this.#remove(item, title, row) }, icon("trash")),
    );
    return row;
  }

  async #remove(item: Summary, title: string, row: HTMLElement): Promise<void> {
    if (!(await confirmRemoval(title))) return;
    const next = row.nextElementSibling ?? row.previousElementSibling;
    try {
      await deleteStory(item.id);
    } catch (error) {
      this.#note.hidden = false;
      this.#note.textContent = `“${title}” is still there: ${error instanceof Error ? error.message : String(error)}`;
      return;
    }
    row.remove();
    announce(`“${title}” is removed`);
    next?.querySelector("a")?.focus();
    this.element.hidden = this.#list.children.length === 0 && this.#more.hidden;
  }
}

/** Ask whether a story shall be removed for good. */
export function confirmRemoval(title: string): Promise<boolean> {
  return confirm("Remove this story?", `“${title}” and its film will be gone for good.`, "Remove it");
}

function facts(item: Summary): (HTMLElement | null)[] {
  const ended = item.state === "succeeded";
  return [
    item.duration && ended ? h("span", {}, clock(item.duration)) : null,
    ended ? null : h("span", { class: `state ${item.state}` }, stateWords(item)),
  ];
}

function stateWords(item: Summary): string {
  if (item.state === "running" && item.stage) return `${STAGE_WORDS[item.stage]}, ${Math.round(100 * item.progress)} %`;
  return { queued: "waiting its turn", running: "being made", failed: "could not be made", cancelled: "stopped", succeeded: "" }[item.state];
}

function when(iso: string): string {
  const date = new Date(iso);
  if (Number.isNaN(date.getTime())) return "";
  const today = date.toDateString() === new Date().toDateString();
  const format: Intl.DateTimeFormatOptions = today ? { hour: "2-digit", minute: "2-digit" } : { day: "numeric", month: "short", year: "numeric" };
  return new Intl.DateTimeFormat("en-GB", format).format(date);
}
