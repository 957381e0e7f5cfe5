// Opens the page: decodes, draws when something changed, and answers clicks.

const KEYS = [
  ["drag", "turn about the place under the pointer"],
  ["right drag, Shift drag, two fingers", "move"],
  ["wheel, pinch, + −", "nearer and farther"],
  ["W A S D, Q E", "fly; down and up"],
  ["arrows", "look around"],
  ["click, tap, Enter", "what is there, where and how high"],
  ["N, T", "north up; from straight above"],
  ["Esc", "close"],
];

class Page {
  constructor(description) {
    this.description = description;
    this.canvas = document.getElementById("view");
    this.size = [1, 1];
    this.frames = 0;
    this.isWanted = false;
    this.lastTime = null;
  }

  message(text) {
    const box = document.getElementById("message");
    box.textContent = text;
    box.hidden = text === "";
  }

  async open() {
    const { description } = this;
    this.texts();
    this.gl = this.canvas.getContext("webgl2", { antialias: true, alpha: false, powerPreference: "high-performance" });
    if (!this.gl) {
      this.message("This browser shows no WebGL 2, which the scene is drawn with. Open the page in a current Firefox, Chrome, "
        + "Edge or Safari, or switch on hardware acceleration in the settings of this one.");
      return;
    }
    if (typeof DecompressionStream === "undefined") {
      this.message("This browser cannot unpack the scene. Open the page in a current Firefox, Chrome, Edge or Safari.");
      return;
    }
    const numbers = document.getElementById("numbers");
    const sections = new Sections(bytesOfBase64(numbers.textContent), description.sections);
    numbers.remove();
    this.data = await SceneData.read(description, sections, (step) => this.message(`Opening the scene: ${step} …`));
    this.ground = new Ground(description, this.data.heights);
    this.overlay = new Overlay(description, this.ground, this.data.symbols);
    this.renderer = new Renderer(this.gl, this.data, this.ground);
    this.cameras = description.cameras.map((view) => this.cameraOf(view));
    this.camera = this.cameras[0];
    this.controls = new Controls(this.canvas, this);
    this.furnish();
    this.message("");
    this.canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      this.renderer = null;
      this.message("The graphics adapter was lost; the scene comes back when it does.");
    });
    this.canvas.addEventListener("webglcontextrestored", () => {
      this.renderer = new Renderer(this.gl, this.data, this.ground);
      this.message("");
      this.moved();
    });
    new ResizeObserver(() => this.moved()).observe(this.canvas);
    this.canvas.focus({ preventScroll: true });
    this.moved();
  }

  // The camera of a view, turned about the ground in the middle of its picture.
  cameraOf(view) {
    const from = view.isParallel ? -1e6 : 0;
    const along = this.ground.meet(view.eye, view.forward, from);
    const [low, high] = this.ground.bounds;
    const middle = [0, 1, 2].map((axis) => (low[axis] + high[axis]) / 2);
    const otherwise = clamp(dot(minus(middle, view.eye), view.forward), 50, 1e6);
    return Camera.of(view, plus(view.eye, view.forward, along ?? otherwise));
  }

  texts() {
    const { title, subtitle, credits, maxError, ground } = this.description;
    document.getElementById("title").textContent = title;
    document.getElementById("subtitle").textContent = subtitle;
    const { classification, zScale } = this.description;
    document.body.classList.toggle("classified", classification !== "");
    for (const id of ["classified-above", "classified-below"]) {
      document.getElementById(id).textContent = classification;
      document.getElementById(id).hidden = classification === "";
    }
    const scale = zScale === 1 ? [] : [`Heights drawn ×${digits(Number(zScale.toPrecision(3)))}`];
    const error = `Ground drawn within ${digits(maxError)} m of its elevation model; heights asked are `
      + (ground.step > 1 ? `those of every ${ground.step}th post of it.` : "exact.");
    document.getElementById("credits").textContent = [...credits, ...scale, error].join(" · ");
    const list = document.createElement("dl");
    for (const [key, action] of KEYS) {
      const [name, value] = [document.createElement("dt"), document.createElement("dd")];
      name.textContent = key;
      value.textContent = action;
      list.append(name, value);
    }
    document.getElementById("keys").append(list);
  }

  furnish() {
    const views = document.getElementById("views");
    views.replaceChildren(...this.description.cameras.map(({ name }, index) => new Option(name, String(index))));
    views.addEventListener("change", () => {
      this.controls.flyTo(this.cameras[Number(views.value)]);
      this.canvas.focus({ preventScroll: true });
    });
    this.overlay.legend();
    document.getElementById("north").addEventListener("click", () => this.controls.turnNorth());
    document.getElementById("help").addEventListener("click", () => this.toggleHelp());
  }

  toggleHelp() {
    const keys = document.getElementById("keys");
    keys.hidden = !keys.hidden;
    document.getElementById("help").setAttribute("aria-expanded", String(!keys.hidden));
  }

  escape() {
    document.getElementById("keys").hidden = true;
    document.getElementById("help").setAttribute("aria-expanded", "false");
    this.overlay.pick = null;
    this.overlay.show([]);
    this.moved();
  }

  moved() {
    if (this.isWanted) return;
    this.isWanted = true;
    requestAnimationFrame((time) => this.frame(time));
  }

  fit() {
    const size = [this.canvas.clientWidth, this.canvas.clientHeight];
    // More than two pixels in one of the style sheet's are not seen, and cost as much again.
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = size.map((side) => Math.max(1, Math.round(side * ratio)));
    if (this.canvas.width === width && this.canvas.height === height && this.ratio === ratio) return;
    [this.canvas.width, this.canvas.height] = [width, height];
    [this.size, this.ratio] = [size, ratio];
    this.overlay.resize(size, ratio);
  }

  frame(time) {
    this.isWanted = false;
    if (!this.renderer || this.canvas.clientWidth === 0) return;
    this.fit();
    const seconds = this.lastTime === null ? 1 / 60 : Math.min((time - this.lastTime) / 1000, 0.3);
    const isMoving = this.controls.step(seconds);
    const { isSettled } = this.renderer.draw(this.camera, [this.canvas.width, this.canvas.height], this.ratio, seconds);
    this.overlay.draw(this.camera, this.size);
    this.frames += 1;
    this.lastTime = isMoving || !isSettled ? time : null;
    if (isMoving || !isSettled) this.moved();
  }

  // What stands at a pixel, in CSS pixels: null for the sky.
  pick(pixel) {
    const scaled = pixel.map((part) => part * this.ratio);
    const seen = this.renderer.pick(this.camera, [this.canvas.width, this.canvas.height], scaled, this.ratio);
    if (!seen) return null;
    const [east, north] = [0, 1].map((axis) => this.ground.origin[axis] + seen.world[axis]);
    // The height is that of the coordinates as they are written.
    const written = [east, north].map((part) => part.toFixed(2));
    const height = this.ground.height(...written.map(Number));
    return {
      feature: this.featureName(seen.feature),
      at: written,
      lonLat: this.ground.lonLatAt(...written.map(Number)),
      height: height === null ? null : digits(height),
      above: height === null ? null : seen.world[2] - height * this.ground.zScale,
      world: seen.world,
    };
  }

  featureName(feature) {
    if (feature === 1) return "ground";
    if (feature === 0xffffffff) return "side of the block";
    return this.description.features[feature - 2] ?? "";
  }

  clicked(pixel) {
    if (!this.renderer) return;
    const place = this.pick(pixel);
    this.overlay.pick = place && place.world;
    this.overlay.show(place ? this.rows(place) : []);
    this.moved();
  }

  rows(place) {
    const rows = [["shows", place.feature], [this.description.crs, place.at.join(", ")]];
    if (place.lonLat) {
      const [longitude, latitude] = place.lonLat;
      const part = (value, signs) => `${Math.abs(value).toFixed(6)}° ${value < 0 ? signs[1] : signs[0]}`;
      rows.push(["WGS 84", `${part(latitude, "NS")}, ${part(longitude, "EW")}`]);
    }
    rows.push(["height", place.height === null ? "no data" : `${place.height} m`]);
    const standing = !/^(ground|side of the block)$/.test(place.feature) && place.above > 0.5;
    if (standing) rows.push(["above ground", `${(place.above).toFixed(1)} m`]);
    return rows;
  }
}

const page = new Page(JSON.parse(document.getElementById("description").textContent));
// For tests, and for whoever wants to steer the page.
window.sandtable = {
  page,
  get camera() {
    const { eye, target, azimuth, pitch, isParallel } = page.camera;
    return { eye, target, azimuth, pitch, isParallel };
  },
  get frames() {
    return page.frames;
  },
  pick: (x, y) => page.pick([x, y]),
};
page.open().catch((error) => {
  console.error(error);
  page.message(`The scene cannot be shown: ${error.message}`);
});
