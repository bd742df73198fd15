/** What goes wrong is said where it belongs: at its field, in the place of the film, and a story can be stopped. */

import { scene, until } from "./browser.mjs";

/** Whether a field is marked as wrong, what is said beside it, and whether it has the focus. */
const field = (page, id, error) =>
  page.evaluate(
    ([control, place]) => {
      const element = document.getElementById(control);
      const words = document.getElementById(place);
      return { invalid: element.getAttribute("aria-invalid"), words: words.hidden ? "" : words.textContent, focused: document.activeElement === element, described: element.getAttribute("aria-describedby") };
    },
    [id, error],
  );

await scene(async (page, nonsense, theme) => {
  await page.goto("/");
  const submit = page.getByRole("button", { name: "Raise the curtain" });
  await submit.click();
  const empty = await field(page, "theme", "theme-error");
  await page.locator("summary").click();
  await page.fill("#height", "9");
  await page.fill("#theme", theme);
  await submit.click();
  await page.locator("#character-height-error").waitFor();
  const tall = await field(page, "height", "character-height-error");
  const cleared = await field(page, "theme", "theme-error");

  await page.fill("#height", "1.7");
  await page.fill("#theme", nonsense);
  await submit.click();
  await until(page, (seen) => seen.state === "failed");
  const failed = { title: await page.locator("h1").textContent(), words: await page.locator(".notice .outcome").textContent(), again: await page.getByRole("link", { name: "Try another theme" }).count() };

  await page.getByRole("link", { name: "Try another theme" }).click();
  await page.fill("#theme", theme);
  await page.keyboard.press("Enter");
  await page.getByRole("button", { name: "Stop" }).click();
  await until(page, (seen) => seen.state === "cancelled");
  await page.locator(".outcome").waitFor();
  const stopped = { id: await page.evaluate(() => window.sims.state().storyId), words: await page.locator(".outcome").first().textContent(), hidden: !(await page.locator(".steps").isVisible()) };

  await page.goto("/#/stories/00000000-0000-7000-8000-000000000000");
  await page.getByRole("heading", { name: "No such story" }).waitFor();
  return { empty, tall, cleared, failed, stopped };
});
