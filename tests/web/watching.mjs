/** A theme is posted with the keyboard alone; its film begins while it is being made, the body moves, the text follows. */

import { around, compare, complaints, holding, overhang, scene, settle, shoot, state, until } from "./browser.mjs";

const [, , service, theme, worker] = process.argv;

/** Note how the story grows, change by change, and how it stood when the film began. */
function note() {
  const seen = { steps: [], cues: [], made: [], playing: null, lit: [] };
  const add = (list, value) => list.at(-1) === value || list.push(value);
  const read = () => {
    if (!window.sims.state().storyId) return;
    add(seen.steps, document.querySelector(".steps:not([hidden]) .steps-words")?.textContent ?? "");
    add(seen.made, document.querySelectorAll(".blocks .made").length);
    add(seen.lit, document.querySelector(".told [aria-current]")?.textContent ?? "");
  };
  const look = () => {
    const sims = window.sims.state();
    if (sims.storyId) add(seen.cues, [...document.querySelectorAll(".cues .cue")].filter((cue) => Number(getComputedStyle(cue).opacity) > 0.5).length);
    if (sims.playing && !seen.playing) {
      seen.playing = { state: sims.state, readyFrames: sims.readyFrames, framesTotal: sims.framesTotal, open: !document.querySelector(".arch.closed") };
    }
    requestAnimationFrame(look);
  };
  // A busy machine draws seldom: what changes is noted as it changes.
  new MutationObserver(read).observe(document.body, { childList: true, subtree: true, attributes: true, characterData: true });
  window.seen = seen;
  look();
}

async function post(page) {
  await page.goto("/");
  await page.waitForSelector("#theme");
  // A visitor thinks for longer than this.
  await page.waitForTimeout(2500);
  await page.evaluate(note);
  let tabs = 0;
  while ((await page.evaluate(() => document.activeElement?.id)) !== "theme" && tabs++ < 12) await page.keyboard.press("Tab");
  await page.keyboard.insertText(theme);
  const posted = page.waitForResponse((response) => response.request().method() === "POST" && response.url().endsWith("/v1/stories"));
  await page.keyboard.press("Enter");
  const { links } = await (await posted).json();
  // The worker waits where the page has to see the story as it grows: a busy machine would pass over it.
  await holding(worker, () => page.waitForFunction(() => window.seen.steps.some(Boolean)));
  while (!(await (await fetch(service + links.self)).json()).motion.frames) await page.waitForTimeout(20);
  await holding(worker, () => page.waitForFunction(() => window.seen.made.at(-1) > 0 && window.seen.playing));
}

/** What is lit in the text beside what is being acted. */
const lit = (page) =>
  page.evaluate(() => ({
    keyframe: window.sims.state().keyframe,
    frame: window.sims.state().frame,
    words: [...document.querySelectorAll(".told [aria-current]")].map((element) => element.textContent).join(""),
  }));

/** Words that are told and not seen: how wide they stand there, and how wide their letters are, CSS pixels; what is clipped away stands nowhere. */
const unseen = (page) =>
  page.evaluate(() => {
    const ink = new OffscreenCanvas(1, 1).getContext("2d");
    return [...document.querySelectorAll(".told .unseen")].map((element) => {
      const { font, clipPath } = getComputedStyle(element);
      ink.font = font;
      const boxes = [...element.getClientRects()];
      return { text: element.textContent, box: clipPath === "none" ? boxes.reduce((sum, { width }) => sum + width, 0) : 0, letters: ink.measureText(element.textContent).width };
    });
  });

/** A still moment: the joints, and a picture of the stage. */
async function moment(page, keyframe) {
  await page.locator(".blocks button").nth(keyframe).click();
  await settle(page);
  return state(page);
}

/** Of the keyframes from one on, the first whose body is a step away from where it was. */
async function farFrom(page, { joints }, keyframe) {
  await page.locator(".blocks button").nth(keyframe).click();
  const [x, , z] = (await state(page)).joints[0];
  const far = Math.hypot(x - joints[0][0], z - joints[0][2]) > 1;
  return far || keyframe + 1 === (await page.locator(".blocks button").count()) ? keyframe : farFrom(page, { joints }, keyframe + 1);
}

/** The same corner of the overview, where the camera stands still, with the body in it, once more, and with it gone elsewhere. */
async function pictures(page, one, later) {
  // The plan could lie over the body.
  await page.getByRole("button", { name: "Plan of the home" }).click();
  await page.locator(".blocks button").nth(one).click();
  const other = await farFrom(page, await state(page), later);
  const first = await moment(page, one);
  const bounds = await page.locator(".picture").boundingBox();
  const clip = around(first.pixels, 6, bounds);
  const here = await shoot(page, clip);
  const again = await shoot(page, clip);
  const second = await moment(page, other);
  const { changed } = await compare(page, here, again, await shoot(page, clip));
  return { first, second, still: changed[0], moved: changed[1], clip };
}

/** The pose in which a keyframe ends, and a picture of where the body is: the next keyframe begins with it. */
async function ending(page, keyframe, place = null) {
  const there = await moment(page, keyframe + 1);
  const clip = place ?? around(there.pixels, 6, await page.locator(".picture").boundingBox());
  return { ...there, clip, picture: await shoot(page, clip) };
}

