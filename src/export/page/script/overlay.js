// What stands on the picture: names without overlap, the north arrow, the scale bar, what was picked.

// Letters by the kind of thing that is named: size in CSS pixels, weight and slope, color.
const LETTERS = {
  place: { px: 14, font: "600", color: "#1c1b19" },
  summit: { px: 12.5, font: "600", color: "#3b2c1e" },
  water: { px: 13, font: "italic 500", color: "#1f4f7d" },
  road: { px: 11.5, font: "500", color: "#4a3a2a" },
  area: { px: 13, font: "italic 500", color: "#3b4a2e" },
  point: { px: 12.5, font: "500", color: "#1c1b19" },
  graphic: { px: 12.5, font: "600", color: "#1c1b19" },
};
// CSS pixels in a pixel of a symbol, which is made for a page 1080 pixels high.
const SYMBOL_SCALE = 0.75;
const FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Noto Sans', sans-serif";
// Free pixels around a name, and the most names at once: more would hide the ground.
const GAP_PX = 4;
const MOST_NAMES = 120;

// A name's lines; the first has the letters of its kind, the others are smaller.
const withLines = (label) => ({ ...label, lines: label.text.split("\n") });

class Overlay {
  constructor(description, ground, symbols) {
    this.description = description;
    this.symbols = description.symbols.map((symbol, index) => ({ ...symbol, bitmap: symbols[index] }))
      .filter(({ bitmap }) => bitmap).sort((a, b) => a.rank - b.rank);
    this.ground = ground;
    this.canvas = document.getElementById("names");
    this.labels = description.labels.map(withLines).sort((a, b) => a.rank - b.rank);
    // Where each name stood last: it keeps to that place while it is free, so that names do not flicker.
    this.last = new Map();
    this.pick = null;
  }

  resize(size, pixelRatio) {
    this.canvas.width = Math.round(size[0] * pixelRatio);
    this.canvas.height = Math.round(size[1] * pixelRatio);
    this.ratio = pixelRatio;
  }

  draw(camera, size) {
    const pen = this.canvas.getContext("2d");
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.clearRect(0, 0, size[0], size[1]);
    const taken = this.furniture();
    this.drawSymbols(pen, camera, size, taken);
    const placed = this.names(pen, camera, size, taken);
    for (const { label, box, at, top } of placed) this.name(pen, label, box, at, top);
    this.last = new Map(placed.map(({ label, place }) => [label, place]));
    if (this.pick) this.cross(pen, camera, size);
    this.north(camera);
    this.scale(camera, size);
  }

  // The boxes of what stands on the page.
  furniture() {
    const boxes = ["title", "subtitle", "views", "north", "scale", "legend", "picked", "credits",
      "classified-above", "classified-below"].map((id) =>
      document.getElementById(id).getBoundingClientRect());
    return boxes.filter((box) => box.width > 0).map(({ left, top, right, bottom }) => [left, top, right, bottom]);
  }

  drawSymbols(pen, camera, size, taken) {
    for (const { ground, bitmap, anchor } of this.symbols) {
      const at = camera.project(ground, size);
      if (!at || at.x < 0 || at.x > size[0] || at.y < 0 || at.y > size[1] || this.ground.hides(camera, ground)) continue;
      const [left, top] = [at.x - anchor[0] * SYMBOL_SCALE, at.y - anchor[1] * SYMBOL_SCALE];
      const [width, height] = [bitmap.width * SYMBOL_SCALE, bitmap.height * SYMBOL_SCALE];
      const box = [left, top, left + width, top + height];
      if (taken.some((other) => box[0] < other[2] && box[2] > other[0] && box[1] < other[3] && box[3] > other[1])) continue;
      taken.push(box);
      pen.drawImage(bitmap, left, top, width, height);
    }
  }

