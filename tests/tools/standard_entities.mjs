// Writes the entities of MIL-STD-2525D in the sets that have drawings, from npm mil-std-2525 0.2.8, for the list of what
// is missing in scenes/SYMBOLS.md: set, code and name on a line.
//
//     npm install --prefix FOLDER mil-std-2525@0.2.8
//     node tests/tools/standard_entities.mjs FOLDER/node_modules > tests/symbology/standard.txt
import { readFileSync } from "fs";

const TABLES = {
  10: "Land unit",
  11: "Land civilian",
  15: "Land equipment",
  20: "Land installation",
  35: "Sea subsurface",
  36: "Mine warfare",
  40: "Activities",
  50: "Signals intelligence",
  60: "Cyberspace",
  "01": "Air",
  "02": "Air missile",
  "05": "Space",
  "06": "Space missile",
  30: "Sea surface",
};
console.log("# The entities of MIL-STD-2525D, from npm mil-std-2525 0.2.8; made by tests/tools/standard_entities.mjs.");
for (const [set, table] of Object.entries(TABLES)) {
  const rows = readFileSync(`${process.argv[2]}/mil-std-2525/tsv-tables/2525d/${table}.tsv`, "utf8").split("\n").slice(1);
  for (const row of rows) {
    const [entity, type, subtype, code, remarks] = row.split("\t").map((cell) => (cell ?? "").trim());
    const name = (entity || type || subtype || "").replace(/\s+/g, " ");
    const isPlace = /reserved/i.test(name + remarks) || code === "000000";
    if (/^\d{6}$/.test(code) && !isPlace) console.log(set, code, name);
  }
}
