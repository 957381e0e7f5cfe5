// The covers of areas: the formulas of draw/area_texture, in GLSL ES 3.00. The shader of the ground has what is used here.

const AREA_SHADER = `
uniform vec4 area[9];      // of an area's texture, in the order of AreaTexture::uniform
uniform float area_share;  // 1 where the surface has one

float area_shown(float wide_m, float pixel_m) {
  return clamp(2.0 * wide_m / (AREA_PART_PX * pixel_m) - 1.0, 0.0, 1.0);
}

// A place by axes of which the first runs along axis.
vec2 area_turned(vec2 at, vec2 axis) {
  return vec2(axis.x * at.x + axis.y * at.y, axis.x * at.y - axis.y * at.x);
}

// The share of a pixel that a line covers whose middle is so far away.
float area_line(float wide_m, float away_m, float pixel_m) {
  vec2 sides = clamp((vec2(0.5, -0.5) * wide_m - away_m) / pixel_m + 0.5, vec2(0.0), vec2(1.0));
  return sides.x - sides.y;
}

vec2 two_noises(vec2 at) {
  vec2 cell = floor(at);
  vec2 part = at - cell;
  vec2 smoothed = part * part * (3.0 - 2.0 * part);
  uvec2 corner = uvec2(ivec2(cell));
  vec2 south = mix(noise_values(corner), noise_values(corner + uvec2(1u, 0u)), smoothed.x);
  vec2 north = mix(noise_values(corner + uvec2(0u, 1u)), noise_values(corner + uvec2(1u, 1u)), smoothed.x);
  return mix(south, north, smoothed.y);
}

// A wave of the noise that moves the strip in which an area fades.
float area_wave(vec2 at, float wave_m, float pixel_m) {
  return clamp(2.0 * wave_m / (NOISE_WAVE_PX * pixel_m) - 1.0, 0.0, 1.0) * two_noises(at / wave_m).x;
}

// The sums of the noise, and those that bend.
vec4 area_noise(vec2 at, float first_m, float pixel_m) {
  vec4 sum = vec4(0.0);
  float height = 1.0;
  float wave_m = first_m;
  vec2 turn = vec2(1.0, 0.0);
  for (float octave = 0.0; octave < AREA_OCTAVES; octave += 1.0) {
    float shown = clamp(2.0 * wave_m / (NOISE_WAVE_PX * pixel_m) - 1.0, 0.0, 1.0);
    if (shown > 0.0) {
      vec2 place = vec2(turn.x * at.x - turn.y * at.y, turn.y * at.x + turn.x * at.y) / wave_m;
      vec2 value = two_noises(place) * (NOISE_SHARE * shown);
      sum += vec4(value, value * height);
    }
    height *= NOISE_FINER;
    wave_m *= NOISE_FINER;
    turn = vec2(NOISE_TURN.x * turn.x - NOISE_TURN.y * turn.y, NOISE_TURN.y * turn.x + NOISE_TURN.x * turn.y);
  }
  return sum;
}

// Parcel.
struct AreaParcel {
  uvec2 cell;
  vec2 own;
  float inside_m;
};

AreaParcel area_parcel(vec2 at, float parcel_m) {
  vec2 grid = at / parcel_m;
  vec2 corner = floor(grid);
  vec3 first = vec3(1e9, 0.0, 0.0);
  vec3 second = vec3(1e9, 0.0, 0.0);
  AreaParcel found = AreaParcel(uvec2(0u), vec2(0.0), 0.0);
  for (int index = 0; index < 9; index += 1) {
    vec2 cell = corner + vec2(float(index % 3) - 1.0, float(index / 3) - 1.0);
    uvec2 salted = uvec2(ivec2(cell)) + uint(AREA_SALTS.x);
    vec2 hash = noise_values(salted);
    vec2 away = cell + 0.5 + AREA_PARCEL_JITTER * hash - grid;
    vec3 here = vec3(dot(away, away), away);
    if (here.x < first.x) {
      second = first;
      first = here;
      found.cell = salted;
      found.own = hash;
    } else if (here.x < second.x) {
      second = here;
    }
  }
  float apart = max(length(second.yz - first.yz), 1e-3);
  found.inside_m = (second.x - first.x) / (2.0 * apart) * parcel_m;
  return found;
}

vec2 area_strip_number(float row, float column, uvec2 own) {
  return noise_values(uvec2(ivec2(vec2(row, column))) + own);
}

float area_strip_tone(float row, float x, float piece_m, float pixel_m, uvec2 own) {
  float along = x / piece_m + area_strip_number(row, 0.0, own).x - 0.5;
  float before = floor(along);
  float part = clamp((along - before - 0.5) * piece_m / pixel_m + 0.5, 0.0, 1.0);
  return mix(area_strip_number(row, before, own).y, area_strip_number(row, before + 1.0, own).y, part);
}

// The tone of the piece of a strip, and the share of a border between strips.
vec2 area_strip(vec2 place, float strip_m, float border_m, float pixel_m, uvec2 own) {
  float along = place.y / strip_m - 0.5;
  float below = floor(along);
  float piece_m = AREA_STRIP_LENGTH * strip_m;
  float shown = area_shown(strip_m, pixel_m);
  float wide_m = AREA_STRIP_BORDER.y * border_m;
  float mean_line = 0.5 * (1.0 - AREA_STRIP_BORDER.x) * wide_m / strip_m;
  if (shown <= 0.0) return vec2(0.0, mean_line);
  float across_m = (along - below - 0.5) * strip_m;
  float first = area_strip_tone(below, place.x, piece_m, pixel_m, own);
  float second = area_strip_tone(below + 1.0, place.x, piece_m, pixel_m, own);
  float line = area_line(wide_m, abs(across_m), pixel_m);
  float lined = step(AREA_STRIP_BORDER.x, area_strip_number(below, 0.0, own).x);
  float tone = mix(first, second, clamp(across_m / pixel_m + 0.5, 0.0, 1.0));
  return vec2(shown * tone, mix(mean_line, lined * line, shown));
}

// The share of the nearest figure and how far it turns to the north-west. figures and radii are those of AreaTexture.
vec2 area_figure(vec2 place, float noise, float pixel_m, uvec2 own, vec4 figures, vec4 radii) {
  vec2 lattice = place / figures.xy;
  vec2 corner = floor(lattice - 0.5);
  float nearest = 1e9;
  float facing = 0.0;
  float radius = 1.0;
  for (int index = 0; index < 4; index += 1) {
    vec2 cell = corner + vec2(float(index % 2), float(index / 2));
    vec2 hash = noise_values(uvec2(ivec2(cell)) + own + uint(AREA_SALTS.y));
    vec2 away = lattice - cell - 0.5 - figures.z * hash;
    vec2 sides = radii.x + fract(hash * 61.0) * (radii.y - radii.x);
    float rectangle = max(abs(away.x / sides.x), abs(away.y / sides.y));
    float ratio = mix(length(away) / sides.x, rectangle, figures.w) + radii.w * noise;
    if (ratio < nearest) {
      nearest = ratio;
      facing = mix((away.y - away.x) * 0.70710678 / sides.x, (away.y > 0.0 ? 1.0 : -1.0), figures.w);
      radius = min(sides.x, sides.y) * min(figures.x, figures.y);
    }
  }
  return vec2(clamp((1.0 - nearest) * radius / pixel_m + 0.5, 0.0, 1.0), clamp(facing, -1.0, 1.0));
}

vec4 area_color(vec2 at, float mean_m, float longest_m, float inward) {
  vec4 ground = area[0];
  vec4 tones = area[3];
  vec4 sizes = area[4];
  vec4 rows = area[5];
  vec4 figures = area[6];
  vec4 radii = area[7];
  vec2 shares = area[8].xy;
  vec4 noise = area_noise(at, sizes.x, mean_m);
  vec2 bent = at + noise.zw * rows.z;
  float light = 1.0 + tones.w * noise.x;
  float tone = noise.y;
  vec2 place = area_turned(bent, NOISE_TURN);
  float inside_m = AREA_ALONE_M;
  uvec2 own = uvec2(0u);
  if (sizes.y > 0.0) {
    float shown = area_shown(sizes.y, longest_m);
    tone = 0.0;
    if (shown > 0.0) {
      AreaParcel parcel = area_parcel(bent, sizes.y);
      vec2 axis = normalize(parcel.own + vec2(1e-3, 0.0));
      place = area_turned(bent, axis);
      inside_m = parcel.inside_m;
      own = parcel.cell;
      shares.y = mix(shares.y, area_line(sizes.z, inside_m, longest_m), shown);
      tone = shown * noise_values(own + uint(AREA_SALTS.y)).x;
      if (sizes.w > 0.0) {
        vec2 strip = area_strip(place, sizes.w, sizes.z, longest_m, own);
        tone = mix(tone, AREA_PARCEL_TONE * tone + strip.x, shown);
        shares.y = mix(shares.y, max(shares.y, strip.y), shown);
      }
    }
  }
  if (rows.x > 0.0) {
    float across = place.y / rows.x;
    light += rows.y * area_shown(rows.x, longest_m) * (1.0 - 4.0 * abs(across - floor(across) - 0.5));
  }
  if (figures.y > 0.0) {
    float shown = area_shown(min(figures.x, figures.y), longest_m);
    if (shown > 0.0) {
      vec2 figure = area_figure(place, noise.x, longest_m, own, figures, radii);
      float margin = inside_m - 0.5 * sizes.z - AREA_FIGURE_MARGIN * figures.y;
      float kept = figure.x * clamp(margin / longest_m + 0.5, 0.0, 1.0);
      shares.x = mix(shares.x, kept, shown);
      light += rows.w * figure.y * kept * shown;
    }
  }
  vec4 color = mix(vec4(ground.rgb + tones.rgb * tone, ground.a), area[1], shares.x);
  color = mix(color, area[2], shares.y);
  if (radii.z > 0.0) {
    float moved = AREA_FADE_MOVED
      * (area_wave(at, AREA_FADE_M, mean_m) + 0.5 * area_wave(at, AREA_FADE_M * NOISE_FINER, mean_m));
    float within = inward * (1.0 - inward) * 4.0;
    float fade = smoothstep(0.0, 1.0, inward + moved * within);
    color.a *= mix(0.5, fade, area_shown(AREA_FADE_WIDE_M, longest_m));
  }
  return vec4(max(color.rgb * max(light, 0.2), vec3(0.0)), color.a);
}
`;
