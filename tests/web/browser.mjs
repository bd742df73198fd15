/** One Chromium for a test: what it asked for and complained about is kept, and told as JSON at the end. */

import { accessSync, constants, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { delimiter, join } from "node:path";
import { chromium } from "playwright-core";

const NAMES = ["chromium", "chromium-browser", "google-chrome"];
const FLAGS = [
  "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking", "--disable-component-update", "--disable-sync",
];
const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
/** Milliseconds for anything that has to happen. */
export const PATIENCE = 120000;

/** The Chromium that CHROMIUM names, or the first on the PATH; null without one. */
export function findChromium() {
  if (process.env.CHROMIUM) return process.env.CHROMIUM;
  const places = (process.env.PATH ?? "").split(delimiter).flatMap((folder) => NAMES.map((name) => join(folder, name)));
  return places.find(executable) ?? null;
}

function executable(path) {
  try {
    accessSync(path, constants.X_OK);
    return true;
  } catch {
    return false;
  }
}

/** Run a scenario with a page of its own and write what it answers, with what the page did beside it, to stdout. */
export async function scene(act, options = {}) {
  const [base, ...rest] = process.argv.slice(2);
  const flags = process.getuid?.() === 0 ? [...FLAGS, "--no-sandbox"] : FLAGS;
  const browser = await chromium.launch({ executablePath: findChromium(), args: flags });
  try {
    // Software draws every point: half as many a side tell as much.
    const context = await browser.newContext({ baseURL: base, viewport: { width: 1100, height: 820 }, deviceScaleFactor: 0.5, ...options });
    context.setDefaultTimeout(PATIENCE);
    const page = await context.newPage();
    const noted = watch(page);
    await page.addInitScript(() => {
      window.violations = [];
      document.addEventListener("securitypolicyviolation", (event) => window.violations.push(`${event.violatedDirective} ${event.blockedURI}`));
    });
    const answer = await act(page, ...rest);
    const violations = await page.evaluate(() => window.violations);
    process.stdout.write(JSON.stringify({ ...answer, ...noted, violations }));
  } finally {
    await browser.close();
  }
}

/** Lists that fill while the page lives: addresses it asked for, errors it told, answers that were errors. */
function watch(page) {
  const noted = { requests: [], errors: [], refused: [] };
  page.on("request", (request) => noted.requests.push(request.url()));
  page.on("response", (response) => response.status() >= 400 && noted.refused.push(`${response.status()} ${new URL(response.url()).pathname}`));
  page.on("pageerror", (error) => noted.errors.push(error.message));
  page.on("console", (message) => {
    // The browser tells every answer of 400 and above as an error of the console; those are in `refused`.
    if (message.type() === "error" && !message.text().startsWith("Failed to load resource")) noted.errors.push(message.text());
  });
  return noted;
}

/** What `window.sims` tells now, joints and pixels too. */
export const state = (page) =>
  page.evaluate(() => {
    const seen = window.sims.state();
    return { ...seen, joints: seen.joints(), pixels: seen.pixels() };
  });

/** Wait until what `window.sims` tells fulfils a condition; it is asked here, since the page's policy evaluates nothing. */
export async function until(page, condition) {
  const deadline = performance.now() + PATIENCE;
  let seen = await state(page);
  while (!condition(seen)) {
    if (performance.now() > deadline) throw new Error(`waited in vain for ${condition}: ${JSON.stringify({ ...seen, joints: seen.joints.length, pixels: null })}`);
    await page.waitForTimeout(40);
    seen = await state(page);
  }
  return seen;
}

/** Do something while the service's worker stands still, so that nothing is made meanwhile however slow the browser is. */
export async function holding(worker, act) {
  process.kill(Number(worker), "SIGSTOP");
  try {
    return await act();
  } finally {
    process.kill(Number(worker), "SIGCONT");
  }
}

/** A rectangle of the window as a PNG in base64. */
export const shoot = async (page, clip) => (await page.screenshot({ clip })).toString("base64");

/** Milliseconds without a picture after which none comes: one that stays is drawn once more, with all its points. */
const QUIET = 1200;

/** Wait until nothing is drawn any more; walls, light and camera go there at once, as for who wants it still. */
export async function settle(page) {
  await page.emulateMedia({ reducedMotion: "reduce" });
  await still(page, 0);
  await page.emulateMedia({ reducedMotion: "no-preference" });
  await still(page, QUIET);
}

/** Wait for five frames without a new picture, and for so many milliseconds. */
async function still(page, quiet) {
  await page.evaluate(async ([patience, milliseconds]) => {
    const deadline = performance.now() + patience;
    for (let [last, still, since] = [-1, 0, performance.now()]; still < 5 || performance.now() - since < milliseconds; ) {
      if (performance.now() > deadline) throw new Error("the picture does not come to rest");
      await new Promise(requestAnimationFrame);
      const { pictures } = window.sims.state();
      if (pictures !== last) since = performance.now();
      [last, still] = [pictures, pictures === last ? still + 1 : 0];
    }
  }, [PATIENCE, quiet]);
}

/** Of pictures of one size: the colours of the first, to 32 steps a channel, and the share of pixels in which each differs from it. */
export async function compare(page, ...pictures) {
  // A blank page of the same browser reads the PNGs: the policy of the page itself loads nothing from data.
  const reader = await page.context().newPage();
  const told = await reader.evaluate(async (all) => {
    const read = async (data) => {
      const bytes = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
      const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
      const ink = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
      ink.drawImage(bitmap, 0, 0);
      return ink.getImageData(0, 0, bitmap.width, bitmap.height).data;
    };
    const [first, ...others] = await Promise.all(all.map(read));
    const found = new Set();
    for (let at = 0; at < first.length; at += 4) found.add(((first[at] >> 3) << 10) | ((first[at + 1] >> 3) << 5) | (first[at + 2] >> 3));
    const differs = (other, at) => Math.abs(first[at] - other[at]) + Math.abs(first[at + 1] - other[at + 1]) + Math.abs(first[at + 2] - other[at + 2]) > 24;
    const changed = others.map((other) => {
      let count = 0;
      for (let at = 0; at < first.length; at += 4) count += differs(other, at) ? 1 : 0;
      return (4 * count) / first.length;
    });
    return { colours: found.size, changed };
  }, pictures);
  await reader.close();
  return told;
}

/** The rectangle of the window around points, with a margin, within bounds. */
export function around(points, margin, bounds) {
  const [xs, ys] = [points.map(([x]) => x), points.map(([, y]) => y)];
  const x = Math.max(Math.floor(Math.min(...xs) - margin), Math.ceil(bounds.x));
  const y = Math.max(Math.floor(Math.min(...ys) - margin), Math.ceil(bounds.y));
  const right = Math.min(Math.ceil(Math.max(...xs) + margin), bounds.x + bounds.width);
  const bottom = Math.min(Math.ceil(Math.max(...ys) + margin), bounds.y + bounds.height);
  return { x, y, width: Math.max(Math.floor(right - x), 1), height: Math.max(Math.floor(bottom - y), 1) };
}

/** How far the page sticks out to the right, pixels. */
export const overhang = (page) => page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);

/** What axe holds against the page, or a part of it, as it is: rule, and the first place. */
export async function complaints(page, part = "html") {
  await page.evaluate(AXE);
  const { violations } = await page.evaluate((chosen) => window.axe.run(chosen, { resultTypes: ["violations"] }), part);
  return violations.filter(({ impact }) => impact === "serious" || impact === "critical").map(({ id, nodes }) => `${id}: ${nodes[0].html.slice(0, 160)}`);
}
