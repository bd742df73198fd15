/** The film: stage, curtain, subtitle, plan and controls, kept in time by one clock. */

import { getGlb, getHome, motionUrl, propsUrl, sceneUrl, type Keyframe, type Point2, type Skill, type Story } from "./api";
import { color, isDark, isStill, onAppearance } from "./appearance";
import type { CameraMode } from "./camera";
import { Controls } from "./controls";
import { fill, h } from "./dom";
import { roomNames } from "./furniture-words";
import { listenKeys, showHelp } from "./keyboard";
import { MiniMap } from "./minimap";
import { Player } from "./player";
import { emptyPose, jointPositions, type Point3 } from "./pose";
import { Reel } from "./reel";
import { settledAt } from "./settling";
import type { Stage } from "./stage";
import { Timeline } from "./timeline";
import { keyframeAt } from "./timing";
import { BEGUN_WORDS, sideOf } from "./words";

const FPS = 30;
/** What a film waits for: what is not made yet, or the film beside it. */
const MADE = "The next moment is being made …";
const HELD = "Waits for the other film …";
/** From where each skill is seen best, radians from straight ahead: what is touched stands in front of the body. */
const ASIDE: Readonly<Record<Skill, number>> = { touch: 2, loco: 0.85, sitdown: 0.7, standup: 0.7, getup: 0.7, liedown: 0.7 };

export class Film {
  readonly element = h("section", { class: "theatre", "aria-label": "Film" });
  readonly player = new Player();
  reel: Reel;
  readonly timeline: Timeline;
  readonly controls: Controls;
  keyframe: number | null = null;
  #id: string;
  #shown: (keyframe: number | null) => void;
  readonly #map = new MiniMap();
  readonly #holder = h("div", { class: "picture", tabindex: 0, role: "img", "aria-label": "The film. A, D, W and S turn the camera" });
  readonly #subtitle = h("p", { class: "subtitle", hidden: true });
  readonly #curtain = h("div", { class: "curtain" }, h("i", {}), h("i", {}));
  readonly #wait = h("p", { class: "waiting", hidden: true }, MADE);
  readonly #notice = h("div", { class: "notice", hidden: true });
  readonly #arch: HTMLElement;
  readonly #pose = emptyPose();
  readonly #ends: (() => void)[] = [];
  #stage: Stage | null = null;
  #raised: Promise<Stage | null>;
  #story: Story | null = null;
  #mode: CameraMode = isStill() ? "orbit" : "follow";
  #asked = { home: false, body: false, doors: false };
  /** For how many frames the props on the stage are, and whether more are on their way. */
  #props = { frames: 0, coming: false };
  #opened = false;
  #last = 0;
  #drawn = -1;
  /** The frame from which on what a keyframe is about is seen, by its index. */
  readonly #settled = new Map<number, number>();
  #seen = false;
  #visible = true;
  /** The keyframe that it begins with, until it has begun. */
  #from: number | null;
  /** Who the body on the stage is. */
  #cast = "";

