/** A story is filmed at a click: how far it is can be seen, it can be stopped, and at last the film is a file; as USD
 * it is made for the click, or the reason why not is shown. */

import { scene } from "./browser.mjs";

/** Refused as by a service that lacks the library, and then asked for again. */
async function asUsd(page, story, folder) {
  const item = page.locator(".usd");
  const make = item.getByRole("button", { name: /^Make .*\.usd$/ });
  const body = JSON.stringify({ title: "Not provided", status: 501, detail: "writing film.usd needs a library" });
  await page.route("**/film.usd", (route) => route.fulfill({ status: 501, contentType: "application/problem+json", body }), { times: 1 });
  await make.click();
  const reason = await item.getByRole("alert").textContent();
  const downloading = page.waitForEvent("download");
  await make.click();
  const download = await downloading;
  const path = `${folder}/film.usd`;
  await download.saveAs(path);
  return { reason, name: download.suggestedFilename(), link: await item.locator("a").textContent() };
}

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

  return { seen, name: download.suggestedFilename(), usd: await asUsd(page, story, folder) };
});
