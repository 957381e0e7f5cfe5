// Draws tactical graphics with an independent renderer, mil-sym-ts, and prints their lines in meters as a text table.
//
//     npm install @armyc2.c5isr.renderer/mil-sym-ts-web@2.10.4
//     node graphics_oracle.mjs > graphics.txt       in the folder of node_modules; the table is tests/symbology/graphics.txt
//
// Every line and area of symbol sets 25, 45 and 46 is drawn in three shapes: one laid out by its draw rule, the same turned and
// smaller, and the same mirrored. The graphics lie on the equator, where a degree has the same length to the east and to the
// north. A pixel is ten meters.

/** What the renderer needs of a browser: it measures texts. */
class TextMeasure {
  font = "10px Arial";
  measureText(text) {
    const px = Number((/([0-9.]+)p[xt]/.exec(this.font) || [0, 10])[1]);
    const width = text.length * px * 0.6;
    return {
      width,
      actualBoundingBoxLeft: 0,
      actualBoundingBoxRight: width,
      actualBoundingBoxAscent: px * 0.75,
      actualBoundingBoxDescent: px * 0.2,
      fontBoundingBoxAscent: px * 0.9,
      fontBoundingBoxDescent: px * 0.2,
    };
  }
}
class Canvas {
  getContext() {
    return new TextMeasure();
  }
}
globalThis.OffscreenCanvas = Canvas;
globalThis.document = { createElement: () => new Canvas() };
globalThis.window = globalThis;

const { WebRenderer, Modifiers, MSLookup, DrawRules, initialize } = await import("@armyc2.c5isr.renderer/mil-sym-ts-web");
if (initialize) await initialize();

const METERS = 111319.49079327357;
const GEOJSON = 2;
/** Versions of the standard: 2525D change 1, and 2525E for what only it has. */
const VERSIONS = [11, 13];
const SETS = [25, 45, 46];

