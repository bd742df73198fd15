/** Light or dark: as the system says, or as chosen here; and whether things should move. */

import { fill, h, icon, type Icon } from "./dom";

type Choice = "auto" | "light" | "dark";

const KEY = "sims-appearance";
const CHOICES: readonly Choice[] = ["auto", "light", "dark"];
const LOOKS: Readonly<Record<Choice, { words: string; icon: Icon }>> = {
  auto: { words: "as the system", icon: "auto" },
  light: { words: "light", icon: "sun" },
  dark: { words: "dark", icon: "moon" },
};

const listeners = new Set<() => void>();
const systemDark = window.matchMedia("(prefers-color-scheme: dark)");
const systemStill = window.matchMedia("(prefers-reduced-motion: reduce)");

function stored(): Choice {
  try {
    const value = localStorage.getItem(KEY) as Choice | null;
    return value && CHOICES.includes(value) ? value : "auto";
  } catch {
    return "auto"; // Where storage is forbidden the choice lasts as long as the page.
  }
}

let choice: Choice = "auto";

function apply(next: Choice): void {
  choice = next;
  if (next === "auto") delete document.documentElement.dataset["look"];
  else document.documentElement.dataset["look"] = next;
  known.clear();
  for (const listener of listeners) listener();
}

export const isDark = (): boolean => (choice === "auto" ? systemDark.matches : choice === "dark");

/** Whether the system asks for little movement. */
export const isStill = (): boolean => systemStill.matches;

/** Be told when colours change; the answer ends that. */
export function onAppearance(listener: () => void): () => void {
  listeners.add(listener);
  return () => listeners.delete(listener);
}

const known = new Map<string, string>();

/** The value of a colour variable of the style sheet now, as rgb(). */
export function color(name: string): string {
  let value = known.get(name);
  if (value === undefined) {
    // A variable's own value may be light-dark(); an element's colour is what came out of it.
    const probe = document.createElement("i");
    probe.style.color = `var(${name})`;
    document.body.append(probe);
    value = getComputedStyle(probe).color;
    probe.remove();
    known.set(name, value);
  }
  return value;
}

/** Read the choice that was made before, and the button that changes it. */
export function appearanceButton(): HTMLButtonElement {
  const button = h("button", { type: "button", class: "quiet round" });
  const show = (): void => {
    const look = LOOKS[choice];
    button.setAttribute("aria-label", `Appearance: ${look.words}. Change it`);
    button.title = `Appearance: ${look.words}`;
    fill(button, icon(look.icon));
  };
  button.addEventListener("click", () => {
    const next = CHOICES[(CHOICES.indexOf(choice) + 1) % CHOICES.length]!;
    try {
      localStorage.setItem(KEY, next);
    } catch {
      // Forbidden storage: see above.
    }
    apply(next);
    show();
  });
  systemDark.addEventListener("change", () => apply(choice));
  apply(stored());
  show();
  return button;
}
