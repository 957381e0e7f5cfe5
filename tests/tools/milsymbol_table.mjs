// Writes the tables of symbols in tests/symbology/milsymbol/: boxes, anchors and dark pixels of the symbols as npm milsymbol
// 3.0.4 draws them, so that `cargo test` needs no node. A file is a symbol set, with every main icon and every modifier that
// milsymbol has of it; `amplifiers.txt` holds frames, echelons, mobility, status and roles; `common.txt` the common modifiers of
// MIL-STD-2525E and the frames that digit 23 states.
//
//     npm install --prefix TOOLS milsymbol@3.0.4 @resvg/resvg-js@2.6.2
//     NODE_PATH=TOOLS/node_modules node tests/tools/milsymbol_table.mjs tests/symbology/milsymbol [FILE …]
//
// A line is: code, box (left, top, right, bottom), anchor (x, y), dark pixels. Units are those of the symbol's box of
// 200 × 200. Pixels: the symbol at 128 pixels for 200 units on white, darkness (1 at black, 0 from half lightness on) blurred
// by a Gaussian of 2 pixels, dark above 0.25, every second pixel of every second row of the whole picture. They are written
// as what differs from the file's first line of the same identity and set: the lengths of runs, of equal pixels and of others
// in turn, in digits of base 64, five bits a digit and the sixth where another follows, the least first. `=` is as in the
// line before; `-` where only box and anchor count. Text is set in the program's own bold font.
import { mkdirSync, writeFileSync } from "fs";
import { createRequire } from "module";
import { join } from "path";

const require = createRequire(process.env.NODE_PATH + "/");
const milsymbol = require("milsymbol");
const { Resvg } = require("@resvg/resvg-js");

const FONT = "assets/fonts/NotoSans-Bold.ttf";
const SETS = [
  "01",
  "02",
  "05",
  "06",
  "10",
  "11",
  "15",
  "20",
  "27",
  "30",
  "35",
  "36",
  "40",
  "50",
  "51",
  "52",
  "53",
  "54",
  "60",
];
// Friend, hostile, neutral, unknown.
const IDENTITIES = [3, 6, 4, 1];
// The middle of the symbol's box is a whole pixel, where the program sets it.
const PIXELS_PER_UNIT = 128 / 200;
const [LEFT, TOP, WIDTH, HEIGHT] = [-50, -62.5, 300, 343.75];
const BLUR = 2;
const DARK = 0.25;
const DIGITS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

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
  // Along rows, each continued beyond its ends; the result lies turned, so that twice is the whole.
  const pass = (from, width, height) => {
    const to = new Float64Array(from.length);
    const row = new Float64Array(width + 2 * reach);
    for (let y = 0; y < height; y++) {
      const line = from.subarray(y * width, (y + 1) * width);
      row.fill(line[0], 0, reach);
      row.set(line, reach);
      row.fill(line[width - 1], width + reach);
      for (let x = 0; x < width; x++) {
        let total = 0;
        for (let i = 0; i < weights.length; i++) total += weights[i] * row[x + i];
        to[x * height + y] = total / sum;
      }
    }
    return to;
  };
  return { dark: pass(pass(dark, width, height), height, width), width, height };
}

function darkPixels(body) {
  const { dark, width, height } = darkness(body);
  const bits = [];
  for (let y = 0; y < height; y += 2) for (let x = 0; x < width; x += 2) bits.push(dark[y * width + x] > DARK);
  return bits;
}

function runs(bits) {
  const lengths = [];
  let [value, length] = [false, 0];
  for (const bit of bits) {
    if (bit === value) length += 1;
    else {
      lengths.push(length);
      [value, length] = [bit, 1];
    }
  }
  if (value) lengths.push(length);
  const digits = (number) => (number < 32 ? DIGITS[number] : DIGITS[32 + (number % 32)] + digits(Math.floor(number / 32)));
  return lengths.map(digits).join("") || "A";
}

class Table {
  lines = ["# Symbols as npm milsymbol 3.0.4 draws them; made by tests/tools/milsymbol_table.mjs, which says what a line is."];
  frames = {};
  last = "";

  add(code, hasPixels = true) {
    const symbol = new milsymbol.Symbol(code, { size: 100 });
    if (!symbol.isValid()) throw new Error(`${code} is no symbol of milsymbol's`);
    const svg = symbol.asSVG().replace(/<svg[^>]*>/, "").replace("</svg>", "").replaceAll('"Arial"', '"Noto Sans"');
    const { bbox: box } = symbol;
    // The drawing has a margin of 4 units round the box.
    const anchor = { x: symbol.getAnchor().x + box.x1 - 4, y: symbol.getAnchor().y + box.y1 - 4 };
    const numbers = [box.x1, box.y1, box.x2, box.y2, anchor.x, anchor.y].map((value) => Math.round(value * 100) / 100);
    this.lines.push([code, ...numbers, hasPixels ? this.pixels(code, svg) : "-"].join(" "));
  }

  pixels(code, svg) {
    const bits = darkPixels(svg);
    const key = code.slice(3, 6);
    const frame = this.frames[key];
    if (!frame) this.frames[key] = bits;
    const text = runs(frame ? bits.map((bit, i) => bit !== frame[i]) : bits);
    const isSame = frame && text === this.last;
    this.last = text;
    return isSame ? "=" : text;
  }
}

