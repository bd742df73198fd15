/** The three.js scene: home, body, light, and the picture of them at one moment. */

import {
  Box3, BufferAttribute, CircleGeometry, Color, DirectionalLight, DoubleSide, HemisphereLight, Mesh, MeshBasicMaterial, NeutralToneMapping,
  Object3D, PCFShadowMap, Scene, SkinnedMesh, Sphere, SpotLight, Vector3, WebGLRenderer,
} from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import type { Home } from "./api";
import { CameraMan, type CameraMode } from "./camera";
import { Cutaway } from "./cutaway";
import { heading, JOINT_NAMES, type Point3, type Pose } from "./pose";
import { wallSides } from "./walls";

/** Colours and strengths that the page chooses. */
export interface Mood {
  readonly dark: boolean;
  /** CSS colours: what is around the home, the floor it stands on, the feeling that tints the light. */
  readonly around: string;
  readonly ground: string;
  readonly tint: string;
}

const SHADOW_REACH = 4.2;

export class Stage {
  readonly cameraMan: CameraMan;
  readonly canvas: HTMLCanvasElement;
  /** Set to have the next picture drawn. */
  dirty = true;
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #sky = new HemisphereLight(0xffffff, 0x8a8078, 1.5);
  readonly #sun = new DirectionalLight(0xfff1dc, 2);
  readonly #spot = new SpotLight(0xffd9a0, 0, 0, 0.5, 0.9, 0);
  readonly #ground: Mesh;
  readonly #body = new Vector3(0, 0.95, 0);
  #joints: Object3D[] = [];
  #bodyRoot: Object3D | null = null;
  #home: Object3D | null = null;
  #cutaway: Cutaway | null = null;
  #heading = 0;
  #tint = new Color(1, 1, 1);
  #tintGoal = new Color(1, 1, 1);
  #skyColor = new Color();
  #seconds = 0;
  #slow = 0;

  /** Throws where the browser has no WebGL. */
  constructor(holder: HTMLElement) {
    this.#renderer = new WebGLRenderer({ antialias: true, powerPreference: "high-performance" });
    this.#renderer.shadowMap.enabled = true;
    this.#renderer.shadowMap.type = PCFShadowMap;
    this.#renderer.toneMapping = NeutralToneMapping;
    this.canvas = this.#renderer.domElement;
    holder.append(this.canvas);
    this.cameraMan = new CameraMan(this.canvas);
    this.cameraMan.controls.addEventListener("change", () => (this.dirty = true));
    this.#ground = groundDisc();
    this.#light();
    this.#scene.add(this.#ground);
    this.resize(holder.clientWidth, holder.clientHeight);
  }

