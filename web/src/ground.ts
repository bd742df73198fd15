/** What lies under a home: the floor it stands on, and a ground under its boards. */

import { BufferAttribute, CircleGeometry, Color, Material, Mesh, MeshBasicMaterial, MeshStandardMaterial, Object3D, Shape, ShapeGeometry, Vector2 } from "three";
import type { Home } from "./api";
import { meshesOf } from "./pieces";
import { outlines } from "./walls";

/** Metres below the floor: enough for depth to tell them apart. */
const BELOW = 0.006;

/** A plain floor under every room's boards, since corners of boards that meet in a T let what is below shine through. */
export function subfloors(scene: Object3D, home: Home): Mesh[] {
  const looks = meshesOf(scene, "floor").map((mesh) => mesh.material as Material);
  return outlines(home).map((outline, index) => {
    // The shape is drawn in x and y, and turned so that its y becomes -z.
    const geometry = new ShapeGeometry(new Shape(outline.map(([x, z]) => new Vector2(x, -z))));
    geometry.rotateX(-Math.PI / 2);
    const look = looks.find((material) => material.name === `floor ${index}`) ?? new MeshStandardMaterial({ roughness: 1 });
    const floor = new Mesh(geometry, look);
    floor.position.y = -BELOW;
    floor.receiveShadow = true;
    return floor;
  });
}

/** A round floor of radius 1 that fades into what is around. */
export function groundDisc(): Mesh {
  const geometry = new CircleGeometry(1, 64);
  geometry.rotateX(-Math.PI / 2);
  geometry.setAttribute("color", new BufferAttribute(new Float32Array(geometry.getAttribute("position").count * 3), 3));
  return new Mesh(geometry, new MeshBasicMaterial({ vertexColors: true, toneMapped: false }));
}

/** Colour the disc from its middle to its rim. */
export function shade(disc: Mesh, middle: Color, rim: Color): void {
  const colors = disc.geometry.getAttribute("color");
  for (let i = 0; i < colors.count; i++) {
    const { r, g, b } = i === 0 ? middle : rim;
    colors.setXYZ(i, r, g, b);
  }
  colors.needsUpdate = true;
}
