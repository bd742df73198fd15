/** The nine emotions that have a colour, found in free text. */

export const EMOTIONS = ["neutral", "happy", "angry", "hurried", "tired", "sad", "stressed", "drunk", "relaxed"] as const;

export type Emotion = (typeof EMOTIONS)[number];

/** The first known emotion that a text such as "tired, sad" names; neutral if none. */
export function emotionOf(text: string): Emotion {
  const words = text.toLowerCase().match(/[a-z]+/g) ?? [];
  const known: readonly string[] = EMOTIONS;
  return (words.find((word) => known.includes(word)) as Emotion | undefined) ?? "neutral";
}