  /** `shown` is told when another keyframe is being acted; the film begins with `from`, or at its beginning. */
  constructor(id: string, shown: (keyframe: number | null) => void, from: number | null = null) {
    this.#id = id;
    this.#from = from;
    this.#shown = shown;
    this.reel = new Reel(id, () => this.#feed());
    this.timeline = new Timeline((frame) => this.player.seek(frame / FPS), (keyframe) => this.seekKeyframe(keyframe), FPS);
    this.controls = new Controls({ ...this.#moves(), full: () => this.#full() });
    this.#arch = h("div", { class: "arch closed" }, this.#holder, h("div", { class: "plan" }, this.#map.element), this.#wait, this.#subtitle, this.#curtain, this.#notice);
    fill(this.element, this.#arch, this.controls.element, this.timeline.element);
    this.player.onChange(() => this.#showState());
    this.controls.showMode(this.#mode);
    this.#ends.push(listenKeys(this.#moves()), onAppearance(() => this.#mood()));
    const sight = new IntersectionObserver(([entry]) => (this.#visible = entry?.isIntersecting ?? true));
    sight.observe(this.#arch);
    this.#ends.push(() => sight.disconnect());
    this.#showState();
    this.#loop(performance.now());
    // The stage takes a moment to build, and is wanted as soon as there is something to show.
    this.#raised = this.#raise();
  }

  /** The stage as it stands for another take of the story, in the same home; it goes on with the keyframe `from`. */
  retake(id: string, shown: (keyframe: number | null) => void, from: number | null): void {
    this.reel.stop();
    this.player.pause();
    [this.#id, this.#shown, this.#from] = [id, shown, from];
    this.reel = new Reel(id, () => this.#feed());
    if (from === null) this.player.seek(0);
    this.#story = this.keyframe = null;
    this.#opened = false;
    this.#drawn = -1;
    this.#props = { frames: 0, coming: false };
    void this.#stage?.setProps(new ArrayBuffer(0));
    this.#settled.clear();
    this.notice();
    this.#wait.hidden = false;
    this.#holder.focus({ preventScroll: true });
  }

  /** What buttons and keys ask for. */
  #moves() {
    return {
      toggle: () => this.player.toggle(),
      skip: (by: number) => this.player.seek(this.player.time + by),
      step: (by: -1 | 1) => this.seekKeyframe(this.#neighbour(by)),
      start: () => this.player.seek(0),
      end: () => this.player.seek(Infinity),
      speed: (speed: number) => this.player.setSpeed(speed),
      camera: (mode: CameraMode) => this.#setMode(mode),
      follow: () => this.#setMode(this.#mode === "follow" ? "orbit" : "follow"),
      map: () => this.controls.showMap(!this.#arch.classList.toggle("without-plan")),
      help: () => showHelp(),
      turn: (around: number, up: number, zoom: number) => this.#stage?.cameraMan.turn(around, up, zoom),
    };
  }

  /** Take in what is known of the story, and fetch what can be had. */
  update(story: Story): void {
    this.#story = story;
    this.timeline.update(story.keyframes);
    if (story.motion.frames > 0) this.reel.want(story.motion.frames);
    if (story.home && story.stage !== "plan" && story.stage !== "furnish") void this.#fetchHome();
    if (story.motion.frames > 0) void this.#fetchBody();
    void this.#fetchProps();
    this.#feed();
  }

  /** Go to where a keyframe begins, if it is made. */
  seekKeyframe(keyframe: number): void {
    const start = this.#story?.keyframes[keyframe]?.start;
    if (start === null || start === undefined) return;
    this.player.seek(start / FPS);
    this.#tick();
    this.#stage?.cut();
  }

  /** How many pictures were drawn. */
  get pictures(): number {
    return this.#stage?.pictures ?? 0;
  }

  /** World positions of the joints, as drawn; from the skeleton alone where nothing is drawn. */
  joints(): Point3[] {
    if (this.#stage?.hasBody) return this.#stage.joints();
    const { skeleton, ready } = this.reel.track;
    return skeleton && ready ? jointPositions(skeleton, this.#pose) : [];
  }

  /** The joints in the window, CSS pixels; empty where nothing is drawn. */
  pixels(): Point2[] {
    return this.#stage?.hasBody ? this.#stage.pixels() : [];
  }

  get camera(): { mode: CameraMode; position: Point3 | null } {
    return { mode: this.#mode, position: this.#stage?.cameraMan.camera.position.toArray() ?? null };
  }

  /** Say something on the closed stage. */
  notice(...content: (Node | string)[]): void {
    fill(this.#notice, ...content);
    this.#notice.hidden = content.length === 0;
    this.element.classList.toggle("empty", content.length > 0);
  }

  dispose(): void {
    this.#last = -1;
    this.reel.stop();
    this.#map.dispose();
    for (const end of this.#ends) end();
    this.#stage?.dispose();
  }

  /** Load three.js and build the stage; null without WebGL, or when nobody looks any more. */
  async #raise(): Promise<Stage | null> {
    try {
      const { Stage } = await import("./stage");
      if (this.#last < 0) return null;
      this.#stage = new Stage(this.#holder);
    } catch (error) {
      this.#withoutPicture(error);
      return null;
    }
    const watch = new ResizeObserver(() => this.#stage?.resize(this.#holder.clientWidth, this.#holder.clientHeight));
    watch.observe(this.#holder);
    this.#ends.push(() => watch.disconnect());
    // Scrolling the page must not zoom the film by accident.
    this.#holder.addEventListener("wheel", (event) => {
      if (this.#stage) this.#stage.cameraMan.controls.enableZoom = event.ctrlKey || this.#holder.contains(document.activeElement);
    }, { capture: true, passive: true });
    this.#holder.addEventListener("pointerdown", () => this.#holder.focus({ preventScroll: true }));
    this.#mood();
    return this.#stage;
  }

  /** The plan takes the stage where three dimensions cannot be drawn. */
  #withoutPicture(error: unknown): void {
    console.warn("The film cannot be drawn:", error);
    this.#arch.classList.add("flat");
    this.#arch.classList.remove("without-plan");
    this.controls.hideCameras();
    this.#holder.removeAttribute("tabindex");
    this.#holder.setAttribute("aria-label", "No film: this browser draws no WebGL");
    fill(this.#holder, h("p", { class: "no-webgl" }, "This browser cannot draw the film (it has no WebGL), so here is the plan. Everything else works, and the film can be downloaded below."));
  }

  async #fetchHome(): Promise<void> {
    if (this.#asked.home) return;
    this.#asked.home = true;
    try {
      const home = await getHome(this.#id);
      this.#map.setHome(home, roomNames(this.#story));
      const glb = getGlb(sceneUrl(this.#id));
      await (await this.#raised)?.setHome(await glb, home);
      this.#mood();
    } catch (error) {
      this.#asked.home = false;
      console.warn("The home cannot be shown yet:", error);
    }
  }

  async #fetchBody(): Promise<void> {
    const cast = JSON.stringify(this.#story?.character);
    if (this.#asked.body && cast === this.#cast) return;
    this.#asked.body = true;
    this.#cast = cast;
    try {
      const glb = await getGlb(motionUrl(this.#id, "glb", 0, 1));
      await (await this.#raised)?.setBody(glb);
    } catch (error) {
      this.#asked.body = false;
      console.warn("The body cannot be shown yet:", error);
    }
  }

  /** What is in the hands in the frames there are by now; fetched again as they become more. */
  async #fetchProps(): Promise<void> {
    const [id, props, frames] = [this.#id, this.#props, this.#story?.motion.frames ?? 0];
    if (props.coming || frames <= props.frames) return;
    props.coming = true;
    try {
      const glb = await getGlb(propsUrl(id));
      const stage = await this.#raised;
      if (props === this.#props) await stage?.setProps(glb);
      this.#withoutDoors(glb);
      props.frames = frames;
    } catch (error) {
      console.warn("What is in the hands cannot be shown yet:", error);
      return;
    } finally {
      props.coming = false;
    }
    if (props === this.#props) void this.#fetchProps();
  }

  /** A home that came before it was known what moves in it comes anew: its doors are among what moves. */
  #withoutDoors(props: ArrayBuffer): void {
    if (!props.byteLength || this.#asked.doors) return;
    this.#asked = { ...this.#asked, home: false, doors: true };
    void this.#fetchHome();
  }

  /** Tell the player how far the film goes by now. */
  #feed(): void {
    const { track } = this.reel;
    const story = this.#story;
    const over = story !== null && (story.motion.complete || !["queued", "running"].includes(story.state));
    this.player.feed(track.readyTime, over && track.ready >= story.motion.frames);
  }

  #open(): void {
    const ready = this.reel.track.ready > 0 && (this.#arch.classList.contains("flat") || (this.#stage?.hasHome && this.#stage.hasBody));
    if (this.#opened || !ready || !this.#reaches()) return;
    this.#opened = true;
    if (this.#from !== null) this.player.seek((this.#startOf(this.#from) ?? 0) / FPS);
    this.#from = null;
    this.reel.track.sample(this.player.time, this.#pose);
    this.#stage?.pose(this.#pose, this.player.time);
    this.#tick();
    this.#stage?.setMode(this.#mode);
    this.#arch.classList.remove("closed");
    this.#showState();
    if (!isStill()) this.player.play();
  }

  /** Whether the moment that it begins with can be seen, or never will be. */
  #reaches(): boolean {
    if (this.#from === null) return true;
    const start = this.#startOf(this.#from);
    const { ready } = this.reel.track;
    return (start !== null && ready > start + 1) || (this.#over() && ready >= (this.#story?.motion.frames ?? 0));
  }

  /** Seconds at which a keyframe begins; null while that is not known, Infinity where it never will be. */
  beginOf(keyframe: number): number | null {
    const start = this.#story?.keyframes[keyframe]?.start ?? null;
    return start === null ? (this.#over() ? Infinity : null) : start / FPS;
  }

  /** Whether the curtain is up. */
  get opened(): boolean {
    return this.#opened;
  }

  /** The first frame of a keyframe, or of the last one where there are fewer by now. */
  #startOf(keyframe: number): number | null {
    const all = this.#story?.keyframes ?? [];
    return all[Math.min(keyframe, all.length - 1)]?.start ?? null;
  }

  #loop(now: number): void {
    if (this.#last < 0) return;
    const seconds = Math.min((now - this.#last) / 1000, 0.25);
    this.#last = now;
    this.#open();
    if (this.#opened) {
      this.player.advance(seconds);
      this.#tick();
      if (this.#stage) this.#stage.cameraMan.calm = isStill();
      if (this.#visible) this.#stage?.render(seconds, this.player.state === "playing");
    }
    requestAnimationFrame((time) => this.#loop(time));
  }

  /** Show the moment everywhere. */
  #tick(): void {
    const { track } = this.reel;
    const frame = this.player.time * FPS;
    this.controls.tick(this.player.time, track.readyTime, !this.#over());
    const keyframes = this.#story?.keyframes ?? [];
    const keyframe = keyframeAt(keyframes, frame + 1e-6);
    this.timeline.tick(frame, keyframe);
    if (frame === this.#drawn && keyframe === this.keyframe) return;
    this.#drawn = frame;
    track.sample(this.player.time, this.#pose);
    this.#stage?.pose(this.#pose, this.player.time);
    this.#map.tick(this.#pose, track, frame);
    const seen = keyframe !== null && frame >= this.#settledAt(keyframe, keyframes);
    if (seen !== this.#seen || keyframe !== this.keyframe) this.#showCard(keyframe === null ? undefined : keyframes[keyframe], seen);
    if (keyframe !== this.keyframe) this.#showKeyframe(keyframe, keyframes);
  }

  #over(): boolean {
    const story = this.#story;
    return story !== null && (story.motion.complete || !["queued", "running"].includes(story.state));
  }

  #settledAt(index: number, keyframes: readonly Keyframe[]): number {
    const { skill, start, end } = keyframes[index]!;
    if (start === null || end === null) return Infinity;
    const known = this.#settled.get(index) ?? settledAt(this.reel.track, skill, start, end);
    if (known < Infinity) this.#settled.set(index, known);
    return known;
  }

  /** What is being done; how it is done is not told before it is seen. */
  #showCard(keyframe: Keyframe | undefined, seen: boolean): void {
    this.#seen = seen;
    this.#subtitle.hidden = !keyframe;
    if (!keyframe) return;
    this.#subtitle.dataset["emotion"] = keyframe.mood;
    fill(this.#subtitle, h("small", {}, keyframe.emotion), h("span", {}, seen ? keyframe.caption : BEGUN_WORDS[keyframe.skill]));
  }

  #showKeyframe(index: number | null, keyframes: readonly Keyframe[]): void {
    this.keyframe = index;
    const keyframe = index === null ? undefined : keyframes[index];
    if (keyframe && this.#stage) {
      this.#stage.cameraMan.aside = ASIDE[keyframe.skill];
      this.#stage.cameraMan.side = sideOf(keyframe.caption);
    }
    this.#map.show(keyframe?.object_id ?? null);
    this.#mood();
    this.#shown(index);
  }

  #mood(): void {
    const emotion = this.keyframe === null ? "neutral" : (this.#story?.keyframes[this.keyframe]?.mood ?? "neutral");
    if (this.#stage) {
      this.#stage.emotion = emotion;
      this.#stage.asleep = this.keyframe !== null && (this.#story?.keyframes[this.keyframe]?.asleep ?? false);
    }
    this.#stage?.setMood({ dark: isDark(), around: color("--stage"), ground: color("--stage-floor"), tint: color(`--${emotion}`) });
  }

  #showState(): void {
    this.controls.update(this.player);
    this.#wait.textContent = this.player.held ? HELD : MADE;
    if (this.#opened || this.#arch.classList.contains("closed")) this.#wait.hidden = this.player.state !== "waiting" || !this.#opened;
  }

  #setMode(mode: CameraMode): void {
    this.#mode = mode;
    this.controls.showMode(mode);
    this.#stage?.setMode(mode);
  }

  #neighbour(by: -1 | 1): number {
    return (this.keyframe ?? 0) + by;
  }

  #full(): void {
    if (document.fullscreenElement) void document.exitFullscreen();
    // Not every browser can, a telephone's least of all.
    else if (document.fullscreenEnabled) void this.element.requestFullscreen();
  }
}
