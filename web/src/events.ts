/** Follows a story while it is being made: server-sent events, and looking from time to time where those are cut off. */

import { eventsUrl, type Stage } from "./api";

/** One action's motion that can be had now. */
export interface Segment {
  readonly index: number;
  readonly keyframe: number;
  readonly start: number;
  readonly end: number;
  readonly reached: boolean;
  readonly progress: number;
}

export interface Heard {
  stage(stage: Stage, progress: number): void;
  progress(stage: Stage, progress: number): void;
  segment(segment: Segment): void;
  /** The story succeeded, failed or was cancelled. */
  ended(): void;
  /** The stream is broken (true) or runs again (false). */
  broken(broken: boolean): void;
}

interface At {
  readonly stage: Stage;
  readonly progress: number;
}

/** What comes with each event. */
interface Said {
  readonly stage: At;
  readonly progress: At;
  readonly segment: Segment;
  readonly done: unknown;
  readonly failed: unknown;
  readonly cancelled: unknown;
}

const AGAIN_MS = 3000;

/** Listen until the story ends; the answer stops listening. */
export function follow(id: string, heard: Heard): () => void {
  let source: EventSource | null = null;
  let timer = 0;

  const on = <Name extends keyof Said>(name: Name, act: (data: Said[Name]) => void): void => {
    source?.addEventListener(name, (event) => act(JSON.parse((event as MessageEvent<string>).data) as Said[Name]));
  };
  const stop = (): void => {
    window.clearTimeout(timer);
    source?.close();
    source = null;
  };
  const open = (): void => {
    source = new EventSource(eventsUrl(id));
    source.onopen = () => heard.broken(false);
    on("stage", ({ stage, progress }) => heard.stage(stage, progress));
    on("progress", ({ stage, progress }) => heard.progress(stage, progress));
    on("segment", (segment) => heard.segment(segment));
    for (const end of ["done", "failed", "cancelled"] as const) {
      on(end, () => {
        // The browser would reconnect to a stream that has said all.
        stop();
        heard.ended();
      });
    }
    source.onerror = () => {
      heard.broken(true);
      // After an answer such as 503 the browser gives up; we do not.
      if (source?.readyState === EventSource.CLOSED) timer = window.setTimeout(open, AGAIN_MS);
    };
  };
  open();
  return stop;
}
