/** The three.js scene: home, body, light, and the picture of them at one moment. */

import { Box3, Color, Mesh, Object3D, Scene, SkinnedMesh, Sphere, Vector3 } from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import type { Home, Point2 } from "./api";
import { CameraMan, type CameraMode } from "./camera";
import { Cutaway } from "./cutaway";
import type { Emotion } from "./emotions";
import { Face } from "./face";
import { Fading } from "./fading";
import { groundDisc, shade, subfloors } from "./ground";
import { Lighting } from "./lighting";
import { heading, JOINT_NAMES, type Point3, type Pose } from "./pose";
import { isMesh } from "./pieces";
import { Props } from "./props";
import { giveBack, lend, warmUp } from "./rendering";
import { boxesOf, Lookout } from "./sight";
import { wallSides } from "./walls";

export { warmUp };

/** Seconds after which a picture has taken long; the share of points a side that is left then; where that ends. */
const LONG = 0.05;
const COARSER = 0.6;
const COARSEST = 0.4;
/** Seconds after which a picture counts as one that stays. */
const RESTS = 0.5;

/** Colours and strengths that the page chooses. */
export interface Mood {
  readonly dark: boolean;
  /** CSS colours: what is around the home, the floor it stands on, the feeling that tints the light. */
  readonly around: string;
  readonly ground: string;
  readonly tint: string;
}

export class Stage {
  readonly cameraMan: CameraMan;
  readonly canvas: HTMLCanvasElement;
  /** What the face shows. */
  emotion: Emotion = "neutral";
  asleep = false;
  /** Set to have the next picture drawn. */
  dirty = true;
  /** How many were drawn. */
  pictures = 0;
  readonly #renderer = lend();
  readonly #scene = new Scene();
  readonly #lighting = new Lighting(this.#scene);
  readonly #ground: Mesh;
  readonly #body = new Vector3(0, 0.95, 0);
  readonly #chest = new Vector3();
  #joints: Object3D[] = [];
  #face: Face | null = null;
  #bodyRoot: Object3D | null = null;
  #props: Props | null = null;
  #home: Object3D | null = null;
  #cutaway: Cutaway | null = null;
  #fading: Fading | null = null;
  readonly #stale = (): void => void (this.dirty = true);
  #heading = 0;
  #time = 0;
  #slow = 0;
  #sharpness = 1;
  /** Seconds without a new picture, and whether the last one has all its points though others are drawn with fewer. */
  #rest = 0;
  #sharp = false;

