/** What the body can do, as a list in words under each skill, and searched; fetched when it is first opened. */

import "./style/captions.css";
import { json, type Skill } from "./api";
import { fill, h, icon } from "./dom";
import { announce } from "./live";
import { capital, count, SKILL_WORDS } from "./words";

/** A caption, the deeds that are seen in it, and other words for it. */
export interface CaptionWords {
  readonly caption: string;
  readonly skill: Skill;
  readonly shows: readonly string[];
  readonly others: readonly string[];
}

/** Those that have, or mean, every one of some words, or how it begins. */
export function found(all: readonly CaptionWords[], asked: string): CaptionWords[] {
  const starts = wordsOf(asked);
  return all.filter(({ caption, skill, shows, others }) => {
    const words = [caption, skill, SKILL_WORDS[skill], ...shows, ...others].flatMap(wordsOf);
    return starts.every((start) => words.some((word) => word.startsWith(start)));
  });
}

/** Have it acted before the page; the player is fetched when it is first asked for. */
function see(one: CaptionWords): void {
  import("./caption-player").then(({ playCaption }) => playCaption(one)).catch((error: unknown) => announce(error instanceof Error ? error.message : String(error)));
}

const wordsOf = (text: string): string[] => text.toLowerCase().match(/[\p{L}\p{N}]+/gu) ?? [];

export const captions = {
  /** Show them; `asked` is what is looked for. */
  show(main: HTMLElement, asked: string): void {
    document.title = "Captions · SIMS stories";
    const words = h("input", { id: "caption-words", type: "search", maxlength: 200, value: asked, placeholder: "laugh, phone, both hands", autocomplete: "off" });
    const list = h("div", { class: "captions", "aria-busy": "true" });
    fill(
      main,
      h(
        "div",
        { class: "library" },
        h("header", { class: "library-head" }, h("h1", {}, "Captions"), h("p", { class: "hint" }, "What the body knows to do, under each skill: how a script says it, and the deeds of a theme that are seen in it. Other words for them are found too. Choose one to see it acted.")),
        h("div", { class: "field", role: "search" }, h("label", { for: words.id }, "Find captions"), words),
        list,
      ),
    );
    json<{ items: CaptionWords[] }>("v1/captions")
      .then(({ items }) => {
        const draw = (): number => {
          const some = found(items, words.value);
          fill(list, ...lists(some));
          return some.length;
        };
        list.removeAttribute("aria-busy");
        draw();
        words.addEventListener("input", () => {
          announce(capital(count(draw(), "caption")));
          const query = words.value.trim();
          history.replaceState(null, "", `#/captions${query ? `?${new URLSearchParams({ with: query })}` : ""}`);
        });
      })
      .catch((error: unknown) => fill(list, h("p", { class: "wrong", role: "alert" }, `Captions cannot be shown: ${error instanceof Error ? error.message : String(error)}`)));
  },
};

/** A section a skill; a sentence where nothing is found. */
function lists(some: readonly CaptionWords[]): HTMLElement[] {
  const skills = [...new Set(some.map(({ skill }) => skill))];
  if (!skills.length) return [h("p", { class: "hint" }, "No caption has these words, or means them.")];
  return skills.map((skill) => {
    const of = some.filter((one) => one.skill === skill);
    return h("section", { "aria-label": SKILL_WORDS[skill] }, h("h2", {}, `${capital(SKILL_WORDS[skill])} `, h("small", {}, `${skill} · ${of.length}`)), h("dl", {}, ...of.map(entry)));
  });
}

function entry(one: CaptionWords): HTMLElement {
  const { caption, shows, others } = one;
  const seen = shows.length ? shows.join(", ") : null;
  return h("div", {}, h("dt", {}, h("button", { type: "button", class: "link see", title: "See it acted", onclick: () => see(one) }, icon("play"), caption)), seen ? h("dd", {}, `seen as: ${seen}`) : null, others[0] ? h("dd", { class: "hint" }, `also: ${others[0]}`) : null);
}
