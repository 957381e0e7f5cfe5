// Draws tactical graphics with an independent renderer, mil-sym-ts, and prints their lines in meters as a text table.
//
//     npm install @armyc2.c5isr.renderer/mil-sym-ts-web@2.10.4
//     node graphics_oracle.mjs > graphics.txt       in the folder of node_modules; the table is tests/symbology/graphics.txt
//
// The graphics lie on the equator, where a degree has the same length to the east and to the north. A pixel is ten meters.

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

const { WebRenderer, Modifiers, initialize } = await import("@armyc2.c5isr.renderer/mil-sym-ts-web");
if (initialize) await initialize();

const METERS = 111319.49079327357;
const GEOJSON = 2;
const LINE = [[1000, 3000], [3000, 3600], [5000, 3000], [7500, 3400]];
const AREA = [[1000, 2500], [2500, 4000], [5500, 4200], [7000, 2800], [4800, 1500]];
const AXIS = [[7500, 3400], [5000, 3000], [3000, 3600], [1000, 3000], [7000, 4100]];
const GRAPHICS = [
  ["phase_line", "140300", LINE],
  ["light_line", "110200", LINE],
  ["boundary", "110100", LINE],
  ["fire_support_coordination_line", "260100", LINE],
  ["coordinated_fire_line", "260200", LINE],
  ["main_supply_route", "330300", LINE],
  ["objective", "151700", AREA],
  ["battle_position", "151200", AREA],
  ["mined_area", "270800", AREA],
  ["area_target", "240801", AREA],
  ["axis_main_attack", "151403", AXIS],
  ["axis_supporting_attack", "151404", AXIS],
  ["axis_aviation", "151401", AXIS],
  ["axis_attack_helicopter", "151402", AXIS],
  ["axis_feint", "151406", AXIS],
  ["counterattack", "340600", AXIS],
  ["attack_by_aviation", "140601", [[7500, 3400], [5000, 3000], [1000, 3000]]],
  ["main_direction_of_attack", "140602", [[7500, 3400], [5000, 3000], [1000, 3000]]],
  ["supporting_direction_of_attack", "140603", [[7500, 3400], [5000, 3000], [1000, 3000]]],
  ["feint_direction_of_attack", "140605", [[7500, 3400], [5000, 3000], [1000, 3000]]],
  ["principal_direction_of_fire", "140500", [[3000, 2000], [6000, 4000], [6500, 2500]]],
  ["infiltration_lane", "140800", [[1000, 3000], [6000, 3500], [6000, 3900]]],
  ["ambush", "141700", [[6000, 4000], [3000, 4000], [3300, 2000]]],
  ["attack_by_fire", "152000", [[6000, 4500], [3000, 3500], [3500, 2000]]],
  ["support_by_fire", "152100", [[3000, 3500], [3500, 2000], [6000, 4500], [6500, 2200]]],
  ["air_corridor", "170100", [[1000, 3000], [4000, 4000], [7000, 3000]], { AM_DISTANCE: "800" }],
  ["linear_target", "240701", [[2000, 2000], [5000, 3500]]],
  ["circular_target", "240803", [[4000, 3000]], { AM_DISTANCE: "1000" }],
  ["range_fan_circular", "242100", [[4000, 3000]], { AM_DISTANCE: "500,1000,2000" }],
  ["obstacle_block", "270501", [[3000, 4000], [3000, 2000], [6000, 3200]]],
  ["obstacle_disrupt", "270502", [[2500, 4200], [2000, 1800], [6000, 3500]]],
  ["obstacle_fix", "270503", [[6000, 3500], [2000, 2500]]],
  ["obstacle_turn", "270504", [[5000, 4500], [2000, 2000], [2500, 4200]]],
  ["obstacle_bypass", "270601", [[3000, 4000], [3000, 2000], [6000, 3200]]],
  ["bridge", "271100", [[2000, 4000], [5000, 4200], [2200, 3000], [5200, 3200]]],
  ["assault_crossing", "271300", [[2000, 4000], [5000, 4200], [2200, 3000], [5200, 3200]]],
  ["ford_easy", "271500", [[2000, 4000], [5000, 4200], [2200, 3000]]],
  ["ford_difficult", "271600", [[2000, 4000], [5000, 4200], [2200, 3000]]],
  ["abatis", "280100", LINE],
  ["ferry", "290700", [[2000, 2000], [6000, 3500]]],
  ["lane", "290600", [[2000, 2000], [6000, 3500]]],
  ["fighting_position", "291000", [[2000, 2000], [6000, 3500]]],
  ["moving_convoy", "330100", [[2000, 2000], [6000, 3500]]],
  ["block", "340100", [[3000, 4000], [3000, 2000], [6000, 3200]]],
  ["breach", "340200", [[3000, 4000], [3000, 2000], [6000, 3200]]],
  ["bypass", "340300", [[3000, 4000], [3000, 2000], [6000, 3200]]],
  ["canalize", "340400", [[3000, 4000], [3000, 2000], [6000, 3200]]],
  ["clear", "340500", [[3000, 4000], [3000, 2000], [6000, 3200]]],
  ["penetrate", "341800", [[3000, 4000], [3000, 2000], [6000, 3200]]],
  ["contain", "151204", [[3000, 4000], [3000, 2000], [6000, 3200]]],
  ["delay", "340800", [[6000, 4500], [2500, 4000], [2500, 3000]]],
  ["withdraw", "342400", [[6000, 4500], [2500, 4000], [2500, 3000]]],
  ["retire", "342000", [[6000, 4500], [2500, 4000], [2500, 3000]]],
  ["disrupt", "341000", [[2500, 4200], [2000, 1800], [6000, 3500]]],
  ["fix", "341100", [[6000, 3500], [2000, 2500]]],
  ["isolate", "341500", [[4000, 3000], [5500, 3000]]],
  ["retain", "151205", [[4000, 3000], [5500, 3000]]],
  ["occupy", "341700", [[4000, 3000], [5500, 3000]]],
  ["secure", "342100", [[4000, 3000], [5500, 3000]]],
  ["cover", "342201", [[4000, 3000], [2000, 2000], [6500, 2500]]],
  ["guard", "342202", [[4000, 3000], [2000, 2000], [6500, 2500]]],
  ["screen", "342203", [[4000, 3000], [2000, 2000], [6500, 2500]]],
  ["seize", "342300", [[2500, 2000], [3200, 2000], [6000, 4000], [6000, 2500]]],
  ["follow_and_assume", "341200", [[2000, 2000], [6000, 3500]]],
  ["follow_and_support", "341300", [[2000, 2000], [6000, 3500]]],
  ["forward_line_of_troops", "140100", LINE],
  ["fortified_line", "290900", LINE],
  ["fortified_area", "151000", AREA],
  ["strong_point", "151203", AREA],
  ["obstacle_line", "290100", LINE],
  ["obstacle_belt", "270100", AREA],
  ["obstacle_free_zone", "270300", AREA],
  ["ditch_under_construction", "290201", LINE],
  ["wire", "290301", LINE],
  ["single_fence", "290302", LINE],
  ["double_apron_fence", "290304", LINE],
];

