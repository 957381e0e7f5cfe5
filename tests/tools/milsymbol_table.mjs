// Writes the table of symbols that tests/symbology/milsymbol.txt holds: boxes, anchors and dark pixels of the symbols
// as npm milsymbol 3.0.4 draws them, so that `cargo test` needs no node.
//
//     npm install --prefix FOLDER milsymbol@3.0.4 @resvg/resvg-js@2.6.2
//     NODE_PATH=FOLDER/node_modules node tests/tools/milsymbol_table.mjs > tests/symbology/milsymbol.txt
//
// A line is: code, box (left, top, right, bottom), anchor (x, y), dark pixels as hexadecimal bits, `-` where only box and
// anchor count. Units are those of the symbol's box of 200 × 200. Pixels: the symbol at 128 pixels for 200 units on white,
// darkness (1 at black, 0 from half lightness on) blurred by a Gaussian of 2 pixels, dark above 0.25, every second pixel in
// the box grown by 4 units, row by row from the upper left. Text is set in the program's own bold font.
import { readFileSync, readdirSync } from "fs";
import { createRequire } from "module";

const require = createRequire(process.env.NODE_PATH + "/");
const { Symbol } = require("milsymbol");
const { Resvg } = require("@resvg/resvg-js");

const FONT = "assets/fonts/NotoSans-Bold.ttf";
const ENTITIES = "src/symbology/entities/";
const SETS = { land_unit: "10", land_equipment: "15", land_installation: "20", activity: "40", air: "01", sea_surface: "30" };
const PIXELS_PER_UNIT = 128 / 200;
const [LEFT, TOP, WIDTH, HEIGHT] = [-50, -60, 300, 340];
const BLUR = 2;
const DARK = 0.25;

function darkness(body) {
  const svg = `<svg xmlns="http://www.w3.org/2000/svg" width="${WIDTH * PIXELS_PER_UNIT}" height="${HEIGHT * PIXELS_PER_UNIT}"
    viewBox="${LEFT} ${TOP} ${WIDTH} ${HEIGHT}"><rect x="${LEFT}" y="${TOP}" width="${WIDTH}" height="${HEIGHT}" fill="white"/>${body}</svg>`;
  const font = { loadSystemFonts: false, fontFiles: [FONT], defaultFontFamily: "Noto Sans" };
  const { pixels, width, height } = new Resvg(svg, { font }).render();
  const dark = Float64Array.from({ length: width * height }, (_, i) => {
    const light = (0.2126 * pixels[4 * i] + 0.7152 * pixels[4 * i + 1] + 0.0722 * pixels[4 * i + 2]) / 255;
    return Math.max(0, 1 - light / 0.5);
  });
  return blurred({ dark, width, height });
}

function blurred({ dark, width, height }) {
  const reach = 3 * BLUR;
  const weights = Array.from({ length: 2 * reach + 1 }, (_, i) => Math.exp(-((i - reach) ** 2) / (2 * BLUR * BLUR)));
  const sum = weights.reduce((a, b) => a + b);
  const pass = (from, at) => from.map((_, index) => {
    const [x, y] = [index % width, Math.floor(index / width)];
    return weights.reduce((total, weight, i) => total + weight * from[at(x, y, i - reach)], 0) / sum;
  });
  const clamp = (value, most) => Math.min(most - 1, Math.max(0, value));
  const rows = pass(dark, (x, y, by) => y * width + clamp(x + by, width));
  return { dark: pass(rows, (x, y, by) => clamp(y + by, height) * width + x), width };
}

function mask(body, box) {
  const { dark, width } = darkness(body);
  const pixel = (value, from) => Math.floor((value - from) * PIXELS_PER_UNIT);
  let bits = "";
  for (let y = pixel(box.y1 - 4, TOP); y < pixel(box.y2 + 4, TOP); y += 2) {
    for (let x = pixel(box.x1 - 4, LEFT); x < pixel(box.x2 + 4, LEFT); x += 2) bits += dark[y * width + x] > DARK ? 1 : 0;
  }
  const nibbles = bits.padEnd(Math.ceil(bits.length / 4) * 4, "0").match(/..../g);
  return nibbles.map((nibble) => parseInt(nibble, 2).toString(16)).join("");
}

function line(code, hasMask = true) {
  const symbol = new Symbol(code, { size: 100 });
  if (!symbol.isValid()) throw new Error(`${code} is no symbol of milsymbol's`);
  const svg = symbol.asSVG().replace(/<svg[^>]*>/, "").replace("</svg>", "").replaceAll('"Arial"', '"Noto Sans"');
  const { bbox: box } = symbol;
  // The drawing has a margin of 4 units round the box.
  const anchor = { x: symbol.getAnchor().x + box.x1 - 4, y: symbol.getAnchor().y + box.y1 - 4 };
  const numbers = [box.x1, box.y1, box.x2, box.y2, anchor.x, anchor.y].map((value) => Math.round(value * 100) / 100);
  console.log(code, ...numbers, hasMask ? mask(svg, box) : "-");
}

const code = (identity, set, { status = 0, role = 0, amplifier = "00", entity = "000000", modifiers = "0000" } = {}) =>
  `100${identity}${set}${status}${role}${amplifier}${entity}${modifiers}`;

console.log("# Symbols as npm milsymbol 3.0.4 draws them; made by tests/tools/milsymbol_table.mjs.");
for (const file of readdirSync(ENTITIES).filter((file) => file !== "mod.rs").sort()) {
  const set = SETS[file.replace(".rs", "")];
  const entities = [...readFileSync(ENTITIES + file, "utf8").matchAll(/entity\(\s*(\d{6}),/g)].map((match) => match[1]);
  // Icons that touch the frame are land units': of others two frames say enough.
  const identities = set === "10" ? [3, 6, 4, 1] : [3, 6];
  for (const entity of entities) for (const identity of identities) line(code(identity, set, { entity }));
}
for (const identity of [3, 6, 4, 1]) {
  for (const modifier of ["03", "06", "41", "54", "98"]) line(code(identity, "10", { entity: "121000", modifiers: modifier + "00" }));
  for (const modifier of ["01", "15", "19", "24", "27", "42", "51", "77"]) line(code(identity, "10", { entity: "121000", modifiers: "00" + modifier }));
  for (const amplifier of [11, 12, 13, 14, 15, 16, 17, 18, 21, 22, 23, 24, 25, 26]) {
    line(code(identity, "10", { amplifier }));
    line(code(identity, "10", { amplifier, role: 4 }), false);
  }
  for (const amplifier of [31, 32, 33, 34, 35, 36, 37, 41, 42, 51, 52, 61, 62]) line(code(identity, "15", { amplifier, entity: "120200" }));
  for (const role of [1, 2, 3, 4, 5, 6, 7]) for (const set of ["10", "15", "20", "01"]) line(code(identity, set, { role }), role === 2 || role === 4);
  for (const set of ["00", "01", "02", "05", "06", "10", "11", "15", "20", "27", "30", "35", "40", "50", "51", "52", "53", "54", "60"]) line(code(identity, set));
  for (const status of [1, 2, 3, 4, 5]) line(code(identity, "10", { status }), status !== 1);
  for (const status of [2, 4]) line(code(identity, "15", { status, amplifier: "33" }), true);
}
for (const identity of [0, 2, 5]) for (const set of ["10", "15", "01", "20", "30", "35"]) line(code(identity, set), false);
