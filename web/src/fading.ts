/** Furniture between the onlooker and the body turns to glass, whole pieces at a time. */

import { BufferAttribute, Material, Mesh, Object3D, Vector3 } from "three";
import { meshesOf, middleOf, own, pieces } from "./pieces";
import { boxAt, stands, type Box } from "./sight";

/** How much is left of what is in the way. */
const GLASS = 0.1;
/** How fast it fades and comes back, a second. */
const RATE = 6;
const NODES = ["furniture", "ceiling"];

/** Runs of vertices of one geometry that belong to one piece of furniture. */
interface Part {
  readonly attribute: BufferAttribute;
  readonly vertices: readonly number[];
  readonly box: number;
}

export class Fading {
  readonly #boxes: readonly Box[];
  readonly #shares: number[];
  readonly #parts: Part[] = [];
  /** What draws the glass; nothing is spent on it while all is solid. */
  readonly #glass: Mesh[] = [];

  constructor(scene: Object3D, boxes: readonly Box[]) {
    this.#boxes = boxes;
    this.#shares = boxes.map(() => 1);
    if (boxes.length === 0) return;
    for (const mesh of NODES.flatMap((name) => meshesOf(scene, name))) this.#prepare(mesh);
  }

  /** Fade and bring back for this eye and body; whether anything still changes. */
  update(eye: Vector3, body: Vector3, seconds: number): boolean {
    const [from, to] = [eye.toArray(), body.toArray()];
    const hiding = this.#boxes.map((box) => stands(box, from, to));
    const step = 1 - Math.exp(-RATE * seconds);
    let moving = false;
    for (const [index, { on }] of this.#boxes.entries()) {
      const goal = hiding[index] || (on !== null && hiding[on]) ? GLASS : 1;
      const share = this.#shares[index]!;
      if (share === goal) continue;
      moving = true;
      const next = Math.abs(goal - share) < 0.01 ? goal : share + (goal - share) * step;
      this.#shares[index] = next;
      for (const part of this.#parts) if (part.box === index) setShare(part, next);
    }
    if (moving) for (const mesh of this.#glass) mesh.visible = this.#shares.some((share) => share < 1);
    return moving;
  }

  /** A mesh is drawn where it is solid; then, after all that is solid, the nearest of what is glass. */
  #prepare(mesh: Mesh): void {
    const { geometry } = mesh;
    const attribute = new BufferAttribute(new Float32Array(geometry.getAttribute("position").count).fill(1), 1);
    geometry.setAttribute("share", attribute);
    for (const vertices of pieces(geometry)) {
      this.#parts.push({ attribute, vertices, box: boxAt(this.#boxes, middleOf(geometry, vertices)) });
    }
    const solid = patchShare(own(mesh), false);
    const depth = glassOf(solid);
    depth.colorWrite = false;
    for (const [order, material] of [depth, glassOf(solid)].entries()) {
      const glass = new Mesh(geometry, material);
      glass.renderOrder = 1 + order;
      glass.visible = false;
      glass.receiveShadow = true;
      this.#glass.push(glass);
      mesh.add(glass);
    }
  }
}

/** The same look, drawn where it is glass. */
export function glassOf<Look extends Material>(solid: Look): Look {
  const glass = patchShare(solid.clone(), true);
  glass.transparent = true;
  return glass;
}

/** Draw either what is solid or what is glass. */
export function patchShare<Look extends Material>(material: Look, glass: boolean): Look {
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = `attribute float share;\nvarying float vShare;\n${shader.vertexShader}`.replace("#include <begin_vertex>", "#include <begin_vertex>\nvShare = share;");
    shader.fragmentShader = `varying float vShare;\n${shader.fragmentShader}`
      .replace("void main() {", `void main() {\nif (vShare ${glass ? ">" : "<"} 0.995) discard;`)
      .replace("#include <opaque_fragment>", `#include <opaque_fragment>\n${glass ? "gl_FragColor.a *= vShare;" : ""}`);
  };
  material.customProgramCacheKey = () => (glass ? "glass" : "solid");
  return material;
}

function setShare({ attribute, vertices }: Part, share: number): void {
  for (const vertex of vertices) attribute.setX(vertex, share);
  attribute.needsUpdate = true;
}
