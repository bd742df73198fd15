/** Seconds from asking for the page to its first paint, and from posting a theme to the film playing. */

import { scene, until } from "./browser.mjs";

await scene(async (page, theme) => {
  await page.goto("/");
  await page.waitForSelector("#theme");
  await page.waitForFunction(() => performance.getEntriesByName("first-contentful-paint").length > 0);
  const paint = await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0].startTime / 1000);
  await page.fill("#theme", theme);
  // A visitor thinks for longer than this.
  await page.waitForTimeout(4000);
  const started = performance.now();
  await page.keyboard.press("Enter");
  await until(page, (seen) => seen.playing);
  return { paint, playing: (performance.now() - started) / 1000 };
});
