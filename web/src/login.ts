/** The door, where the service asks for a key. */

import { ApiError, logIn } from "./api";
import { fill, h } from "./dom";

/** A form that asks for the key and calls `opened` when it is right. */
export function loginForm(opened: () => void): HTMLElement {
  const key = h("input", { id: "key", name: "key", type: "password", required: true, autocomplete: "current-password", "aria-describedby": "key-error" });
  const wrong = h("p", { class: "wrong", id: "key-error", role: "alert", hidden: true });
  const enter = h("button", { type: "submit", class: "primary" }, "Come in");
  const form = h("form", { class: "login arch-panel" });
  fill(
    form,
    h("h1", {}, "A key, please"),
    h("p", { class: "hint" }, "This stage is not open to everybody. Whoever runs it can give you a key; it is kept as a cookie until you leave."),
    h("div", { class: "field" }, h("label", { for: "key" }, "Key"), key, wrong),
    enter,
  );
  const tryKey = async (): Promise<void> => {
    enter.disabled = true;
    try {
      await logIn(key.value);
      opened();
    } catch (error) {
      wrong.hidden = false;
      wrong.textContent = error instanceof ApiError && !error.passing ? "This key does not fit." : error instanceof Error ? error.message : String(error);
      key.select();
    }
    enter.disabled = false;
  };
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    void tryKey();
  });
  queueMicrotask(() => key.focus());
  return form;
}
