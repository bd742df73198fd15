/** Seconds from asking for the page to its first paint, and from posting a theme to the film playing. */

import { scene, until } from "./browser.mjs";

const VISITS = 3;

/** The median over visitors who have nothing of the page yet. */
async function paint(page) {
  const seconds = [];
  for (let visit = 0; visit < VISITS; visit++) {
    const context = await page.context().browser().newContext();
    const fresh = await context.newPage();
    await fresh.goto(process.argv[2]);
    await fresh.waitForFunction(() => performance.getEntriesByName("first-contentful-paint").length > 0);
    seconds.push(await fresh.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0].startTime / 1000));
    await context.close();
  }
  return seconds.sort((a, b) => a - b)[Math.floor(VISITS / 2)];
}

await scene(async (page, theme) => {
  const painted = await paint(page);
  await page.goto("/");
  await page.fill("#theme", theme);
  // A visitor thinks for longer than this.
  await page.waitForTimeout(4000);
  const started = performance.now();
  await page.keyboard.press("Enter");
  await until(page, (seen) => seen.playing);
  return { paint: painted, playing: (performance.now() - started) / 1000 };
});
