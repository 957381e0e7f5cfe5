// Vectors, and a camera that turns about a target. World space: X east, Y north, Z up, meters.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const plus = (a, b, factor = 1) => [a[0] + b[0] * factor, a[1] + b[1] * factor, a[2] + b[2] * factor];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const length = (a) => Math.hypot(a[0], a[1], a[2]);
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
const mix = (a, b, part) => a + (b - a) * part;
const smoothstep = (part) => part * part * (3 - 2 * part);

// The picture that views are fitted to; see page.rs.
const VIEW_ASPECT = 1280 / 720;

// `azimuth` is the viewing direction clockwise from north and `pitch` its angle below the horizon, radians. `halfHeight`
// is the tangent of half the vertical field of view or, with parallel rays, half the height of the picture in meters.
class Camera {
  constructor(state) {
    Object.assign(this, state);
  }

  static of(view, target) {
    const { eye, forward } = view;
    const azimuth = Math.hypot(forward[0], forward[1]) > 1e-6
      ? Math.atan2(forward[0], forward[1])
      : Math.atan2(view.up[0], view.up[1]);
    const pitch = Math.asin(clamp(-forward[2], -1, 1));
    const { halfHeight, isParallel, stretch } = view;
    const distance = Math.max(dot(minus(target, eye), forward), 1);
    return new Camera({ target: plus(eye, forward, distance), distance, azimuth, pitch, halfHeight, isParallel, stretch });
  }

  with(change) {
    return new Camera({ ...this, ...change });
  }

  get forward() {
    const level = Math.cos(this.pitch);
    return [Math.sin(this.azimuth) * level, Math.cos(this.azimuth) * level, -Math.sin(this.pitch)];
  }

  get right() {
    return [Math.cos(this.azimuth), -Math.sin(this.azimuth), 0];
  }

  get up() {
    const level = Math.sin(this.pitch);
    return [Math.sin(this.azimuth) * level, Math.cos(this.azimuth) * level, Math.cos(this.pitch)];
  }

  get eye() {
    return plus(this.target, this.forward, -this.distance);
  }

  // Half of what the picture spans at unit depth or, with parallel rays, in meters: across and up.
  spans(size) {
    const aspect = size[0] / size[1];
    const up = this.halfHeight * Math.max(1, VIEW_ASPECT / aspect);
    return [up * aspect, up / this.stretch];
  }

  // Meters that the picture is high at the target.
  heightAtTarget(size) {
    return 2 * this.spans(size)[1] * this.stretch * (this.isParallel ? 1 : this.distance);
  }

  // The ray through a place of the picture, in pixels from its upper left corner.
  ray(pixel, size) {
    const [across, up] = this.spans(size);
    const x = (pixel[0] / size[0] * 2 - 1) * across;
    const y = (1 - pixel[1] / size[1] * 2) * up;
    const aside = plus(plus([0, 0, 0], this.right, x), this.up, y);
    return this.isParallel
      ? { origin: plus(this.eye, aside), direction: this.forward }
      : { origin: this.eye, direction: plus(this.forward, aside) };
  }

  // The pixel of a place and its depth along the viewing direction; null behind the eye.
  project(world, size) {
    const offset = minus(world, this.eye);
    const depth = dot(offset, this.forward);
    if (!this.isParallel && depth <= 0) return null;
    const [across, up] = this.spans(size);
    const scale = this.isParallel ? 1 : depth;
    const x = dot(offset, this.right) / (across * scale);
    const y = dot(offset, this.up) / (up * scale);
    return { x: (x * 0.5 + 0.5) * size[0], y: (0.5 - y * 0.5) * size[1], depth };
  }

  // Meters in a pixel at a depth.
  metersPerPixel(depth, size) {
    return 2 * this.spans(size)[0] * (this.isParallel ? 1 : depth) / size[0];
  }

  // The same eye with another target, in the middle of the picture at a depth.
  retargeted(distance) {
    return this.with({ target: plus(this.eye, this.forward, distance), distance });
  }

  // The camera turned about a place, which keeps its pixel.
  turnedAbout(pivot, azimuth, pitch) {
    const offset = minus(this.eye, pivot);
    const aside = [this.right, this.up, this.forward].map((axis) => dot(offset, axis));
    const turned = this.with({ azimuth, pitch });
    const eye = [turned.right, turned.up, turned.forward]
      .reduce((sum, axis, index) => plus(sum, axis, aside[index]), pivot);
    return turned.with({ target: plus(eye, turned.forward, turned.distance) });
  }

  // `part` of the way to another camera.
  toward(other, part) {
    const near = part < 0.5 ? this : other;
    const turn = Math.atan2(Math.sin(other.azimuth - this.azimuth), Math.cos(other.azimuth - this.azimuth));
    const span = (camera) => Math.log(camera.halfHeight * (camera.isParallel ? 1 : camera.distance));
    const height = Math.exp(mix(span(this), span(other), part));
    const same = this.isParallel === other.isParallel;
    const halfHeight = near.isParallel ? height : same ? mix(this.halfHeight, other.halfHeight, part) : near.halfHeight;
    return new Camera({
      target: [0, 1, 2].map((axis) => mix(this.target[axis], other.target[axis], part)),
      distance: near.isParallel ? mix(this.distance, other.distance, part) : height / halfHeight,
      azimuth: this.azimuth + turn * part,
      pitch: mix(this.pitch, other.pitch, part),
      halfHeight,
      isParallel: near.isParallel,
      stretch: mix(this.stretch, other.stretch, part),
    });
  }
}
