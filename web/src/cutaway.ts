/** Walls in the way of the onlooker sink to stumps. */

import { BufferAttribute, Color, Group, Material, Mesh, MeshStandardMaterial, Object3D, PlaneGeometry, Vector3 } from "three";
import type { Point2 } from "./api";
import { meshesOf, middleOf, own, pieces } from "./pieces";
import type { Point3 } from "./pose";
import { distance, hides, stumps, WALL_DEPTH, type WallSide } from "./walls";

/** Metres of a wall that stay, so that rooms keep their outline. */
const STUMP = 0.09;
const FULL = 100;
/** How fast walls sink and rise, a second. */
const RATE = 7;

/** Runs of vertices of one geometry that belong to one wall. */
interface Part {
  readonly attribute: BufferAttribute;
  readonly wall: number;
  readonly vertices: readonly number[];
  /** Doors, windows and their frames go altogether; of a wall a stump stays. */
  readonly vanishes: boolean;
}

export class Cutaway {
  readonly #sides: readonly WallSide[];
  readonly #parts: Part[] = [];
  readonly #heights: number[];
  readonly #caps: Group[];
  readonly #capLook = new MeshStandardMaterial({ roughness: 1 });

  constructor(scene: Object3D, sides: readonly WallSide[]) {
    this.#sides = sides;
    this.#heights = sides.map((side) => side.height);
    for (const mesh of meshesOf(scene, "wall")) this.#prepareWall(mesh, false);
    for (const mesh of ["door", "window"].flatMap((name) => meshesOf(scene, name))) this.#prepareWall(mesh, true);
    this.#caps = sides.map((side) => capsOf(side, this.#capLook));
    scene.add(...this.#caps);
  }

  /** Colour of a wall where it is cut. */
  set color(color: Color) {
    this.#capLook.color.copy(color);
  }

  /** Lower and raise walls for this eye and body; whether anything still moves. */
  update(eye: Vector3, body: Vector3, seconds: number): boolean {
    const share = 1 - Math.exp(-RATE * seconds);
    let moving = false;
    for (const [index, side] of this.#sides.entries()) {
      const goal = hides(side, [eye.x, eye.z], [body.x, body.z]) ? STUMP : side.height + 0.05;
      const height = this.#heights[index]!;
      if (height === goal) continue;
      const next = Math.abs(goal - height) < 0.01 ? goal : height + (goal - height) * share;
      this.#heights[index] = next;
      moving = true;
      // At full height nothing is cut, whatever stands proud of the wall.
      const whole = next === goal && goal > STUMP;
      for (const part of this.#parts) if (part.wall === index) setCut(part, whole ? FULL : part.vanishes ? next - 2 * STUMP : next);
      this.#caps[index]!.visible = !whole;
      this.#caps[index]!.position.y = next + 0.003;
    }
    return moving;
  }

  #prepareWall(mesh: Mesh, vanishes: boolean): void {
    const geometry = mesh.geometry;
    const attribute = new BufferAttribute(new Float32Array(geometry.getAttribute("position").count).fill(FULL), 1);
    geometry.setAttribute("cut", attribute);
    for (const vertices of pieces(geometry)) {
      this.#parts.push({ attribute, vertices, wall: nearest(this.#sides, middleOf(geometry, vertices)), vanishes });
    }
    patchWall(own(mesh));
  }
}

/** Lids on a wall's stumps, at height 0. */
function capsOf(side: WallSide, look: Material): Group {
  const group = new Group();
  const along: Point2 = [side.b[0] - side.a[0], side.b[1] - side.a[1]];
  const length = Math.hypot(...along) || 1;
  for (const [from, to] of stumps(side)) {
    const middle = (from + to) / 2 / length;
    const lid = new Mesh(new PlaneGeometry(to - from, WALL_DEPTH), look);
    lid.receiveShadow = true;
    lid.position.set(side.a[0] + middle * along[0] + (side.out[0] * WALL_DEPTH) / 2, 0, side.a[1] + middle * along[1] + (side.out[1] * WALL_DEPTH) / 2);
    lid.rotation.set(-Math.PI / 2, 0, Math.atan2(-along[1], along[0]));
    group.add(lid);
  }
  group.visible = false;
  return group;
}

function setCut(part: Part, cut: number): void {
  for (const vertex of part.vertices) part.attribute.setX(vertex, cut);
  part.attribute.needsUpdate = true;
}

function nearest(sides: readonly WallSide[], [x, , z]: Point3): number {
  let best = -1;
  let least = Infinity;
  for (const [index, side] of sides.entries()) {
    const gap = distance([x, z], side.a, side.b);
    if (gap < least) [best, least] = [index, gap];
  }
  return best;
}

const WORLD_VERTEX = "varying vec3 vPlace;\n";
const WORLD_PLACE = "#include <begin_vertex>\nvPlace = (modelMatrix * vec4(transformed, 1.0)).xyz;";

/** Above its cut a wall is not drawn. */
export function patchWall(material: Material): void {
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = `attribute float cut;\nvarying float vCut;\n${WORLD_VERTEX}${shader.vertexShader}`.replace(
      "#include <begin_vertex>",
      `${WORLD_PLACE}\nvCut = cut;`,
    );
    shader.fragmentShader = `varying float vCut;\n${WORLD_VERTEX}${shader.fragmentShader}`.replace(
      "void main() {",
      "void main() {\nif (vPlace.y > vCut) discard;",
    );
  };
  material.customProgramCacheKey = () => "cut";
}