console.log("# Lines of tactical graphics as mil-sym-ts 2.10.4 draws them, in meters; a text is 120 m high.");
console.log("# Made by tests/tools/graphics_oracle.mjs.");
const list = (points) => points.map((point) => point.join(" ")).join(", ");
const meters = (points) => list(points.map((point) => point.map((degrees) => (degrees * METERS).toFixed(0))));
for (const [word, code, points, fields] of GRAPHICS) {
  const modifiers = new Map(Object.entries(fields || {}).map(([name, value]) => [Modifiers[name], value]));
  const places = points.map(([x, y]) => `${x / METERS},${y / METERS}`).join(" ");
  const box = `0,0,${10000 / METERS},${6000 / METERS}`;
  const sidc = `1003250000${code}0000`;
  const text = WebRenderer.RenderSymbol2D("id", word, "", sidc, places, 1000, 600, box, modifiers, new Map(), GEOJSON);
  console.log(`graphic ${word} ${code}`);
  console.log("points", list(points));
  for (const { geometry } of JSON.parse(text).features) {
    const { type, coordinates } = geometry;
    if (type === "LineString") console.log("line", meters(coordinates));
    if (type === "MultiLineString") coordinates.forEach((line) => console.log("line", meters(line)));
    if (type === "Polygon") coordinates.forEach((ring) => console.log("ring", meters(ring)));
    if (type === "MultiPolygon") coordinates.flat().forEach((ring) => console.log("ring", meters(ring)));
  }
}
