/** Fetches a story's frames piece by piece, in order, as far as they are made. */

import { ApiError, getMotion } from "./api";
import { readFrames, Track } from "./motion";

/** The first pieces are short so that the film begins soon. */
const FIRST = 240;
const PIECE = 1200;
const AGAIN_MS = 2000;

export class Reel {
  readonly track = new Track();
  readonly #id: string;
  readonly #grown: () => void;
  readonly #stop = new AbortController();
  #wanted = 0;
  #busy = false;

  /** `grown` is called whenever more frames can be played. */
  constructor(id: string, grown: () => void) {
    this.#id = id;
    this.#grown = grown;
  }

  /** Frames up to here exist; fetch those that are missing. */
  want(frames: number): void {
    this.#wanted = Math.max(this.#wanted, frames);
    if (!this.#busy) void this.#fetch();
  }

  stop(): void {
    this.#stop.abort();
  }

  #stopped(): boolean {
    return this.#stop.signal.aborted;
  }

  async #fetch(): Promise<void> {
    this.#busy = true;
    const { track } = this;
    while (track.ready < this.#wanted && !this.#stopped()) {
      const from = track.ready;
      const to = Math.min(from + (from === 0 ? FIRST : PIECE), this.#wanted);
      try {
        track.append(await readFrames(await getMotion(this.#id, from, to, this.#stop.signal), from));
        if (track.ready === from) break;
        this.#grown();
      } catch (error) {
        if (this.#stopped()) break;
        if (!(error instanceof ApiError) || !error.passing) throw error;
        await new Promise((resolve) => setTimeout(resolve, AGAIN_MS));
      }
    }
    this.#busy = false;
  }
}