/** How one sits is changed with the form beside the film, with what else it can do, and played from there. */
async function changed(page) {
  const { links, keyframes } = await (await fetch(`${service}/v1/stories/${(await state(page)).storyId}`)).json();
  const at = keyframes.findIndex(({ skill }) => skill === "sitdown");
  // From above the camera stands still.
  await page.keyboard.press("f");
  const before = await ending(page, at);
  await page.getByRole("button", { name: "Change the script" }).click();
  const rows = page.locator(".draft");
  await rows.first().waitFor();
  const counts = [await rows.count()];
  const [seed, play] = [page.locator("#take-seed"), page.getByRole("button", { name: "Play this" })];
  const kept = await seed.inputValue();
  const playable = [await play.isEnabled()];
  for (const value of ["41", kept]) {
    await seed.fill(value);  // the field keeps the focus: nothing is left or confirmed
    playable.push(await play.isEnabled());
  }
  const on = (words) => page.getByLabel(`Moment ${at + 1}: ${words}`);
  await on("leave it out").click();
  counts.push(await rows.count());
  await page.keyboard.press("Control+z");
  await on("put another behind it").click();
  counts.push(await rows.count());
  await page.getByRole("button", { name: "Undo" }).click();
  await on("earlier").press("Enter");
  const carried = await page.evaluate(() => document.activeElement.getAttribute("aria-label"));
  await page.keyboard.press("Control+z");
  counts.push(await rows.count());
  const wrong = await complaints(page, ".editor");
  const sideways = await overhang(page);
  const captions = await on("how").evaluate((field) => [...field.list.options].map((option) => option.value));
  const caption = captions.find((one) => /legs|knees|cross/.test(one) && one !== keyframes[at].caption);
  // What is typed is taken on leaving, and the click that leaves the field does what it is for.
  await on("how").focus();
  await page.keyboard.insertText(caption);
  await on("put another behind it").click();
  counts.push(await rows.count());
  for (const _ of [1, 2]) await page.getByRole("button", { name: "Undo" }).click();
  // It is looked for by typing, and taken by Enter.
  await on("how").focus();
  await page.keyboard.insertText(caption);
  await page.keyboard.press("Enter");
  const [begun] = [performance.now(), await page.getByRole("button", { name: "Play this" }).click()];
  await until(page, (seen) => seen.storyId !== links.self.split("/").at(-1) && seen.playing);
  const { storyId, keyframe } = await state(page);
  const milliseconds = performance.now() - begun;
  const origin = await page.locator(".origin").textContent();
  await page.keyboard.press("Space");
  await until(page, (seen) => !seen.playing);
  // While it is made a film may stop to wait and go on by itself, and what comes may change the picture.
  while ((await (await fetch(`${service}/v1/stories/${storyId}`)).json()).state !== "succeeded") await page.waitForTimeout(100);
  if ((await state(page)).playing) await page.keyboard.press("Space");
  await until(page, (seen) => !seen.playing);
  await page.locator(".blocks .made").nth(at + 1).waitFor();
  const after = await ending(page, at, before.clip);
  const { changed: apart } = await compare(page, before.picture, after.picture);
  const pose = ({ joints }) => ({ joints });
  return { at, take: storyId, keyframe, counts, playable, carried, wrong, sideways, caption, origin, milliseconds, apart: apart[0], before: pose(before), after: { ...pose(after), frame: after.frame } };
}

await scene(async (page) => {
  await post(page);
  await page.waitForFunction(() => window.seen.lit.length > 2);
  await until(page, (seen) => seen.state === "succeeded" && seen.readyFrames === seen.framesTotal);
  const grown = await page.evaluate(() => window.seen);
  await page.keyboard.press("Escape");
  await page.locator(".picture").focus();
  await page.keyboard.press("Space");
  await until(page, (seen) => !seen.playing);
  await page.keyboard.press("f");
  const count = await page.locator(".blocks button").count();
  const [early, late] = [Math.floor(count * 0.2), Math.floor(count * 0.6)];
  const drawn = await pictures(page, early, late);
  await page.keyboard.press("f");
  const follow = await moment(page, Math.floor(count * 0.5));
  const bounds = await page.locator(".picture").boundingBox();
  const { colours } = await compare(page, await shoot(page, bounds));
  // When each row of the script begins to show, which pictures that come seldom on a busy machine do not catch.
  grown.delays = await page.locator(".cues .cue").evaluateAll((rows) => rows.map((row) => parseFloat(getComputedStyle(row).animationDelay)));
  const told = [];
  for (const keyframe of [0, early, late, count - 1]) {
    await page.locator(".blocks button").nth(keyframe).click();
    told.push(await lit(page));
  }
  const sentences = await page.locator(".told .moment").count();
  const clicked = [];
  for (const sentence of [0, Math.floor(sentences / 2)]) {
    await page.locator(".told .moment").nth(sentence).click();
    clicked.push({ words: await page.locator(".told .moment").nth(sentence).textContent(), ...(await lit(page)) });
  }
  const story = (await state(page)).storyId;
  return { grown, drawn, follow, colours, bounds, told, clicked, unseen: await unseen(page), note: await page.locator(".told-note").innerText(), story, changed: await changed(page) };
});