/** Points by draw rule, else by their number; and what else a rule needs. */
const SHAPES = {
  AXIS1: [[7500, 3400], [5000, 3000], [3000, 3600], [1000, 3000], [7000, 4100]],
  AXIS2: [[7500, 3400], [5000, 3000], [3000, 3600], [1000, 3000], [7000, 4100]],
  LINE3: [[3000, 2000], [6000, 4000], [6500, 2500]],
  POLYLINE1: [[1000, 3000], [6000, 3500], [6000, 3900]],
  LINE29: [[6000, 4000], [3000, 4000], [3300, 2000]],
  AREA6: [[4000, 3000], [5500, 3000]],
  AREA7: [[6000, 4500], [3000, 3500], [3500, 2000]],
  AREA8: [[3000, 3500], [3500, 2000], [6000, 4500], [6500, 2200]],
  AREA12: [[2500, 4200], [2000, 1800], [6000, 3500]],
  AREA25: [[2500, 4200], [2000, 1800], [6000, 3500]],
  AREA15: [[4000, 3000], [5500, 3000]],
  AREA16: [[4000, 3000], [5500, 3000]],
  AREA19: [[4000, 3000], [5500, 3000]],
  AREA18: [[3000, 3800], [6500, 3600], [6500, 2400], [3000, 2200]],
  AREA14: [[4000, 3000], [4000, 3500], [5200, 3000]],
  AREA21: [[3000, 2000], [6500, 4200], [6500, 2600]],
  AREA26: [[2000, 2500], [3500, 4000], [5000, 2500], [5600, 2500], [6600, 3600], [7600, 2400]],
  LINE9: [[6000, 3500], [2000, 2500]],
  LINE28: [[6000, 3500], [2000, 2500]],
  LINE10: [[5000, 4500], [2000, 2000], [2500, 4200]],
  LINE11: [[2000, 4000], [5000, 4200], [2200, 3000], [5200, 3200]],
  LINE16: [[2000, 4000], [5000, 4200], [2200, 3000], [5200, 3200]],
  LINE17: [[2000, 4000], [5000, 4200], [2200, 3000]],
  LINE24: [[6000, 4500], [2500, 4000], [2500, 3000]],
  LINE26: [[4000, 3000], [2000, 2000], [6500, 2500]],
  LINE27: [[2500, 2000], [3200, 2000], [6000, 4000], [6000, 2500]],
  LINE12: [[2000, 3000], [6000, 3000], [4000, 3500]],
  LINE30: [[6000, 3600], [2000, 2600], [3000, 4000]],
  LINE33: [[2000, 2000], [5000, 2400], [4600, 4000]],
  AREA27: [[2000, 3000], [5500, 3600], [4000, 4500]],
  LINE31: [[2500, 4000], [4500, 4200], [5500, 3000], [6500, 3000]],
  1: [[4000, 3000]],
  2: [[2000, 2000], [6000, 3500]],
  3: [[3000, 4000], [3000, 2000], [6000, 3200]],
  4: [[2000, 4000], [5000, 4200], [2200, 3000], [5200, 3200]],
  line: [[1000, 3000], [3000, 3600], [5000, 3000], [7500, 3400]],
  area: [[1000, 2500], [2500, 4000], [5500, 4200], [7000, 2800], [4800, 1500]],
};
const FIELDS = {
  CORRIDOR1: { AM_DISTANCE: "800" },
  CIRCULAR1: { AM_DISTANCE: "1000" },
  CIRCULAR2: { AM_DISTANCE: "500,1000,2000" },
  RECTANGULAR1: { AM_DISTANCE: "1200" },
  // In mils: 30 degrees.
  RECTANGULAR2: { AM_DISTANCE: "2400,1200", AN_AZIMUTH: "533.333" },
  RECTANGULAR3: { AM_DISTANCE: "1200" },
  // This renderer turns an ellipse counter-clockwise from east: an azimuth of 60 degrees.
  ELLIPSE1: { AM_DISTANCE: "1500,700", AN_AZIMUTH: "30" },
  ARC1: { AM_DISTANCE: "0,1000,2000", AN_AZIMUTH: "20,90,30,80" },
  POINT17: { AM_DISTANCE: "600,1500", AN_AZIMUTH: "40,90" },
  POINT18: { AM_DISTANCE: "600,1500", AN_AZIMUTH: "40,90" },
};

/** The points of a kind whose draw rule is `rule`. */
function pointsOf(rule, least, most) {
  if (SHAPES[rule]) return SHAPES[rule];
  if (most < 10 || least === most) return SHAPES[least];
  return /AREA/.test(rule) ? SHAPES.area : SHAPES.line;
}
/** The same points turned by 80 degrees and shrunk, and mirrored, about the middle of the picture. */
const turned = ([x, y]) => {
  const [a, b, c, s] = [x - 4200, y - 3000, Math.cos(1.4) * 0.7, Math.sin(1.4) * 0.7];
  return [Math.round(5000 + a * c - b * s), Math.round(3000 + a * s + b * c)];
};
const mirrored = ([x, y]) => [Math.round(5000 - (x - 4200) * 0.9), Math.round(3000 + (y - 3000) * 0.9)];

const rules = new Map(Object.entries(DrawRules).filter(([, value]) => typeof value === "number").map(([k, v]) => [v, k]));
const POINTS = /^(DONOTDRAW|POINT(?!12|17|18))/;
/** What 2525E draws by other points than 2525D. */
const OTHER_POINTS = {
  25240701: [[2000, 2000], [4500, 3400], [6000, 3500]],
  25342201: [[2000, 2000], [3500, 3000], [4500, 3000], [7000, 2000]],
};
const lookup = MSLookup.getInstance();
const kinds = new Map();
for (const version of VERSIONS) {
  for (const id of lookup.getIDList(version)) {
    const info = lookup.getMSLInfo(id, version);
    if (!info || !SETS.includes(info.getSymbolSet()) || kinds.has(id)) continue;
    const rule = rules.get(info.getDrawRule()) || "";
    const isMetoc = info.getSymbolSet() !== 25;
    if (POINTS.test(rule) || (isMetoc && !/LINE|AREA/i.test(info.getGeometry?.() || rule))) continue;
    kinds.set(id, { version, rule, least: info.getMinPointCount(), most: info.getMaxPointCount() });
  }
}

