/** A furniture graph as a small picture: one ring a room, room under room, lines between what is used together. */

import type { FurnitureGraph } from "./api";
import { s } from "./dom";
import { nameOf } from "./furniture-words";
import { plain } from "./words";

const RADIUS = 62;
const WIDTH = 300;
/** Above and below a ring, for names. */
const MARGIN = 22;
const ROOM_NAME = 34;

/** An SVG with a name for those who do not see it. */
export function drawGraph(graph: FurnitureGraph): SVGSVGElement {
  const rooms = [...new Set(graph.nodes.map((node) => node.room))];
  const places: [number, number][] = [];
  const names: SVGElement[] = [];
  let top = 0;
  for (const room of rooms) {
    const members = graph.nodes.flatMap((node, index) => (node.room === room ? [index] : []));
    // One stands alone, two stand side by side, more stand in a ring.
    const [across, down] = members.length === 1 ? [0, 0] : members.length === 2 ? [0.7 * RADIUS, 0] : [1.15 * RADIUS, RADIUS];
    const first = members.length === 2 ? Math.PI : -Math.PI / 2;
    const middle: [number, number] = [WIDTH / 2, top + MARGIN + down];
    for (const [turn, index] of members.entries()) {
      const angle = (2 * Math.PI * turn) / members.length + first;
      places[index] = [middle[0] + across * Math.cos(angle), middle[1] + down * Math.sin(angle)];
      names.push(label(graph.nodes[index]!, places[index], angle, across ? 1 : 0));
    }
    top = middle[1] + down + MARGIN;
    if (room) names.push(s("text", { x: middle[0], y: (top += ROOM_NAME / 2), class: "graph-room", "text-anchor": "middle" }, plain(room)));
    top += ROOM_NAME / 2;
  }
  const lines = graph.edges.map(([a, b]) => {
    const [x1, y1] = places[a] ?? [0, 0];
    const [x2, y2] = places[b] ?? [0, 0];
    return s("line", { x1, y1, x2, y2 });
  });
  const dots = places.map(([cx, cy]) => s("circle", { cx, cy, r: 5 }));
  const words = graph.nodes.map((node) => nameOf(node.category)).join(", ");
  return s("svg", { viewBox: `0 0 ${WIDTH} ${top}`, role: "img", "aria-label": `Furniture: ${words}`, style: `max-width: ${WIDTH}px` }, ...lines, ...dots, ...names);
}

function label(node: FurnitureGraph["nodes"][number], [x, y]: [number, number], angle: number, reach: number): SVGElement {
  const side = Math.cos(angle) * reach;
  const anchor = side > 0.2 ? "start" : side < -0.2 ? "end" : "middle";
  const shift: [number, number] = anchor === "middle" ? [0, Math.sin(angle) > 0 ? 18 : -11] : [Math.sign(side) * 9, 4];
  return s("text", { x: x + shift[0], y: y + shift[1], "text-anchor": anchor }, `${nameOf(node.category)}${node.instance > 1 ? ` ${node.instance}` : ""}`);
}
