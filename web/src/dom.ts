/** Making elements, in one line each. */

type Child = Node | string | null | undefined | false;
type Attributes = Record<string, string | number | boolean | null | undefined | ((event: never) => void)>;

/** An element with attributes (`onclick` and the like listen; true is an empty attribute, false and null are none) and children. */
export function h<K extends keyof HTMLElementTagNameMap>(tag: K, attributes: Attributes = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  dress(element, attributes);
  element.append(...present(children));
  return element;
}

/** The same for SVG. */
export function s<K extends keyof SVGElementTagNameMap>(tag: K, attributes: Attributes = {}, ...children: Child[]): SVGElementTagNameMap[K] {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  dress(element, attributes);
  element.append(...present(children));
  return element;
}

function dress(element: Element, attributes: Attributes): void {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name.slice(2), value as (event: Event) => void);
    else if (value !== null && value !== undefined && value !== false) element.setAttribute(name, value === true ? "" : String(value));
  }
}

const present = (children: Child[]): (Node | string)[] => children.filter((child) => child !== null && child !== undefined && child !== false);

/** The element of that id in index.html, which holds all that is made here. */
export function framed(id: string): HTMLElement {
  const element = document.getElementById(id);
  if (!element) throw new Error(`index.html has no element #${id}`);
  return element;
}

/** Replace what an element holds. */
export function fill(element: Element, ...children: Child[]): void {
  element.replaceChildren(...present(children));
}

const ICONS = {
  play: "M8 5.5v13l10.5-6.5z",
  pause: "M8 5.5h3v13H8zM13.5 5.5h3v13h-3z",
  back: "M17.5 6v12L9 12zM6.5 6h2v12h-2z",
  next: "M6.5 6v12L15 12zM15.500 6h2v12h-2z",
  again: "M12 5a7 7 0 1 0 6.600 4.700l-1.900.7A5 5 0 1 1 12 7v3l4.500-4L12 2z",
  full: "M5 5h6v2H7v4H5zM19 19h-6v-2h4v-4h2z",
  map: "M5 5h14v14H5zm2 2v4h4V7zm6 0v10h4V7zm-6 6v4h4v-4z",
  help: "M12 3a9 9 0 1 0 0 18 9 9 0 0 0 0-18m0 2a7 7 0 1 1 0 14 7 7 0 0 1 0-14m-1 10h2v2h-2zm1-8c-2 0-3.300 1.200-3.500 3l1.900.3c.1-.8.700-1.400 1.600-1.400.9 0 1.500.5 1.500 1.300 0 .7-.4 1.100-1.100 1.600-.9.7-1.400 1.200-1.400 2.200h2c0-.5.3-.8 1-1.300.9-.7 1.500-1.400 1.500-2.600 0-1.900-1.500-3.100-3.500-3.100",
  sun: "M12 8a4 4 0 1 0 0 8 4 4 0 0 0 0-8M11 2h2v3.500h-2zM11 18.500h2V22h-2zM2 11h3.500v2H2zM18.500 11H22v2h-3.500zM4.200 5.600l1.400-1.400 2.500 2.500-1.400 1.400zM15.900 17.300l1.400-1.400 2.500 2.500-1.400 1.400zM4.200 18.400l2.500-2.500 1.400 1.400-2.500 2.500zM15.900 6.700l2.500-2.500 1.400 1.400-2.500 2.500z",
  moon: "M13.500 3.200A9 9 0 1 0 20.800 14 7.500 7.500 0 0 1 13.500 3.200",
  auto: "M12 3a9 9 0 1 0 0 18 9 9 0 0 0 0-18m0 2v14a7 7 0 0 1 0-14",
  close: "M6.400 5 12 10.600 17.600 5 19 6.400 13.400 12l5.600 5.600-1.400 1.400-5.600-5.600L6.400 19 5 17.600 10.600 12 5 6.400z",
  link: "M10.600 13.400a4 4 0 0 1 0-5.700l2.800-2.800a4 4 0 0 1 5.700 5.700l-1.700 1.700-1.400-1.400 1.700-1.700a2 2 0 0 0-2.900-2.900L12 9.100a2 2 0 0 0 0 2.900zM13.400 10.600a4 4 0 0 1 0 5.700l-2.800 2.800a4 4 0 0 1-5.700-5.700l1.700-1.700 1.400 1.400-1.700 1.700a2 2 0 0 0 2.900 2.900l2.800-2.800a2 2 0 0 0 0-2.900z",
  trash: "M9 4h6v2h4v2H5V6h4zM6.500 9.500h11L16.700 20H7.300z",
  up: "M12 7l6 6-1.400 1.400L12 9.800l-4.600 4.600L6 13z",
  downward: "M12 16l-6-6 1.400-1.400 4.600 4.600 4.600-4.600L18 10z",
  plus: "M11 5h2v6h6v2h-6v6h-2v-6H5v-2h6z",
  down: "M11 4h2v8.200l3-3 1.400 1.400L12 16l-5.400-5.400L8 9.200l3 3zM5 18h14v2H5z",
} as const;

export type Icon = keyof typeof ICONS;

/** A small picture; it says nothing to a screen reader, so its button must. */
export function icon(name: Icon): SVGSVGElement {
  return s("svg", { viewBox: "0 0 24 24", class: "icon", "aria-hidden": "true", focusable: "false" }, s("path", { d: ICONS[name], "fill-rule": "evenodd" }));
}
