/** The page's renderer, made and warmed up before it is wanted; a second one only while two films are shown. */

import {
  BoxGeometry, Bone, BufferAttribute, Mesh, MeshBasicMaterial, MeshStandardMaterial, NeutralToneMapping, PCFShadowMap, PerspectiveCamera, Scene,
  Skeleton, SkinnedMesh, Vector3, WebGLRenderer,
} from "three";
import { patchWall } from "./cutaway";
import { glassOf, patchShare } from "./fading";
import { Lighting } from "./lighting";

/** Those that nobody draws with now. */
const free: WebGLRenderer[] = [];
let made = 0;
/** Kept, since a program goes with the last material that uses it. */
let warmer: Scene | null = null;

/** One that is free, until it is given back; else a new one: making one takes long, and browsers give out few. Throws without WebGL. */
export function lend(): WebGLRenderer {
  const known = free.pop();
  if (known) return known;
  const fresh = new WebGLRenderer({ antialias: true, powerPreference: "high-performance" });
  fresh.shadowMap.enabled = true;
  fresh.shadowMap.type = PCFShadowMap;
  fresh.toneMapping = NeutralToneMapping;
  made++;
  return fresh;
}

export function giveBack(drawing: WebGLRenderer): void {
  free.push(drawing);
}

/** Have the programs built that homes and bodies need, by drawing a small scene with every kind of surface. */
export function warmUp(): void {
  // Whoever draws already has had them built.
  if (made) return;
  warmer = new Scene();
  const lighting = new Lighting(warmer);
  lighting.aim(new Vector3(0, 1, 0));
  const wall = new MeshStandardMaterial({ flatShading: true });
  const pane = new MeshStandardMaterial({ flatShading: true, transparent: true, opacity: 0.3 });
  const solid = new MeshStandardMaterial({ flatShading: true });
  patchWall(wall);
  patchWall(pane);
  patchShare(solid, false);
  const glass = glassOf(solid);
  for (const material of [wall, pane, solid, glass, new MeshStandardMaterial({ flatShading: true }), new MeshStandardMaterial()]) {
    const mesh = new Mesh(box(), material);
    // Homes come without normals, and programs differ by that.
    if (material.flatShading) mesh.geometry.deleteAttribute("normal");
    mesh.castShadow = mesh.receiveShadow = true;
    warmer.add(mesh);
  }
  warmer.add(new Mesh(box(), new MeshBasicMaterial({ vertexColors: true, toneMapped: false })), body());
  const camera = new PerspectiveCamera();
  camera.position.set(0, 0, 4);
  const drawing = lend();
  drawing.setSize(64, 64);
  drawing.render(warmer, camera);
  giveBack(drawing);
}

function box(): BoxGeometry {
  const geometry = new BoxGeometry();
  const { count } = geometry.getAttribute("position");
  geometry.setAttribute("cut", new BufferAttribute(new Float32Array(count).fill(9), 1));
  geometry.setAttribute("share", new BufferAttribute(new Float32Array(count).fill(1), 1));
  geometry.setAttribute("color", new BufferAttribute(new Float32Array(3 * count), 3));
  return geometry;
}

function body(): SkinnedMesh {
  const geometry = box();
  const { count } = geometry.getAttribute("position");
  geometry.setAttribute("skinIndex", new BufferAttribute(new Uint8Array(4 * count), 4));
  geometry.setAttribute("skinWeight", new BufferAttribute(new Float32Array(4 * count).fill(0.25), 4));
  const mesh = new SkinnedMesh(geometry, new MeshStandardMaterial());
  const bone = new Bone();
  mesh.add(bone);
  mesh.bind(new Skeleton([bone]));
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}
