/** docs/images/page.png: `node docs/images/page.mjs http://127.0.0.1:8000` has a service make the demo's story and takes the page of it. */

import { readFileSync } from "node:fs";
import { scene, settle, until } from "../../tests/web/browser.mjs";

const MAKEFILE = readFileSync(new URL("../../Makefile", import.meta.url), "utf8");
const asked = (name) => new RegExp(`^${name} \\?= (.+)$`, "m").exec(MAKEFILE)[1];
/** The moment that is shown, counted from 0: he drinks. */
const SHOWN = 5;

await scene(
  async (page) => {
    const posted = await page.request.post("/v1/stories", { data: { theme: asked("THEME"), seed: Number(asked("THEME_SEED")) } });
    const { id } = await posted.json();
    let story = await (await page.request.get(`/v1/stories/${id}`)).json();
    while (["queued", "running"].includes(story.state)) {
      await page.waitForTimeout(300);
      story = await (await page.request.get(`/v1/stories/${id}`)).json();
    }
    await page.goto(`/#/stories/${id}?from=${SHOWN}`);
    // Where what the moment is about is seen, and told.
    await until(page, (seen) => seen.playing && seen.keyframe === SHOWN);
    await page.waitForFunction((caption) => document.querySelector(".subtitle span")?.textContent === caption, story.keyframes[SHOWN].caption);
    await page.waitForTimeout(1500);
    await page.keyboard.press("Space");
    await settle(page);
    await page.screenshot({ path: new URL("page.png", import.meta.url).pathname });
    return { story: id };
  },
  { viewport: { width: 1440, height: 900 }, deviceScaleFactor: 1, colorScheme: "light" },
);
