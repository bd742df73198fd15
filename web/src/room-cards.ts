/** Rooms as cards, page by page; a room's plan is fetched once its card is on the screen. */

import { h } from "./dom";
import { listing } from "./furniture-words";
import { ranked } from "./glyphs";
import { thumbnail } from "./plan";
import { getRoom, roomAddress, type Room, type RoomSummary } from "./room-api";
import { capital, plain } from "./words";

/** Plans that are fetched at the same time: the service looks every room over. */
const AT_ONCE = 3;

export class RoomCards {
  readonly element = h("ul", { class: "room-cards" });
  readonly #wanted = new Map<Element, string>();
  readonly #eye: IntersectionObserver;
  #fetching = 0;

  constructor() {
    this.#eye = new IntersectionObserver((seen) => this.#look(seen), { rootMargin: "120px" });
  }

  add(rooms: readonly RoomSummary[]): void {
    for (const room of rooms) {
      const frame = h("div", { class: "card-plan", "data-room": room.id });
      const facts = h("p", { class: "hint" }, `${capital(kinds(room))}, ${square(room.area)}${room.built_in ? "" : ", your own"}`);
      this.element.append(h("li", {}, frame, h("h3", {}, h("a", { href: roomAddress(room.id) }, room.id)), facts, h("p", { class: "card-furniture" }, capital(listing(ranked(room.furniture))) || "Empty")));
      this.#eye.observe(frame);
    }
  }

  clear(): void {
    this.#eye.disconnect();
    this.#wanted.clear();
    this.element.replaceChildren();
  }

  /** Put the keyboard on a card. */
  focus(place: number): void {
    this.element.children[place]?.querySelector("a")?.focus();
  }

  #look(seen: readonly IntersectionObserverEntry[]): void {
    for (const { target, isIntersecting } of seen) {
      if (isIntersecting) this.#wanted.set(target, (target as HTMLElement).dataset["room"] ?? "");
      else this.#wanted.delete(target);
    }
    this.#fetch();
  }

  #fetch(): void {
    for (const [frame, id] of this.#wanted) {
      if (this.#fetching === AT_ONCE) return;
      this.#wanted.delete(frame);
      this.#eye.unobserve(frame);
      this.#fetching++;
      void getRoom(id)
        .then((room: Room) => frame.append(thumbnail(room)))
        // A card without a picture still leads to its room.
        .catch(() => frame.classList.add("failed"))
        .finally(() => {
          this.#fetching--;
          this.#fetch();
        });
    }
  }
}

/** "12.6 m²" */
export const square = (area: number): string => `${area.toFixed(1)} m²`;

/** "bedroom and study" */
export const kinds = (room: Pick<RoomSummary, "room_type" | "tags">): string => [...new Set([room.room_type, ...room.tags])].map(plain).join(" and ");
