/** The home from above: rooms, doorways, furniture, and the body on its way. */

import type { Home, Point2 } from "./api";
import { color, onAppearance } from "./appearance";
import { h } from "./dom";
import { nameOf, pieceName } from "./furniture-words";
import type { Track } from "./motion";
import { heading, type Pose } from "./pose";
import { contains, outlines, toHome } from "./walls";

interface Piece {
  readonly id: string;
  readonly name: string;
  readonly corners: readonly Point2[];
  readonly top: number;
}

interface Label {
  readonly name: string;
  readonly x: number;
  readonly y: number;
  readonly half: number;
}

/** Frames of the way that are shown behind the body. */
const TRAIL = 240;
const MARGIN = 0.35;
/** What hangs higher than this is not drawn: it would hide what stands below, metres. */
const HANGING = 1.3;
/** From this many pixels a metre on, furniture is named without being asked. */
const NAMED = 46;

export class MiniMap {
  readonly element: HTMLCanvasElement;
  readonly #ink: CanvasRenderingContext2D;
  readonly #still = document.createElement("canvas");
  readonly #end: () => void;
  readonly #observer: ResizeObserver;
  #home: Home | null = null;
  #pieces: Piece[] = [];
  #rooms: Point2[][] = [];
  #names: readonly string[] = [];
  #scale = 1;
  #shift: Point2 = [0, 0];
  #target: string | null = null;
  #pointed: string | null = null;
  #last: { pose: Pose; track: Track; frame: number } | null = null;

