/** Captions on the page are seen acted: by keyboard, cancelled, thrown away after, and no story is lost by it. */

import { scene } from "./browser.mjs";

await scene(async (page, id) => {
  const dropped = () => page.waitForResponse((response) => response.request().method() === "DELETE");
  const kept = async () => (await (await page.request.get("/v1/stories?limit=50")).json()).items.map((item) => item.id);
  const before = await kept();
  await page.goto(`/#/stories/${id}`);
  await page.locator(".title h1").waitFor();
  await page.getByRole("link", { name: "Captions" }).click();
  await page.locator("#caption-words").fill("drinking standing");
  const see = page.getByRole("button", { name: "drinking while standing, cup in the right hand" });
  await see.focus();
  await page.keyboard.press("Enter");
  const dialog = page.getByRole("dialog", { name: /drinking while standing/ });
  const status = dialog.getByRole("status");
  const said = await status.textContent();
  const canvas = dialog.locator(".picture canvas");
  await canvas.waitFor();
  await status.waitFor({ state: "hidden" });
  const subtitle = dialog.locator(".subtitle span");
  await subtitle.waitFor();
  const begun = await subtitle.textContent();
  // The film goes on with what the caption says.
  const pictures = [await canvas.screenshot()];
  await page.waitForTimeout(900);
  pictures.push(await canvas.screenshot());
  const wide = await dialog.evaluate((box) => [box.scrollWidth - box.clientWidth, box.getBoundingClientRect().right - innerWidth]);
  const gone = dropped();
  await page.keyboard.press("Escape");
  await dialog.waitFor({ state: "detached" });
  await gone;
  const focused = await page.evaluate(() => document.activeElement?.textContent);
  // And one that is left before it is there.
  const posted = page.waitForRequest((request) => request.url().endsWith("/v1/motions"));
  await page.keyboard.press("Enter");
  await posted;
  const goneToo = dropped();
  await page.keyboard.press("Escape");
  await goneToo;
  const after = await kept();
  await page.goBack();
  await page.locator(".title h1").waitFor();
  return { said, begun, moved: !pictures[0].equals(pictures[1]), wide, focused, before, after, address: await page.evaluate(() => location.hash) };
});
