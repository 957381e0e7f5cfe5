// The headless browser of the tests of pages.
//
// SANDTABLE_BROWSER/node_modules holds playwright-core; the browser is chromium-headless-shell or chromium of the PATH, or the one
// that SANDTABLE_CHROMIUM names.
import { accessSync, constants } from "node:fs";
import { createRequire } from "node:module";
import { delimiter, join, resolve } from "node:path";

function browserPath() {
  if (process.env.SANDTABLE_CHROMIUM) return process.env.SANDTABLE_CHROMIUM;
  for (const name of ["chromium-headless-shell", "chromium"]) {
    for (const folder of process.env.PATH.split(delimiter)) {
      const path = join(folder, name);
      try {
        accessSync(path, constants.X_OK);
        return path;
      } catch {
        // Not here.
      }
    }
  }
  throw new Error("there is no chromium-headless-shell and no chromium on the PATH");
}

/** The browser, started with more arguments. */
export function launch(more = []) {
  const require = createRequire(join(resolve(process.env.SANDTABLE_BROWSER), "node_modules", "x.js"));
  const { chromium } = require("playwright-core");
  return chromium.launch({ executablePath: browserPath(), args: ["--no-sandbox", ...more] });
}

/** What a page requests, and the errors that it complains of, while it is used. */
export function watch(page) {
  const told = { requests: [], complaints: [] };
  page.on("request", (request) => told.requests.push(request.url().slice(0, 100)));
  page.on("pageerror", (error) => told.complaints.push(error.message));
  page.on("console", (message) => {
    if (message.type() === "error") told.complaints.push(message.text());
  });
  return told;
}