  constructor() {
    this.element = h("canvas", { class: "map", role: "img", "aria-label": "Plan of the home" });
    const ink = this.element.getContext("2d");
    if (!ink) throw new Error("this browser draws no pictures");
    this.#ink = ink;
    this.#end = onAppearance(() => this.#redraw());
    this.#observer = new ResizeObserver(() => this.#redraw());
    this.#observer.observe(this.element);
    this.element.addEventListener("pointermove", (event) => this.#point(event));
    this.element.addEventListener("pointerleave", () => this.#point(null));
  }

  /** `names` are what its rooms are called in the story. */
  setHome(home: Home, names: readonly string[]): void {
    this.#home = home;
    this.#names = names;
    this.#rooms = outlines(home);
    this.#pieces = home.rooms.flatMap((room, index) =>
      room.layout.objects.filter((object) => object.position[1] < HANGING).map((object) => {
        const [w, , d] = object.size;
        const at = (x: number, z: number): Point2 => {
          const [dx, dz] = toHome([x, z], { offset: [0, 0, 0], yaw: object.yaw });
          return toHome([dx + object.position[0], dz + object.position[2]], room);
        };
        const corners = [at(-w / 2, -d / 2), at(w / 2, -d / 2), at(w / 2, d / 2), at(-w / 2, d / 2)];
        return { id: `${index}/${object.id}`, name: nameOf(object.category), corners, top: object.position[1] + object.size[1] };
      }),
    );
    this.#pieces.sort((a, b) => a.top - b.top);
    this.#redraw();
  }

  /** Mark the piece a keyframe is about, and say in words where the body is. */
  show(objectId: string | null): void {
    this.#target = objectId;
    const pose = this.#last?.pose;
    const place: Point2 | null = pose ? [pose.root[0]!, pose.root[2]!] : null;
    const room = place === null ? -1 : this.#rooms.findIndex((outline) => contains(outline, place));
    const where = room >= 0 ? ` The body is in the ${this.#names[room]}${objectId ? `, on its way to or at the ${pieceName(objectId)}` : ""}.` : "";
    this.element.setAttribute("aria-label", `Plan of the home: ${this.#names.join(", ")}.${where}`);
    this.#redraw();
  }

  tick(pose: Pose, track: Track, frame: number): void {
    this.#last = { pose, track, frame };
    this.#draw();
  }

  dispose(): void {
    this.#end();
    this.#observer.disconnect();
  }

  #point(event: PointerEvent | null): void {
    const place: Point2 | null = event && [(event.offsetX - this.#shift[0]) / this.#scale, (event.offsetY - this.#shift[1]) / this.#scale];
    const found = place && this.#pieces.filter((piece) => contains(piece.corners, place)).at(-1);
    if ((found?.id ?? null) === this.#pointed) return;
    this.#pointed = found?.id ?? null;
    this.#draw();
  }

  /** Draw what stands still aside, once. */
  #redraw(): void {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (!this.#home || !width || !height) return;
    const dense = Math.min(window.devicePixelRatio, 2);
    for (const canvas of [this.element, this.#still]) {
      canvas.width = Math.round(width * dense);
      canvas.height = Math.round(height * dense);
    }
    this.#fit(width, height);
    const ink = this.#still.getContext("2d");
    if (!ink) return;
    ink.setTransform(dense, 0, 0, dense, 0, 0);
    this.#ink.setTransform(dense, 0, 0, dense, 0, 0);
    for (const room of this.#rooms) {
      trace(ink, room.map((p) => this.#at(p)), color("--map-floor"), color("--map-wall"), 2);
    }
    this.#openDoorways(ink);
    for (const piece of this.#pieces) {
      const rug = piece.top < 0.03;
      const lit = piece.id === this.#target;
      trace(ink, piece.corners.map((p) => this.#at(p)), color(lit ? "--lamp" : rug ? "--map-rug" : "--map-piece"), color("--map-line"), rug ? 0 : 0.75);
    }
    const taken: Label[] = [];
    const large = this.#scale >= NAMED ? this.#pieces.filter((piece) => piece.top >= 0.03) : [];
    for (const piece of large) {
      const label = this.#label(ink, piece);
      // What finds no room for its name tells it when it is pointed at.
      if (taken.some((other) => Math.abs(other.x - label.x) < other.half + label.half && Math.abs(other.y - label.y) < 17)) continue;
      taken.push(label);
      this.#name(ink, label);
    }
    this.#draw();
  }

  #openDoorways(ink: CanvasRenderingContext2D): void {
    for (const { segment } of this.#home?.doorways ?? []) {
      ink.strokeStyle = color("--map-floor");
      ink.lineWidth = Math.max(0.2 * this.#scale, 4);
      ink.beginPath();
      ink.moveTo(...this.#at(segment[0]));
      ink.lineTo(...this.#at(segment[1]));
      ink.stroke();
    }
  }

  #fit(width: number, height: number): void {
    const corners = this.#rooms.flat();
    const xs = corners.map((p) => p[0]), zs = corners.map((p) => p[1]);
    const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...zs), Math.max(...zs)];
    this.#scale = Math.min(width / (right - left + 2 * MARGIN), height / (bottom - top + 2 * MARGIN));
    this.#shift = [width / 2 - (this.#scale * (left + right)) / 2, height / 2 - (this.#scale * (top + bottom)) / 2];
  }

  #at([x, z]: Point2): [number, number] {
    return [x * this.#scale + this.#shift[0], z * this.#scale + this.#shift[1]];
  }

  #draw(): void {
    const ink = this.#ink;
    const { clientWidth: width, clientHeight: height } = this.element;
    ink.clearRect(0, 0, width, height);
    ink.drawImage(this.#still, 0, 0, width, height);
    if (this.#last) this.#drawBody(ink, this.#last);
    const pointed = this.#pieces.find((piece) => piece.id === this.#pointed);
    if (pointed) this.#name(ink, this.#label(ink, pointed));
  }

  #drawBody(ink: CanvasRenderingContext2D, { pose, track, frame }: { pose: Pose; track: Track; frame: number }): void {
    const accent = color("--map-body");
    ink.strokeStyle = accent;
    ink.lineCap = ink.lineJoin = "round";
    ink.lineWidth = 2;
    const now = Math.min(Math.floor(frame), track.ready - 1);
    for (let from = Math.max(now - TRAIL, 0); from < now; from += 8) {
      ink.globalAlpha = 0.65 * (1 - (now - from) / TRAIL);
      ink.beginPath();
      ink.moveTo(...this.#at(track.floorPoint(from)));
      ink.lineTo(...this.#at(track.floorPoint(Math.min(from + 8, now))));
      ink.stroke();
    }
    ink.globalAlpha = 1;
    const [x, y] = this.#at([pose.root[0]!, pose.root[2]!]);
    const facing = heading(pose);
    ink.save();
    ink.translate(x, y);
    // Yaw 0 is +Z, which is down on the map.
    ink.rotate(-facing);
    trace(ink, [[-5, -3.5], [0, 9.5], [5, -3.5]], accent, accent, 1);
    ink.restore();
    ink.beginPath();
    ink.arc(x, y, 5, 0, 2 * Math.PI);
    ink.fillStyle = accent;
    ink.fill();
    ink.strokeStyle = color("--map-floor");
    ink.lineWidth = 1.5;
    ink.stroke();
  }

  /** Where the name of a piece is written: over its middle, but not outside the picture. */
  #label(ink: CanvasRenderingContext2D, { name, corners }: Piece): Label {
    const [x, y] = this.#at([(corners[0]![0] + corners[2]![0]) / 2, (corners[0]![1] + corners[2]![1]) / 2]);
    ink.font = "600 11px system-ui, sans-serif";
    const half = ink.measureText(name).width / 2 + 4;
    return { name, half, y, x: Math.min(Math.max(x, half), Math.max(this.element.clientWidth - half, half)) };
  }

  #name(ink: CanvasRenderingContext2D, { name, x, y, half }: Label): void {
    ink.textAlign = "center";
    ink.textBaseline = "middle";
    ink.fillStyle = color("--map-label");
    ink.beginPath();
    ink.roundRect(x - half, y - 8, 2 * half, 16, 4);
    ink.fill();
    ink.fillStyle = color("--ink");
    ink.fillText(name, x, y + 0.5);
  }
}

function trace(ink: CanvasRenderingContext2D, points: readonly Point2[], filled: string, line: string, width: number): void {
  ink.beginPath();
  for (const [index, [x, y]] of points.entries()) ink[index ? "lineTo" : "moveTo"](x, y);
  ink.closePath();
  ink.fillStyle = filled;
  ink.fill();
  if (!width) return;
  ink.strokeStyle = line;
  ink.lineWidth = width;
  ink.lineJoin = "miter";
  ink.stroke();
}
