/** Where the film is seen from: round the home, or along with the body. */

import { MathUtils, PerspectiveCamera, Spherical, Vector3 } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Lookout } from "./sight";

export type CameraMode = "follow" | "orbit";

/** Seconds after a hand on the camera before it turns by itself again. */
const REST = 8;
/** Radians a second at most. */
const FASTEST = 0.55;
const NEAR = 4.4;
/** The camera's angle from straight above, radians. */
const STEEP = 1.12;
/** Where the camera aims above 0.6 of the pelvis, metres: low, so that what is written below leaves the feet free. */
const GAZE = 0.2;
/** Seconds between looks for a better place, and how much better it must be. */
const LOOK_EVERY = 0.7;
const WORTH = 0.3;
/** What it counts to be on the side away from what is done. */
const FAR_SIDE = 0.5;
/** Radians added to the best angle where that is obstructed. */
const DETOURS = [0, 0.45, -0.45, 0.9, 1.4, 2];

export class CameraMan {
  readonly camera = new PerspectiveCamera(38, 1, 0.05, 200);
  readonly controls: OrbitControls;
  /** Whether the camera must not swing by itself. */
  calm = false;
  /** How far from straight ahead the body is seen, radians. */
  aside = 0.75;
  /** The side on which something is done: 1 its left, -1 its right, 0 neither. */
  side = 0;
  /** Knows what is in the way; without it nothing is. */
  lookout: Lookout | null = null;
  #mode: CameraMode = "orbit";
  #centre = new Vector3(0, 0.8, 0);
  #reach = 6;
  #touched = -Infinity;
  #speed = 0;
  /** The angle from the body's front that the camera makes for, and the seconds since that was considered. */
  #offset = 0.75;
  #considered = Infinity;
  #narrow = 1;
  #step = new Vector3();
  #orb = new Spherical();

  constructor(canvas: HTMLElement) {
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.minDistance = 1.2;
    this.controls.maxDistance = 30;
    this.controls.maxPolarAngle = MathUtils.degToRad(88);
    this.controls.enablePan = true;
    this.controls.addEventListener("start", () => this.touch());
    this.controls.addEventListener("change", () => this.touch(false));
  }

  get mode(): CameraMode {
    return this.#mode;
  }

