/** Parts of a scene's merged geometry: what hangs together, and where it is. */

import { BufferGeometry, Material, Mesh, Object3D } from "three";
import type { Point3 } from "./pose";

/** The mesh's material, made its own: the loader shares one between meshes that look alike. */
export function own(mesh: Mesh): Material {
  return (mesh.material = (mesh.material as Material).clone());
}

/** Whether it is drawn as triangles; `instanceof` alone would not know of what. */
export const isMesh = (object: Object3D): object is Mesh => object instanceof Mesh;

/** All meshes of the node of that name; several looks make it a group. */
export function meshesOf(scene: Object3D, name: string): Mesh[] {
  const found: Mesh[] = [];
  scene.getObjectByName(name)?.traverse((object) => {
    if (isMesh(object)) found.push(object);
  });
  return found;
}

/** Vertices that hang together by triangles: boxes and boards that were merged into one geometry. */
export function pieces(geometry: BufferGeometry): number[][] {
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

export function middleOf(geometry: BufferGeometry, vertices: readonly number[]): Point3 {
  const position = geometry.getAttribute("position");
  const middle: Point3 = [0, 0, 0];
  for (const vertex of vertices) {
    middle[0] += position.getX(vertex) / vertices.length;
    middle[1] += position.getY(vertex) / vertices.length;
    middle[2] += position.getZ(vertex) / vertices.length;
  }
  return middle;
}
