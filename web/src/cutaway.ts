/** Makes a home transparent to the onlooker: walls in the way sink, furniture in the way gets a hole. */

import { BufferAttribute, BufferGeometry, Color, Group, Material, Mesh, MeshStandardMaterial, Object3D, PlaneGeometry, Vector3 } from "three";
import type { Point2 } from "./api";
import { distance, hides, stumps, WALL_DEPTH, type WallSide } from "./walls";

/** Metres of a wall that stay, so that rooms keep their outline. */
const STUMP = 0.09;
const FULL = 100;
/** How fast walls sink and rise, a second. */
const RATE = 7;
const SOLID_NODES = ["furniture", "ceiling"];

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
  readonly #body = { value: new Vector3(0, 1, 0) };
  readonly #caps: Group[];
  readonly #capLook = new MeshStandardMaterial({ roughness: 1 });

  constructor(scene: Object3D, sides: readonly WallSide[]) {
    this.#sides = sides;
    this.#heights = sides.map((side) => side.height);
    meshesOf(scene, "wall", (mesh) => this.#prepareWall(mesh, false));
    for (const name of ["door", "window"]) meshesOf(scene, name, (mesh) => this.#prepareWall(mesh, true));
    for (const name of SOLID_NODES) {
      meshesOf(scene, name, (mesh) => patchSolid(own(mesh), this.#body));
    }
    this.#caps = sides.map((side) => capsOf(side, this.#capLook));
    scene.add(...this.#caps);
  }

  /** Colour of a wall where it is cut. */
  set color(color: Color) {
    this.#capLook.color.copy(color);
  }

  /** Lower and raise walls for this eye and body; whether anything still moves. */
  update(eye: Vector3, body: Vector3, seconds: number): boolean {
    this.#body.value.copy(body);
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

/** The mesh's material, made its own: the loader shares one between meshes that look alike. */
function own(mesh: Mesh): Material {
  return (mesh.material = (mesh.material as Material).clone());
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

/** All meshes of the node of that name; several looks make it a group. */
function meshesOf(scene: Object3D, name: string, act: (mesh: Mesh) => void): void {
  scene.getObjectByName(name)?.traverse((object) => {
    if (object instanceof Mesh) act(object);
  });
}

/** Vertices that hang together by triangles: boxes and boards that were merged into one geometry. */
function pieces(geometry: BufferGeometry): number[][] {
  const count = geometry.getAttribute("position").count;
  const parent = Int32Array.from({ length: count }, (_, i) => i);
  const root = (i: number): number => {
    while (parent[i] !== i) i = parent[i] = parent[parent[i]!]!;
    return i;
  };
  const index = geometry.getIndex();
  const corner = (i: number): number => (index ? index.getX(i) : i);
  for (let i = 0; i + 2 < (index?.count ?? count); i += 3) {
    parent[root(corner(i + 1))] = root(corner(i));
    parent[root(corner(i + 2))] = root(corner(i));
  }
  const found = new Map<number, number[]>();
  for (let i = 0; i < count; i++) {
    const at = root(i);
    const members = found.get(at);
    if (members) members.push(i);
    else found.set(at, [i]);
  }
  return [...found.values()];
}

function middleOf(geometry: BufferGeometry, vertices: readonly number[]): Point2 {
  const position = geometry.getAttribute("position");
  let x = 0;
  let z = 0;
  for (const vertex of vertices) {
    x += position.getX(vertex);
    z += position.getZ(vertex);
  }
  return [x / vertices.length, z / vertices.length];
}

function nearest(sides: readonly WallSide[], point: Point2): number {
  let best = -1;
  let least = Infinity;
  for (const [index, side] of sides.entries()) {
    const gap = distance(point, side.a, side.b);
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

/** Near the line from the eye to the body, and clearly before it, what is solid gets thin. */
export function patchSolid(material: Material, body: { value: Vector3 }): void {
  // The share that is left goes to that share of a pixel's samples: nothing needs sorting.
  material.alphaToCoverage = true;
  material.onBeforeCompile = (shader) => {
    shader.uniforms["bodyPlace"] = body;
    shader.vertexShader = `${WORLD_VERTEX}${shader.vertexShader}`.replace("#include <begin_vertex>", WORLD_PLACE);
    shader.fragmentShader = `uniform vec3 bodyPlace;\n${WORLD_VERTEX}${shader.fragmentShader}`.replace(
      "#include <opaque_fragment>",
      `#include <opaque_fragment>
        vec3 sight = bodyPlace - cameraPosition;
        float along = dot(vPlace - cameraPosition, sight) / dot(sight, sight);
        float aside = distance(vPlace, cameraPosition + along * sight);
        float before = smoothstep(0.5, 0.75, (1.0 - along) * length(sight)) * step(0.0, along);
        gl_FragColor.a = max(smoothstep(0.3, 0.55, aside), 1.0 - before);
        if (gl_FragColor.a < 0.1) discard;`,
    );
  };
  material.customProgramCacheKey = () => "hole";
}
