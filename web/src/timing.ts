/** Where keyframes lie on the time line. */

export interface Timed {
  /** First frame and stop frame; null until it is made. */
  readonly start: number | null;
  readonly end: number | null;
}

export interface Block {
  /** Share of the line before the block and share it takes, 0 to 1. */
  readonly left: number;
  readonly width: number;
  readonly made: boolean;
}

/** One block a keyframe: as wide as its frames; those not made yet share what is left, each as wide as the mean of the others. */
export function blocks(keyframes: readonly Timed[]): Block[] {
  const lengths = keyframes.map((k) => (k.start === null || k.end === null ? null : Math.max(k.end - k.start, 1)));
  const known = lengths.filter((length) => length !== null);
  const mean = known.length ? known.reduce((a, b) => a + b, 0) / known.length : 1;
  const total = lengths.reduce<number>((sum, length) => sum + (length ?? mean), 0) || 1;
  let left = 0;
  return lengths.map((length) => {
    const width = (length ?? mean) / total;
    const block = { left, width, made: length !== null };
    left += width;
    return block;
  });
}

/** Place of a frame on the line, 0 to 1. */
export function placeOf(keyframes: readonly Timed[], laid: readonly Block[], frame: number): number {
  const index = keyframeAt(keyframes, frame);
  const keyframe = index === null ? undefined : keyframes[index];
  const block = index === null ? undefined : laid[index];
  if (!keyframe || !block || keyframe.start === null || keyframe.end === null) return 0;
  const share = (frame - keyframe.start) / Math.max(keyframe.end - keyframe.start, 1);
  return block.left + block.width * Math.min(Math.max(share, 0), 1);
}

/** The keyframe that is acted at a frame; the last made one beyond the end; null before any is made. */
export function keyframeAt(keyframes: readonly Timed[], frame: number): number | null {
  let found: number | null = null;
  for (const [index, keyframe] of keyframes.entries()) {
    if (keyframe.start !== null && keyframe.start <= frame) found = index;
  }
  return found ?? (keyframes[0]?.start === undefined || keyframes[0].start === null ? null : 0);
}

/** Minutes and seconds, "2:07". */
export function clock(seconds: number): string {
  const whole = Math.max(Math.floor(seconds + 1e-6), 0);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}
