/** A furniture graph as a small picture: one ring a room, lines between what is used together. */

import type { FurnitureGraph } from "./api";
import { s } from "./dom";
import { plain } from "./words";

const RADIUS = 62;
const WIDTH = 300;
const HEIGHT = 210;

/** An SVG with a name for those who do not see it. */
export function drawGraph(graph: FurnitureGraph): SVGSVGElement {
  const rooms = [...new Set(graph.nodes.map((node) => node.room))];
  const places: [number, number][] = [];
  const names: SVGElement[] = [];
  for (const [column, room] of rooms.entries()) {
    const members = graph.nodes.flatMap((node, index) => (node.room === room ? [index] : []));
    const middle: [number, number] = [column * WIDTH + WIDTH / 2, HEIGHT / 2];
    for (const [turn, index] of members.entries()) {
      const angle = (2 * Math.PI * turn) / members.length - Math.PI / 2;
      const reach = members.length === 1 ? 0 : 1;
      places[index] = [middle[0] + reach * RADIUS * 1.15 * Math.cos(angle), middle[1] + reach * RADIUS * Math.sin(angle)];
      names.push(label(graph.nodes[index]!, places[index], angle, reach));
    }
    if (room) names.push(s("text", { x: middle[0], y: HEIGHT - 6, class: "graph-room", "text-anchor": "middle" }, plain(room)));
  }
  const lines = graph.edges.map(([a, b]) => {
    const [x1, y1] = places[a] ?? [0, 0];
    const [x2, y2] = places[b] ?? [0, 0];
    return s("line", { x1, y1, x2, y2 });
  });
  const dots = places.map(([cx, cy]) => s("circle", { cx, cy, r: 5 }));
  const words = graph.nodes.map((node) => plain(node.category)).join(", ");
  return s("svg", { viewBox: `0 0 ${rooms.length * WIDTH} ${HEIGHT}`, role: "img", "aria-label": `Furniture: ${words}`, style: `max-width: ${rooms.length * WIDTH}px` }, ...lines, ...dots, ...names);
}

function label(node: FurnitureGraph["nodes"][number], [x, y]: [number, number], angle: number, reach: number): SVGElement {
  const side = Math.cos(angle) * reach;
  const anchor = side > 0.2 ? "start" : side < -0.2 ? "end" : "middle";
  const shift: [number, number] = anchor === "middle" ? [0, Math.sin(angle) > 0 ? 18 : -11] : [Math.sign(side) * 9, 4];
  return s("text", { x: x + shift[0], y: y + shift[1], "text-anchor": anchor }, `${plain(node.category)}${node.instance > 1 ? ` ${node.instance}` : ""}`);
}
