/** The light on stage: sky, a sun with soft shadows, a spot on the body; by day and in the evening. */

import { Color, DirectionalLight, HemisphereLight, Scene, SpotLight, Vector3 } from "three";

/** Half the width of what throws shadows around the body, metres. */
const SHADOW_REACH = 4.2;
/** How much of a feeling's colour the sky takes on. */
const TINGE = 0.12;

export class Lighting {
  readonly #sky = new HemisphereLight(0xffffff, 0x8a8078, 1.5);
  readonly #sun = new DirectionalLight(0xfff1dc, 2);
  readonly #spot = new SpotLight(0xffe0b4, 1, 0, 0.5, 0.9, 0);
  readonly #skyColor = new Color();
  readonly #tint = new Color(1, 1, 1);
  readonly #goal = new Color(1, 1, 1);

  constructor(scene: Scene) {
    const { shadow } = this.#sun;
    this.#sun.castShadow = true;
    shadow.mapSize.set(1536, 1536);
    shadow.radius = 4;
    shadow.bias = -0.0004;
    shadow.normalBias = 0.02;
    Object.assign(shadow.camera, { left: -SHADOW_REACH, right: SHADOW_REACH, top: SHADOW_REACH, bottom: -SHADOW_REACH, near: 1, far: 16 });
    scene.add(this.#sky, this.#sun, this.#sun.target, this.#spot, this.#spot.target);
  }

  /** Day or evening, and the colour of a feeling that the light drifts towards. */
  set(dark: boolean, tint: string): void {
    this.#skyColor.set(dark ? 0xc3cde0 : 0xffffff);
    this.#sky.groundColor.set(dark ? 0x7d7068 : 0xd8cfc4);
    this.#sky.intensity = dark ? 1.6 : 2.75;
    this.#sun.color.set(dark ? 0xffdcb4 : 0xfff4e4);
    this.#sun.intensity = dark ? 1.1 : 1.6;
    this.#spot.intensity = dark ? 1.5 : 0;
    // A feeling gives the light a hue, not darkness.
    const { r, g, b } = this.#goal.set(tint);
    this.#goal.multiplyScalar(1 / Math.max(r, g, b, 0.01));
  }

  /** Let the colour drift; whether it still changes. */
  drift(seconds: number): boolean {
    const miss = Math.hypot(this.#tint.r - this.#goal.r, this.#tint.g - this.#goal.g, this.#tint.b - this.#goal.b);
    this.#tint.lerp(this.#goal, miss < 0.004 ? 1 : 1 - Math.exp(-1.5 * seconds));
    this.#sky.color.copy(this.#skyColor).lerp(this.#tint, TINGE);
    return miss >= 0.004;
  }

  /** Shine on the body. */
  aim({ x, y, z }: Vector3): void {
    this.#sun.target.position.set(x, 0.6, z);
    this.#sun.position.set(x + 2.6, 7.6, z + 3.2);
    this.#spot.target.position.set(x, y, z);
    this.#spot.position.set(x - 1.2, y + 5, z + 1.5);
  }

  /** Coarser shadows, where pictures take long. */
  simplify(): void {
    const { shadow } = this.#sun;
    shadow.mapSize.set(512, 512);
    shadow.map?.dispose();
    shadow.map = null;
  }

  dispose(): void {
    this.#sun.dispose();
    this.#spot.dispose();
  }
}
