/** The library: rooms are looked through, searched by furniture, looked at, brought in, taken away, and played in. */

import { complaints, overhang, scene } from "./browser.mjs";

const NOOK = {
  id: "page-nook",
  room_type: "study",
  floor_polygon: [[-1.5, -1.5], [-1.5, 1.5], [1.5, 1.5], [1.5, -1.5]],
  doors: [{ segment: [[-1.5, -0.4], [-1.5, 0.4]] }],
  objects: [
    { id: "armchair_1", category: "armchair", position: [0.8, 0, -0.8], size: [0.8, 0.9, 0.8], yaw: 0 },
    { id: "bookshelf_1", category: "bookshelf", position: [1, 0, 1.3], size: [0.8, 1.9, 0.3], yaw: 3.14159 },
  ],
};
/** A sofa that is a box, and something that is nothing. */
const OBJ = `o sofa_1
v -1 0 -0.4\nv 1 0 -0.4\nv 1 0.8 -0.4\nv -1 0.8 -0.4\nv -1 0 0.4\nv 1 0 0.4\nv 1 0.8 0.4\nv -1 0.8 0.4
f 1 2 3 4\nf 5 6 7 8\nf 1 2 6 5\nf 4 3 7 8\nf 1 4 8 5\nf 2 3 7 6\n`;

const texts = (page, selector) => page.locator(selector).allTextContents();
const planRequests = (page, noted) => page.on("request", (request) => /v1\/layouts\/[^?/]+$/.test(request.url()) && noted.push(request.url()));

/** Cards by type, and what is fetched for them. */
async function browse(page) {
  const plans = [];
  planRequests(page, plans);
  await page.goto("/");
  await page.getByRole("link", { name: "Rooms" }).click();
  await page.locator(".card-plan svg").first().waitFor();
  await page.waitForTimeout(300);
  const all = { cards: await page.locator(".room-cards > li").count(), plans: new Set(plans).size, pieces: await page.locator(".card-plan").first().locator("[data-object]").count(), first: (await texts(page, ".room-cards h3"))[0] };
  const before = await page.locator(".room-cards > li").count();
  await page.getByRole("button", { name: "More rooms" }).click();
  await page.waitForFunction((count) => document.querySelectorAll(".room-cards > li").length > count, before);
  const names = await texts(page, ".room-cards h3");
  await page.getByRole("radio", { name: "study" }).check();
  await page.waitForFunction(() => {
    const said = [...document.querySelectorAll(".room-cards .hint")];
    return said.length > 0 && said.every((one) => /study/i.test(one.textContent));
  });
  return { all, names, studies: await texts(page, ".room-cards .hint"), address: new URL(page.url()).hash };
}

/** What is found for words, and what is said of words that are none. */
async function search(page) {
  await page.getByRole("radio", { name: "all", exact: true }).check();
  const field = page.getByLabel("Find rooms by furniture");
  await field.fill("sofa:fly");
  await field.press("Enter");
  const wrong = { words: await page.locator("#furniture-error").textContent(), invalid: await field.getAttribute("aria-invalid"), focused: await field.evaluate((element) => document.activeElement === element) };
  await field.fill("Sofa:sit + coffee table, piano + sofa, tv stand");
  await field.press("Enter");
  await page.locator(".match").first().waitFor();
  const match = page.locator(".match").first();
  for (const place of [0, 1]) await match.locator(".room-plan").nth(place).locator(".number").first().waitFor();
  const numbers = (place) => match.locator(".room-plan").nth(place).locator(".number").evaluateAll((all) => all.map((one) => [one.querySelector("text").textContent, one.classList[1]]));
  return {
    wrong,
    count: await page.locator(".match").count(),
    asked: await numbers(0),
    found: await numbers(1),
    lost: await match.locator(".relation.lost").count(),
    relations: await match.locator(".relation").count(),
    sum: await match.locator(".match-sum").textContent(),
    list: await match.locator(".standing li").allTextContents(),
    room: await match.locator("h3 a").textContent(),
    marked: await match.locator(".piece.stands").count(),
  };
}

/** How many elements are to be seen. */
const seen = (page, selector) => page.locator(selector).evaluateAll((all) => all.filter((one) => getComputedStyle(one).display !== "none").length);

