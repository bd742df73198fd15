/** Stories outlive the page: the gallery has them, page by page, and an address opens one again. */

import { scene, until } from "./browser.mjs";

await scene(async (page, id) => {
  await page.goto(`/#/stories/${id}`);
  await until(page, (seen) => seen.playing);
  const before = await page.title();
  await page.reload();
  await until(page, (seen) => seen.playing && seen.readyFrames > 0);
  const after = await page.title();
  await page.keyboard.press("Space");
  await page.goto("/");
  const rows = page.locator(".bill li");
  await rows.first().waitFor();
  const first = await rows.count();
  const more = page.getByRole("button", { name: "More stories" });
  const counts = [first];
  while ((await more.isVisible()) && counts.length < 40) {
    await more.click();
    await page.waitForFunction((seen) => document.querySelectorAll(".bill li").length > seen, counts.at(-1));
    counts.push(await rows.count());
  }
  const links = await page.locator(".bill a").evaluateAll((all) => all.map((link) => link.getAttribute("href")));
  await page.locator(`.bill a[href="#/stories/${id}"]`).click();
  await until(page, (seen) => seen.storyId !== null && seen.playing);
  return { before, after, counts, links, opened: await page.evaluate(() => window.sims.state().storyId) };
});
