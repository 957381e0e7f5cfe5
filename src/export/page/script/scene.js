// The scene on the graphics adapter: buffers and textures, made anew when the adapter was lost.

// The side of the shadow map in texels.
const SHADOW_SIDE = 2048;

// The error of a model's simpler form on the picture, in pixels, and the size below which the ground alone shows a plant:
// those of model/detail.rs and scene/picture/detail.rs, a little coarser while everything moves.
const FORM_ERROR_PX = 0.75;
const LEAST_PLANT_PX = 1.5;

// Numbers of the scene, decoded once; the adapter's copies are made of them.
class SceneData {
  static async read(description, sections, progress) {
    const data = new SceneData();
    data.description = description;
    const map = description.map;
    progress("heights");
    data.heights = await sections.floats(description.ground.heights);
    progress("ground");
    const [heights, east, north, sun, sky, water] = await Promise.all([
      sections.floats(map.heights), sections.words(map.slopeEast), sections.words(map.slopeNorth),
      sections.bytes(map.sun), sections.bytes(map.sky), sections.bytes(map.water),
    ]);
    data.heightLevels = levelsOf(heights, map.columns, map.rows, 1);
    const posts = new Float32Array(heights.length * 4);
    for (let post = 0; post < heights.length; post += 1) {
      posts[4 * post] = (east[post] - 32768) / map.slopeSteps;
      posts[4 * post + 1] = (north[post] - 32768) / map.slopeSteps;
      posts[4 * post + 2] = sun[post] / 255;
      posts[4 * post + 3] = (water[post] - 127) / 127;
    }
    data.postLevels = levelsOf(posts, map.columns, map.rows, 4);
    data.skyLevels = levelsOf(sky, map.columns, map.rows, 1);
    progress("things");
    data.batches = [];
    for (const batch of description.batches) {
      const optional = (name, kind) => (batch[name] ? sections[kind](batch[name]) : null);
      const [positions, triangles, uvs, colors, normals, features, places, placeFeatures] = await Promise.all([
        sections.floats(batch.positions), sections.words(batch.triangles), optional("uvs", "floats"),
        optional("colors", "bytes"), optional("normals", "bytes"), optional("features", "words"),
        batch.places ? sections.shared("floats", batch.places) : null,
        batch.placeFeatures ? sections.shared("words", batch.placeFeatures) : null,
      ]);
      data.batches.push({ ...batch, positions, triangles, uvs, colors, normals, features, places, placeFeatures });
    }
    progress("pictures");
    const picture = (texture, bytes) => texture && createImageBitmap(
      new Blob([bytes], { type: texture.type }),
      { premultiplyAlpha: "none", colorSpaceConversion: "none" },
    );
    data.textures = await Promise.all(
      description.textures.map((texture) => texture && picture(texture, sections.raw(texture))),
    );
    data.symbols = await Promise.all(
      description.symbols.map(({ picture: texture }) => texture && picture(texture, sections.raw(texture))),
    );
    const imagery = description.imagery && description.imagery.picture;
    data.imagery = imagery ? await picture(imagery, sections.raw(imagery)) : null;
    return data;
  }
}

// Mip levels by a box filter that keeps every level over the same ground, whatever the number of posts; see the polyphase
// filter of "Non-power-of-two mipmapping" (Nvidia 2005).
function levelsOf(values, columns, rows, channels) {
  const levels = [{ values, columns, rows }];
  const halved = (source, count, stride, lines, lineStride, make) => {
    const half = Math.max(count >> 1, 1);
    for (let line = 0; line < lines; line += 1) {
      for (let index = 0; index < half; index += 1) {
        const first = line * lineStride + 2 * index * stride;
        for (let channel = 0; channel < channels; channel += 1) {
          const at = (step) => source[first + step * stride + channel];
          let value;
          if (count === 1) value = source[line * lineStride + channel];
          else if (count % 2 === 0) value = (at(0) + at(1)) / 2;
          else value = ((half - index) * at(0) + half * at(1) + (index + 1) * at(2)) / count;
          make(index, line, channel, value);
        }
      }
    }
    return half;
  };
  for (let last = levels[0]; last.columns > 1 || last.rows > 1; last = levels[levels.length - 1]) {
    const width = Math.max(last.columns >> 1, 1);
    const narrow = new Float32Array(width * last.rows * channels);
    halved(last.values, last.columns, channels, last.rows, last.columns * channels, (x, y, channel, value) => {
      narrow[(y * width + x) * channels + channel] = value;
    });
    const height = Math.max(last.rows >> 1, 1);
    const Kind = values.constructor;
    const small = new Kind(width * height * channels);
    halved(narrow, last.rows, width * channels, width, channels, (y, x, channel, value) => {
      small[(y * width + x) * channels + channel] = Kind === Uint8Array ? Math.round(value) : value;
    });
    levels.push({ values: small, columns: width, rows: height });
  }
  return levels;
}

