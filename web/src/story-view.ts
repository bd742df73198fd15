/** One story on the page: film, text, script, report; kept up to date while it is being made. */

import { ApiError, cancelStory, deleteStory, getStory, type Story } from "./api";
import { isStill } from "./appearance";
import { fill, h } from "./dom";
import { showDownloads } from "./downloads";
import { follow } from "./events";
import { Film } from "./film";
import { confirmRemoval } from "./gallery";
import { announce } from "./live";
import { showMaking } from "./making";
import { NextSteps } from "./next-steps";
import { showOrigin } from "./origin";
import { marks } from "./outcomes";
import { showReport } from "./report";
import { ScriptList } from "./script-list";
import { Steps } from "./steps";
import { Telling } from "./telling";
import { capital, count } from "./words";

const AGAIN_MS = 2500;
/** Where the script stands beside the film, as in story.css. */
const WIDE = window.matchMedia("(min-width: 70rem)");

export class StoryView {
  readonly element = h("article", { class: "story" });
  readonly film: Film;
  /** Stories that play in this very home, so that the film can go on with them: its own takes, and what it is a take of. */
  readonly #near = new Set<string>();
  #handed = false;
  readonly id: string;
  readonly #steps: Steps;
  readonly #telling: Telling;
  readonly #script: ScriptList;
  readonly #title = h("h1", {}, "…");
  readonly #theme = h("p", { class: "theme" });
  readonly #derived = h("p", { class: "origin", hidden: true });
  readonly #next = new NextSteps(() => void this.#edit(), () => this.#toFiles());
  readonly #book = h("section", { class: "book", "aria-label": "The story and its script" });
  readonly #foot = h("div", { class: "row foot" });
  readonly #sections: { readonly script: HTMLElement; readonly report: HTMLElement; readonly making: HTMLElement; readonly files: HTMLElement };
  readonly #left: () => void;
  /** A theme that is longer than the heading has lines for is seen to go on, and can be scrolled by keys too. */
  readonly #lines = new ResizeObserver(() => {
    const cut = this.#theme.scrollHeight > this.#theme.clientHeight + 1;
    this.#theme.classList.toggle("cut", cut);
    this.#theme.tabIndex = cut ? 0 : -1;
  });
  #story: Story | null = null;
  /** What it is a take of, once that is fetched. */
  #origin: Story | null = null;
  #originAsked = false;
  #unfollow: (() => void) | null = null;
  #fetching = false;
  #again = false;
  #live = true;
  /** Whether the script is to be changed as soon as it is there. */
  #goesOn = false;

  /**
   * `left` is called when the story is no more; the film begins with the keyframe `from`, or at its beginning. Another
   * view may have handed its film over: then the script is still being changed.
   */
  constructor(id: string, left: () => void, from: number | null = null, before: StoryView | null = null) {
    this.id = id;
    this.#left = left;
    const seek = (keyframe: number): void => this.film.seekKeyframe(keyframe);
    this.#steps = new Steps(() => void this.#cancel());
    this.#telling = new Telling(seek);
    this.#script = new ScriptList(seek);
    const shown = (keyframe: number | null): void => {
      this.#telling.show(keyframe);
      this.#script.show(keyframe);
    };
    this.film = before?.film ?? new Film(id, shown, from);
    if (before) {
      this.film.retake(id, shown, from);
      this.#near.add(before.id);
      this.#goesOn = true;
    }
    const section = (name: string): HTMLElement => h("section", { class: name, hidden: true });
    this.#sections = { script: section("script"), report: section("report"), making: section("making"), files: section("downloads") };
    fill(this.#sections.script, h("h2", {}, "The script"), this.#script.element);
    this.#read();
    fill(
      this.element,
      h("header", { class: "title" }, this.#title, this.#theme),
      this.#steps.element,
      this.film.element,
      h("div", { class: "beside" }, this.#next.element, this.#derived, this.#book),
      h("div", { class: "backstage" }, this.#sections.report, this.#sections.making, h("div", { class: "column" }, this.#sections.files, this.#foot)),
    );
    this.#lines.observe(this.#theme);
    void this.refresh();
  }

  get story(): Story | null {
    return this.#story;
  }

  /** Fetch the story again; calls while one is under way become one more. */
  async refresh(): Promise<void> {
    this.#again = this.#fetching;
    if (this.#fetching) return;
    this.#fetching = true;
    try {
      this.#show(await getStory(this.id));
    } catch (error) {
      this.#explain(error);
    }
    this.#fetching = false;
    if (this.#again && this.#live) void this.refresh();
  }

  /** Whether the film can go on with that story as it stands on the stage; then it is no longer this view's. */
  handsOver(id: string): boolean {
    return (this.#handed = this.#near.has(id));
  }

  dispose(): void {
    this.#live = false;
    this.#unfollow?.();
    this.#lines.disconnect();
    if (!this.#handed) this.film.dispose();
  }

  #show(story: Story): void {
    if (!this.#live) return;
    const before = this.#story;
    this.#story = story;
    const making = story.state === "queued" || story.state === "running";
    this.#title.textContent = story.title ?? (story.kind === "motion" ? "A motion" : making ? "Being written …" : "No story this time");
    this.#theme.textContent = story.theme ?? "";
    document.title = `${story.title ?? "A story"} · SIMS stories`;
    this.element.classList.toggle("without-text", !story.text && !making);
    this.element.classList.toggle("alone", !story.text && !story.keyframes.length && !making);
    this.#steps.update(story);
    this.#telling.update(story);
    this.#script.update(story.keyframes, story.motion.fps, before !== null, marks(story));
    this.film.update(story);
    const seek = (keyframe: number): void => this.film.seekKeyframe(keyframe);
    void this.#showOrigin(story);
    this.#sections.script.hidden = story.keyframes.length === 0;
    this.#next.change.hidden = !story.home;
    if (this.#goesOn && story.home && !making) void this.#edit(false);
    if (!making || before?.stage !== story.stage) {
      this.#sections.report.hidden = !showReport(this.#sections.report, story, seek);
      this.#sections.making.hidden = !showMaking(this.#sections.making, story);
      this.#next.files.hidden = this.#sections.files.hidden = making || !showDownloads(this.#sections.files, story);
    }
    if (making && !this.#unfollow) this.#follow();
    if (!making) this.#close(story, before);
  }

  /** What a take derives from, and what of it is another. */
  async #showOrigin(story: Story): Promise<void> {
    showOrigin(this.#derived, story, this.#origin);
    if (!story.derived_from || this.#originAsked) return;
    this.#originAsked = true;
    try {
      this.#origin = await getStory(story.derived_from);
    } catch {
      return; // It is no more, or nobody answers: the line says what is known without it.
    }
    if (this.#story) showOrigin(this.#derived, this.#story, this.#origin);
  }

  /** The told story and its script beside the film. */
  #read(): void {
    fill(this.#book, this.#telling.element, this.#sections.script);
  }

  #toFiles(): void {
    this.#sections.files.scrollIntoView({ block: "start", behavior: isStill() ? "auto" : "smooth" });
    this.#sections.files.querySelector<HTMLElement>("button, a")?.focus({ preventScroll: true });
  }

  /** Beside the film the script can be changed; its code is fetched when it is first asked for. */
  async #edit(asked = true): Promise<void> {
    if (!this.#story) return;
    this.#goesOn = false;
    this.#next.change.disabled = true;
    try {
      const { ScriptEditor } = await import("./script-editor");
      const close = (): void => {
        this.element.classList.remove("editing");
        this.#read();
        this.#next.change.disabled = false;
        this.#next.change.focus();
      };
      const editor = await ScriptEditor.open(this.#story, (take, from, elsewhere) => this.#goOn(take.id, from, elsewhere), close);
      if (!this.#live) return;
      this.element.classList.add("editing");
      fill(this.#book, editor.element);
      if (!asked) return;
      this.film.player.pause();
      (WIDE.matches ? this.element : this.#book).scrollIntoView({ block: "start" });
      editor.focus();
    } catch (error) {
      this.#next.change.disabled = false;
      announce(error instanceof Error ? error.message : String(error));
    }
  }

  #goOn(id: string, from: number, elsewhere: boolean): void {
    if (!elsewhere) this.#near.add(id);
    location.hash = `#/stories/${id}?from=${from}`;
  }

  #follow(): void {
    this.#unfollow = follow(this.id, {
      stage: (stage, progress) => {
        this.#steps.show(stage, progress);
        void this.refresh();
      },
      progress: (stage, progress) => this.#steps.show(stage, progress),
      segment: (segment) => {
        this.film.reel.want(segment.end);
        void this.refresh();
      },
      ended: () => void this.refresh(),
      broken: (broken) => this.#steps.setBroken(broken),
    });
  }

  /** Say how it ended. */
  #close(story: Story, before: Story | null): void {
    this.#unfollow?.();
    if (this.#foot.childElementCount === 0) {
      fill(this.#foot, h("a", { href: "#/", class: "button plain" }, "Another story"), h("button", { type: "button", class: "plain", onclick: () => void this.#remove() }, "Remove this one"));
    }
    const watched = before !== null && before.state !== story.state;
    if (story.state === "succeeded") {
      if (watched) announce(`${story.title ?? "The motion"} is ready: ${count(story.keyframes.length, "moment")}`);
      return;
    }
    const [head, detail] =
      story.state === "cancelled"
        ? ["Stopped", story.motion.frames ? "What was made until then can be watched." : "It was stopped before anything could be seen."]
        : [story.error?.title ?? "It could not be made", capital((story.error?.detail ?? "The service gives no reason.").replace(/^theme: /, ""))];
    const note = h("div", { class: "outcome", role: "status" }, h("b", {}, head), h("p", {}, detail));
    if (story.motion.frames) this.element.querySelector(".title")?.append(...(this.element.querySelector(".title .outcome") ? [] : [note]));
    else this.film.notice(note, h("a", { href: "#/", class: "button primary" }, "Try another theme"));
  }

  #explain(error: unknown): void {
    if (!this.#live) return;
    if (!(error instanceof ApiError)) throw error;
    if (error.status === 401) return void window.dispatchEvent(new Event("sims-login"));
    if (error.passing) {
      this.#steps.setBroken(true);
      if (!this.#story) this.film.notice(h("div", { class: "outcome" }, h("b", {}, error.title), h("p", {}, error.detail)));
      window.setTimeout(() => this.#live && void this.refresh(), AGAIN_MS);
      return;
    }
    const gone = error.status === 404;
    this.element.classList.add("alone");
    this.#title.textContent = gone ? "No such story" : error.title;
    this.film.notice(h("div", { class: "outcome" }, h("p", {}, gone ? "It was removed, or the link to it is not whole." : error.detail)), h("a", { href: "#/", class: "button primary" }, "To the stories there are"));
  }

  async #cancel(): Promise<void> {
    this.#steps.setStopping();
    try {
      await cancelStory(this.id);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
    }
    void this.refresh();
  }

  async #remove(): Promise<void> {
    if (!(await confirmRemoval(this.#story?.title ?? "This story"))) return;
    try {
      await deleteStory(this.id);
      this.#left();
    } catch (error) {
      this.#foot.append(h("p", { class: "wrong", role: "alert" }, error instanceof Error ? error.message : String(error)));
    }
  }
}
