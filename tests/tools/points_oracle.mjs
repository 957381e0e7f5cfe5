// Prints the icons of the points of symbol set 25 as an independent library, milsymbol, draws them, without letters, as lines in
// a box of 200 units, Y down, whose middle is the place.
//
//     npm install milsymbol@3.0.4
//     node points_oracle.mjs CODE... > points.txt      in the folder of node_modules, with the codes of
//     src/symbology/graphic/point_table.rs; the table is tests/symbology/points.txt

import ms from "milsymbol";

const CURVE_STEPS = 6;

/** The arc of an SVG path from `from`, as points. */
function arc(from, [rx, ry, turn, large, sweep, x, y]) {
  const phi = (turn * Math.PI) / 180;
  const [cos, sin] = [Math.cos(phi), Math.sin(phi)];
  const [dx, dy] = [(from[0] - x) / 2, (from[1] - y) / 2];
  const [px, py] = [cos * dx + sin * dy, cos * dy - sin * dx];
  const grown = Math.max(1, Math.sqrt((px / rx) ** 2 + (py / ry) ** 2));
  [rx, ry] = [rx * grown, ry * grown];
  const under = rx * rx * ry * ry - rx * rx * py * py - ry * ry * px * px;
  const share = Math.sqrt(Math.max(0, under / (rx * rx * py * py + ry * ry * px * px))) * (large === sweep ? -1 : 1);
  const [cx, cy] = [(share * rx * py) / ry, (-share * ry * px) / rx];
  const start = Math.atan2((py - cy) / ry, (px - cx) / rx);
  let way = Math.atan2((-py - cy) / ry, (-px - cx) / rx) - start;
  if (sweep && way < 0) way += 2 * Math.PI;
  if (!sweep && way > 0) way -= 2 * Math.PI;
  const [mx, my] = [cos * cx - sin * cy + (from[0] + x) / 2, sin * cx + cos * cy + (from[1] + y) / 2];
  const steps = Math.ceil(Math.abs(way) * 4);
  return Array.from({ length: steps }, (_, step) => {
    const angle = start + (way * (step + 1)) / steps;
    const [ux, uy] = [rx * Math.cos(angle), ry * Math.sin(angle)];
    return [mx + cos * ux - sin * uy, my + sin * ux + cos * uy];
  });
}

/** The lines of an SVG path. */
function lines(path) {
  const words = path.match(/[a-zA-Z]|-?\d*\.?\d+(?:e-?\d+)?/g);
  const counts = { m: 2, l: 2, h: 1, v: 1, c: 6, q: 4, a: 7, z: 0 };
  const found = [];
  let [at, begin, command, index] = [[0, 0], [0, 0], "m", 0];
  while (index < words.length) {
    if (/^[a-zA-Z]$/.test(words[index])) command = words[index++];
    const kind = command.toLowerCase();
    const numbers = words.slice(index, index + counts[kind]).map(Number);
    index += counts[kind];
    const base = command === kind ? at : [0, 0];
    const pairs = [];
    if (kind !== "a") for (let i = 0; i + 1 < numbers.length; i += 2) pairs.push([base[0] + numbers[i], base[1] + numbers[i + 1]]);
    const line = found[found.length - 1];
    if (kind === "m") {
      found.push([pairs[0]]);
      [at, begin] = [pairs[0], pairs[0]];
      command = command === "m" ? "l" : "L";
      continue;
    }
    let points = pairs;
    if (kind === "h") points = [[base[0] + numbers[0], at[1]]];
    if (kind === "v") points = [[at[0], base[1] + numbers[0]]];
    if (kind === "z") points = [begin];
    if (kind === "a") points = arc(at, [...numbers.slice(0, 5), base[0] + numbers[5], base[1] + numbers[6]]);
    if (kind === "c" || kind === "q") {
      const all = [at, ...pairs];
      points = Array.from({ length: CURVE_STEPS }, (_, step) => {
        const t = (step + 1) / CURVE_STEPS;
        let level = all;
        while (level.length > 1) level = level.slice(1).map((p, i) => [level[i][0] + (p[0] - level[i][0]) * t, level[i][1] + (p[1] - level[i][1]) * t]);
        return level[0];
      });
    }
    if (kind === "z") found.push([begin]);
    line.push(...points);
    at = points[points.length - 1];
  }
  return found.filter((line) => line.length > 1);
}

function* drawn(parts) {
  for (const part of [parts].flat(Infinity)) {
    if (part?.type === "path") yield* lines(part.d);
    if (part?.type === "circle") {
      const corner = (step) => [part.cx + part.r * Math.cos((step * Math.PI) / 12), part.cy + part.r * Math.sin((step * Math.PI) / 12)];
      yield Array.from({ length: 25 }, (_, step) => corner(step));
    }
    if (part?.draw) yield* drawn(part.draw);
  }
}

console.log("# Icons of the points of symbol set 25 as milsymbol 3.0.4 draws them, without letters, in a box of 200 units.");
console.log("# Made by tests/tools/points_oracle.mjs.");
for (const code of process.argv.slice(2)) {
  for (const version of [13, 10]) {
    const symbol = new ms.Symbol(`${version}0325${"0000"}${code}0000`, { size: 100 });
    if (!symbol.isValid()) continue;
    console.log(`point ${code}`);
    for (const line of drawn(symbol.drawInstructions)) {
      console.log("line", line.map((at) => at.map((number) => Number(number.toFixed(1))).join(" ")).join(","));
    }
    break;
  }
}
