/** Two films in step: each new moment of both begins together, and the one that is there first waits. */

/** A film's playhead and where its moments begin. */
export interface Stepping {
  /** Seconds. */
  readonly time: number;
  /** Seconds that can be played. */
  readonly ready: number;
  readonly ended: boolean;
  /** Playing, or about to. */
  readonly running: boolean;
  /** How often it was sent to another place. */
  readonly seeks: number;
  seek(time: number): void;
  play(): void;
  /** Where it waits, seconds. */
  bar(time: number): void;
  /** Seconds at which a keyframe begins; null while that is not known, Infinity where it never will be. */
  startOf(keyframe: number): number | null;
}

/** What a start may be off by the count of frames, seconds. */
const NEAR = 1e-6;

export class InStep {
  readonly #films: readonly [Stepping, Stepping];
  #moments: readonly (readonly [number, number])[] = [];
  #seeks: readonly [number, number];

  constructor(films: readonly [Stepping, Stepping]) {
    this.#films = films;
    this.#seeks = [films[0].seeks, films[1].seeks];
    for (const film of films) film.bar(0);
  }

  /** The keyframes that belong together. */
  pair(moments: readonly (readonly [number, number])[]): void {
    this.#moments = moments;
  }

  /** Whether both can begin with a moment. */
  reaches(moment: number): boolean {
    return this.#films.every((film, side) => (this.#start(side, moment) ?? Infinity) < film.ready);
  }

  /** Neither waits for the other any more. */
  release(): void {
    for (const film of this.#films) film.bar(Infinity);
  }

  /** Both at the beginning of a moment. */
  seek(moment: number): void {
    for (const [side, film] of this.#films.entries()) film.seek(Math.min(this.#start(side, moment) ?? 0, 1e6));
    this.#seeks = [this.#films[0].seeks, this.#films[1].seeks];
    this.tick();
  }

  /** Bring along the one that was left where the other was sent elsewhere, and let both go as far as both may. */
  tick(): void {
    const [one, other] = this.#films;
    const sent = [one.seeks !== this.#seeks[0], other.seeks !== this.#seeks[1]] as const;
    if (sent[0] || sent[1]) this.#follow(sent[0] ? 0 : 1, sent[0] && sent[1]);
    this.#seeks = [one.seeks, other.seeks];
    const over = one.ended || other.ended;
    const next = Math.min(this.#momentOf(0), this.#momentOf(1)) + 1;
    for (const [side, film] of this.#films.entries()) film.bar(over ? Infinity : (this.#start(side, next) ?? Infinity));
  }

  /** The moment that a film is at, among those of both; -1 before the first. */
  #momentOf(side: number): number {
    const { time } = this.#films[side]!;
    return this.#moments.findLastIndex((_, moment) => (this.#start(side, moment) ?? Infinity) <= time + NEAR);
  }

  #start(side: number, moment: number): number | null {
    const keyframe = this.#moments[moment]?.[side];
    return keyframe === undefined ? Infinity : this.#films[side]!.startOf(keyframe);
  }

  /** The other goes where this one was sent: as far into the same moment, and no farther. `both`: unless it is there. */
  #follow(side: 0 | 1, both: boolean): void {
    const film = this.#films[side];
    const moment = this.#momentOf(side);
    const along = side === 0 ? 1 : 0;
    if (both && this.#momentOf(along) === moment) return;
    const [from, to, end] = [this.#start(side, moment), this.#start(along, moment), this.#start(along, moment + 1)];
    const left = this.#films[along];
    const was = left.ended;
    left.seek(moment < 0 || to === null ? 0 : Math.min(to + film.time - (from ?? 0), (end ?? Infinity) - 2 * NEAR));
    if (was && film.running && !left.running) left.play();
  }
}
