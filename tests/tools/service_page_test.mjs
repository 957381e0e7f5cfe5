// Uses the page of a running service in a headless browser, as a person would, and prints what happened as one line of JSON.
//
//     SANDTABLE_BROWSER=FOLDER node tests/tools/service_page_test.mjs http://127.0.0.1:8080/ OUT_FOLDER
//
// `browser.mjs` says where the browser comes from. The dataset is that of the demo, assets/jacksboro/dem.tif. OUT_FOLDER gets a
// picture of each tool at 1280 × 800, and one of the page on a phone; service-page.jpg is that of the book.
import { join } from "node:path";
import { launch, watch } from "./browser.mjs";

const [address, out] = process.argv.slice(2);
const browser = await launch();
const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, hasTouch: true });
const page = await context.newPage();
page.setDefaultTimeout(120_000);
const told = watch(page);
const response = await page.goto(address);
told.headers = response.headers();

const idle = () => page.waitForFunction(() => window.sandtable?.isIdle);
/** What the page shows of an answer. */
const shown = () => page.evaluate(() => {
  const facts = (list) => Object.fromEntries([...list.querySelectorAll("dt")].map((dt) => [dt.textContent, dt.nextSibling.textContent]));
  return {
    verdict: document.getElementById("verdict").textContent,
    facts: facts(document.getElementById("facts")),
    points: [...document.querySelectorAll("#points li")].map((item) => facts(item)),
    error: document.getElementById("error").textContent,
    chart: document.getElementById("chart").hidden ? null : document.querySelector("#chart canvas").getAttribute("aria-label"),
  };
});
const answer = async (picture) => {
  await idle();
  if (picture) await page.screenshot({ path: join(out, picture) });
  return shown();
};
const tool = (name) => page.locator(`#tools input[value=${name}]`).check({ force: true });
/** Clicks a place of the map. */
const click = async (lat, lng) => {
  const at = await page.evaluate((place) => {
    const box = document.getElementById("map").getBoundingClientRect();
    const { x, y } = sandtable.map.pixel_of(place);
    return { x: box.left + x, y: box.top + y };
  }, { lat, lng });
  await page.mouse.click(at.x, at.y);
};
/** The color of the map at a place, of 255. */
const color = (lat, lng) => page.evaluate((place) => {
  const canvas = document.getElementById("map");
  const { x, y } = sandtable.map.pixel_of(place);
  const ratio = canvas.width / canvas.clientWidth;
  return [...canvas.getContext("2d").getImageData(Math.round(x * ratio), Math.round(y * ratio), 1, 1).data];
}, { lat, lng });

await idle();
told.title = await page.title();
told.tiles = await page.evaluate(() => [...sandtable.map.tiles.values()].filter((tile) => tile.picture).length);
told.ground = await color(36.3, -84.2);

await click(36.3, -84.2);
told.height = await answer("height.png");
await tool("profile");
await click(36.21, -84.28);
await click(36.33, -84.17);
await click(36.36, -84.1);
told.profile = await answer("profile.png");
await page.locator("#chart canvas").hover({ position: { x: 180, y: 90 } });
told.hovered = await page.locator("#chart figcaption").textContent();
await tool("sight");
await page.fill("#observer", "10");
await click(36.2, -84.23);
await click(36.38, -84.12);
told.sight = await answer("sight.png");

// A place in words, and a setting that changes the answer.
await tool("viewshed");
await page.fill("#position", "16SGF5000018000");
await page.keyboard.press("Enter");
told.words = await answer();
await page.fill("#range", "8");
await page.keyboard.press("Tab");
told.viewshed = await answer("viewshed.png");
await page.screenshot({ path: join(out, "service-page.jpg"), type: "jpeg", quality: 88 });

// What the service refuses, and what the page refuses, are sentences.
await page.fill("#position", "16S 500000 4000000");
await page.keyboard.press("Enter");
told.refusal = (await answer()).error;
await page.fill("#position", "nowhere<img src=x onerror=alert(1)>");
await page.keyboard.press("Enter");
told.nonsense = (await answer()).error;
await page.fill("#range", "-1");
await page.keyboard.press("Tab");
told.wrong = (await answer()).error;
await page.fill("#range", "5");

// By keys alone: to the map, a place under the cross, another beside it, back and away.
await tool("height");
await page.locator("#map").focus();
await page.keyboard.press("0");
await page.keyboard.press("+");
await page.keyboard.press("ArrowRight");
await page.keyboard.press("Enter");
told.key = await answer();
await page.keyboard.press("ArrowDown");
await page.keyboard.press("Enter");
told.second_key = await answer();
await page.keyboard.press("Escape");
told.cleared = await answer();

// Dragging and the wheel move the map and choose nothing.
const center = () => page.evaluate(() => [sandtable.map.center.x, sandtable.map.center.y, sandtable.map.zoom]);
const before = await center();
await page.mouse.move(400, 400);
await page.mouse.down();
await page.mouse.move(500, 440, { steps: 4 });
await page.mouse.up();
const dragged = await center();
await page.mouse.wheel(0, -240);
told.moves = { drag: before[0] > dragged[0] && before[1] > dragged[1], wheel: (await center())[2] > dragged[2] };
told.afterMoves = await answer();

// Outside the ground.
await page.locator("#whole").click();
await page.fill("#position", "10N 10E");
await page.keyboard.press("Enter");
told.outside = await answer();

// On a phone, by taps: everything fits across the screen.
await page.setViewportSize({ width: 390, height: 844 });
await page.locator("#whole").click();
await idle();
const box = await page.locator("#map").boundingBox();
await page.touchscreen.tap(box.x + box.width / 2, box.y + box.height / 2);
told.phone = await answer("phone.png");
told.overflow = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
told.complaints = told.complaints.filter((text) => !text.includes("400 (Bad Request)"));
await browser.close();
console.log(JSON.stringify(told));
