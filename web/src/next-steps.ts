/** What one does next with a story: change its script, take it along, show it to somebody. */

import { h, icon } from "./dom";
import { announce } from "./live";

const COPIED_MS = 2500;

export class NextSteps {
  readonly element: HTMLElement;
  /** Shown once there is a script that can be changed, and files to take. */
  readonly change: HTMLButtonElement;
  readonly files: HTMLButtonElement;

  /** `change` opens the script as a form, `files` leads to what can be taken along. */
  constructor(change: () => void, files: () => void) {
    this.change = step("Change the script", change);
    this.files = step("Download", files);
    [this.change.hidden, this.files.hidden] = [true, true];
    this.element = h("div", { class: "row next", role: "group", "aria-label": "What next" }, this.change, this.files, window.isSecureContext ? copying() : null);
  }
}

const step = (words: string, act: () => void): HTMLButtonElement => h("button", { type: "button", class: "plain small", onclick: act }, words);

/** The address of what is shown goes to the clipboard, which only pages that are served securely may write. */
function copying(): HTMLButtonElement {
  const said = h("span", { hidden: true });
  const copy = async (): Promise<void> => {
    said.textContent = await navigator.clipboard.writeText(location.href).then(() => "Link copied", () => "Not allowed");
    said.hidden = false;
    announce(said.textContent);
    window.setTimeout(() => (said.hidden = true), COPIED_MS);
  };
  return h("button", { type: "button", class: "plain small", "aria-label": "Copy link", title: "Copy link", onclick: () => void copy() }, icon("link"), said);
}
