/** A story's film.usd among its files: a button that has it made and taken along, or says why it cannot be. */

import { ApiError, getUsd } from "./api";
import { fill, h, icon } from "./dom";
import { announce } from "./live";

const WORDS = "the same as USD, for engines and usdview";

/** An item of a list of files. A service without usd-core answers with the remedy, which is shown. */
export function usdItem(id: string, name: string): HTMLLIElement {
  const item = h("li", { class: "usd" });
  const words = h("span", { class: "hint" }, WORDS);
  const make = h("button", { type: "button", class: "plain", onclick: () => void take() }, icon("down"), `Make ${name}`);

  const take = async (): Promise<void> => {
    make.disabled = true;
    fill(item, make, words);
    try {
      const address = URL.createObjectURL(await getUsd(id));
      const link = h("a", { href: address, download: name }, icon("down"), name);
      fill(item, link, words);
      announce(`${name} is ready`);
      link.click();
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      make.disabled = false;
      item.append(h("p", { class: "wrong", role: "alert" }, error.detail || error.title));
    }
  };

  fill(item, make, words);
  return item;
}
