/** Links to everything of a story that can be taken along. */

import { filmUrl, motionUrl, sceneUrl, storyUrl, type Story } from "./api";
import { fill, h, icon } from "./dom";
import { filmItem } from "./filming";
import { usdItem } from "./usd";

interface File {
  readonly name: string;
  readonly url: string;
  readonly words: string;
  readonly there: boolean;
}

/** Fill a section with links to what there is; false while there is nothing. */
export function showDownloads(section: HTMLElement, story: Story): boolean {
  const { id, motion, home, state } = story;
  const moved = motion.frames > 0;
  const stem = (story.title ?? story.kind).toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "") || "story";
  const files: File[] = [
    { name: `${stem}.glb`, url: filmUrl(id), words: "the film: home and animated body, for Blender, three.js, any glTF viewer", there: state === "succeeded" },
    { name: `${stem}-scene.glb`, url: sceneUrl(id), words: "the home alone", there: home !== null },
    { name: `${stem}-body.glb`, url: motionUrl(id, "glb"), words: "the skinned body with its animation", there: moved },
    { name: `${stem}.bvh`, url: motionUrl(id, "bvh"), words: "the motion for animation tools", there: moved },
    { name: `${stem}.npz`, url: motionUrl(id, "npz"), words: "the motion exactly, for numpy", there: moved },
    { name: `${stem}-motion.json`, url: motionUrl(id, "json"), words: "the motion as text", there: moved },
    { name: `${stem}.json`, url: storyUrl(id), words: "the story: text, script, rooms, report", there: story.keyframes.length > 0 },
  ];
  const there = files.filter((file) => file.there);
  if (!there.length) return false;
  fill(
    section,
    h("h2", {}, "Download"),
    h("ul", { class: "files" }, ...(state === "succeeded" ? [filmItem(id, `${stem}.mp4`), usdItem(id, `${stem}.usd`)] : []), ...there.map((file) => h("li", {}, h("a", { href: file.url, download: file.name }, icon("down"), file.name), h("span", { class: "hint" }, file.words)))),
  );
  return true;
}
