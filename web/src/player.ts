/** The playhead: it moves with the clock, waits at the end of what is ready, and stops at the end of the story. */

export type PlayState = "paused" | "playing" | "waiting" | "ended";

export const SPEEDS = [0.5, 1, 2] as const;

export class Player {
  time = 0;
  speed = 1;
  #state: PlayState = "paused";
  #readyTime = 0;
  #complete = false;
  #bar = Infinity;
  #seeks = 0;
  #listeners = new Set<() => void>();

  get state(): PlayState {
    return this.#state;
  }

  /** Playing, or about to play when more is ready. */
  get running(): boolean {
    return this.#state === "playing" || this.#state === "waiting";
  }

  /** Waiting at a bar, though more is ready. */
  get held(): boolean {
    return this.#state === "waiting" && this.time < this.#readyTime;
  }

  /** How often it was sent to another place. */
  get seeks(): number {
    return this.#seeks;
  }

  /** Play no farther than to a time in seconds; who goes beyond waits there. */
  bar(time: number): void {
    this.#bar = time;
    if (this.#state === "waiting" && this.time < this.#end) this.#set("playing");
  }

  get #end(): number {
    return Math.min(this.#readyTime, this.#bar);
  }

  /** Told when the state, the speed or the place was changed by other than time going by. */
  onChange(listener: () => void): void {
    this.#listeners.add(listener);
  }

  /** Say how many seconds can be played, and whether that is all there will be. */
  feed(readyTime: number, complete: boolean): void {
    this.#readyTime = readyTime;
    this.#complete = complete;
    if (this.#state === "waiting" && this.time < this.#end) this.#set("playing");
    else if (this.#state === "waiting" && complete && this.time >= readyTime) this.#set("ended");
    else if (this.#state === "ended" && !complete) this.#set("paused");
  }

  play(): void {
    if (this.#state === "ended" || (this.#complete && this.time >= this.#readyTime)) {
      this.time = 0;
      this.#seeks++;
    }
    this.#set(this.time < this.#end ? "playing" : "waiting");
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
    this.#seeks++;
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
    const before = this.time;
    this.time += seconds * this.speed;
    if (this.time < this.#end) return;
    // Who was sent beyond the bar stays there.
    this.time = Math.max(this.#end, Math.min(before, this.#readyTime));
    this.#set(this.#complete && this.time >= this.#readyTime ? "ended" : "waiting");
  }

  #set(state: PlayState): void {
    this.#state = state;
    this.#tell();
  }

  #tell(): void {
    for (const listener of this.#listeners) listener();
  }
}
