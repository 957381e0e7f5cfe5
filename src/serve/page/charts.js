// The chart of the ground along a line.

class ProfileChart {
  /** `pointed` is called with the station under the pointer, or with null. */
  constructor(figure, pointed) {
    this.figure = figure;
    this.canvas = figure.querySelector("canvas");
    this.caption = figure.querySelector("figcaption");
    this.stations = [];
    this.marks = [];
    const point = (event) => {
      const box = this.canvas.getBoundingClientRect();
      const found = event && this.station_at(event.clientX - box.left);
      this.marked = found ?? null;
      this.draw();
      pointed(this.marked);
    };
    this.canvas.addEventListener("pointermove", point);
    this.canvas.addEventListener("pointerdown", point);
    this.canvas.addEventListener("pointerleave", () => point(null));
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  /** Shows the stations of a profile; `marks` are stations with a color. */
  show(stations, length_m, marks = []) {
    const known = stations.filter(({ elevation }) => elevation !== null);
    Object.assign(this, { stations, marks, length_m, known, marked: null });
    this.figure.hidden = known.length < 2;
    if (this.figure.hidden) return;
    const heights = known.map(({ elevation }) => elevation);
    this.low = heights.reduce((a, b) => Math.min(a, b));
    this.high = heights.reduce((a, b) => Math.max(a, b));
    const label = `The ground over ${meters(length_m)}, from ${this.low.toFixed(1)} m to ${this.high.toFixed(1)} m high`;
    this.canvas.setAttribute("aria-label", label);
    this.draw();
  }

  hide() {
    this.stations = [];
    this.figure.hidden = true;
  }

  frame() {
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    return { left: 46, right: width - 6, top: 8, bottom: height - 20, width, height };
  }

  station_at(pixel) {
    if (!this.known?.length) return null;
    const { left, right } = this.frame();
    const station_m = ((pixel - left) / Math.max(right - left, 1)) * this.length_m;
    const far = (station) => Math.abs(station.station_m - station_m);
    return this.known.reduce((best, station) => (far(station) < far(best) ? station : best));
  }

  draw() {
    if (this.figure.hidden || !this.known?.length) return;
    const ratio = window.devicePixelRatio || 1;
    const { left, right, top, bottom, width, height } = this.frame();
    this.canvas.width = Math.max(1, Math.round(width * ratio));
    this.canvas.height = Math.max(1, Math.round(height * ratio));
    const context = this.canvas.getContext("2d");
    context.scale(ratio, ratio);
    const span = Math.max(this.high - this.low, 1);
    const [low, high] = [this.low - 0.06 * span, this.low + 1.06 * span];
    const x = (station_m) => left + (station_m / Math.max(this.length_m, 1e-9)) * (right - left);
    const y = (elevation) => bottom - ((elevation - low) / (high - low)) * (bottom - top);
    context.font = "12px system-ui, sans-serif";
    this.draw_axes(context, { x, y, left, right, top, bottom, low, high });
    // A gap where there is no ground.
    const runs = [[]];
    for (const station of this.stations) {
      if (station.elevation === null) runs.push([]);
      else runs.at(-1).push(station);
    }
    for (const run of runs.filter(({ length }) => length > 1)) {
      context.beginPath();
      run.forEach(({ station_m, elevation }) => context.lineTo(x(station_m), y(elevation)));
      context.strokeStyle = "#5b4a2f";
      context.lineWidth = 1.5;
      context.lineJoin = "round";
      context.stroke();
      context.lineTo(x(run.at(-1).station_m), bottom);
      context.lineTo(x(run[0].station_m), bottom);
      context.fillStyle = "rgb(178 156 108 / 45%)";
      context.fill();
    }
    const dots = this.marks.concat(this.marked ? [{ ...this.marked, color: "#0b5cad" }] : []);
    for (const { station_m, elevation, color } of dots) {
      context.beginPath();
      context.arc(x(station_m), y(elevation), 4.5, 0, 2 * Math.PI);
      context.fillStyle = color;
      context.fill();
    }
    this.caption.textContent = this.marked
      ? `${this.marked.elevation.toFixed(2)} m high, ${meters(this.marked.station_m)} from the start`
      : "";
  }

  draw_axes(context, { x, y, left, right, top, bottom, low, high }) {
    context.strokeStyle = "#d5dbe0";
    context.fillStyle = "#55636d";
    context.lineWidth = 1;
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const height of round_steps(low, high, 4)) {
      context.beginPath();
      context.moveTo(left, y(height));
      context.lineTo(right, y(height));
      context.stroke();
      context.fillText(String(height), left - 6, y(height));
    }
    context.textBaseline = "bottom";
    const isFar = this.length_m >= 2000;
    for (const station of round_steps(0, this.length_m, 4)) {
      context.textAlign = station === 0 ? "left" : "center";
      if (x(station) > right - 30) continue;
      context.fillText(isFar ? `${Number((station / 1000).toPrecision(6))} km` : `${station} m`, x(station), bottom + 19);
    }
    context.textAlign = "left";
    context.textBaseline = "top";
    context.fillText("m", left + 3, top - 4);
  }
}

/** Round numbers from `low` to `high`, about `count` of them. */
function round_steps(low, high, count) {
  const rough = Math.max((high - low) / count, 1e-6);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= rough);
  const steps = [];
  for (let index = Math.ceil(low / step); index * step <= high; index += 1) steps.push(Number((index * step).toPrecision(12)));
  return steps;
}
