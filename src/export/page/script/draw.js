// Draws the scene for a camera, and says what a pixel shows.

// By how much what is draped counts as nearer than the ground that it lies on: DRAPE_TOLERANCE of draw/list.rs.
const DRAPE_NEARER = 1 + 1 / 50000;

// The lines of a picture that the widths of symbols are for; a picture lower than half of them has wider symbols.
const SYMBOL_LINES = 1080;

// The share of the distance to what is nearest at which the picture begins. Smaller loses depth, larger cuts off what
// stands high beside the eye.
const NEAR_SHARE = 0.1;

// The share of a depth in which the air is clear: CLEAR_DEPTH of picture/haze.rs.
const CLEAR_DEPTH = 0.25;

class Renderer {
  constructor(gl, data, ground) {
    this.gl = gl;
    this.data = data;
    this.ground = ground;
    this.scene = new AdapterScene(gl, data);
    this.studio = null;
    this.triangles = 0;
  }

  // What the picture shows the scene as: PictureSetting of scene/picture/setting.rs.
  setting(camera, size) {
    const [low, high] = this.data.description.bounds;
    const spans = camera.spans(size);
    const forward = camera.forward;
    const top = camera.isParallel ? forward : plus(forward, camera.up, spans[1]);
    const topRise = top[2] / length(top);
    if (-forward[2] > 0.985) return "plan";
    if (topRise > 0) return "landscape";
    const isLow = topRise > -0.174;
    const rim = this.rim(camera, size, low, high);
    if (rim === 2 || (rim === 1 && !isLow)) return "block";
    return isLow ? "skyline" : "ground";
  }

  // Whether the block's edge is in view: 0 not, 1 behind the ground, 2 the foot of a wall.
  rim(camera, size, low, high) {
    const eye = camera.eye;
    const within = (axis) => eye[axis] >= low[axis] && eye[axis] <= high[axis];
    if (within(0) && within(1) && eye[2] <= high[2]) return 0;
    const isSeen = (at) => {
      const seen = camera.project(at, size);
      return seen !== null && seen.x >= 0 && seen.y >= 0 && seen.x <= size[0] && seen.y <= size[1];
    };
    const foot = this.data.description.baseZ;
    let found = 0;
    for (let step = 0; step <= 64; step += 1) {
      const [x, y] = [mix(low[0], high[0], step / 64), mix(low[1], high[1], step / 64)];
      const edges = [[x, low[1], 0, -1], [x, high[1], 0, 1], [low[0], y, -1, 0], [high[0], y, 1, 0]];
      for (const [atX, atY, outX, outY] of edges) {
        const toEye = camera.isParallel ? camera.forward.map((part) => -part) : minus(eye, [atX, atY, foot]);
        if (isSeen([atX, atY, foot]) && outX * toEye[0] + outY * toEye[1] > 0) return 2;
        if ([foot, low[2], high[2]].some((z) => isSeen([atX, atY, z]))) found = 1;
      }
    }
    return found;
  }

  // The nearest and the farthest distance of the scene's box from the eye.
  reach(camera) {
    const [low, high] = this.data.description.bounds;
    const eye = camera.eye;
    const away = (pick) => Math.hypot(...[0, 1, 2].map((axis) => pick(low[axis] - eye[axis], high[axis] - eye[axis])));
    const near = away((a, b) => (a > 0 ? a : b < 0 ? b : 0));
    return [near, away((a, b) => Math.max(Math.abs(a), Math.abs(b)))];
  }

  planes(camera) {
    const [near, far] = this.reach(camera);
    if (camera.isParallel) return [camera.distance - far * 2, camera.distance + far * 2].map((at) => at);
    const z = this.ground.worldZ(camera.eye[0], camera.eye[1]);
    const above = z === null ? near : Math.max(camera.eye[2] - z, 0);
    return [clamp(Math.max(near, Math.min(above, 2000)) * NEAR_SHARE, 0.2, far / 4), far * 1.5 + 1000];
  }

