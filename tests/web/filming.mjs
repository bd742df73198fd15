/** A story is filmed at a click: how far it is can be seen, it can be stopped, and at last the film is a file. */

import { readFileSync } from "node:fs";
import { scene } from "./browser.mjs";

await scene(async (page, story, folder) => {
  await page.goto(`/#/stories/${story}`);
  const item = page.locator(".filming");
  await item.getByRole("button", { name: /^Make .*\.mp4$/ }).click();
  await item.getByRole("button", { name: "Stop" }).click();
  const again = item.getByRole("button", { name: /^Make .*\.mp4$/ });
  await again.waitFor();
  await again.click();
  const bar = item.locator("progress");
  await bar.waitFor();
  await item.scrollIntoViewIfNeeded();
  const seen = [];
  const link = item.locator("a");
  while (!(await link.count())) {
    seen.push(await bar.evaluate((element) => element.value).catch(() => 100));
    await page.waitForTimeout(300);

  }
  const downloading = page.waitForEvent("download");
  await link.click();
  const download = await downloading;
  const path = `${folder}/film.mp4`;
  await download.saveAs(path);

  return { seen, name: download.suggestedFilename(), bytes: readFileSync(path).length };
});
