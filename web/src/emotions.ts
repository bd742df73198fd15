/** The nine emotions that have a colour, found in free text. */

export const EMOTIONS = ["neutral", "happy", "angry", "hurried", "tired", "sad", "stressed", "drunk", "relaxed"] as const;

export type Emotion = (typeof EMOTIONS)[number];

/** Words that mean one of the nine. */
const ALIKE: Readonly<Record<string, Emotion>> = {
  calm: "relaxed", content: "relaxed", peaceful: "relaxed",
  excited: "happy", joyful: "happy", cheerful: "happy", proud: "happy",
  depressed: "sad", lonely: "sad", grieving: "sad", disappointed: "sad",
  furious: "angry", annoyed: "angry", frustrated: "angry",
  anxious: "stressed", nervous: "stressed", worried: "stressed", scared: "stressed", afraid: "stressed",
  exhausted: "tired", sleepy: "tired", weary: "tired", sick: "tired",
  hasty: "hurried", rushed: "hurried", drunken: "drunk", tipsy: "drunk",
};

/** The first known emotion that a text such as "tired, sad" names; neutral if none. */
export function emotionOf(text: string): Emotion {
  const words = text.toLowerCase().match(/[a-z]+/g) ?? [];
  const known: readonly string[] = EMOTIONS;
  for (const word of words) {
    if (known.includes(word)) return word as Emotion;
    const alike = ALIKE[word];
    if (alike) return alike;
  }
  return "neutral";
}
