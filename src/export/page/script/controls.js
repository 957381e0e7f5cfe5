// Mouse, touch and keyboard: turning about what is under the pointer, moving along the ground, coming nearer, flying.

// Radians that a picture's height of dragging turns.
const TURN = 2.4;
// A press that moves no farther than this, in CSS pixels, is a click.
const CLICK_PX = 5;
// The least angle above the horizon that turning leads to, and the eye's least height over the ground in meters.
const LOWEST_PITCH = 0.02;
const LEAST_HEIGHT_M = 1.7;
// Seconds to fly over what the picture shows at the target.
const FLY_S = 1.2;

class Controls {
  // `view` has the camera, `size` in CSS pixels, `ground`, and `moved()` and `clicked(pixel)`.
  constructor(canvas, view) {
    this.canvas = canvas;
    this.view = view;
    this.pointers = new Map();
    this.keys = new Set();
    this.drag = null;
    this.flight = null;
    const on = (name, handler, options) => canvas.addEventListener(name, handler, options);
    on("pointerdown", (event) => this.pressed(event));
    on("pointermove", (event) => this.movedPointer(event));
    on("pointerup", (event) => this.released(event));
    on("pointercancel", (event) => this.released(event));
    on("wheel", (event) => this.wheeled(event), { passive: false });
    on("contextmenu", (event) => event.preventDefault());
    on("keydown", (event) => this.keyPressed(event));
    on("keyup", (event) => this.keys.delete(event.code));
    on("blur", () => this.keys.clear());
  }

  pixel(event) {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  // The place on the ground at a pixel; where there is none, the place at the target's height, or the target.
  placeAt(pixel) {
    const { camera, size, ground } = this.view;
    const { origin, direction } = camera.ray(pixel, size);
    const along = ground.meet(origin, direction, camera.isParallel ? -1e6 : 0);
    if (along !== null) return plus(origin, direction, along);
    const down = direction[2] < -1e-3 ? (camera.target[2] - origin[2]) / direction[2] : Infinity;
    const far = 3 * Math.max(camera.distance, 1);
    return down > 0 && down < far ? plus(origin, direction, down) : null;
  }

  pressed(event) {
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, this.pixel(event));
    this.flight = null;
    this.begin(event);
    event.preventDefault();
  }

  begin(event) {
    const places = [...this.pointers.values()];
    const start = this.middle(places);
    const isPan = places.length > 1 || event.button === 2 || event.button === 1 || event.shiftKey;
    this.drag = {
      kind: isPan ? "pan" : "turn",
      start,
      last: start,
      spread: this.spread(places),
      camera: this.view.camera,
      pivot: this.placeAt(start) || this.view.camera.target,
      isClick: places.length === 1 && !isPan,
    };
  }

  middle(places) {
    const sum = places.reduce((total, place) => [total[0] + place[0], total[1] + place[1]], [0, 0]);
    return sum.map((part) => part / Math.max(places.length, 1));
  }

  spread(places) {
    return places.length < 2 ? 0 : Math.hypot(places[1][0] - places[0][0], places[1][1] - places[0][1]);
  }

  movedPointer(event) {
    if (!this.pointers.has(event.pointerId) || !this.drag) return;
    this.pointers.set(event.pointerId, this.pixel(event));
    const { drag, view } = this;
    const places = [...this.pointers.values()];
    const now = this.middle(places);
    if (Math.hypot(now[0] - drag.start[0], now[1] - drag.start[1]) > CLICK_PX) drag.isClick = false;
    if (drag.isClick) return;
    const [dx, dy] = [now[0] - drag.start[0], now[1] - drag.start[1]];
    if (drag.kind === "turn") {
      const azimuth = drag.camera.azimuth - dx / view.size[1] * TURN;
      const pitch = clamp(drag.camera.pitch + dy / view.size[1] * TURN, LOWEST_PITCH, Math.PI / 2);
      this.move(drag.camera.turnedAbout(drag.pivot, azimuth, pitch));
    } else {
      this.move(this.panned(drag, now, this.spread(places)));
    }
  }

  // The camera moved level so that the place that was taken hold of is under the pointer, and nearer by a pinch.
  panned(drag, now, spread) {
    const { size } = this.view;
    let { camera } = drag;
    if (drag.spread > 0 && spread > 0) camera = this.nearer(camera, drag.pivot, drag.spread / spread);
    const { origin, direction } = camera.ray(now, size);
    const steep = Math.abs(direction[2]) > 0.05 * length(direction);
    if (steep) {
      const along = (drag.pivot[2] - origin[2]) / direction[2];
      if (camera.isParallel || (along > 0 && along < 20 * camera.distance)) {
        const shift = minus(drag.pivot, plus(origin, direction, along));
        return camera.with({ target: plus(camera.target, [shift[0], shift[1], 0]) });
      }
    }
    // Looking along the ground, the picture moves as a sheet at the place's depth.
    const depth = dot(minus(drag.pivot, camera.eye), camera.forward);
    const scale = camera.metersPerPixel(Math.max(depth, 1), size);
    const aside = plus(camera.target, camera.right, -(now[0] - drag.start[0]) * scale);
    return camera.with({ target: plus(aside, camera.up, (now[1] - drag.start[1]) * scale) });
  }

