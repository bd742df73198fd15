/** A story's film.mp4 among its files: a button that has it made, how far it is, and then the file. */

import { ApiError, getFilm, makeFilm, mp4Url, stopFilm, type FilmJob } from "./api";
import { fill, h, icon } from "./dom";
import { announce } from "./live";

const LOOK_MS = 1000;
const WORDS = "the story filmed, with its title and its told words, for any player; slanted words are told and not seen";

/** An item of a list of files. It looks after itself, and stops when it is taken from the page. */
export function filmItem(id: string, name: string): HTMLLIElement {
  const item = h("li", { class: "filming" });
  const words = h("span", { class: "hint" }, WORDS);

  const show = (film: FilmJob | null): void => {
    if (film?.state === "succeeded") {
      const size = film.bytes === null ? "" : ` (${(film.bytes / 1e6).toFixed(1)} MB)`;
      fill(item, h("a", { href: mp4Url(id), download: name }, icon("down"), name), h("span", { class: "hint" }, `${WORDS}${size}`));
    } else if (film?.state === "queued" || film?.state === "running") {
      const done = Math.round(100 * film.progress);
      const bar = h("progress", { max: 100, value: done, "aria-label": "How much of the film is made" });
      const stop = h("button", { type: "button", class: "plain", onclick: () => void act(() => stopFilm(id).then(() => null)) }, "Stop");
      fill(item, h("span", { class: "row" }, bar, ` ${done} % `, stop), words);
    } else {
      const start = h("button", { type: "button", class: "plain", onclick: () => void begin() }, icon("down"), `Make ${name}`);
      const wrong = film?.state === "failed" ? h("p", { class: "wrong", role: "alert" }, film.error?.detail ?? "It could not be filmed.") : null;
      fill(item, start, words, wrong);
    }
  };

  const act = async (ask: () => Promise<FilmJob | null>): Promise<FilmJob | null> => {
    try {
      const film = await ask();
      show(film);
      return film;
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      item.append(h("p", { class: "wrong", role: "alert" }, error.detail || error.title));
      return null;
    }
  };

  const watch = async (film: FilmJob | null): Promise<void> => {
    let last = film;
    while (last && (last.state === "queued" || last.state === "running")) {
      await new Promise((later) => window.setTimeout(later, LOOK_MS));
      if (!item.isConnected) return;
      last = await act(() => getFilm(id));
    }
    if (film && film.state !== "succeeded" && last?.state === "succeeded") announce(`${name} is ready`);
  };

  const begin = async (): Promise<void> => watch(await act(() => makeFilm(id)));
  show(null);
  void act(() => getFilm(id)).then(watch);
  return item;
}