  names(pen, camera, size, taken) {
    const placed = [];
    const isFree = (box) => taken.every((other) =>
      box[0] > other[2] + GAP_PX || box[2] < other[0] - GAP_PX || box[1] > other[3] + GAP_PX || box[3] < other[1] - GAP_PX);
    for (const label of this.labels) {
      if (placed.length >= MOST_NAMES) break;
      const at = camera.project(label.ground, size);
      const top = camera.project(label.anchor, size);
      if (!at || !top || top.x < 0 || top.x > size[0] || top.y < 0 || top.y > size[1]) continue;
      const letters = LETTERS[label.kind] || LETTERS.point;
      pen.font = `${letters.font} ${letters.px}px ${FONT}`;
      label.width ??= Math.max(...label.lines.map((line) => pen.measureText(line).width));
      const boxes = this.places(label, letters, at, top);
      const fits = (box) => box && box[0] >= 2 && box[2] <= size[0] - 2 && box[1] >= 2 && isFree(box);
      const last = this.last.get(label);
      const place = fits(boxes[last]) ? last : boxes.findIndex(fits);
      const box = boxes[place];
      if (!box || (this.ground.hides(camera, label.anchor) && this.ground.hides(camera, label.ground))) continue;
      taken.push(box);
      placed.push({ label, place, box, at, top });
    }
    return placed;
  }

  // Boxes where a name may stand, the best first.
  places(label, letters, at, top) {
    const [width, height] = [label.width, letters.px * 1.2 * label.lines.length];
    const boxOf = (left, lower) => [left, lower - height, left + width, lower];
    const isRaised = Math.hypot(top.x - at.x, top.y - at.y) > 3;
    const centered = boxOf(top.x - width / 2, top.y + height / 2);
    if (label.kind === "water" || label.kind === "area" || label.kind === "road" || label.kind === "graphic") return [centered];
    const above = boxOf(top.x - width / 2, top.y - 5);
    if (isRaised) return [above, boxOf(top.x + 8, top.y + height / 2), boxOf(top.x - 8 - width, top.y + height / 2)];
    return [boxOf(at.x + 8, at.y + height / 2 - 3), boxOf(at.x - 8 - width, at.y + height / 2 - 3), above,
      boxOf(at.x - width / 2, at.y + height + 5)];
  }

  name(pen, label, box, at, top) {
    const letters = LETTERS[label.kind] || LETTERS.point;
    pen.lineJoin = "round";
    if (Math.hypot(top.x - at.x, top.y - at.y) > 3) {
      pen.strokeStyle = "rgba(30, 28, 25, 0.7)";
      pen.lineWidth = 1;
      pen.beginPath();
      pen.moveTo(at.x, at.y);
      pen.lineTo(top.x, top.y - 3);
      pen.stroke();
    }
    this.mark(pen, label.kind, at);
    pen.textBaseline = "alphabetic";
    pen.textAlign = box[0] > at.x ? "left" : box[2] < at.x ? "right" : "center";
    const x = { left: box[0], right: box[2], center: (box[0] + box[2]) / 2 }[pen.textAlign];
    label.lines.forEach((line, index) => {
      pen.font = `${index ? "500" : letters.font} ${letters.px * (index ? 0.88 : 1)}px ${FONT}`;
      pen.strokeStyle = "rgba(255, 255, 255, 0.8)";
      pen.lineWidth = 3;
      const baseline = box[1] + letters.px * (0.94 + 1.2 * index);
      pen.strokeText(line, x, baseline);
      pen.fillStyle = label.color ? `rgb(${label.color.slice(0, 3).join(" ")})` : letters.color;
      pen.fillText(line, x, baseline);
    });
  }

  mark(pen, kind, at) {
    pen.fillStyle = "#1c1b19";
    pen.strokeStyle = "#ffffff";
    pen.lineWidth = 1.2;
    pen.beginPath();
    if (kind === "place") {
      pen.arc(at.x, at.y, 3.4, 0, 2 * Math.PI);
      [pen.fillStyle, pen.strokeStyle, pen.lineWidth] = ["#ffffff", "#1c1b19", 1.6];
    } else if (kind === "summit") {
      pen.moveTo(at.x, at.y - 5);
      pen.lineTo(at.x + 4.2, at.y + 2.5);
      pen.lineTo(at.x - 4.2, at.y + 2.5);
      pen.closePath();
    } else if (kind === "point") {
      pen.arc(at.x, at.y, 2.8, 0, 2 * Math.PI);
    }
    pen.stroke();
    pen.fill();
  }

