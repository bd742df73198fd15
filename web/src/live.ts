/** One polite voice for screen readers: what happens without being asked for. */

let region: HTMLElement | null = null;
let said = "";

/** Say a sentence; the same one is not said twice in a row. */
export function announce(sentence: string): void {
  region ??= document.querySelector<HTMLElement>("#live");
  if (!region || sentence === said) return;
  said = sentence;
  region.textContent = sentence;
}
