/** How well the story was acted, in plain words, and honest labels of what made it. */

import type { Beat, Keyframe, KeyframeFigures, Report, Skill, Story } from "./api";
import { fill, h } from "./dom";
import { placeWords } from "./furniture-words";
import { moverList, type Phase } from "./movers";
import { badge, isOtherwise, lacking, legend, otherwiseWords, outcomeOf } from "./outcomes";
import { beatsWords, capital, centimetres, count, isAsked, percent, SKILL_WORDS } from "./words";

/** From these on a moment is worth a remark, metres. */
const WIDE_CONTACT = 0.03;
const DEEP = 0.08;

/** Who planned it: rules are not called a language model. */
export function plannerWords(planner: string | null): string {
  if (planner === null || planner === "given") return "The keyframes were given; nothing was planned.";
  if (planner === "rules") return "Planned without a language model: by rules, and by a classifier where the sentence encoder is installed.";
  return `Planned by a language model, ${planner.replace(/^llm:/, "")}.`;
}

export function encoderWords(encoder: string | null): string {
  if (!encoder) return "No short scripts were looked up.";
  if (encoder === "hashing") return "Scripts found by their words (hashing), the stand-in where no sentence encoder is.";
  return `Scripts found by meaning with the sentence encoder ${encoder}. It and the classifier of clauses are all that is learned in planning.`;
}

/** A story's figures, each with what it counts. */
export function figureList({ motion, screen_time_not_acted: other }: Report): HTMLElement {
  const figures: [string, string][] = [
    ...(other === null ? [] : ([[percent(other), "of the film shows nothing that the theme asked for"]] as [string, string][])),
    [`${motion.reached} of ${motion.keyframes}`, "moments reached their goal"],
    ...(motion.contact_error === null ? [] : ([[centimetres(motion.contact_error), "from where hands, seat and back should touch, on average"]] as [string, string][])),
    [centimetres(motion.pen_mean), `inside furniture on average; ${percent(motion.pen_share)} of the frames touch any`],
    ...(motion.slip === null ? [] : ([[`${motion.slip.toFixed(1)} cm/s`, "standing feet slip; people's about 3"]] as [string, string][])),
    [`${Math.round(motion.seconds)} s`, "of motion at 30 frames a second"],
  ];
  return h("dl", { class: "figures" }, ...figures.flatMap(([value, words]) => [h("dt", {}, value), h("dd", {}, words)]));
}

/** How many limits are kept, and in everyday words which are not; null for a story of an earlier version. */
export function limitList({ limits = [] }: Pick<Report, "limits">): HTMLElement | null {
  const missed = limits.filter(({ kept, words }) => !kept && words);
  if (!limits.length || missed.length < limits.filter(({ kept }) => !kept).length) return null;
  const kept = h("p", { class: "fine" }, `${missed.length ? limits.length - missed.length : "All"} ${missed.length ? "of " : ""}${limits.length} limits of how well it moves are kept.`);
  if (!missed.length) return h("div", { class: "limits" }, kept);
  kept.append(" Those that are missed are no errors; the story is whole. What each figure counts is told in docs/metrics.md of the project.");
  return h("div", { class: "limits" }, kept, h("ul", { class: "remarks" }, ...missed.map(({ figure, words }) => h("li", {}, `${capital(words ?? figure)} `, h("code", {}, figure)))));
}

/** Fill a section with a story's report; false while there is none. */
export function showReport(section: HTMLElement, story: Story, seek: (keyframe: number) => void): boolean {
  const { report } = story;
  if (!report) return false;
  const remarks = [...report.keyframes.flatMap((figure) => remark(figure, story.keyframes[figure.keyframe], seek)), ...story.beats.flatMap((beat, index) => stoodFor(beat, index, story, seek))];
  fill(
    section,
    h("h2", {}, "How well it went"),
    story.beats.length ? h("p", { class: "acted" }, h("b", {}, beatsWords(story.beats))) : null,
    story.beats.length ? h("ul", { class: "outcomes", "aria-label": "What became of the beats of your theme" }, ...story.beats.map(became)) : null,
    legend(story.beats, report.keyframes),
    figureList(report),
    limitList(report),
    remarks.length ? h("ul", { class: "remarks" }, ...remarks) : null,
    standing(story, remarks.length === 0),
    h("ul", { class: "labels" }, h("li", {}, plannerWords(report.planner)), h("li", {}, encoderWords(report.encoder))),
    h("h3", {}, "What moved the body"),
    moverList(phasesOf(report), report.moved_by),
  );
  return true;
}