function program(gl, vertex, fragment, name) {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) {
      throw new Error(`the shader ${name}: ${gl.getShaderInfoLog(shader)}`);
    }
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error(`the shader ${name}: ${gl.getProgramInfoLog(made)}`);
  }
  const places = {};
  const count = gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS) || 0;
  for (let index = 0; index < count; index += 1) {
    const { name: uniform } = gl.getActiveUniform(made, index);
    places[uniform.replace("[0]", "")] = gl.getUniformLocation(made, uniform);
  }
  return { made, places };
}

class AdapterScene {
  constructor(gl, data) {
    this.gl = gl;
    this.data = data;
    this.programs = {
      ground: program(gl, VERTEX_SHADER, GROUND_SHADER, "ground"),
      solid: program(gl, VERTEX_SHADER, SOLID_SHADER, "solid"),
      pick: program(gl, VERTEX_SHADER, PICK_SHADER, "pick"),
      shadow: program(gl, VERTEX_SHADER, SHADOW_SHADER, "shadow"),
      backdrop: program(gl, BACKDROP_VERTEX, BACKDROP_SHADER, "backdrop"),
    };
    this.sharp = gl.getExtension("EXT_texture_filter_anisotropic");
    const { description } = data;
    this.white = this.plain([255, 255, 255, 255]);
    this.heights = this.levels(data.heightLevels, gl.R32F, gl.RED, gl.FLOAT, gl.NEAREST);
    this.slopes = this.levels(data.postLevels, gl.RGBA16F, gl.RGBA, gl.FLOAT, gl.LINEAR);
    this.skies = this.levels(data.skyLevels, gl.R8, gl.RED, gl.UNSIGNED_BYTE, gl.LINEAR);
    this.ramp = this.rampTexture(description.map.ramp);
    this.textures = data.textures.map((bitmap) => (bitmap ? this.picture(bitmap, gl.REPEAT) : this.white));
    this.imagery = data.imagery ? this.picture(data.imagery, gl.CLAMP_TO_EDGE) : this.white;
    this.forms = description.forms.map((form) => ({ ...form, count: 0, places: null }));
    this.batches = data.batches.map((batch) => this.batch(batch));
    this.groups = this.formGroups();
    this.shadow = this.shadowTarget();
    this.pickTarget = null;
  }

