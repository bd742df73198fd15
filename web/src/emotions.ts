/** The nine emotions; each has a colour. */

export const EMOTIONS = ["neutral", "happy", "angry", "hurried", "tired", "sad", "stressed", "drunk", "relaxed"] as const;

export type Emotion = (typeof EMOTIONS)[number];