  // The distance at which haze begins, and its rate: haze() of picture/haze.rs.
  haze(camera, setting) {
    const stated = this.data.description.haze;
    const [near, far] = this.reach(camera);
    const clear = { plan: 1, landscape: 0.62 }[setting] ?? 0.94;
    const [reach, depth] = stated === null ? [far - near, -Math.log(clear)] : [stated, 1];
    if (camera.isParallel || depth === 0 || reach <= 0) return [near, 0];
    const start = stated !== null || setting === "landscape" ? CLEAR_DEPTH : 0;
    return [near + start * reach, depth / ((1 - start) * reach)];
  }

  // The values that do not differ between batches.
  frame(camera, size, pixelRatio) {
    const { light } = this.data.description;
    const setting = this.setting(camera, size);
    const [near, far] = this.planes(camera);
    const [across, up] = camera.spans(size);
    const [hazeNear, hazeRate] = this.haze(camera, setting);
    return {
      eye: camera.eye,
      forward: camera.forward,
      right: [...camera.right, 1 / across],
      up: [...camera.up, 1 / up],
      depth: camera.isParallel
        ? [2 / (far - near), -(far + near) / (far - near)]
        : [(far + near) / (far - near), -2 * far * near / (far - near)],
      isParallel: camera.isParallel,
      depths: camera.isParallel ? [1, 1] : [near, far],
      haze: [...light.haze, hazeRate],
      zenith: [...light.zenith, hazeNear],
      setting,
      // Meters in a pixel at unit depth.
      realPixel: 2 * up * camera.stretch / size[1],
      pixel: 2 * up * camera.stretch / Math.min(SYMBOL_LINES, 2 * size[1] / pixelRatio),
    };
  }

  use({ made, places }, frame) {
    const { gl } = this;
    const { light, map, imagery, zScale } = this.data.description;
    gl.useProgram(made);
    const set = (name, call, ...values) => places[name] && gl[call](places[name], ...values);
    set("eye", "uniform3fv", frame.eye);
    set("forward", "uniform3fv", frame.forward);
    set("right", "uniform4fv", frame.right);
    set("up", "uniform4fv", frame.up);
    set("haze", "uniform4fv", frame.haze);
    set("zenith", "uniform4fv", frame.zenith);
    set("real_pixel", "uniform1f", frame.realPixel ?? 1);
    set("horizon", "uniform1f", light.horizon);
    set("to_sun", "uniform3fv", light.toSun);
    for (const name of ["sun", "sky", "bounce"]) set(name, "uniform3fv", light[name]);
    set("studio_top", "uniform3fv", light.studioTop.map((channel) => channel / 255));
    set("studio_bottom", "uniform3fv", light.studioBottom.map((channel) => channel / 255));
    set("studio", "uniform1f", frame.studio);
    set("base_texture", "uniform1i", 0);
    set("shadow_map", "uniform1i", 7);
    set("shadow", "uniform4fv", frame.shadow ? frame.shadow.terms : [0, 0, 0, 0]);
    if (frame.shadow) set("shadow_from_world", "uniformMatrix4fv", false, frame.shadow.matrix);
    gl.activeTexture(gl.TEXTURE7);
    gl.bindTexture(gl.TEXTURE_2D, frame.isShadow ? null : this.scene.shadow.texture);
    if (!places.heights) return;
    const textures = [["heights", "heights"], ["slopes", "slopes"], ["skies", "skies"], ["ramp", "ramp"],
      ["imagery_texture", "imagery"]];
    textures.forEach(([name, texture], index) => {
      gl.activeTexture(gl.TEXTURE1 + index);
      gl.bindTexture(gl.TEXTURE_2D, this.scene[texture]);
      set(name, "uniform1i", 1 + index);
    });
    const coarsest = this.data.heightLevels.length - 1;
    set("grid", "uniform4f", ...map.origin, 1 / map.cell[0], 1 / map.cell[1]);
    set("grid_size", "uniform4f", map.columns, map.rows, Math.min(map.formLevel, coarsest), coarsest);
    set("ramp_range", "uniform4f", ...this.scene.rampRange, map.contours ? 1 : 0, map.hasGrain ? 1 : 0);
    set("bathymetry", "uniform4fv", light.bathymetry.flat());
    set("undergrowth", "uniform4fv", light.undergrowth);
    set("shallow", "uniform4fv", light.shallow);
    set("open_water", "uniform4f", ...light.open, 0);
    const { cover, contours } = map;
    set("cover", "uniform4f", ...(cover ? [cover.tree, cover.snow, cover.trueRise, cover.shadyNorth] : [0, 0, 0, 0]));
    set("cover_more", "uniform3f", ...(cover ? [cover.moisture, cover.cell, cover.hasForms ? 1 : 0] : [0, 1, 0]));
    set("cover_colors", "uniform4fv", cover ? cover.colors : new Array(28).fill(0));
    const linear = (channel) => (channel <= 0.04045 ? channel / 12.92 : ((channel + 0.055) / 1.055) ** 2.4);
    set("contour", "uniform4f", ...(contours
      ? [...contours.color.slice(0, 3).map((channel) => linear(channel / 255)), contours.color[3] / 255]
      : [0, 0, 0, 0]));
    set("contour_lit", "uniform4f", ...(contours && contours.lit
      ? [...contours.lit.slice(0, 3).map((channel) => linear(channel / 255)), 1]
      : [0, 0, 0, 0]));
    set("contour_turn", "uniform3f", ...(contours ? contours.turn : [0, 0, 0]));
    set("contour_shape", "uniform4f", ...(contours
      ? [contours.interval, contours.width * frame.pixelRatio, contours.every]
      : [1, 1, 1]), map.zFactor);
    set("shade_gain", "uniform1f", map.shadeGain);
    set("shade_detail", "uniform1f", map.detail);
    set("curved_rise", "uniform1f", map.curvedRise);
    set("sky_most", "uniform1f", map.skyMost);
    set("sides", "uniform3fv", light.sides.flat());
    set("side_shares", "uniform4fv", light.sideShares);
    set("imagery", "uniform4f", ...(imagery ? [...imagery.origin, 1 / imagery.size[0], 1 / imagery.size[1]] : [0, 0, 1, 1]));
    set("imagery_size", "uniform4f", ...(imagery && this.data.imagery
      ? [1 / this.data.imagery.width, 1 / this.data.imagery.height, 1, imagery.isShaded ? 1 : 0]
      : [1, 1, 0, 0]));
  }

