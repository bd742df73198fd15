/** A caption being acted before the page: its keyframes are posted as a motion, played, and thrown away when it is closed. */

import "./style/caption-player.css";
import { ApiError, deleteStory, getExample, getStory, newKey, postMotion } from "./api";
import type { CaptionWords } from "./captions";
import { fill, h, icon } from "./dom";
import { follow } from "./events";
import { Film } from "./film";
import { capital, SKILL_WORDS } from "./words";

/** Show it until it is closed; what had the focus has it again then. */
export function playCaption({ caption, skill }: CaptionWords): void {
  const before = document.activeElement;
  const status = h("p", { class: "hint", role: "status" }, "A room is being found, and the body set going …");
  const close = h("button", { type: "button", class: "quiet round", "aria-label": "Close", autofocus: true, onclick: () => dialog.close() }, icon("close"));
  const holder = h("div", {});
  const dialog = h("dialog", { class: "player", "aria-labelledby": "player-title" });
  fill(dialog, h("header", { class: "row spread" }, h("h2", { id: "player-title" }, `${capital(SKILL_WORDS[skill])}: ${caption}`), close), status, holder);
  const stop = new AbortController();
  const { signal } = stop;
  dialog.addEventListener("close", () => {
    stop.abort();
    dialog.remove();
    if (before instanceof HTMLElement) before.focus();
  });
  // Who goes elsewhere by the address or leaves the page has closed it.
  for (const gone of ["hashchange", "pagehide"]) window.addEventListener(gone, () => dialog.close(), { signal });
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) dialog.close();
  });
  document.body.append(dialog);
  dialog.showModal();
  play(caption, skill, holder, status, signal).catch((error: unknown) => {
    if (signal.aborted) return;
    if (error instanceof ApiError && error.status === 401) {
      dialog.close();
      window.dispatchEvent(new Event("sims-login"));
      return;
    }
    status.hidden = false;
    status.textContent = `It cannot be shown: ${error instanceof Error ? error.message : String(error)}`;
  });
}

async function play(caption: string, skill: CaptionWords["skill"], holder: HTMLElement, status: HTMLElement, signal: AbortSignal): Promise<void> {
  const example = await getExample(skill, caption, signal);
  // What was closed while it was being posted is thrown away all the same, so the posting itself is not cut off.
  const { id } = await postMotion(example, newKey());
  // Whoever still asks for it has an answer before it is gone.
  let asked: Promise<void> = Promise.resolve();
  const drop = (): void => {
    asked.catch(() => undefined).finally(() => deleteStory(id)).catch(() => undefined);
  };
  if (signal.aborted) {
    drop();
    return;
  }
  signal.addEventListener("abort", drop);
  const last = example.keyframes.length - 1;
  const film = new Film(id, () => undefined, last);
  signal.addEventListener("abort", () => film.dispose());
  fill(holder, film.element);
  const look = async (): Promise<void> => {
    const story = await getStory(id);
    if (signal.aborted) return;
    film.update(story);
    const own = story.keyframes[last];
    status.hidden = own?.end !== null && own?.end !== undefined;
    if (story.state === "failed") throw new Error(story.error?.detail ?? "the service gives no reason");
  };
  const refresh = (): Promise<void> => (asked = asked.catch(() => undefined).then(look));
  const told = (error: unknown): void => {
    if (signal.aborted) return;
    status.hidden = false;
    status.textContent = `It cannot be shown: ${error instanceof Error ? error.message : String(error)}`;
  };
  const again = (): void => void refresh().catch(told);
  const segment = ({ end }: { readonly end: number }): void => {
    film.reel.want(end);
    again();
  };
  const unfollow = follow(id, { stage: again, progress: () => undefined, segment, ended: again, broken: () => undefined });
  signal.addEventListener("abort", unfollow);
  await refresh();
}