/** All that the film is made of, piece after piece; stories made by earlier versions have none. */
export const phasesOf = (report: Report): Phase[] => report.keyframes.flatMap(({ phases }) => phases ?? []);

/** What stands out besides single moments, in a sentence; null where nothing does. */
export function standsOut(beats: readonly Beat[], limits: readonly { readonly kept: boolean }[] = []): string | null {
  const missing = beats.filter((beat) => isAsked(beat) && outcomeOf(beat) === "missing").length;
  const partly = beats.filter((beat) => beat.acted && lacking(beat)).length;
  const missed = limits.filter(({ kept }) => !kept).length;
  const told = [
    ...(missing ? [`${count(missing, "beat")} of your theme ${missing === 1 ? "is" : "are"} not acted`] : []),
    ...(partly ? [`something of ${count(partly, "beat")} is not shown`] : []),
    ...(missed ? [`${count(missed, "limit")} of how well it moves ${missed === 1 ? "is" : "are"} missed`] : []),
  ];
  return told.length ? `What stands out, as told above: ${told.join("; ")}.` : null;
}

/** Whether nothing at all stands out is said only where it is so. */
function standing({ beats, report }: Story, quiet: boolean): HTMLElement | null {
  const words = standsOut(beats, report?.limits) ?? (quiet ? "Nothing stands out: every moment came out as it was meant to." : null);
  return words === null ? null : h("p", { class: "fine" }, words);
}

/** Where something is seen that only stands for a beat. */
function stoodFor(beat: Beat, index: number, { keyframes }: Story, seek: (keyframe: number) => void): HTMLElement[] {
  if (outcomeOf(beat) !== "stands") return [];
  const shown = keyframes.filter((keyframe) => keyframe.beat === index || keyframe.also.includes(index));
  const links = shown.flatMap((keyframe, place) => [place ? ", " : "", momentLink(keyframe.index, keyframe.skill, keyframe, seek)]);
  return [h("li", {}, badge("stands"), " ", ...links, ` – ${links.length ? "" : "something "}only stands for “${beat.text}”.`)];
}

function momentLink(index: number, skill: Skill, keyframe: Keyframe | undefined, seek: (keyframe: number) => void): HTMLElement {
  const place = keyframe ? ` at the ${placeWords(keyframe)}` : "";
  return h("button", { type: "button", class: "link", onclick: () => seek(index) }, `Moment ${index + 1}, ${SKILL_WORDS[skill]}${place}`);
}

function became(beat: Beat): HTMLElement {
  const lacks = lacking(beat);
  return h("li", {}, badge(outcomeOf(beat)), h("span", {}, `“${beat.text}”`, lacks ? h("small", {}, ` ${lacks}`) : null));
}

function remark(figure: KeyframeFigures, keyframe: Keyframe | undefined, seek: (keyframe: number) => void): HTMLElement[] {
  const said: string[] = [];
  if (!figure.reached) said.push(`not reached${figure.reason ? `: ${figure.reason}` : ""}`);
  if (figure.contact_error !== null && figure.contact_error > WIDE_CONTACT) said.push(`${centimetres(figure.contact_error)} from its place`);
  if (figure.pen_max > DEEP) said.push(`up to ${centimetres(figure.pen_max)} inside furniture`);
  said.push(...otherwiseWords(figure));
  if (!said.length) return [];
  const go = momentLink(figure.keyframe, figure.skill, keyframe, seek);
  return [h("li", {}, ...(isOtherwise(figure) ? [badge("otherwise"), " "] : []), go, ` – ${said.join(", ")}.`)];
}
