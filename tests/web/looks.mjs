/** The page at three sizes, light and dark: nothing sticks out, nothing that axe calls serious, and it stands still if asked to. */

import { complaints, overhang, scene, until } from "./browser.mjs";

const SIZES = [[390, 844], [820, 1180], [1440, 900]];

async function visit(page, address, look) {
  await page.goto("about:blank");
  await page.emulateMedia({ colorScheme: look });
  await page.goto(address);
}

await scene(async (page, id) => {
  const shown = [];
  for (const [name, address] of [["front", "/"], ["story", `/#/stories/${id}`]]) {
    for (const look of ["light", "dark"]) {
      await visit(page, address, look);
      if (name === "front") await page.locator(".bill li").first().waitFor();
      else {
        await until(page, (seen) => seen.playing);
        await page.keyboard.press("Space");
      }
      for (const [width, height] of SIZES) {
        await page.setViewportSize({ width, height });
        await page.waitForTimeout(120);
        // Colours differ by look and the order of things by width: one width a look is enough.
        const wrong = width === (look === "light" ? 390 : 1440) ? await complaints(page) : null;
        shown.push({ name, look, width, overhang: await overhang(page), wrong });
      }
    }
  }
  await page.emulateMedia({ reducedMotion: "reduce" });
  await page.goto("about:blank");
  await page.goto(`/#/stories/${id}`);
  await until(page, (seen) => seen.joints.length === 22);
  const early = await page.evaluate(() => window.sims.state().time);
  await page.waitForTimeout(700);
  const still = await page.evaluate(() => ({
    time: window.sims.state().time,
    playing: window.sims.state().playing,
    camera: window.sims.state().camera,
    running: document.getAnimations().filter((animation) => animation.playState === "running" && animation.effect.getComputedTiming().duration > 10).length,
  }));
  return { shown, still: { ...still, early } };
});
