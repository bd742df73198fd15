/** The playhead: it moves with the clock, waits at the end of what is ready, and stops at the end of the story. */

export type PlayState = "paused" | "playing" | "waiting" | "ended";

export const SPEEDS = [0.5, 1, 2] as const;

export class Player {
  time = 0;
  speed = 1;
  #state: PlayState = "paused";
  #readyTime = 0;
  #complete = false;
  #listeners = new Set<() => void>();

  get state(): PlayState {
    return this.#state;
  }

  /** Playing, or about to play when more is ready. */
  get running(): boolean {
    return this.#state === "playing" || this.#state === "waiting";
  }

  /** Told when the state, the speed or the place was changed by other than time going by. */
  onChange(listener: () => void): void {
    this.#listeners.add(listener);
  }

  /** Say how many seconds can be played, and whether that is all there will be. */
  feed(readyTime: number, complete: boolean): void {
    this.#readyTime = readyTime;
    this.#complete = complete;
    if (this.#state === "waiting" && this.time < readyTime) this.#set("playing");
    else if (this.#state === "waiting" && complete) this.#set("ended");
    else if (this.#state === "ended" && !complete) this.#set("paused");
  }

  play(): void {
    if (this.#state === "ended" || (this.#complete && this.time >= this.#readyTime)) this.time = 0;
    this.#set(this.time < this.#readyTime ? "playing" : "waiting");
  }

  pause(): void {
    this.#set("paused");
  }

  toggle(): void {
    if (this.running) this.pause();
    else this.play();
  }

  /** Go to a time in seconds; beyond what is ready, to its end. */
  seek(time: number): void {
    this.time = Math.min(Math.max(time, 0), this.#readyTime);
    const atEnd = this.#complete && this.time >= this.#readyTime;
    if (this.running || this.#state === "ended") this.#set(atEnd ? "ended" : this.running ? "playing" : "paused");
    else this.#tell();
  }

  setSpeed(speed: number): void {
    this.speed = speed;
    this.#tell();
  }

  /** Let seconds go by. */
  advance(seconds: number): void {
    if (this.#state !== "playing") return;
    this.time += seconds * this.speed;
    if (this.time < this.#readyTime) return;
    this.time = this.#readyTime;
    this.#set(this.#complete ? "ended" : "waiting");
  }

  #set(state: PlayState): void {
    this.#state = state;
    this.#tell();
  }

  #tell(): void {
    for (const listener of this.#listeners) listener();
  }
}