  cross(pen, camera, size) {
    const at = camera.project(this.pick, size);
    if (!at) return;
    for (const [width, color] of [[4, "rgba(255, 255, 255, 0.9)"], [1.6, "#b3261e"]]) {
      pen.strokeStyle = color;
      pen.lineWidth = width;
      pen.beginPath();
      for (const [x, y] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
        pen.moveTo(at.x + 3 * x, at.y + 3 * y);
        pen.lineTo(at.x + 11 * x, at.y + 11 * y);
      }
      pen.stroke();
    }
  }

  north(camera) {
    const tilt = 0.45 + 0.55 * Math.abs(Math.sin(camera.pitch));
    const degrees = (this.ground.trueNorth(camera.target) - camera.azimuth) * 180 / Math.PI;
    document.getElementById("needle").setAttribute("transform", `scale(1 ${tilt}) rotate(${degrees})`);
  }

  // A bar of a round length: that of ground across the view in the middle of the picture.
  scale(camera, size) {
    const box = document.getElementById("scale");
    const { origin, direction } = camera.ray([size[0] / 2, size[1] / 2], size);
    const along = camera.isParallel ? 1 : this.ground.meet(origin, direction);
    box.hidden = along === null;
    if (along === null) return;
    const perPixel = camera.metersPerPixel(along, size);
    const most = perPixel * Math.min(160, size[0] / 4);
    const power = 10 ** Math.floor(Math.log10(most));
    const meters = [5, 2, 1].map((digit) => digit * power).find((round) => round <= most);
    document.getElementById("bar").style.width = `${meters / perPixel}px`;
    const text = meters >= 1000 ? `${digits(meters / 1000)} km` : `${digits(Number(meters.toPrecision(1)))} m`;
    document.getElementById("length").textContent = camera.isParallel ? text : `${text} in the middle`;
  }

  // The colors of the ground by height; none where a picture hides most of it.
  legend() {
    const { map, imagery } = this.description;
    const stops = map.ramp;
    const [low, high] = [stops[0][0], stops[stops.length - 1][0]];
    if (imagery || !(high > low)) return;
    const channel = (light) => Math.round(255 * (light <= 0.0031308 ? 12.92 * light : 1.055 * light ** (1 / 2.4) - 0.055));
    const steps = Array.from({ length: 33 }, (_, step) => {
      const height = mix(low, high, step / 32);
      const above = clamp(stops.findIndex((stop) => stop[0] > height), 1, stops.length - 1) || 1;
      const [before, after] = [stops[above - 1], stops[step === 32 ? stops.length - 1 : above]];
      const part = step === 32 ? 1 : (height - before[0]) / (after[0] - before[0]);
      return `rgb(${[1, 2, 3].map((index) => channel(mix(before[index], after[index], part))).join(" ")})`;
    });
    const bar = document.getElementById("ramp");
    bar.style.background = `linear-gradient(to top, ${steps.join(", ")})`;
    const power = 10 ** Math.floor(Math.log10((high - low) / 3));
    const step = [5, 2, 1].map((digit) => digit * power).find((round) => round * 3 <= high - low) ?? power;
    for (let height = Math.ceil(low / step) * step; height <= high; height += step) {
      const mark = document.createElement("span");
      mark.textContent = digits(Number(height.toPrecision(12)));
      mark.style.bottom = `${100 * (height - low) / (high - low)}%`;
      bar.append(mark);
    }
    const most = Math.max(...[...bar.children].map((mark) => mark.textContent.length));
    bar.style.marginRight = `${8 + 7 * most}px`;
    document.getElementById("legend").hidden = false;
  }

  // Shows what was picked: rows of a term and a text.
  show(rows) {
    const list = document.getElementById("picked");
    list.replaceChildren(...rows.flatMap(([term, text]) => {
      const [name, value] = [document.createElement("dt"), document.createElement("dd")];
      name.textContent = term;
      value.textContent = text;
      return [name, value];
    }));
    list.hidden = rows.length === 0;
  }
}
