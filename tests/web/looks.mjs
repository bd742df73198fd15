/** The page at three sizes, light and dark: nothing sticks out, nothing that axe calls serious, and it stands still if asked to; the script as a
 * form at the sizes of laptops and of a telephone. */

import { complaints, overhang, scene, until } from "./browser.mjs";

const SIZES = [[390, 844], [820, 1180], [1440, 900]];

/** Where what one does next with a story must be seen as it opens. */
const NEXT_SIZES = [[1280, 800], [1440, 900], [390, 844]];

const FORM_SIZES = [[1200, 800], [1366, 768], [1440, 900], [390, 844]];

async function visit(page, address, look) {
  await page.goto("about:blank");
  await page.emulateMedia({ colorScheme: look });
  await page.goto(address);
}

/** How far down what one does next reaches, and how many rows of the script are whole, without scrolling. */
async function next(page) {
  const told = [];
  for (const [width, height] of NEXT_SIZES) {
    await page.setViewportSize({ width, height });
    await page.evaluate(() => window.scrollTo(0, 0));
    await page.waitForTimeout(150);
    const [bottom, rows, film] = await page.evaluate(() => {
      const down = (selector) => [...document.querySelectorAll(selector)].map((one) => one.getBoundingClientRect().bottom);
      const edge = Math.min(down(".cues")[0], window.innerHeight);
      return [Math.max(...down(".next button")), down(".cue").filter((one) => one <= edge).length, down(".scrub")[0]];
    });
    const named = await page.getByRole("group", { name: "What next" }).getByRole("button").evaluateAll((all) => all.map((one) => one.ariaLabel ?? one.textContent));
    told.push({ width, height, bottom, rows, film, named });
  }
  return told;
}

/** How the form is laid out where one looks at it: boxes of the window, CSS pixels. */
async function form(page) {
  await page.getByRole("button", { name: "Change the script" }).click();
  await page.locator(".draft").first().waitFor();
  const told = [];
  for (const [width, height] of FORM_SIZES) {
    await page.setViewportSize({ width, height });
    await page.evaluate(() => window.scrollTo(0, 0));
    // Under a film on a telephone one goes on to the form.
    if (width < 600) await page.locator(".editor-head").evaluate((head) => head.scrollIntoView());
    await page.waitForTimeout(150);
    const boxes = await page.evaluate(() => {
      const box = (element) => (({ left, top, right, bottom }) => ({ left, top, right, bottom }))(element.getBoundingClientRect());
      const all = (selector) => [...document.querySelectorAll(selector)].filter((element) => element.offsetParent).map(box);
      const pairs = [...document.querySelectorAll(".editor label[for^=take]")].map((label) => ({ name: label.textContent, label: box(label), field: box(document.getElementById(label.htmlFor)) }));
      return { pairs, rows: all(".draft"), list: box(document.querySelector(".drafts")), play: box(document.querySelector(".editor-foot .primary")), foot: box(document.querySelector(".editor-foot")), controls: all(".controls > *") };
    });
    // Wherever one has scrolled to, the form lies over nothing else.
    const over = [];
    for (const down of [0, 250, 500]) {
      await page.evaluate((y) => window.scrollTo(0, y), down);
      await page.waitForTimeout(80);
      over.push(await page.evaluate(() => document.querySelector(".editor").getBoundingClientRect().bottom - document.querySelector(".backstage").getBoundingClientRect().top));
    }
    told.push({ width, height, over, sideways: await overhang(page), ...boxes });
  }
  return told;
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
  return { shown, still: { ...still, early }, next: await next(page), form: await form(page) };
});