  isShown(batch, frame) {
    if (batch.band !== undefined) {
      const { bands } = this.data.description;
      const [least, most] = frame.depths.map((depth) => depth * frame.pixel);
      return most > (bands[batch.band + 1] ?? 0) && (batch.band === 0 || least <= bands[batch.band]);
    }
    return !batch.table || frame.setting === "block";
  }

  one(batch, { places }, frame) {
    const { gl } = this;
    const { material } = batch;
    const set = (name, call, ...values) => places[name] && gl[call](places[name], ...values);
    const nearer = batch.layer === "draped" ? DRAPE_NEARER : 1;
    set("depth", "uniform4f", ...frame.depth, nearer, frame.isParallel ? 1 : 0);
    set("base_color", "uniform4fv", material.color);
    set("alpha_mode", "uniform1i", { opaque: 0, mask: 1, blend: 2 }[material.alpha.mode]);
    set("cutoff", "uniform1f", material.alpha.cutoff ?? 0);
    set("is_map", "uniform1f", material.groundMap ? 1 : 0);
    set("is_water", "uniform1f", material.isWater ? 1 : 0);
    set("is_natural", "uniform1f", material.isNatural ? 1 : 0);
    set("area_share", "uniform1f", material.area ? 1 : 0);
    if (material.area) set("area", "uniform4fv", material.area);
    set("is_hatching", "uniform1f", material.hatching ? 1 : 0);
    set("in_all_light", "uniform1f", material.shadows ? 0 : 1);
    const bands = this.data.description.bands;
    set("band", "uniform4f", ...(batch.band === undefined
      ? [0, 0, 0, 0]
      : [bands[batch.band], batch.band === 0 ? 1e30 : bands[batch.band], bands[batch.band + 1] ?? 0, frame.pixel]));
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, material.texture === null ? this.scene.white : this.scene.textures[material.texture]);
    if (material.texture !== null) this.scene.setWrap(material.wrap);
    if (material.twoSided || frame.isShadow) gl.disable(gl.CULL_FACE);
    else gl.enable(gl.CULL_FACE);
    gl.bindVertexArray(batch.array);
    if (!batch.colors) gl.vertexAttrib4f(3, ...(batch.color || [255, 255, 255, 255]).map((channel) => channel / 255));
    if (!batch.normals) gl.vertexAttrib3f(1, 0, 0, 0);
    if (!batch.uvs) gl.vertexAttrib2f(2, 0, 0);
    if (!batch.features && !batch.placeFeatures) gl.vertexAttribI4ui(4, batch.feature ?? 0, 0, 0, 0);
    const count = batch.form === undefined ? batch.count ?? 1 : this.scene.forms[batch.form].count;
    if (batch.places) {
      if (count > 0) gl.drawElementsInstanced(gl.TRIANGLES, batch.indices, gl.UNSIGNED_INT, 0, count);
    } else {
      [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]].forEach((row, index) => gl.vertexAttrib4f(5 + index, ...row));
      gl.drawElements(gl.TRIANGLES, batch.indices, gl.UNSIGNED_INT, 0);
    }
    this.triangles += batch.indices / 3 * count;
  }

  // Batches of a kind in their order; `program` names the shader of each.
  several(frame, wanted, shaderOf) {
    let last = null;
    for (const batch of this.scene.batches) {
      if (!wanted(batch) || !this.isShown(batch, frame)) continue;
      const shader = shaderOf(batch);
      if (shader !== last) this.use(this.scene.programs[shader], frame);
      last = shader;
      this.one(batch, this.scene.programs[shader], frame);
    }
  }

  shaderOf(batch) {
    return batch.material.onGround || batch.material.groundMap ? "ground" : "solid";
  }

  // Draws a frame `seconds` after the last one.
  draw(camera, size, pixelRatio, seconds = 1) {
    const { gl } = this;
    const frame = { ...this.frame(camera, size, pixelRatio), pixelRatio };
    const isStudio = frame.setting === "landscape" || frame.setting === "skyline" ? 0 : 1;
    // The backdrop changes over a fifth of a second: a step would look like a flash.
    const most = 5 * seconds;
    this.studio = this.studio === null ? isStudio : this.studio + clamp(isStudio - this.studio, -most, most);
    frame.studio = this.studio;
    this.chooseForms(camera, size);
    frame.shadow = this.drawShadows(camera, size);
    this.triangles = 0;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, size[0], size[1]);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
    gl.disable(gl.CULL_FACE);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.bindVertexArray(null);
    gl.depthMask(false);
    this.use(this.scene.programs.backdrop, frame);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.depthMask(true);
    const shaderOf = (batch) => this.shaderOf(batch);
    this.several(frame, (batch) => batch.layer === "ground", shaderOf);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(-1, -4);
    this.several(frame, (batch) => batch.layer === "draped", shaderOf);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.disable(gl.BLEND);
    gl.depthMask(true);
    const isSolid = (batch, mode) => batch.layer === "solid" && batch.material.alpha.mode === mode;
    this.several(frame, (batch) => isSolid(batch, "opaque"), shaderOf);
    gl.enable(gl.SAMPLE_ALPHA_TO_COVERAGE);
    this.several(frame, (batch) => isSolid(batch, "mask"), shaderOf);
    gl.disable(gl.SAMPLE_ALPHA_TO_COVERAGE);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    this.several(frame, (batch) => isSolid(batch, "blend"), shaderOf);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
    gl.bindVertexArray(null);
    return { isSettled: this.studio === isStudio, setting: frame.setting };
  }

  // Chooses the forms of models anew where the eye has moved by more than a share of the way to what it looks at.
  chooseForms(camera, size) {
    if (this.scene.groups.length === 0) return;
    const [eye, pixels] = [camera.eye, size[1] / (2 * camera.spans(size)[1])];
    const last = this.formsFor;
    const moved = last ? length(minus(last.eye, eye)) / camera.distance + Math.abs(Math.log(pixels / last.pixels)) : 1;
    if (moved < 0.02 && last.isParallel === camera.isParallel) return;
    this.formsFor = { eye, pixels, isParallel: camera.isParallel };
    this.scene.chooseForms(eye, pixels, camera.isParallel);
  }

  // The depths of solids as the sun sees them, around what the picture shows; null where nothing casts a shadow.
  drawShadows(camera, size) {
    const casts = (batch) => batch.layer === "solid" && !batch.table && batch.material.alpha.mode !== "blend"
      && batch.material.shadows && batch.feature !== 0xffffffff;
    if (!this.scene.batches.some(casts)) return null;
    const { gl } = this;
    const { bounds, light } = this.data.description;
    const half = clamp(camera.heightAtTarget(size), 20, 0.6 * Math.hypot(bounds[1][0] - bounds[0][0], bounds[1][1] - bounds[0][1]));
    const toSun = light.toSun;
    const level = Math.hypot(toSun[0], toSun[1]);
    const right = level > 1e-6 ? [-toSun[1] / level, toSun[0] / level, 0] : [1, 0, 0];
    const up = [toSun[1] * right[2] - toSun[2] * right[1], toSun[2] * right[0] - toSun[0] * right[2],
      toSun[0] * right[1] - toSun[1] * right[0]];
    const deep = length(minus(bounds[1], bounds[0])) + 1000;
    // In steps of texels, so that edges stand still while the camera moves.
    const texel = 2 * half / SHADOW_SIDE;
    const snapped = (axis) => Math.round(dot(camera.target, axis) / texel) * texel;
    const center = [right, up, toSun].reduce((sum, axis, index) =>
      plus(sum, axis, index === 2 ? dot(camera.target, axis) : snapped(axis)), [0, 0, 0]);
    const frame = {
      eye: plus(center, toSun, deep / 2), forward: toSun.map((part) => -part),
      right: [...right, 1 / half], up: [...up, 1 / half], depth: [2 / deep, -1], isParallel: true,
      haze: [0, 0, 0, 0], zenith: [0, 0, 0, 0], setting: "plan", pixel: 0, isShadow: true, pixelRatio: 1, studio: 0,
    };
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.scene.shadow.frame);
    gl.viewport(0, 0, SHADOW_SIDE, SHADOW_SIDE);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.depthMask(true);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1.5, 2);
    this.several(frame, casts, () => "shadow");
    gl.disable(gl.POLYGON_OFFSET_FILL);
    const row = (axis, scale, shift) => [...axis.map((part) => part * scale), shift];
    const rows = [
      row(right, 0.5 / half, 0.5 - dot(frame.eye, right) * 0.5 / half),
      row(up, 0.5 / half, 0.5 - dot(frame.eye, up) * 0.5 / half),
      row(toSun, -1 / deep, dot(frame.eye, toSun) / deep),
      [0, 0, 0, 1],
    ];
    const matrix = [0, 1, 2, 3].flatMap((column) => rows.map((values) => values[column]));
    return { matrix, terms: [1, texel, 1 / SHADOW_SIDE, 0.3 * texel / deep] };
  }

  // The feature and the world position at a pixel of the picture, counted from the upper left; null for the sky.
  pick(camera, size, pixel, pixelRatio) {
    const { gl } = this;
    const frame = { ...this.frame(camera, size, pixelRatio), pixelRatio, studio: 0 };
    const [x, y] = [Math.floor(pixel[0]), size[1] - 1 - Math.floor(pixel[1])];
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.scene.pickFrame(size));
    gl.viewport(0, 0, size[0], size[1]);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(x, y, 1, 1);
    gl.enable(gl.DEPTH_TEST);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
    gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    const shader = () => "pick";
    this.several(frame, (batch) => batch.layer === "ground", shader);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(-1, -4);
    gl.depthMask(false);
    this.several(frame, (batch) => batch.layer === "draped", shader);
    gl.depthMask(true);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    this.several(frame, (batch) => batch.layer === "solid" && !batch.table, shader);
    const seen = new Uint32Array(4);
    gl.readPixels(x, y, 1, 1, gl.RGBA_INTEGER, gl.UNSIGNED_INT, seen);
    gl.disable(gl.SCISSOR_TEST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.bindVertexArray(null);
    if (seen[0] === 0) return null;
    const depth = new Float32Array(seen.buffer, 4, 1)[0];
    const { origin, direction } = camera.ray([Math.floor(pixel[0]) + 0.5, Math.floor(pixel[1]) + 0.5], size);
    return { feature: seen[0], depth, world: plus(origin, direction, depth) };
  }
}