  texture(wrap, small, large) {
    const { gl } = this;
    const made = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, made);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, wrap);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, wrap);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, small);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, large);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    return made;
  }

  // What the bound texture shows beyond its borders: two materials may show one texture in two ways.
  setWrap(wrap) {
    const { gl } = this;
    const ways = { repeat: gl.REPEAT, mirror: gl.MIRRORED_REPEAT, clamp: gl.CLAMP_TO_EDGE };
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, ways[wrap[0]]);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, ways[wrap[1]]);
  }

  sharpen() {
    if (this.sharp) this.gl.texParameteri(this.gl.TEXTURE_2D, this.sharp.TEXTURE_MAX_ANISOTROPY_EXT, 8);
  }

  plain(color) {
    const { gl } = this;
    const made = this.texture(gl.REPEAT, gl.NEAREST, gl.NEAREST);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 1, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(color));
    return made;
  }

  levels(levels, format, channels, kind, filter) {
    const { gl } = this;
    const isLinear = filter === gl.LINEAR;
    const small = isLinear ? gl.LINEAR_MIPMAP_LINEAR : gl.NEAREST_MIPMAP_NEAREST;
    const made = this.texture(gl.CLAMP_TO_EDGE, small, filter);
    levels.forEach(({ values, columns, rows }, level) =>
      gl.texImage2D(gl.TEXTURE_2D, level, format, columns, rows, 0, channels, kind, values));
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAX_LEVEL, levels.length - 1);
    if (isLinear) this.sharpen();
    return made;
  }

  picture(bitmap, wrap) {
    const { gl } = this;
    const made = this.texture(wrap, gl.LINEAR_MIPMAP_LINEAR, gl.LINEAR);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.SRGB8_ALPHA8, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
    gl.generateMipmap(gl.TEXTURE_2D);
    this.sharpen();
    return made;
  }

  // The ramp at even steps of height.
  rampTexture(stops) {
    const { gl } = this;
    const steps = 2048;
    const [low, high] = [stops[0][0], stops[stops.length - 1][0]];
    const colors = new Float32Array(steps * 4);
    for (let step = 0, above = 1; step < steps; step += 1) {
      const height = mix(low, high, (step + 0.5) / steps);
      while (above < stops.length - 1 && stops[above][0] <= height) above += 1;
      const [before, after] = [stops[above - 1], stops[Math.min(above, stops.length - 1)]];
      const part = after[0] > before[0] ? clamp((height - before[0]) / (after[0] - before[0]), 0, 1) : 0;
      for (let channel = 0; channel < 3; channel += 1) {
        colors[4 * step + channel] = mix(before[channel + 1], after[channel + 1], part);
      }
    }
    const made = this.texture(gl.CLAMP_TO_EDGE, gl.LINEAR, gl.LINEAR);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA16F, steps, 1, 0, gl.RGBA, gl.FLOAT, colors);
    this.rampRange = [low, high > low ? 1 / (high - low) : 0];
    return made;
  }

  buffer(target, values) {
    const { gl } = this;
    const made = gl.createBuffer();
    gl.bindBuffer(target, made);
    gl.bufferData(target, values, gl.STATIC_DRAW);
    return made;
  }

  batch(batch) {
    const { gl } = this;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const floats = (place, values, size) => {
      this.buffer(gl.ARRAY_BUFFER, values);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 0, 0);
    };
    floats(0, batch.positions, 3);
    if (batch.normals) {
      this.buffer(gl.ARRAY_BUFFER, batch.normals);
      gl.enableVertexAttribArray(1);
      gl.vertexAttribPointer(1, 3, gl.BYTE, true, 0, 0);
    }
    if (batch.uvs) floats(2, batch.uvs, 2);
    if (batch.colors) {
      this.buffer(gl.ARRAY_BUFFER, batch.colors);
      gl.enableVertexAttribArray(3);
      gl.vertexAttribPointer(3, 4, gl.UNSIGNED_BYTE, true, 0, 0);
    }
    const form = this.formOf(batch);
    const features = batch.placeFeatures || batch.features;
    if (features) {
      if (form) gl.bindBuffer(gl.ARRAY_BUFFER, form.featureBuffer);
      else this.buffer(gl.ARRAY_BUFFER, features);
      gl.enableVertexAttribArray(4);
      gl.vertexAttribIPointer(4, 1, gl.UNSIGNED_INT, 0, 0);
      gl.vertexAttribDivisor(4, batch.placeFeatures ? 1 : 0);
    }
    if (batch.places) {
      if (form) gl.bindBuffer(gl.ARRAY_BUFFER, form.placeBuffer);
      else this.buffer(gl.ARRAY_BUFFER, batch.places);
      for (let row = 0; row < 3; row += 1) {
        gl.enableVertexAttribArray(5 + row);
        gl.vertexAttribPointer(5 + row, 4, gl.FLOAT, false, 48, 16 * row);
        gl.vertexAttribDivisor(5 + row, 1);
      }
    }
    this.buffer(gl.ELEMENT_ARRAY_BUFFER, batch.triangles);
    gl.bindVertexArray(null);
    const material = this.data.description.materials[batch.material];
    return { ...batch, array, material, indices: batch.triangles.length };
  }

  // The form of models that a batch is a part of, with the buffers of the places where it is shown.
  formOf(batch) {
    if (batch.form === undefined) return null;
    const form = this.forms[batch.form];
    if (!form.places) {
      form.places = batch.places;
      form.features = batch.placeFeatures;
      form.count = batch.count;
      form.placeBuffer = this.buffer(this.gl.ARRAY_BUFFER, batch.places);
      form.featureBuffer = this.buffer(this.gl.ARRAY_BUFFER, batch.placeFeatures);
    }
    return form;
  }

  // The forms of each group of equal models, the finest first; groups that are always shown in full are left out.
  formGroups() {
    const groups = new Map();
    for (const form of this.forms.filter((each) => each.places)) {
      if (!groups.has(form.group)) groups.set(form.group, []);
      groups.get(form.group).push(form);
    }
    return [...groups.values()].filter((forms) => forms.length > 1 || forms[0].isPlant);
  }

  // Chooses the form of each model by its size on the picture; `pixels` are those of a meter at unit depth.
  chooseForms(eye, pixels, isParallel) {
    const { gl } = this;
    for (const forms of this.groups) {
      const { places, features, center, radius, isPlant } = forms[0];
      const chosen = forms.map(() => ({ places: [], features: [] }));
      for (let index = 0; index < features.length; index += 1) {
        const at = index * 12;
        const scale = Math.hypot(places[at], places[at + 4], places[at + 8]);
        let away = 0;
        for (let row = 0; row < 3; row += 1) {
          const first = at + 4 * row;
          const world = places[first] * center[0] + places[first + 1] * center[1] + places[first + 2] * center[2] + places[first + 3];
          away += (world - eye[row]) ** 2;
        }
        const depth = isParallel ? 1 : Math.max(Math.sqrt(away) - radius * scale, 0.5);
        const perUnit = pixels * scale / depth;
        if (isPlant && 2 * radius * perUnit < LEAST_PLANT_PX) continue;
        let form = forms.length - 1;
        while (form > 0 && forms[form].error * perUnit > FORM_ERROR_PX) form -= 1;
        for (let value = 0; value < 12; value += 1) chosen[form].places.push(places[at + value]);
        chosen[form].features.push(features[index]);
      }
      forms.forEach((form, index) => {
        form.count = chosen[index].features.length;
        gl.bindBuffer(gl.ARRAY_BUFFER, form.placeBuffer);
        gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(chosen[index].places), gl.DYNAMIC_DRAW);
        gl.bindBuffer(gl.ARRAY_BUFFER, form.featureBuffer);
        gl.bufferData(gl.ARRAY_BUFFER, new Uint32Array(chosen[index].features), gl.DYNAMIC_DRAW);
      });
    }
  }

  shadowTarget() {
    const { gl } = this;
    const texture = this.texture(gl.CLAMP_TO_EDGE, gl.LINEAR, gl.LINEAR);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.DEPTH_COMPONENT24, SHADOW_SIDE, SHADOW_SIDE, 0, gl.DEPTH_COMPONENT,
      gl.UNSIGNED_INT, null);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_FUNC, gl.LEQUAL);
    const frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, texture, 0);
    gl.drawBuffers([gl.NONE]);
    gl.readBuffer(gl.NONE);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return { texture, frame };
  }

  // A target for picking, as large as the picture.
  pickFrame(size) {
    const { gl } = this;
    const old = this.pickTarget;
    if (old && old.size[0] === size[0] && old.size[1] === size[1]) return old.frame;
    if (old) {
      gl.deleteRenderbuffer(old.color);
      gl.deleteRenderbuffer(old.depth);
      gl.deleteFramebuffer(old.frame);
    }
    const buffer = (format) => {
      const made = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, made);
      gl.renderbufferStorage(gl.RENDERBUFFER, format, size[0], size[1]);
      return made;
    };
    const [color, depth, frame] = [buffer(gl.RG32UI), buffer(gl.DEPTH_COMPONENT24), gl.createFramebuffer()];
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, color);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
    this.pickTarget = { color, depth, frame, size };
    return frame;
  }
}
