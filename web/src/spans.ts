/** Which words of the told story tell which keyframe. */

export interface Span {
  /** Character offsets into the text; `end` is exclusive. */
  readonly start: number;
  readonly end: number;
  readonly keyframes: readonly number[];
}

/** Letters of the text that tell what the body is not seen doing. */
export interface Letters {
  readonly start: number;
  readonly end: number;
}

export interface Piece {
  readonly text: string;
  /** Whether the body is not seen doing it. */
  readonly thought: boolean;
  /** Index of its span; null for words that tell no keyframe. */
  readonly span: number | null;
}

/** Index of the span that tells a keyframe, or else of the last one before it; null if there is none. */
export function spanOf(spans: readonly Span[], keyframe: number): number | null {
  let best: number | null = null;
  let nearest = -1;
  for (const [index, span] of spans.entries()) {
    for (const told of span.keyframes) {
      if (told <= keyframe && told > nearest) {
        nearest = told;
        best = index;
      }
    }
  }
  return best;
}

/**
 * The text's paragraphs, each cut where spans and thoughts begin and end. Spans that are out of bounds or overlap are left
 * out.
 */
export function paragraphs(text: string, spans: readonly Span[], thoughts: readonly Letters[] = []): Piece[][] {
  const points = offsets(text);
  const ordered = spans.map((span, index) => ({ span, index })).sort((a, b) => a.span.start - b.span.start);
  const result: Piece[][] = [[]];
  const bounds = thoughts.flatMap(({ start, end }) => [start, end]).sort((a, b) => a - b);
  const put = (from: number, to: number, span: number | null): void => {
    const inside = bounds.find((bound) => bound > from && bound < Math.min(to, text.length));
    if (inside !== undefined) {
      put(from, inside, span);
      put(inside, to, span);
      return;
    }
    const thought = thoughts.some(({ start, end }) => start <= from && from < end);
    const parts = text.slice(points(from), points(to)).split(/\n\s*\n/);
    for (const [number, part] of parts.entries()) {
      if (number > 0) result.push([]);
      if (part) result.at(-1)?.push({ text: part, thought, span });
    }
  };
  let at = 0;
  for (const { span, index } of ordered) {
    if (span.start < at || span.end <= span.start || points(span.end) > text.length) continue;
    put(at, span.start, null);
    put(span.start, span.end, index);
    at = span.end;
  }
  put(at, Number.POSITIVE_INFINITY, null);
  return result.filter((pieces) => pieces.some((piece) => piece.text.trim()));
}

/** The service counts characters, JavaScript counts UTF-16 units: the two differ beyond the basic plane. */
function offsets(text: string): (character: number) => number {
  if (!/[\ud800-\udfff]/.test(text)) return (character) => (Number.isFinite(character) ? character : text.length);
  const units: number[] = [];
  let unit = 0;
  for (const character of text) {
    units.push(unit);
    unit += character.length;
  }
  units.push(unit);
  return (character) => units[character] ?? (Number.isFinite(character) ? text.length + 1 : text.length);
}
