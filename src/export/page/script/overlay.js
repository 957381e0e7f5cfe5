// What stands on the picture: names without overlap, the north arrow, the scale bar, what was picked.

// Letters by the kind of thing that is named: size in CSS pixels, weight and slope, color.
const LETTERS = {
  place: { px: 14, font: "600", color: "#1c1b19" },
  summit: { px: 12.5, font: "600", color: "#3b2c1e" },
  water: { px: 13, font: "italic 500", color: "#1f4f7d" },
  road: { px: 11.5, font: "500", color: "#4a3a2a" },
  area: { px: 13, font: "italic 500", color: "#3b4a2e" },
  point: { px: 12.5, font: "500", color: "#1c1b19" },
};
const FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Noto Sans', sans-serif";
// Free pixels around a name, and the most names at once: more would hide the ground.
const GAP_PX = 4;
const MOST_NAMES = 120;

class Overlay {
  constructor(description, ground) {
    this.description = description;
    this.ground = ground;
    this.canvas = document.getElementById("names");
    this.labels = [...description.labels].sort((a, b) => a.rank - b.rank);
    // A name that was shown keeps its place before its equals, so that names do not flicker.
    this.shown = new Set();
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
    const placed = this.names(pen, camera, size, taken);
    for (const { label, box, at, top } of placed) this.name(pen, label, box, at, top);
    this.shown = new Set(placed.map(({ label }) => label));
    if (this.pick) this.cross(pen, camera, size);
    this.north(camera);
    this.scale(camera, size);
  }

  // The boxes of what stands on the page.
  furniture() {
    const boxes = ["title", "subtitle", "views", "north", "scale", "picked", "credits"].map((id) =>
      document.getElementById(id).getBoundingClientRect());
    return boxes.filter((box) => box.width > 0).map(({ left, top, right, bottom }) => [left, top, right, bottom]);
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
      label.width ??= pen.measureText(label.text).width;
      const box = this.places(label, letters, at, top).find((candidate) =>
        candidate[0] >= 2 && candidate[2] <= size[0] - 2 && candidate[1] >= 2 && isFree(candidate));
      if (!box || (this.ground.hides(camera, label.anchor) && this.ground.hides(camera, label.ground))) continue;
      taken.push(box);
      placed.push({ label, box, at, top });
    }
    return placed;
  }

  // Boxes where a name may stand, the best first.
  places(label, letters, at, top) {
    const [width, height] = [label.width, letters.px * 1.2];
    const boxOf = (left, lower) => [left, lower - height, left + width, lower];
    const isRaised = Math.hypot(top.x - at.x, top.y - at.y) > 3;
    const centered = boxOf(top.x - width / 2, top.y + height / 2);
    if (label.kind === "water" || label.kind === "area" || label.kind === "road") return [centered];
    const above = boxOf(top.x - width / 2, top.y - 5);
    if (isRaised) return [above];
    return [boxOf(at.x + 7, at.y + height / 2), boxOf(at.x - 7 - width, at.y + height / 2), above,
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
    pen.font = `${letters.font} ${letters.px}px ${FONT}`;
    pen.textBaseline = "alphabetic";
    pen.strokeStyle = "rgba(255, 255, 255, 0.86)";
    pen.lineWidth = 3;
    const baseline = box[3] - letters.px * 0.26;
    pen.strokeText(label.text, box[0], baseline);
    pen.fillStyle = letters.color;
    pen.fillText(label.text, box[0], baseline);
  }

  mark(pen, kind, at) {
    pen.fillStyle = "#1c1b19";
    pen.strokeStyle = "#ffffff";
    pen.lineWidth = 1.2;
    pen.beginPath();
    if (kind === "summit") {
      pen.moveTo(at.x, at.y - 5);
      pen.lineTo(at.x + 4.2, at.y + 2.5);
      pen.lineTo(at.x - 4.2, at.y + 2.5);
      pen.closePath();
    } else if (kind === "place" || kind === "point") {
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
    const degrees = -camera.azimuth * 180 / Math.PI;
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
