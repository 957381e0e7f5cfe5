// The ground on the processor: heights as the program answers them, where a ray meets it, longitude and latitude.

class Ground {
  constructor(description, heights) {
    Object.assign(this, description.ground);
    this.heights = heights;
    this.zScale = description.zScale;
    this.lonLat = description.lonLat;
    this.bounds = description.bounds;
  }

  // The height at map coordinates: bilinear between posts, in the very order of operations of terrain/query/cell.rs. Null
  // where there is none.
  height(east, north) {
    return this.heightAtGrid((east - this.origin[0]) / this.cell[0], (north - this.origin[1]) / this.cell[1]);
  }

  heightAtGrid(x, y) {
    const { columns, rows, heights } = this;
    if (!(x >= 0 && y >= 0 && x <= columns - 1 && y <= rows - 1)) return null;
    const column = Math.min(Math.floor(x), columns - 2);
    const row = Math.min(Math.floor(y), rows - 2);
    const [px, py] = [x - column, y - row];
    const first = row * columns + column;
    const [sw, se, nw, ne] = [heights[first], heights[first + 1], heights[first + columns], heights[first + columns + 1]];
    const south = sw + (se - sw) * px;
    const up = nw + (ne - nw) * px;
    const height = south + (up - south) * py;
    if (!Number.isNaN(height)) return height;
    let [sum, total] = [0, 0];
    const weights = [(1 - px) * (1 - py), px * (1 - py), (1 - px) * py, px * py];
    [sw, se, nw, ne].forEach((corner, index) => {
      if (weights[index] > 0 && !Number.isNaN(corner)) {
        sum += weights[index] * corner;
        total += weights[index];
      }
    });
    return total === 0 ? null : sum / total;
  }

  // World Z of the drawn ground at a world position; null where there is none.
  worldZ(x, y) {
    const height = this.heightAtGrid(x / this.cell[0], y / this.cell[1]);
    return height === null ? null : height * this.zScale;
  }

  // The first place where a ray meets the drawn ground, as the distance along its direction; null where it does not.
  // Steps are half a cell, and longer where the ray is long: a ridge narrower than a 2000th of it may be missed.
  meet(origin, direction, from = 0) {
    const [low, high] = this.bounds;
    let [near, far] = [from, Infinity];
    for (let axis = 0; axis < 3; axis += 1) {
      const margin = axis === 2 ? 1 : 0;
      const ends = [low[axis] - margin, high[axis] + margin].map((side) => (side - origin[axis]) / direction[axis]);
      if (direction[axis] === 0) {
        if (origin[axis] < low[axis] - margin || origin[axis] > high[axis] + margin) return null;
        continue;
      }
      near = Math.max(near, Math.min(...ends));
      far = Math.min(far, Math.max(...ends));
    }
    if (!(near < far)) return null;
    const level = Math.hypot(direction[0], direction[1]);
    const step = Math.max(0.5 * Math.min(...this.cell) / Math.max(level, 1e-9), (far - near) / 2000);
    const above = (along) => {
      const at = plus(origin, direction, along);
      const z = this.worldZ(at[0], at[1]);
      return z === null ? null : at[2] - z;
    };
    let [before, last] = [null, near];
    for (let along = near; ; along = Math.min(along + step, far)) {
      const now = above(along);
      if (now !== null && now <= 0 && before !== null && before > 0) {
        let [over, under] = [last, along];
        for (let halving = 0; halving < 40; halving += 1) {
          const middle = (over + under) / 2;
          if (above(middle) > 0) over = middle;
          else under = middle;
        }
        return under;
      }
      if (along >= far) return null;
      [before, last] = [now, along];
    }
  }

  // Whether ground stands between the eye and a place. What lies within a few meters, or a 500th of the way, does not count.
  hides(camera, place) {
    const eye = camera.isParallel ? plus(place, camera.forward, -camera.distance * 2) : camera.eye;
    const way = minus(place, eye);
    const steps = 160;
    const slack = Math.max(3, length(way) / 500);
    const top = this.bounds[1][2];
    for (let step = 1; step < steps; step += 1) {
      const at = plus(eye, way, step / steps);
      if (at[2] > top && way[2] > 0) return false;
      const z = at[2] > top ? null : this.worldZ(at[0], at[1]);
      if (z !== null && at[2] < z - slack) return true;
    }
    return false;
  }

  // The direction of true north at a place of the world, clockwise from grid north in radians; 0 where that is not known.
  trueNorth(world) {
    const step = Math.max(...this.cell);
    const at = [world[0] + this.origin[0], world[1] + this.origin[1]];
    const places = [[0, 0], [step, 0], [0, step]].map((away) => this.lonLatAt(at[0] + away[0], at[1] + away[1]));
    if (places.some((place) => place === null)) return 0;
    // Along a meridian longitudes do not change, and latitudes grow.
    const [east, north] = [1, 2].map((index) => ((places[index][0] - places[0][0] + 540) % 360) - 180);
    const sign = -north * (places[1][1] - places[0][1]) + east * (places[2][1] - places[0][1]) < 0 ? -1 : 1;
    return Math.atan2(-north * sign, east * sign);
  }

  // Longitude and latitude in degrees at map coordinates, by the table of geom/chebyshev.rs; null where there is none.
  lonLatAt(east, north) {
    const table = this.lonLat;
    if (!table) return null;
    const { min, max, points, values } = table;
    const place = [(east - min[0]) / (max[0] - min[0]) * 2 - 1, (north - min[1]) / (max[1] - min[1]) * 2 - 1];
    const shares = place.map((part) => {
      const cosine = (index) => Math.cos(Math.PI * index / (points - 1));
      const away = Array.from({ length: points }, (_, index) => part - cosine(index));
      const exact = away.indexOf(0);
      if (exact >= 0) return away.map((_, index) => (index === exact ? 1 : 0));
      const weights = away.map((off, index) =>
        (index % 2 ? -1 : 1) * (index === 0 || index === points - 1 ? 0.5 : 1) / off);
      const sum = weights.reduce((a, b) => a + b);
      return weights.map((weight) => weight / sum);
    });
    const sum = [0, 0];
    for (let row = 0; row < points; row += 1) {
      for (let column = 0; column < points; column += 1) {
        const value = values[row * points + column];
        const share = shares[0][column] * shares[1][row];
        sum[0] += value[0] * share;
        sum[1] += value[1] * share;
      }
    }
    return [((sum[0] + 540) % 360 + 360) % 360 - 180, sum[1]];
  }
}

// A number as the program prints it: the shortest digits that read back the same, and no exponent.
function digits(value) {
  const text = Object.is(value, -0) ? "-0" : String(value);
  const [mantissa, exponent] = text.split("e");
  if (exponent === undefined) return text;
  const sign = mantissa.startsWith("-") ? "-" : "";
  const [whole, part = ""] = mantissa.replace("-", "").split(".");
  const point = whole.length + Number(exponent);
  const all = whole + part;
  if (point <= 0) return `${sign}0.${"0".repeat(-point)}${all}`;
  return sign + (point >= all.length ? all.padEnd(point, "0") : `${all.slice(0, point)}.${all.slice(point)}`);
}
