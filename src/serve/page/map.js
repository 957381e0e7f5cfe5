// The map: tiles of the service in Web Mercator, moved by pointers and keys; what tools draw lies over it.
//
//   place (lat, lng) ─► world (0 … 1, y down) ─► pixels of the page

const TILE = 256;
const FINEST = 22;
/** Tiles that are kept, and that are fetched at once. */
const KEPT = 500;
const AT_ONCE = 4;
/** A pointer that moves no farther than this clicks. */
const CLICK_PX = 6;

const world_of = ({ lat, lng }) => ({
  x: (lng + 180) / 360,
  y: 0.5 - Math.asinh(Math.tan((lat * Math.PI) / 180)) / (2 * Math.PI),
});
const place_at = ({ x, y }) => place((Math.atan(Math.sinh(Math.PI * (1 - 2 * y))) * 180) / Math.PI, x * 360 - 180);

class TileMap {
  /** `picked` is called with a place, `complained` with a sentence; `draw_over` draws over the tiles. */
  constructor(canvas, { picked, complained, draw_over, moved }) {
    Object.assign(this, { canvas, picked, complained, draw_over, moved });
    this.context = canvas.getContext("2d");
    this.center = { x: 0.5, y: 0.5 };
    this.zoom = 1;
    this.tiles = new Map();
    this.loading = 0;
    this.dataset = null;
    this.hasCross = false;
    this.frames = 0;
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.listen();
    this.resize();
  }

  get width() { return this.canvas.clientWidth; }
  get height() { return this.canvas.clientHeight; }
  /** Pixels of the page that the world is wide. */
  get size() { return TILE * 2 ** this.zoom; }

  resize() {
    const ratio = window.devicePixelRatio || 1;
    this.canvas.width = Math.max(1, Math.round(this.width * ratio));
    this.canvas.height = Math.max(1, Math.round(this.height * ratio));
    this.want();
  }

  show(dataset) {
    this.dataset = dataset;
    this.tiles.clear();
    this.isBroken = false;
    this.whole();
  }

  whole() {
    const bounds = this.dataset?.bounds;
    if (!bounds) return this.want();
    const [low, high] = [world_of({ lat: bounds.south, lng: bounds.west }), world_of({ lat: bounds.north, lng: bounds.east })];
    this.center = { x: (low.x + high.x) / 2, y: (low.y + high.y) / 2 };
    const part = Math.max((high.x - low.x) / Math.max(this.width, 1), (low.y - high.y) / Math.max(this.height, 1));
    this.set_zoom(Math.log2(0.96 / (TILE * part)));
    this.want();
  }

  set_zoom(zoom) { this.zoom = Math.min(Math.max(zoom, 0), FINEST); }

  pixel_of(at) { return this.pixel_of_world(world_of(at)); }

  pixel_of_world({ x, y }) {
    return { x: this.width / 2 + (x - this.center.x) * this.size, y: this.height / 2 + (y - this.center.y) * this.size };
  }

  world_at(pixel) {
    return { x: this.center.x + (pixel.x - this.width / 2) / this.size, y: this.center.y + (pixel.y - this.height / 2) / this.size };
  }

  place_at(pixel) { return place_at(this.world_at(pixel)); }

  move(across, down) {
    this.center.x += across / this.size;
    this.center.y = Math.min(Math.max(this.center.y + down / this.size, 0), 1);
    this.want();
  }

  /** Zooms by some levels, so that what is under `pixel` stays there. */
  zoom_at(levels, pixel = { x: this.width / 2, y: this.height / 2 }) {
    const before = this.world_at(pixel);
    this.set_zoom(this.zoom + levels);
    const after = this.world_at(pixel);
    this.center.x += before.x - after.x;
    this.center.y += before.y - after.y;
    this.want();
  }

  /** Brings a place into view. */
  reveal(at) {
    const { x, y } = this.pixel_of(at);
    const margin = 40;
    if (x < margin || y < margin || x > this.width - margin || y > this.height - margin) this.center = world_of(at);
    this.want();
  }

  /** Draws at the next frame. */
  want() {
    if (this.isWanted) return;
    this.isWanted = true;
    requestAnimationFrame(() => {
      this.isWanted = false;
      this.draw();
    });
  }

  get isIdle() { return !this.isWanted && this.loading === 0 && !this.missing; }

