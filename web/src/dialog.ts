/** Questions and explanations in front of the page. */

import { fill, h } from "./dom";

/** Ask before something that cannot be undone; true if it was agreed to. */
export function confirm(question: string, detail: string, agree: string): Promise<boolean> {
  const yes = h("button", { type: "submit", value: "yes", class: "danger" }, agree);
  const no = h("button", { type: "submit", value: "no", class: "plain", autofocus: true }, "Keep it");
  const dialog = open(question, h("form", { method: "dialog" }, h("p", {}, detail), h("div", { class: "row end" }, no, yes)));
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => resolve(dialog.returnValue === "yes"), { once: true });
  });
}

/** Show content under a heading until it is closed. */
export function show(title: string, content: Node): void {
  const close = h("button", { type: "submit", value: "", class: "plain", autofocus: true }, "Close");
  open(title, h("form", { method: "dialog" }, content, h("div", { class: "row end" }, close)));
}

function open(title: string, content: Node): HTMLDialogElement {
  const dialog = h("dialog", { "aria-labelledby": "dialog-title" });
  fill(dialog, h("h2", { id: "dialog-title" }, title), content);
  dialog.addEventListener("close", () => dialog.remove());
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) dialog.close("");
  });
  document.body.append(dialog);
  dialog.showModal();
  return dialog;
}