  released(event) {
    this.pointers.delete(event.pointerId);
    const { drag } = this;
    if (drag && drag.isClick && event.type === "pointerup") this.view.clicked(this.pixel(event));
    if (this.pointers.size > 0) this.begin(event);
    else this.drag = null;
  }

  wheeled(event) {
    event.preventDefault();
    this.flight = null;
    const lines = event.deltaMode === 1 ? 33 : event.deltaMode === 2 ? 400 : 1;
    const factor = Math.exp(clamp(event.deltaY * lines, -300, 300) * 0.0018);
    const pivot = this.placeAt(this.pixel(event)) || this.view.camera.target;
    this.move(this.nearer(this.view.camera, pivot, factor));
  }

  // The camera with all distances to a place multiplied; the place keeps its pixel.
  nearer(camera, place, factor) {
    const { ground } = this.view;
    const most = 4 * length(minus(ground.bounds[1], ground.bounds[0]));
    const span = camera.isParallel ? camera.halfHeight : length(minus(camera.eye, place));
    const bounded = clamp(factor, Math.min(1, 3 / span), Math.max(1, most / span));
    const target = plus(place, minus(camera.target, place), bounded);
    return camera.isParallel
      ? camera.with({ target, halfHeight: camera.halfHeight * bounded })
      : camera.with({ target, distance: camera.distance * bounded });
  }

  keyPressed(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { view } = this;
    const moves = ["KeyW", "KeyA", "KeyS", "KeyD", "KeyQ", "KeyE", "ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight",
      "Equal", "Minus", "NumpadAdd", "NumpadSubtract"];
    if (moves.includes(event.code)) {
      this.flight = null;
      this.keys.add(event.code);
      view.moved();
    } else if (event.code === "KeyN") this.turnNorth();
    else if (event.code === "KeyT") this.flyTo(this.lookedAt(view.camera).with({ pitch: Math.PI / 2 }));
    else if (event.code === "Enter" || event.code === "Space") view.clicked([view.size[0] / 2, view.size[1] / 2]);
    else if (event.key === "?") view.toggleHelp();
    else if (event.code === "Escape") view.escape();
    else return;
    event.preventDefault();
  }

  // The camera with its target on the ground in the middle of the picture, so that turning keeps what is shown.
  lookedAt(camera) {
    const { ground } = this.view;
    const along = ground.meet(camera.eye, camera.forward, camera.isParallel ? -1e6 : 0);
    return along !== null && !camera.isParallel && along > 1 ? camera.retargeted(along) : camera;
  }

  turnNorth() {
    const camera = this.lookedAt(this.view.camera);
    this.flyTo(camera.with({ azimuth: this.view.ground.trueNorth(camera.target) }));
  }

  flyTo(camera, seconds = 1.2) {
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.flight = { from: this.view.camera, to: camera, seconds: still ? 0 : seconds, passed: 0 };
    this.view.moved();
  }

  move(camera) {
    this.view.camera = this.aboveGround(camera);
    this.view.moved();
  }

  aboveGround(camera) {
    if (camera.isParallel) return camera;
    const eye = camera.eye;
    const z = this.view.ground.worldZ(eye[0], eye[1]);
    const lift = z === null ? 0 : z + LEAST_HEIGHT_M - eye[2];
    return lift > 0 ? camera.with({ target: plus(camera.target, [0, 0, lift]) }) : camera;
  }

  // Moves on by the seconds since the last frame; returns whether there is more to come.
  step(seconds) {
    const { flight, view } = this;
    if (flight) {
      flight.passed += seconds;
      const part = flight.seconds > 0 ? Math.min(flight.passed / flight.seconds, 1) : 1;
      view.camera = part >= 1 ? flight.to : this.aboveGround(flight.from.toward(flight.to, smoothstep(part)));
      if (part >= 1) this.flight = null;
      return part < 1;
    }
    if (this.keys.size === 0) return false;
    const held = (...codes) => codes.some((code) => this.keys.has(code));
    let camera = this.lookedAt(view.camera);
    const speed = Math.max(camera.heightAtTarget(view.size), 20) / FLY_S * seconds;
    const level = [Math.sin(camera.azimuth), Math.cos(camera.azimuth), 0];
    const go = (axis, metres) => { camera = camera.with({ target: plus(camera.target, axis, metres) }); };
    if (held("KeyW")) go(level, speed);
    if (held("KeyS")) go(level, -speed);
    if (held("KeyD")) go(camera.right, speed);
    if (held("KeyA")) go(camera.right, -speed);
    if (held("KeyE") && !camera.isParallel) go([0, 0, 1], speed / 2);
    if (held("KeyQ") && !camera.isParallel) go([0, 0, 1], -speed / 2);
    const turn = (held("ArrowRight") ? 1 : 0) - (held("ArrowLeft") ? 1 : 0);
    const tilt = (held("ArrowDown") ? 1 : 0) - (held("ArrowUp") ? 1 : 0);
    if (turn || tilt) {
      const pitch = clamp(camera.pitch + tilt * seconds * 0.8, -0.3, Math.PI / 2);
      camera = camera.turnedAbout(camera.eye, camera.azimuth + turn * seconds, pitch);
    }
    const zoom = (held("Minus", "NumpadSubtract") ? 1 : 0) - (held("Equal", "NumpadAdd") ? 1 : 0);
    if (zoom) camera = this.nearer(camera, camera.target, Math.exp(zoom * seconds * 1.5));
    view.camera = this.aboveGround(camera);
    return true;
  }
}
