/** A story is played in a room that is brought in beside its script; as it was and as it is now play side by side. */

import { PATIENCE, complaints, overhang, scene, until } from "./browser.mjs";

const ROOM = {
  id: "page-den",
  room_type: "living_room",
  floor_polygon: [[-2, -2], [-2, 2], [2, 2], [2, -2]],
  doors: [{ segment: [[-2, -0.4], [-2, 0.4]] }],
  objects: [{ id: "sofa_1", category: "sofa", position: [0.8, 0, -1.4], size: [1.8, 0.8, 0.85], yaw: 0 }],
};

async function give(page, name, room) {
  await page.getByLabel("File").setInputFiles({ name, mimeType: "application/json", buffer: Buffer.from(JSON.stringify(room)) });
  await page.locator(".import-answer:empty").waitFor({ state: "attached" });
  await page.getByRole("button", { name: "Bring it in" }).click();
  await page.locator(".import-answer > *").first().waitFor();
  return { words: await page.locator(".import-answer").innerText(), rooms: await page.getByLabel("Played in").inputValue() };
}

/** The library does not know the room; then it is brought in, first spoiled. */
async function move(page, id) {
  await page.goto(`/#/stories/${id}`);
  await page.getByRole("button", { name: "Change the script" }).click();
  await page.locator(".draft").first().waitFor();
  await page.getByLabel("Played in").fill("nowhere");
  await page.getByRole("button", { name: "Play this" }).click();
  await page.locator("#take-home[aria-invalid]").waitFor();
  const unknown = await page.locator(".editor-foot .wrong").innerText();
  await page.locator(".editor .bring summary").click();
  const spoiled = await give(page, "spoiled.json", { ...ROOM, floor_polygon: [[0, 0], [1, 1]] });
  const own = await give(page, "den.json", ROOM);
  const [wrong, sideways] = [await complaints(page, ".editor"), await overhang(page)];
  const posted = page.waitForRequest((request) => request.method() === "POST" && request.url().endsWith("/takes"));
  await page.getByRole("button", { name: "Play this" }).click();
  const { layouts } = (await posted).postDataJSON();
  const { storyId } = await until(page, (seen) => seen.storyId !== id && seen.playing);
  return { unknown, spoiled, own, wrong, sideways, layouts, take: storyId };
}

/** The same, moved by another backend: the form beside the film names it. */
async function withBackend(page, id, backend) {
  await page.goto(`/#/stories/${id}`);
  await page.getByRole("button", { name: "Change the script" }).click();
  await page.locator("#take-backend").selectOption(backend);
  await page.getByRole("button", { name: "Play this" }).click();
  const { storyId } = await until(page, (seen) => seen.storyId !== id && seen.playing);
  return storyId;
}

/** Where both films are. */
const places = (page) => page.locator(".side input[type=range]").evaluateAll((all) => all.map((slider) => Number(slider.value)));

/** The frames at which both films are, again and again, until each has begun with a moment. */
async function together(page, ids, moment) {
  const seen = [];
  const starts = await Promise.all(ids.map((id) => startOf(page, id, moment)));
  const deadline = performance.now() + PATIENCE;
  while (!seen.length || starts.some((start, side) => !(seen.at(-1)[side] > start))) {
    if (performance.now() > deadline) throw new Error(`they never came as far as ${starts}: ${seen.at(-1)}`);
    seen.push(await page.evaluate(() => window.sims.state().both.map(({ frame }) => frame)));
    await page.waitForTimeout(60);
  }
  return seen;
}

/** The first frame of a keyframe, once it is made. */
async function startOf(page, id, keyframe) {
  for (;;) {
    const { keyframes } = await (await fetch(`${process.argv[2]}/v1/stories/${id}`)).json();
    if (keyframes[keyframe].start !== null) return keyframes[keyframe].start;
    await page.waitForTimeout(200);
  }
}

async function compareBoth(page) {
  await page.locator(".differs:not([hidden])").waitFor();
  let [before, now] = [[0, 0], await places(page)];
  // They wait for each other, then both go on.
  while (now.length < 2 || now.some((place, side) => place <= (before[side] ?? 0))) {
    await page.waitForTimeout(100);
    [before, now] = [before.some(Boolean) ? before : now, await places(page)];
  }
  await page.locator(".side .movers").nth(1).waitFor();
  const each = (part) => page.locator(`.side ${part}`).allInnerTexts();
  const [heads, figures, movers] = [await each("h2"), await each(".figures"), await each(".movers")];
  return { title: await page.locator("h1").innerText(), heads, figures, movers, differs: await page.locator(".differs").innerText(), sideways: await overhang(page) };
}

await scene(async (page, id) => {
  const moved = await move(page, id);
  const beside = () => page.getByRole("link", { name: "See both side by side" }).click();
  await beside();
  // The way to the seat is another there, so that one of them has to wait.
  await page.locator(".pair").waitFor();
  const [both, steps] = await Promise.all([compareBoth(page), together(page, [id, moved.take], 1)]);
  const learned = await withBackend(page, id, "diffusion");
  await beside();
  return { moved, both, learned, steps, backends: await compareBoth(page) };
});