  /** The home's middle and the radius around it. */
  setHome(centre: Vector3, radius: number): void {
    this.#centre.copy(centre);
    this.#reach = radius;
    if (this.#mode === "orbit") this.#overview();
  }

  /** Change what is looked at; the camera starts from a good place. */
  setMode(mode: CameraMode, body: Vector3, heading: number): void {
    this.#mode = mode;
    this.#touched = -Infinity;
    if (mode === "orbit") this.#overview();
    else this.#stand(body, heading + (this.#offset = this.#best(body, heading, heading, 0)));
  }

  /** Note that somebody moves the camera by hand. */
  touch(now = true): void {
    if (now) this.#touched = performance.now() / 1000;
  }

  /** Look from a good place at once, unless somebody has just chosen another. */
  cut(body: Vector3, heading: number): void {
    if (this.#mode !== "follow" || performance.now() / 1000 - this.#touched < REST) return;
    this.#orb.setFromVector3(this.#step.subVectors(this.camera.position, this.controls.target));
    this.#offset = this.#best(body, heading, this.#orb.theta, 0.05);
    if (Math.abs(angle(heading + this.#offset - this.#orb.theta)) > 0.5) this.#stand(body, heading + this.#offset);
  }

  resize(width: number, height: number): void {
    this.camera.aspect = width / height;
    // A narrow picture needs more distance for the same room.
    const narrow = Math.max(1, 1.25 / this.camera.aspect);
    if (narrow !== this.#narrow) {
      this.#step.subVectors(this.camera.position, this.controls.target).multiplyScalar(narrow / this.#narrow);
      this.camera.position.copy(this.controls.target).add(this.#step);
      this.#narrow = narrow;
    }
    this.camera.updateProjectionMatrix();
  }

  /** Turn by angles in radians and come nearer or go away by a factor. */
  turn(around: number, up: number, zoom: number): void {
    this.touch();
    this.#orb.setFromVector3(this.#step.subVectors(this.camera.position, this.controls.target));
    this.#orb.theta += around;
    this.#orb.phi = MathUtils.clamp(this.#orb.phi + up, 0.1, this.controls.maxPolarAngle);
    this.#orb.radius = MathUtils.clamp(this.#orb.radius * zoom, this.controls.minDistance, this.controls.maxDistance);
    this.camera.position.copy(this.controls.target).add(this.#step.setFromSpherical(this.#orb));
  }

  /** Let time go by; `playing` lets the camera swing round to where the body is seen best. */
  update(seconds: number, body: Vector3, heading: number, playing: boolean): void {
    if (this.#mode === "follow") this.#travel(seconds, body, heading, playing);
    this.controls.update(seconds);
  }

  #travel(seconds: number, body: Vector3, heading: number, playing: boolean): void {
    const target = this.controls.target;
    const goal = this.#step.set(body.x, GAZE + 0.6 * body.y, body.z);
    const jump = goal.distanceTo(target) > 2.5;
    goal.sub(target).multiplyScalar(jump ? 1 : 1 - Math.exp(-2.6 * seconds));
    target.add(goal);
    this.camera.position.add(goal);
    if (jump) this.cut(body, heading);
    if (this.calm || !playing || performance.now() / 1000 - this.#touched < REST) {
      this.#speed = 0;
      return;
    }
    this.#orb.setFromVector3(goal.subVectors(this.camera.position, target));
    if ((this.#considered += seconds) > LOOK_EVERY) this.#consider(body, heading);
    const wanted = MathUtils.clamp(angle(heading + this.#offset - this.#orb.theta) * 0.6, -FASTEST, FASTEST);
    this.#speed += (wanted - this.#speed) * (1 - Math.exp(-1.5 * seconds));
    this.#orb.theta += this.#speed * seconds;
    this.camera.position.copy(target).add(goal.setFromSpherical(this.#orb));
  }

  /** Make for another place if it is clearly better than the one made for. */
  #consider(body: Vector3, heading: number): void {
    this.#considered = 0;
    const best = this.#best(body, heading, this.#orb.theta, 0.15);
    const cost = (offset: number): number => this.#cost(body, heading, offset, this.#orb.theta, 0.15);
    if (cost(this.#offset) - cost(best) > WORTH) this.#offset = best;
  }

  /** The angle from the body's front at which it is seen best. */
  #best(body: Vector3, heading: number, from: number, effort: number): number {
    const offsets = DETOURS.flatMap((detour) => [this.aside + detour, -this.aside - detour]);
    const costs = offsets.map((offset) => this.#cost(body, heading, offset, from, effort));
    return offsets[costs.indexOf(Math.min(...costs))]!;
  }

  /** What is in the way there, how far that is from the best angle, and the effort of a radian's swing. */
  #cost(body: Vector3, heading: number, offset: number, from: number, effort: number): number {
    const around = heading + offset;
    const eye = this.#step.setFromSphericalCoords(NEAR * this.#narrow, STEEP, around);
    eye.add(body).setY(eye.y - 0.4 * body.y + GAZE);
    const hidden = this.lookout?.cost(eye.toArray(), body.toArray()) ?? 0;
    const behind = offset * this.side < 0 ? FAR_SIDE : 0;
    return hidden + behind + 0.35 * Math.abs(Math.abs(offset) - this.aside) + effort * Math.abs(angle(around - from));
  }

  #overview(): void {
    const away = this.#narrow * (this.#reach / Math.sin(MathUtils.degToRad(this.camera.fov / 2)));
    this.controls.target.copy(this.#centre);
    this.camera.position.setFromSphericalCoords(away * 0.92, 0.8, 0.62).add(this.#centre);
  }

  #stand(body: Vector3, around: number): void {
    this.controls.target.set(body.x, GAZE + 0.6 * body.y, body.z);
    this.camera.position.setFromSphericalCoords(NEAR * this.#narrow, STEEP, around).add(this.controls.target);
  }
}

/** The same angle within half a turn either way. */
function angle(radians: number): number {
  return Math.atan2(Math.sin(radians), Math.cos(radians));
}
