// Opens an exported page in a headless browser, as a person would, and prints what happened as one line of JSON.
//
//     SANDTABLE_BROWSER=FOLDER node tests/tools/page_test.mjs PAGE.html OUT.png
//
// `browser.mjs` says where the browser comes from. OUT.png is the first view at 1280 × 720 without what stands on it.
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { launch, watch } from "./browser.mjs";

const [page_file, picture] = process.argv.slice(2);
const browser = await launch(["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]);
const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, hasTouch: true });
const page = await context.newPage();
// Cameras jump: a software adapter draws few frames a second.
await page.emulateMedia({ reducedMotion: "reduce" });
const told = watch(page);
page.setDefaultTimeout(300_000);

const settled = () => page.waitForFunction(() => window.sandtable?.frames > 0 && !sandtable.page.isWanted
  && !sandtable.page.controls.flight);
const camera = () => page.evaluate(() => sandtable.camera);
const picked = () => page.evaluate(() => {
  const list = document.getElementById("picked");
  return Object.fromEntries([...list.querySelectorAll("dt")].map((dt) => [dt.textContent, dt.nextSibling.textContent]));
});

const started = Date.now();
await page.goto(pathToFileURL(resolve(page_file)).href);
await page.waitForFunction(() => window.sandtable?.frames > 0);
told.firstFrame_ms = Date.now() - started;
await settled();
told.title = await page.title();
const stands = (visibility) => page.evaluate((to) => {
  document.querySelectorAll("main > :not(#view)").forEach((it) => { it.style.visibility = to; });
}, visibility);
await stands("hidden");
await page.screenshot({ path: picture, timeout: 300_000 });
await stands("");

// A click with the mouse, and a tap elsewhere.
await page.mouse.click(500, 480);
await page.waitForFunction(() => !document.getElementById("picked").hidden);
told.click = await picked();
await page.touchscreen.tap(760, 560);
await page.waitForFunction((old) => document.getElementById("picked").textContent !== old, Object.entries(told.click).flat().join(""));
told.tap = await picked();
// The sky closes what was picked.
await page.keyboard.press("Escape");
told.closed = await page.locator("#picked").isHidden();

// Turning, coming nearer and flying each move the camera; a named view brings it back.
const first = await camera();
const eye = (it) => it.eye.map((part) => Math.round(part)).join();
told.moves = {};
const move = async (name, act) => {
  const before = await camera();
  await act();
  await settled();
  told.moves[name] = eye(before) !== eye(await camera());
};
await move("drag", async () => {
  await page.mouse.move(640, 400);
  await page.mouse.down();
  await page.mouse.move(720, 420, { steps: 3 });
  await page.mouse.up();
});
await move("wheel", () => page.mouse.wheel(0, -200));
await move("key", async () => {
  await page.keyboard.down("KeyW");
  await page.waitForTimeout(300);
  await page.keyboard.up("KeyW");
});
const views = await page.locator("#views option").allTextContents();
told.views = views;
await page.selectOption("#views", { index: views.length - 1 });
await settled();
await page.selectOption("#views", { index: 0 });
await settled();
told.isBack = eye(first) === eye(await camera());

// A smaller window, and the loss of the graphics adapter.
await page.setViewportSize({ width: 420, height: 700 });
await page.waitForFunction(() => sandtable.page.canvas.width === 420);
await settled();
told.canvas = await page.evaluate(() => [sandtable.page.canvas.width, sandtable.page.canvas.height]);
const frames = await page.evaluate(() => {
  const lose = sandtable.page.gl.getExtension("WEBGL_lose_context");
  lose.loseContext();
  setTimeout(() => lose.restoreContext(), 200);
  return sandtable.frames;
});
await page.waitForFunction((before) => sandtable.frames > before, frames);
await settled();
told.message = await page.locator("#message").textContent();
await browser.close();
console.log(JSON.stringify(told));
