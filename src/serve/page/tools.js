// The tools: how many places each needs, what it asks the service, and what it shows of the answer.
//
// A tool's `ask` resolves to what is shown: { verdict, facts, chart, lines, points, grid }.

const IN_SIGHT = "#1b7f3b";
const HIDDEN = "#a3261b";
const LINE = "#0b5cad";
/** The parts of a viewshed's grid a side, each drawn as a parallelogram. */
const GRID_STEPS = 4;

const ABSENCES = { NoData: "The elevation has no data there", Outside: "This lies outside the elevation" };

const TOOLS = {
  height: {
    places: 1,
    hint: "Click the map for the height of a place.",
    async ask({ described_places: [{ elevation, status, datum }] }) {
      const verdict = elevation === null ? ABSENCES[status] ?? status : `${elevation.toFixed(2)} m`;
      return { verdict, facts: datum ? [["Counted from", datum]] : [] };
    },
  },
  profile: {
    places: 2,
    isLonger: true,
    hint: "Click two places or more: the ground along the line between them.",
    async ask({ dataset, places, signal }) {
      const profile = await ask("v1/profile", { dataset: dataset.name, locations: places.map(written).join("|") }, signal);
      const known = profile.results.filter(({ elevation }) => elevation !== null);
      const facts = [];
      if (known.length > 0) {
        const heights = known.map(({ elevation }) => elevation);
        facts.push(["Lowest", `${heights.reduce((a, b) => Math.min(a, b)).toFixed(2)} m`]);
        facts.push(["Highest", `${heights.reduce((a, b) => Math.max(a, b)).toFixed(2)} m`]);
      }
      const { climb, descent } = climbs(profile.results);
      facts.push(["Climb", `${climb.toFixed(1)} m`], ["Descent", `${descent.toFixed(1)} m`]);
      facts.push(["Breaks of the ground", String(profile.results.length)]);
      const chart = { stations: profile.results, length_m: profile.length_m };
      return { verdict: meters(profile.length_m), facts, chart, lines: [{ places, color: LINE }] };
    },
  },
  sight: {
    places: 2,
    hint: "Click the eye, then what it looks at.",
    letters: "ET",
    async ask({ dataset, places: [from, to], settings, signal }) {
      const heights = { observer_height: settings.observer, target_height: settings.target };
      const [sight, profile] = await Promise.all([
        ask("v1/los", { dataset: dataset.name, from: written(from), to: written(to), ...heights }, signal),
        ask("v1/profile", { dataset: dataset.name, locations: `${written(from)}|${written(to)}` }, signal),
      ]);
      const { visible, blocker, distance_m } = sight;
      const facts = [["Distance", meters(distance_m)]];
      const [lines, points, marks] = [[], [], []];
      if (blocker) {
        const at = blocker.location;
        facts.push(["Hidden by", `ground ${blocker.elevation.toFixed(2)} m high`]);
        facts.push(["There", `${meters(blocker.distance_m)} from the eye`], ["At", degrees(place(at.lat, at.lng))]);
        lines.push({ places: [from, at], color: IN_SIGHT }, { places: [at, to], color: HIDDEN });
        points.push({ at, letter: "×", color: HIDDEN });
        marks.push({ station_m: blocker.distance_m, elevation: blocker.elevation, color: HIDDEN });
      } else {
        lines.push({ places: [from, to], color: visible ? IN_SIGHT : "#55636d" });
      }
      const verdict = visible === null ? ABSENCES[sight.sight] ?? sight.sight : visible ? "In sight" : "Hidden";
      return { verdict, facts, lines, points, chart: { stations: profile.results, length_m: profile.length_m, marks } };
    },
  },
  viewshed: {
    places: 1,
    hint: "Click where the eye is: bright ground is in sight, dark ground is hidden.",
    letters: "E",
    async ask({ dataset, places: [at], settings, signal }) {
      const viewshed = await ask("v1/viewshed", {
        dataset: dataset.name,
        observer: written(at),
        observer_height: settings.observer,
        target_height: settings.target,
        range: 1000 * settings.range,
      }, signal);
      const { visible, hidden } = viewshed.counts;
      const square_km = viewshed.visible_area_m2 / 1e6;
      const facts = [
        ["Of the ground in range", `${((100 * visible) / Math.max(visible + hidden, 1)).toFixed(1)} %`],
        ["Posts", `${visible} in sight, ${hidden} hidden`],
        ["Post", `${viewshed.cell.x.toFixed(1)} × ${viewshed.cell.y.toFixed(1)} m, ${viewshed.crs}`],
      ];
      const grid = { picture: viewshed_picture(viewshed), places: await grid_places(dataset, viewshed, signal) };
      return { verdict: `${square_km.toFixed(2)} km² in sight`, facts, grid };
    },
  },
};

/** The sums of what a profile rises and falls. */
function climbs(stations) {
  let [climb, descent] = [0, 0];
  for (let index = 1; index < stations.length; index += 1) {
    const [before, now] = [stations[index - 1].elevation, stations[index].elevation];
    if (before === null || now === null) continue;
    climb += Math.max(now - before, 0);
    descent += Math.max(before - now, 0);
  }
  return { climb, descent };
}

/** The posts of a viewshed as pixels, north up. */
function viewshed_picture({ columns, rows, runs }) {
  // Light against dark, which tells them apart without hues.
  const colors = { v: [255, 226, 80, 255], h: [44, 50, 78, 255] };
  const data = new ImageData(columns, rows);
  runs.forEach((row, number) => {
    let at = (rows - 1 - number) * columns;
    for (const [, count, letter] of row.matchAll(/(\d+)([vhnb])/g)) {
      const color = colors[letter];
      for (let left = Number(count); left > 0; left -= 1, at += 1) {
        if (color) data.data.set(color, 4 * at);
      }
    }
  });
  const picture = document.createElement("canvas");
  [picture.width, picture.height] = [columns, rows];
  picture.getContext("2d").putImageData(data, 0, 0);
  return picture;
}

/** The places of posts of a viewshed's grid, evenly from the south-west to the north-east. */
async function grid_places(dataset, { crs, south_west, cell, columns, rows }, signal) {
  const locations = [];
  for (let row = 0; row <= GRID_STEPS; row += 1) {
    for (let column = 0; column <= GRID_STEPS; column += 1) {
      const x = south_west.x + (cell.x * (columns - 1) * column) / GRID_STEPS;
      const y = south_west.y + (cell.y * (rows - 1) * row) / GRID_STEPS;
      locations.push(`${x},${y}`);
    }
  }
  const system = /^EPSG:\d+$/.test(crs) ? crs : "native";
  const answer = await ask(path_of(dataset), { crs: system, positions: "dd", locations: locations.join("|") }, signal);
  const places = answer.results.map(({ location }) => place_of_degrees(location.position));
  return places.every(Boolean) ? places : null;
}