  /** Throws where the browser has no WebGL. */
  constructor(holder: HTMLElement) {
    this.canvas = this.#renderer.domElement;
    holder.append(this.canvas);
    this.cameraMan = new CameraMan(this.canvas);
    this.cameraMan.controls.addEventListener("change", this.#stale);
    this.canvas.addEventListener("webglcontextrestored", this.#stale);
    this.#ground = groundDisc();
    this.#scene.add(this.#ground);
    this.resize(holder.clientWidth, holder.clientHeight);
  }

  /** Build the home of a scene.glb; its walls get out of the way by the home's plan. */
  async setHome(glb: ArrayBuffer, home: Home): Promise<void> {
    const { scene } = await new GLTFLoader().parseAsync(glb, "");
    scene.traverse((object) => {
      if (!isMesh(object)) return;
      const group = object.parent?.name && object.parent !== scene ? object.parent.name : object.name;
      // Walls throw no shadow: they come and go, and there is no ceiling to let light in below.
      object.castShadow = group.startsWith("furniture");
      object.receiveShadow = true;
    });
    this.#cutaway = new Cutaway(scene, wallSides(home));
    this.#fading = new Fading(scene, boxesOf(home));
    this.cameraMan.lookout = new Lookout(home);
    scene.add(...subfloors(scene, home));
    if (this.#home) this.#scene.remove(this.#home);
    this.#scene.add(scene);
    const box = new Box3().setFromObject(scene);
    const sphere = box.getBoundingSphere(new Sphere());
    this.cameraMan.setHome(new Vector3(sphere.center.x, 0.5, sphere.center.z), sphere.radius * 0.84);
    this.#ground.position.set(sphere.center.x, -0.02, sphere.center.z);
    this.#ground.scale.setScalar(sphere.radius * 2.2);
    this.#home = scene;
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
    this.#face = Face.of(scene);
    this.#scene.add(scene);
    this.#bodyRoot = scene;
    this.dirty = true;
  }

  /** Put what is in the hands on stage in place of what was; nothing where the glb is empty. */
  async setProps(glb: ArrayBuffer): Promise<void> {
    const loaded = glb.byteLength ? await new GLTFLoader().parseAsync(glb, "") : null;
    this.#props?.dispose();
    this.#props = loaded && new Props(loaded.scene, loaded.animations[0]);
    if (loaded) this.#scene.add(loaded.scene);
    this.#props?.seek(this.#time);
    this.dirty = true;
  }

  get hasHome(): boolean {
    return this.#home !== null;
  }

  get hasBody(): boolean {
    return this.#bodyRoot !== null;
  }

  /** Show a moment: the body's pose at a time in seconds. */
  pose(pose: Pose, time: number): void {
    this.#time = time;
    this.#props?.seek(time);
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

  /** Where the joints are in the window, CSS pixels from its left and top. */
  pixels(): Point2[] {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const { camera } = this.cameraMan;
    camera.updateMatrixWorld();
    return this.joints().map((joint) => {
      const { x, y } = new Vector3(...joint).project(camera);
      return [left + ((x + 1) / 2) * width, top + ((1 - y) / 2) * height];
    });
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
    this.#lighting.set(dark, tint);
    if (this.#cutaway) this.#cutaway.color = new Color(dark ? 0x8a958f : 0xb9c4bc);
    this.dirty = true;
  }

  resize(width: number, height: number): void {
    if (!width || !height) return;
    this.#renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2) * (this.#sharp ? 1 : this.#sharpness));
    this.#renderer.setSize(width, height);
    this.cameraMan.resize(width, height);
    // Another size empties the canvas, and it would be shown so until the next picture; before there is a home the
    // curtain is closed, and software would draw the empty stage for as long as the home is waited for.
    if (this.#home) this.#draw();
  }

  /** Draw if anything has changed; seconds since the last call. */
  render(seconds: number, playing: boolean): void {
    const step = Math.min(seconds, 0.1);
    this.cameraMan.update(step, this.#body, this.#heading, playing);
    const eye = this.cameraMan.camera.position;
    this.#chest.set(this.#body.x, this.#body.y + 0.15, this.#body.z);
    const pace = this.cameraMan.calm ? 1 : step;
    if (this.#cutaway?.update(eye, this.#chest, pace)) this.dirty = true;
    if (this.#fading?.update(eye, this.#body, pace)) this.dirty = true;
    if (this.#lighting.drift(this.cameraMan.calm ? Infinity : step)) this.dirty = true;
    if (this.#face?.update(playing ? step : 0, this.emotion, this.asleep, this.cameraMan.calm || !playing)) this.dirty = true;
    if (!this.dirty) {
      if (!playing) this.#refine(seconds);
      return;
    }
    this.#rest = 0;
    if (this.#sharp) this.#redraw(false);
    else this.#draw();
    this.#watch(seconds);
  }

  #draw(): void {
    this.pictures++;
    this.dirty = false;
    this.#lighting.aim(this.#chest);
    this.#renderer.render(this.#scene, this.cameraMan.camera);
  }

  /** A picture that stays has all its points, however long it takes. */
  #refine(seconds: number): void {
    if (this.#sharpness === 1 || this.#sharp || !this.#home) return;
    this.#rest += seconds;
    if (this.cameraMan.calm || this.#rest > RESTS) this.#redraw(true);
  }

  #redraw(sharp: boolean): void {
    this.#sharp = sharp;
    this.resize(this.canvas.clientWidth, this.canvas.clientHeight);
  }

  /** Fewer points where pictures take long, and fewer still where that did not help: software draws a few a second. */
  #watch(seconds: number): void {
    if (this.#sharpness <= COARSEST) return;
    this.#slow = seconds > LONG ? this.#slow + Math.max(0.04, seconds) : Math.max(this.#slow - 0.02, 0);
    if (this.#slow < 1) return;
    this.#slow = 0;
    this.#sharpness *= COARSER;
    this.#lighting.simplify();
    this.resize(this.canvas.clientWidth, this.canvas.clientHeight);
  }

  dispose(): void {
    this.cameraMan.controls.dispose();
    this.canvas.removeEventListener("webglcontextrestored", this.#stale);
    this.#scene.traverse((object) => {
      if (!isMesh(object)) return;
      object.geometry.dispose();
      for (const material of [object.material].flat()) material.dispose();
    });
    this.#lighting.dispose();
    this.#renderer.renderLists.dispose();
    this.canvas.remove();
    giveBack(this.#renderer);
  }
}