  draw() {
    const { context, canvas } = this;
    const ratio = canvas.width / Math.max(this.width, 1);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, this.width, this.height);
    context.imageSmoothingQuality = "high";
    this.missing = 0;
    if (this.dataset?.bounds && !this.isBroken) this.draw_tiles(ratio);
    this.draw_over(context);
    if (this.hasCross) this.draw_cross();
    this.frames += 1;
    this.moved();
  }

  draw_tiles(ratio) {
    const z = Math.min(Math.max(Math.round(this.zoom + Math.log2(ratio)), 0), FINEST);
    const count = 2 ** z;
    const { south, west, north, east } = this.dataset.bounds;
    const [low, high] = [world_of({ lat: north, lng: west }), world_of({ lat: south, lng: east })];
    const [first, last] = [this.world_at({ x: 0, y: 0 }), this.world_at({ x: this.width, y: this.height })];
    const index = (part) => Math.floor(part * count);
    const wanted = [];
    for (let y = index(Math.max(first.y, low.y)); y <= Math.min(index(Math.min(last.y, high.y)), count - 1); y += 1) {
      for (let x = index(Math.max(first.x, low.x)); x <= Math.min(index(Math.min(last.x, high.x)), count - 1); x += 1) {
        if (!this.draw_tile(z, x, y)) wanted.push({ z, x, y });
      }
    }
    const far = ({ x, y }) => Math.hypot((x + 0.5) / count - this.center.x, (y + 0.5) / count - this.center.y);
    wanted.sort((a, b) => far(a) - far(b));
    this.missing = wanted.length;
    wanted.filter(({ z, x, y }) => !this.tiles.has(`${z}/${x}/${y}`)).forEach((tile) => this.load(tile));
  }

  /** Draws a tile, or what is there of the tiles around it; whether it was there. */
  draw_tile(z, x, y) {
    const corner = this.pixel_of_world({ x: x / 2 ** z, y: y / 2 ** z });
    const side = this.size / 2 ** z;
    for (let up = 0; up <= Math.min(z, 6); up += 1) {
      const found = this.tiles.get(`${z - up}/${x >> up}/${y >> up}`);
      if (!found?.picture) continue;
      const part = TILE / 2 ** up;
      const [left, top] = [(x % 2 ** up) * part, (y % 2 ** up) * part];
      // A seam of half a pixel shows where tiles meet between pixels.
      this.context.drawImage(found.picture, left, top, part, part, corner.x, corner.y, side + 0.5, side + 0.5);
      return up === 0;
    }
    return this.tiles.get(`${z}/${x}/${y}`)?.isEmpty ?? false;
  }

  async load({ z, x, y }) {
    if (this.loading >= AT_ONCE) return;
    const [name, dataset] = [`${z}/${x}/${y}`, this.dataset];
    const tile = {};
    this.tiles.set(name, tile);
    this.loading += 1;
    try {
      const answer = await reply(`v1/tiles/${encodeURIComponent(dataset.name)}/${name}.png`);
      tile.picture = await createImageBitmap(await answer.blob());
    } catch (error) {
      if (dataset === this.dataset) this.failed(error, name);
    }
    this.loading -= 1;
    for (const [old] of this.tiles) {
      if (this.tiles.size <= KEPT) break;
      this.tiles.delete(old);
    }
    this.want();
  }

  failed(error, name) {
    if (error.retryAfter) {
      setTimeout(() => { this.tiles.delete(name); this.want(); }, 1000 * error.retryAfter);
    } else {
      this.isBroken = true;
    }
    this.complained(error.message);
  }

  draw_cross() {
    const { context } = this;
    const [x, y] = [this.width / 2, this.height / 2];
    context.beginPath();
    for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
      context.moveTo(x + 4 * dx, y + 4 * dy);
      context.lineTo(x + 16 * dx, y + 16 * dy);
    }
    stroke_with_halo(context, "#1d2a33", 2);
  }

  listen() {
    const { canvas } = this;
    const pointers = new Map();
    const at = (event) => {
      const box = canvas.getBoundingClientRect();
      return { x: event.clientX - box.left, y: event.clientY - box.top };
    };
    let [start, isClick] = [null, false];
    canvas.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, at(event));
      [start, isClick] = [at(event), pointers.size === 1];
    });
    canvas.addEventListener("pointermove", (event) => {
      const [now, before] = [at(event), pointers.get(event.pointerId)];
      this.pointed = now;
      if (!before) return this.moved();
      if (Math.hypot(now.x - start.x, now.y - start.y) > CLICK_PX) isClick = false;
      const others = [...pointers].filter(([id]) => id !== event.pointerId).map(([, other]) => other);
      pointers.set(event.pointerId, now);
      if (others.length === 0 && !isClick) this.move(before.x - now.x, before.y - now.y);
      if (others.length === 1) this.pinch(others[0], before, now);
    });
    const end = (event) => {
      if (!pointers.delete(event.pointerId)) return;
      if (isClick && event.type === "pointerup") {
        this.hasCross = false;
        this.picked(this.place_at(at(event)));
      }
    };
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    canvas.addEventListener("pointerleave", () => { this.pointed = null; this.moved(); });
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      const lines = event.deltaY * (event.deltaMode === 1 ? 20 : 1);
      this.zoom_at(Math.max(-1, Math.min(1, -lines / 240)), at(event));
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const step = 64;
      const acts = {
        ArrowLeft: () => this.move(-step, 0),
        ArrowRight: () => this.move(step, 0),
        ArrowUp: () => this.move(0, -step),
        ArrowDown: () => this.move(0, step),
        "+": () => this.zoom_at(1),
        "=": () => this.zoom_at(1),
        "-": () => this.zoom_at(-1),
        0: () => this.whole(),
        Enter: () => this.picked(this.place_at({ x: this.width / 2, y: this.height / 2 })),
      };
      if (!acts[event.key]) return;
      event.preventDefault();
      this.hasCross = true;
      acts[event.key]();
      this.want();
    });
    canvas.addEventListener("blur", () => { this.hasCross = false; this.want(); });
  }

  pinch(other, before, now) {
    const length = (end) => Math.max(Math.hypot(end.x - other.x, end.y - other.y), 1);
    const middle = { x: (other.x + now.x) / 2, y: (other.y + now.y) / 2 };
    this.move((before.x - now.x) / 2, (before.y - now.y) / 2);
    this.zoom_at(Math.log2(length(now) / length(before)), middle);
  }

  /** A line through places. */
  draw_line(places, color, width = 3) {
    const { context } = this;
    context.beginPath();
    places.map((at) => this.pixel_of(at)).forEach(({ x, y }) => context.lineTo(x, y));
    stroke_with_halo(context, color, width);
  }

  /** A dot with a letter. */
  draw_point(at, letter, color) {
    const { context } = this;
    const { x, y } = this.pixel_of(at);
    context.beginPath();
    context.arc(x, y, 9, 0, 2 * Math.PI);
    context.fillStyle = color;
    context.fill();
    context.lineWidth = 2;
    context.strokeStyle = "#fff";
    context.stroke();
    context.fillStyle = "#fff";
    context.font = "600 11px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillText(letter, x, y + 0.5);
  }

  /**
   * A picture of rows and columns, whose posts from `places`, `steps` + 1 a side from the south-west, lie where these say: cut
   * into parts, each of which is brought there by a parallelogram, since a grid in meters is turned and bent on this map.
   */
  draw_grid(picture, places, steps) {
    // Parts reach half a post into each other, so that no seam shows: on a layer of its own, which then lies over the tiles.
    const layer = document.createElement("canvas");
    [layer.width, layer.height] = [this.canvas.width, this.canvas.height];
    const context = layer.getContext("2d");
    context.imageSmoothingEnabled = false;
    const base = this.context.getTransform();
    const pixels = places.map((at) => this.pixel_of(at));
    const at = (column, row) => pixels[row * (steps + 1) + column];
    const [wide, high] = [(picture.width - 1) / steps, (picture.height - 1) / steps];
    const [width, height] = [wide + 1, high + 1];
    for (let row = 0; row < steps; row += 1) {
      for (let column = 0; column < steps; column += 1) {
        const [corner, east, north] = [at(column, row), at(column + 1, row), at(column, row + 1)];
        const east_of = { x: (east.x - corner.x) / wide, y: (east.y - corner.y) / wide };
        const south_of = { x: (corner.x - north.x) / high, y: (corner.y - north.y) / high };
        context.setTransform(base);
        context.transform(east_of.x, east_of.y, south_of.x, south_of.y, corner.x, corner.y);
        // In posts from the corner: east, and south of it; the places are those of the centers of posts.
        const top = picture.height - 1 - (row + 1) * high;
        context.drawImage(picture, column * wide, top, width, height, -0.5, -high - 0.5, width, height);
      }
    }
    this.context.save();
    this.context.setTransform(1, 0, 0, 1, 0, 0);
    this.context.globalAlpha = 0.6;
    this.context.drawImage(layer, 0, 0);
    this.context.restore();
  }
}

function stroke_with_halo(context, color, width) {
  context.lineJoin = context.lineCap = "round";
  context.lineWidth = width + 3;
  context.strokeStyle = "rgb(255 255 255 / 85%)";
  context.stroke();
  context.lineWidth = width;
  context.strokeStyle = color;
  context.stroke();
}