async function look(page) {
  await page.locator(".match h3 a").first().click();
  await page.locator(".room-plan.large .names text").first().waitFor();
  const layers = {};
  for (const [name, selector] of [["Names", ".names text"], ["Neighbours", ".plan-graph line"], ["Sitting and lying", ".place:not(.touch)"], ["Touching", ".place.touch"]]) {
    const button = page.getByRole("button", { name, exact: true });
    const was = (await button.getAttribute("aria-pressed")) === "true";
    const first = await seen(page, selector);
    await button.click();
    const second = await seen(page, selector);
    layers[name] = was ? { on: first, off: second } : { on: second, off: first };
    await button.click();
  }
  // The row of the last toggle is left for the plan, whose one stop leads on to all pieces.
  await page.getByRole("button", { name: "Touching", exact: true }).focus();
  await page.keyboard.press("Tab");
  const marked = () => page.evaluate(() => ({ id: document.querySelector(".piece.marked")?.dataset.object, label: document.activeElement.getAttribute("aria-label"), caption: document.querySelector(".plan-caption").textContent, near: document.querySelectorAll(".piece.near").length, edges: document.querySelectorAll(".plan-graph line.marked").length }));
  const first = await marked();
  await page.keyboard.press("ArrowRight");
  const second = await marked();
  await page.keyboard.press("Enter");
  const chosen = await page.locator(".piece[aria-selected='true']").getAttribute("data-object");
  await page.keyboard.press("Escape");
  await page.keyboard.press("Tab");
  return { title: await page.title(), layers, first, second, chosen, left: await page.locator(".piece.marked").count(), rows: await page.locator(".piece-row").count(), files: await page.locator(".files a").evaluateAll((all) => all.map((link) => link.getAttribute("href"))) };
}

async function bring(page) {
  await page.getByRole("main").getByRole("link", { name: "Rooms", exact: true }).click();
  await page.locator(".library").waitFor();
  const kept = { matches: await page.locator(".match").count(), words: await page.getByLabel("Find rooms by furniture").inputValue() };
  await page.locator(".bring summary").click();
  const give = async (name, text) => {
    await page.getByLabel("File").setInputFiles({ name, mimeType: "application/octet-stream", buffer: Buffer.from(text) });
    await page.waitForFunction(() => document.querySelector(".import-answer").childElementCount === 0);
    await page.waitForTimeout(100);
    const format = await page.getByLabel("It is").inputValue();
    await page.getByRole("button", { name: "Bring it in" }).click();
    await page.locator(".import-answer > *").first().waitFor();
    return { format, words: await page.locator(".import-answer").innerText() };
  };
  const spoiled = await give("spoiled.json", JSON.stringify({ ...NOOK, floor_polygon: [[0, 0], [1, 1]] }));
  const cut = await give("cut.glb", "glTF");
  const obj = await give("corner.obj", OBJ);
  const own = await give("nook.json", JSON.stringify(NOOK));
  const again = await give("nook.json", JSON.stringify(NOOK));
  return { kept, spoiled, cut, obj, own, again };
}

/** Both kinds of page, narrow and wide; one by day and one by night is looked at closely. */
async function judge(page) {
  const shown = [];
  const find = "/#/rooms?with=sofa:sit%20%2B%20coffee%20table,%20piano%20%2B%20sofa&most=2";
  for (const [address, ready, look, widths] of [[find, ".match .number", "light", [1440, 320]], ["/#/rooms/page-nook", ".names text", "dark", [320, 1440]]]) {
    await page.emulateMedia({ colorScheme: look });
    await page.goto("about:blank");
    await page.goto(address);
    await page.locator(ready).first().waitFor();
    for (const width of widths) {
      await page.setViewportSize({ width, height: 900 });
      await page.waitForTimeout(100);
      shown.push({ address, look, width, overhang: await overhang(page) });
    }
    shown.at(-1).wrong = await complaints(page);
  }
  return shown;
}

/** A story is asked for here, and the room is taken away. */
async function use(page) {
  await page.getByRole("link", { name: "Play a story here" }).click();
  await page.locator(".stage-chosen").waitFor();
  const words = await page.locator(".stage-chosen").innerText();
  await page.fill("#theme", "A person reads in the armchair.");
  const posted = page.waitForRequest((request) => request.method() === "POST" && request.url().endsWith("/v1/stories"));
  await page.keyboard.press("Enter");
  const asked = (await posted).postDataJSON();
  await page.waitForFunction(() => window.sims.state().storyId);
  const story = await page.evaluate(() => window.sims.state().storyId);
  await page.goto("/#/rooms/page-nook");
  await page.getByRole("button", { name: "Remove this room" }).click();
  await page.getByRole("button", { name: "Remove it" }).click();
  await page.locator(".room-cards h3").first().waitFor();
  await page.goto("/#/rooms/page-nook");
  await page.getByRole("heading", { name: "No such room" }).waitFor();
  return { words, asked, story };
}

await scene(async (page) => {
  const browsed = await browse(page);
  const searched = await search(page);
  const looked = await look(page);
  const brought = await bring(page);
  const judged = await judge(page);
  return { browsed, searched, looked, brought, judged, used: await use(page) };
});