const code = (identity, set, { version = 10, status = 0, role = 0, amplifier = "00", entity = "000000", modifiers = "0000" } = {}) =>
  `${version}0${identity}${set}${status}${role}${amplifier}${entity}${modifiers}`;

// The icons and modifiers of a set that milsymbol has, as it draws them for a friend.
function icons(set, version) {
  const { metadata, colors } = new milsymbol.Symbol(code(3, set, { version }));
  const parts = milsymbol._getIconParts(metadata, colors, true, "", false);
  return milsymbol._getIcons.number(milsymbol, set, parts, true, metadata.edition);
}

// Where 2525E differs, the code follows with its version.
function versions(set, kind, key) {
  const drawn = [10, 13].map((version) => JSON.stringify(icons(set, version)[kind][key]));
  return drawn[0] === drawn[1] ? [10] : [10, 13];
}

function symbolSet(set) {
  const table = new Table();
  for (const identity of IDENTITIES) table.add(code(identity, set));
  const each = (kind, options) => {
    for (const [key, drawing] of Object.entries(icons(set, 10)[kind]).sort(([a], [b]) => (a < b ? -1 : 1))) {
      // The common modifiers of 2525E have three digits; a number that is reserved has no drawing.
      if (kind !== "icons" && (key.length !== 2 || drawing.length === 0)) continue;
      for (const version of versions(set, kind, key)) {
        for (const identity of IDENTITIES) table.add(code(identity, set, { version, ...options(key) }));
      }
    }
  };
  each("icons", (entity) => ({ entity }));
  each("m1", (modifier) => ({ modifiers: modifier + "00" }));
  each("m2", (modifier) => ({ modifiers: "00" + modifier }));
  // Icons of equipment make way for modifiers, but for some; special headquarters have subtypes of their own.
  const more = {
    10: [95, 96, 97, 98].map((subtype) => ({ entity: `1211${subtype}` })),
    15: ["0100", "0001", "0101"].flatMap((modifiers) => ["120200", "110200", "200900"].map((entity) => ({ entity, modifiers }))),
    27: ["0100", "0001", "0101"].flatMap((modifiers) => ["110101", "110301"].map((entity) => ({ entity, modifiers }))),
  };
  for (const options of more[set] ?? []) for (const identity of IDENTITIES) table.add(code(identity, set, options));
  return table.lines;
}

function amplifiers() {
  const table = new Table();
  const sets = ["00", "01", "02", "05", "06", "10", "11", "15", "20", "27", "30", "35", "40", "50", "51", "52", "53", "54", "60"];
  for (const identity of IDENTITIES) for (const set of sets) table.add(code(identity, set));
  for (const identity of IDENTITIES) {
    for (const amplifier of [11, 12, 13, 14, 15, 16, 17, 18, 21, 22, 23, 24, 25, 26]) {
      table.add(code(identity, "10", { amplifier }));
      table.add(code(identity, "10", { amplifier, role: 4 }), false);
    }
    for (const amplifier of [13, 15, 18]) table.add(code(identity, "20", { amplifier }), identity === 3);
    for (const amplifier of [31, 32, 33, 34, 35, 36, 37, 41, 42, 51, 52, 61, 62]) table.add(code(identity, "15", { amplifier, entity: "120200" }));
    for (const role of [1, 2, 3, 4, 5, 6, 7]) for (const set of ["10", "15", "20", "01"]) table.add(code(identity, set, { role }), role === 2 || role === 4);
    for (const status of [1, 2, 3, 4, 5]) table.add(code(identity, "10", { status }), status !== 1);
    for (const status of [2, 4]) table.add(code(identity, "15", { status, amplifier: "33" }), true);
  }
  for (const identity of [0, 2, 5]) for (const set of ["10", "15", "01", "20", "30", "35"]) table.add(code(identity, set), false);
  return table.lines;
}

function common() {
  const table = new Table();
  const extended = (identity, set, flags, frame, options) => code(identity, set, { version: 13, ...options }) + flags + frame + "0000000";
  const { m1, m2 } = icons("10", 13);
  const numbers = (drawings) => Object.keys(drawings).filter((key) => key.length === 3).sort();
  for (const identity of IDENTITIES) table.add(extended(identity, "10", "00", 0, {}));
  for (const key of numbers(m1)) for (const identity of IDENTITIES) table.add(extended(identity, "10", "10", 0, { modifiers: key.slice(1) + "00" }));
  for (const key of numbers(m2)) for (const identity of IDENTITIES) table.add(extended(identity, "10", "01", 0, { modifiers: "00" + key.slice(1) }));
  // Milsymbol draws 9, cyberspace, without its corner.
  for (const frame of [1, 2, 3, 4, 5, 6, 7, 8]) for (const set of ["01", "20", "40"]) for (const identity of IDENTITIES) table.add(extended(identity, set, "00", frame, {}));
  return table.lines;
}

const [folder, ...wanted] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
for (const name of wanted.length ? wanted : [...SETS, "amplifiers", "common"]) {
  const lines = name === "amplifiers" ? amplifiers() : name === "common" ? common() : symbolSet(name);
  writeFileSync(join(folder, `${name}.txt`), lines.join("\n") + "\n");
}