  #light(): void {
    const { shadow } = this.#sun;
    this.#sun.castShadow = true;
    shadow.mapSize.set(1536, 1536);
    shadow.radius = 4;
    shadow.bias = -0.0004;
    shadow.normalBias = 0.02;
    Object.assign(shadow.camera, { left: -SHADOW_REACH, right: SHADOW_REACH, top: SHADOW_REACH, bottom: -SHADOW_REACH, near: 1, far: 16 });
    this.#scene.add(this.#sky, this.#sun, this.#sun.target, this.#spot, this.#spot.target);
  }

  /** Build the home of a scene.glb; its walls get out of the way by the home's plan. */
  async setHome(glb: ArrayBuffer, home: Home): Promise<void> {
    const { scene } = await new GLTFLoader().parseAsync(glb, "");
    scene.traverse((object) => {
      if (!(object instanceof Mesh)) return;
      const group = object.parent?.name && object.parent !== scene ? object.parent.name : object.name;
      // Walls throw no shadow: they come and go, and there is no ceiling to let light in below.
      object.castShadow = group.startsWith("furniture");
      object.receiveShadow = true;
    });
    this.#cutaway = new Cutaway(scene, wallSides(home));
    this.#home = scene;
    this.#scene.add(scene);
    const box = new Box3().setFromObject(scene);
    const sphere = box.getBoundingSphere(new Sphere());
    this.cameraMan.setHome(new Vector3(sphere.center.x, 0.5, sphere.center.z), sphere.radius * 0.84);
    this.#ground.position.set(sphere.center.x, -0.02, sphere.center.z);
    this.#ground.scale.setScalar(sphere.radius * 2.2);
    this.dirty = true;
  }

  /** Put the skinned body of a motion's glb on stage. */
  async setBody(glb: ArrayBuffer): Promise<void> {
    const { scene } = await new GLTFLoader().parseAsync(glb, "");
    scene.traverse((object) => {
      if (!(object instanceof SkinnedMesh)) return;
      object.frustumCulled = false;
      object.castShadow = true;
      object.receiveShadow = true;
    });
    this.#joints = JOINT_NAMES.map((name) => scene.getObjectByName(name)).filter((joint) => joint !== undefined);
    if (this.#joints.length !== JOINT_NAMES.length) throw new Error("the body lacks joints");
    this.#bodyRoot = scene;
    this.#scene.add(scene);
    this.dirty = true;
  }

  get hasHome(): boolean {
    return this.#home !== null;
  }

  get hasBody(): boolean {
    return this.#bodyRoot !== null;
  }

  pose(pose: Pose): void {
    this.#body.fromArray(pose.root);
    this.#heading = heading(pose);
    this.#joints[0]?.position.fromArray(pose.root);
    for (const [index, joint] of this.#joints.entries()) joint.quaternion.fromArray(pose.rotations, index * 4);
    this.dirty = true;
  }

  /** World positions of the joints as they are drawn. */
  joints(): Point3[] {
    this.#bodyRoot?.updateMatrixWorld(true);
    return this.#joints.map((joint) => joint.getWorldPosition(new Vector3()).toArray());
  }

  /** The story jumped: look at the body from a good side. */
  cut(): void {
    this.cameraMan.cut(this.#body, this.#heading);
    this.dirty = true;
  }

  setMode(mode: CameraMode): void {
    this.cameraMan.setMode(mode, this.#body, this.#heading);
    this.dirty = true;
  }

  setMood({ dark, around, ground, tint }: Mood): void {
    this.#renderer.setClearColor(new Color(around));
    shade(this.#ground, new Color(ground), new Color(around));
    this.#skyColor.set(dark ? 0xc3cde0 : 0xffffff);
    this.#sky.groundColor.set(dark ? 0x7d7068 : 0xd8cfc4);
    this.#sky.intensity = dark ? 1.35 : 2.75;
    this.#sun.color.set(dark ? 0xffdcb4 : 0xfff4e4);
    this.#sun.intensity = dark ? 1.1 : 1.6;
    this.#spot.intensity = dark ? 1.5 : 0;
    // A feeling gives the light a hue, not darkness.
    const { r, g, b } = this.#tintGoal.set(tint);
    this.#tintGoal.multiplyScalar(1 / Math.max(r, g, b, 0.01));
    if (this.#cutaway) this.#cutaway.color = new Color(dark ? 0x8a958f : 0xb9c4bc);
    this.dirty = true;
  }

  resize(width: number, height: number): void {
    if (!width || !height) return;
    this.#renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2) * (this.#slow > 1 ? 0.6 : 1));
    this.#renderer.setSize(width, height);
    this.cameraMan.resize(width, height);
    this.dirty = true;
  }

  /** Draw if anything has changed; seconds since the last call. */
  render(seconds: number, playing: boolean): void {
    this.#seconds = Math.min(seconds, 0.1);
    this.cameraMan.update(this.#seconds, this.#body, this.#heading, playing);
    const eye = this.cameraMan.camera.position;
    const chest = new Vector3(this.#body.x, this.#body.y + 0.15, this.#body.z);
    if (this.#cutaway?.update(eye, chest, this.cameraMan.calm ? 1 : this.#seconds)) this.dirty = true;
    if (this.#blend()) this.dirty = true;
    if (!this.dirty) return;
    this.dirty = false;
    this.#sun.target.position.set(this.#body.x, 0.6, this.#body.z);
    this.#sun.position.copy(this.#sun.target.position).add(this.#spotPlace.set(2.6, 7, 3.2));
    this.#spot.target.position.copy(chest);
    this.#spot.position.copy(chest).add(this.#spotPlace.set(-1.2, 5, 1.5));
    this.#renderer.render(this.#scene, this.cameraMan.camera);
    this.#watch(seconds);
  }

  readonly #spotPlace = new Vector3();

  /** Let the light take on the feeling of the moment; whether it still changes. */
  #blend(): boolean {
    const miss = Math.hypot(this.#tint.r - this.#tintGoal.r, this.#tint.g - this.#tintGoal.g, this.#tint.b - this.#tintGoal.b);
    this.#tint.lerp(this.#tintGoal, miss < 0.004 ? 1 : 1 - Math.exp(-1.5 * this.#seconds));
    this.#sky.color.copy(this.#skyColor).lerp(this.#tint, 0.12);
    return miss >= 0.004;
  }

  /** Fewer points where pictures take long. */
  #watch(seconds: number): void {
    if (this.#slow > 1) return;
    this.#slow = seconds > 0.05 ? this.#slow + 0.04 : Math.max(this.#slow - 0.02, 0);
    if (this.#slow > 1) this.resize(this.canvas.clientWidth, this.canvas.clientHeight);
  }

  dispose(): void {
    this.cameraMan.controls.dispose();
    this.#scene.traverse((object) => {
      if (!(object instanceof Mesh)) return;
      object.geometry.dispose();
      for (const material of [object.material].flat()) material.dispose();
    });
    this.#renderer.dispose();
    this.canvas.remove();
  }
}

/** A round floor of radius 1 that fades into what is around. */
function groundDisc(): Mesh {
  const geometry = new CircleGeometry(1, 64);
  geometry.rotateX(-Math.PI / 2);
  geometry.setAttribute("color", new BufferAttribute(new Float32Array(geometry.getAttribute("position").count * 3), 3));
  return new Mesh(geometry, new MeshBasicMaterial({ vertexColors: true, toneMapped: false, side: DoubleSide }));
}

function shade(disc: Mesh, middle: Color, rim: Color): void {
  const colors = disc.geometry.getAttribute("color");
  for (let i = 0; i < colors.count; i++) {
    const { r, g, b } = i === 0 ? middle : rim;
    colors.setXYZ(i, r, g, b);
  }
  colors.needsUpdate = true;
}
