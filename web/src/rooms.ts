/** The library of rooms and each of them: a part of the page of its own, fetched when it is first opened. */

import "./style/rooms.css";
import { fill } from "./dom";
import { Library } from "./library";
import { RoomView } from "./room-view";

/** Kept while the page lives, so that who comes back finds what was left. */
let library: Library | null = null;

export const rooms = {
  /** Show a room, or all of them where none is named; the answer ends that. */
  show(main: HTMLElement, id: string, query: string): () => void {
    if (id) {
      const view = new RoomView(id, library?.address || "#/rooms", () => {
        library = null;
        location.hash = "#/rooms";
      });
      fill(main, view.element);
      return () => view.dispose();
    }
    const shown = (library ??= new Library());
    fill(main, shown.element);
    shown.open(query ? `#/rooms?${query}` : "#/rooms");
    window.scrollTo(0, shown.scroll);
    return () => void (shown.scroll = window.scrollY);
  },
};