/** Every field, as its letters. */
const LETTERS = {
  T_UNIQUE_DESIGNATION_1: "FT", T1_UNIQUE_DESIGNATION_2: "FT1", H_ADDITIONAL_INFO_1: "FH", N_HOSTILE: "ENY", W_DTG_1: "FW",
  W1_DTG_2: "FW1", AP_TARGET_NUMBER: "FAP", AS_COUNTRY: "FAS", V_EQUIP_TYPE: "FV",
};

console.log("# Lines and texts of graphics as mil-sym-ts 2.10.4 draws them, in meters; a text is 120 m high.");
console.log("# Made by tests/tools/graphics_oracle.mjs.");
/** Whether a line has any length: the renderer draws some that have none, at a corner of the picture. */
const isLine = (line) => line.some(([x, y]) => x !== line[0][0] || y !== line[0][1]);
const list = (points) => points.map((point) => point.join(" ")).join(",");
const meters = (points) => list(points.map((point) => point.map((degrees) => (degrees * METERS).toFixed(0))));
const box = `0,0,${10000 / METERS},${6000 / METERS}`;
const drawn = [...kinds].sort(([a], [b]) => (a < b ? -1 : 1));
for (const [id, shape] of Object.entries(OTHER_POINTS)) {
  drawn.push([id, { version: 13, rule: rules.get(lookup.getMSLInfo(id, 13).getDrawRule()), shape }]);
}
for (const [id, { version, rule, least, most, shape }] of drawn) {
  const isMetoc = !id.startsWith("25");
  const base = shape ? shape : isMetoc ? pointsOf(/^AREA/.test(rule) ? "area" : "line", 2, 99) : pointsOf(rule, least, most);
  for (const points of [base, base.map(turned), base.map(mirrored), null]) {
    // After three shapes the texts of the first one with all fields.
    const isFull = points === null;
    const letters = isFull ? LETTERS : { T_UNIQUE_DESIGNATION_1: "RED" };
    const fields = { ...(FIELDS[rule] || {}), ...letters };
    const modifiers = new Map(Object.entries(fields).map(([name, value]) => [Modifiers[name], value]));
    const places = (points || base).map(([x, y]) => `${x / METERS},${y / METERS}`).join(" ");
    const latest = isFull && lookup.getMSLInfo(id, 13) ? 13 : version;
    const sidc = `${latest}${isFull ? "06" : "03"}${id.slice(0, 2)}0000${id.slice(2)}0000${latest > 12 ? "0000000000" : ""}`;
    const text = WebRenderer.RenderSymbol2D("id", id, "", sidc, places, 1000, 600, box, modifiers, new Map(), GEOJSON);
    const features = JSON.parse(text).features;
    if (!features) continue;
    if (isFull) {
      const labels = features.map((feature) => feature.properties.label).filter((label) => label);
      if (labels.length) console.log("fields", labels.join(" ").replaceAll("\n", " "));
      continue;
    }
    console.log(`graphic ${id.slice(0, 2)} ${id.slice(2)} ${rule}`);
    console.log("points", list(points));
    for (const { geometry, properties } of features) {
      const { type, coordinates } = geometry;
      if (type === "LineString") console.log("line", meters(coordinates));
      if (type === "MultiLineString") coordinates.filter(isLine).forEach((line) => console.log("line", meters(line)));
      if (type === "Polygon") coordinates.filter((ring) => ring.length).forEach((ring) => console.log("ring", meters(ring)));
      if (type === "MultiPolygon") coordinates.flat().forEach((ring) => console.log("ring", meters(ring)));
      if (type === "Point" && properties.label) {
        console.log("text", meters([coordinates]), properties.label.replaceAll("\n", "\\n"));
      }
    }
  }
}
