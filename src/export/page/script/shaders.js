// The shaders: the formulas of draw/lighting, draw/ground and the modules beside them, in GLSL ES 3.00.

const VERTEX_SHADER = `#version 300 es
precision highp float;
uniform vec3 eye;
uniform vec4 right, up;   // w: 1 / what half of the picture spans
uniform vec3 forward;
uniform vec4 depth;       // A and B of the depth buffer, by how much it counts as nearer, 1 with parallel rays
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec4 color;
layout(location = 4) in uint feature;
layout(location = 5) in vec4 row0;
layout(location = 6) in vec4 row1;
layout(location = 7) in vec4 row2;
out vec3 world;
out vec3 side;
out vec2 at_texture;
out vec4 tint;
flat out uint feature_id;
out float along;

vec3 linear_from_srgb(vec3 c) {
  return mix(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, lessThanEqual(c, vec3(0.04045)));
}

void main() {
  world = vec3(dot(row0, vec4(position, 1.0)), dot(row1, vec4(position, 1.0)), dot(row2, vec4(position, 1.0)));
  side = vec3(dot(row0.xyz, normal), dot(row1.xyz, normal), dot(row2.xyz, normal));
  at_texture = uv;
  tint = vec4(linear_from_srgb(color.rgb), color.a);
  feature_id = feature;
  vec3 offset = world - eye;
  along = dot(offset, forward);
  vec2 across = vec2(dot(offset, right.xyz) * right.w, dot(offset, up.xyz) * up.w);
  gl_Position = depth.w > 0.5
    ? vec4(across, depth.x * along + depth.y - (depth.z - 1.0) * 0.05, 1.0)
    : vec4(across, depth.x * along + depth.y * depth.z, along);
}`;

const COMMON = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler2DShadow;
${CONSTANTS}
uniform vec3 eye, forward;
uniform vec4 depth;
uniform vec3 to_sun, sun, sky, bounce;
uniform vec4 haze;        // rgb, 1 / distance
uniform vec4 zenith;      // rgb, distance at which haze begins
uniform float horizon;
uniform vec4 base_color;
uniform sampler2D base_texture;
uniform int alpha_mode;   // 0 opaque, 1 mask, 2 blend
uniform float cutoff;
uniform float is_water, is_natural, is_hatching;
uniform vec4 band;        // of a line symbol: meters in a pixel that it is wide enough for, the most, the least that it shows
                          // at; meters in a pixel at unit depth
uniform float real_pixel; // meters in a pixel of the picture at unit depth
uniform mat4 shadow_from_world;
uniform vec4 shadow;      // 1 where there is a map, its texel in meters, 1 / its side, bias
uniform sampler2DShadow shadow_map;
in vec3 world;
in vec3 side;
in vec2 at_texture;
in vec4 tint;
flat in uint feature_id;
in float along;

vec3 srgb_from_linear(vec3 c) {
  c = clamp(c, 0.0, 1.0);
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, c * 12.92, lessThanEqual(c, vec3(0.0031308)));
}

uvec2 mixed_bits(uvec2 at) {
  uint x = at.x * 1664525u + 1013904223u;
  uint y = at.y * 1664525u + 1013904223u;
  x += y * 1664525u;
  y += x * 1664525u;
  x ^= x >> 16;
  y ^= y >> 16;
  x += y * 1664525u;
  y += x * 1664525u;
  x ^= x >> 16;
  y ^= y >> 16;
  return uvec2(x, y);
}

float hash(uvec2 at) {
  return float(mixed_bits(at).x >> 8) / 8388608.0 - 1.0;
}

float noise(vec2 at) {
  vec2 cell = floor(at);
  vec2 part = at - cell;
  vec2 smoothed = part * part * (3.0 - 2.0 * part);
  uvec2 corner = uvec2(ivec2(cell));
  float south = mix(hash(corner), hash(corner + uvec2(1u, 0u)), smoothed.x);
  float north = mix(hash(corner + uvec2(0u, 1u)), hash(corner + uvec2(1u, 1u)), smoothed.x);
  return mix(south, north, smoothed.y);
}

float wave(vec2 at, float pixel_m, float wave_m, float share) {
  float shown = clamp(2.0 * wave_m / (GRAIN_WAVE_PX * pixel_m) - 1.0, 0.0, 1.0);
  return shown <= 0.0 ? 0.0 : share * shown * noise(at / wave_m);
}

float waves(vec2 at, float pixel_m, vec3 waves_m, vec3 shares) {
  return wave(at, pixel_m, waves_m.x, shares.x) + wave(at, pixel_m, waves_m.y, shares.y) + wave(at, pixel_m, waves_m.z, shares.z);
}

vec3 from_eye() {
  return depth.w > 0.5 ? forward : world - eye;
}

vec3 sky_at(vec3 ray) {
  float rise = max(ray.z, 0.0);
  return mix(haze.rgb, zenith.rgb, rise * (2.0 - rise) * (rise * (1.0 + horizon) / (rise + horizon)));
}

vec2 ripple(vec2 at, float pixel_m, float low, float wave_m, float steepness) {
  float shown = low * clamp(2.0 * wave_m / (RIPPLE_WAVE_PX * pixel_m) - 1.0, 0.0, 1.0);
  if (shown <= 0.0) return vec2(0.0);
  vec2 place = at / wave_m;
  return vec2(noise(place), noise(place + vec2(37.5, 17.25))) * (shown * steepness);
}

vec3 mirror_sky(vec3 color, float water, float pixel_m) {
  if (water <= 0.0) return color;
  vec3 ray = normalize(from_eye());
  float low = clamp((1.0 + ray.z - RIPPLE_GRAZING.x) / (RIPPLE_GRAZING.y - RIPPLE_GRAZING.x), 0.0, 1.0);
  vec2 ripples = ripple(world.xy, pixel_m, low, RIPPLE_WAVES_M.x, RIPPLE_STEEPNESS.x)
    + ripple(world.xy, pixel_m, low, RIPPLE_WAVES_M.y, RIPPLE_STEEPNESS.y)
    + ripple(world.xy, pixel_m, low, RIPPLE_WAVES_M.z, RIPPLE_STEEPNESS.z);
  vec3 normal = normalize(vec3(-ripples, 1.0));
  float facing = -dot(ray, normal);
  float grazing = 1.0 - clamp(facing, 0.0, 1.0);
  float share = WATER_MIRRORED + (WATER_MOST_MIRRORED - WATER_MIRRORED) * pow(grazing, 5.0);
  return mix(color, sky_at(ray + normal * (2.0 * facing)), share * water);
}

// The share of the sun that solids let through.
float sun_share(vec3 normal) {
  if (shadow.x < 0.5) return 1.0;
  vec3 place = (shadow_from_world * vec4(world + normal * shadow.y * 1.5, 1.0)).xyz;
  if (any(lessThan(place, vec3(0.0))) || any(greaterThan(place, vec3(1.0)))) return 1.0;
  float sum = 0.0;
  for (int y = -1; y <= 1; y += 1) {
    for (int x = -1; x <= 1; x += 1) {
      sum += texture(shadow_map, vec3(place.xy + vec2(x, y) * shadow.z, place.z - shadow.w));
    }
  }
  return sum / 9.0;
}

vec4 surface() {
  if (is_hatching > 0.5) {
    float across = (gl_FragCoord.x - gl_FragCoord.y) * 0.70710678 / HATCHING_PITCH_PX;
    return vec4(base_color.rgb, base_color.a * clamp(HATCHING_WIDTH_PX / 2.0 + 0.5 - abs(fract(across) - 0.5) * HATCHING_PITCH_PX, 0.0, 1.0));
  }
  return base_color * tint * texture(base_texture, at_texture);
}

// The share of a pixel that a line symbol covers; 1 for all else. Symbols are made SPREAD times as wide as their band needs,
// see scene/picture/all_round.rs, and grow where they are seen across at a low angle.
const float SPREAD = 2.0;
const float MOST_GROWTH = 3.0;

float symbol_cover() {
  float across = abs(at_texture.y * 2.0 - 1.0);
  vec2 change = vec2(dFdx(across), dFdy(across));
  vec2 right = dFdx(world.xy);
  vec2 down = dFdy(world.xy);
  if (band.x == 0.0) return 1.0;
  float pixel = band.w * (depth.w > 0.5 ? 1.0 : along);
  if (pixel > band.y || pixel <= band.z) return 0.0;
  // What it changes by in a meter of ground, and what that would be in a pixel if it were seen from above.
  float area = right.x * down.y - right.y * down.x;
  vec2 per_m = vec2(change.x * down.y - change.y * right.y, change.y * right.x - change.x * down.x) / area;
  float level = length(per_m) * real_pixel * (depth.w > 0.5 ? 1.0 : along);
  float edge = max(length(change), 1e-4);
  float growth = clamp(edge / max(level, 1e-6), 1.0, MOST_GROWTH);
  return clamp((min(pixel / band.x * growth / SPREAD, 1.0) - across) / edge + 0.5, 0.0, 1.0);
}

vec4 seen(vec3 light, float alpha) {
  float clear = exp(-max(distance(world, eye) - zenith.w, 0.0) * haze.w);
  vec3 shown = depth.w > 0.5 ? light : mix(haze.rgb, light, clear);
  return vec4(srgb_from_linear(shown), alpha);
}
`;

const GROUND_SHADER = `${COMMON}
uniform float is_map;       // 1 where the color is the map's, 0 for what is draped
uniform vec4 grid;          // origin of the ground map, 1 / cell
uniform vec4 grid_size;     // columns, rows, the level of the generalized ground, the coarsest level
uniform sampler2D heights;
uniform sampler2D slopes;   // slope east, slope north, share of the sun, water
uniform sampler2D skies;
uniform sampler2D ramp;     // colors by height
uniform vec4 ramp_range;    // lowest height, 1 / range, 1 where contours are drawn, 1 where the ground has a grain
uniform vec4 bathymetry[9]; // height, rgb
uniform vec4 undergrowth, shallow, open_water;
uniform vec4 cover;         // tree line, snow line, true rise over drawn (0: no cover), 1 where the north is shady
uniform float curved_rise;  // drawn rise per meter of elevation; 0 where the ground between posts is straight
uniform vec3 cover_more;    // moisture, cell of the ground in meters, 1 where it has forms too small for that
uniform vec4 cover_colors[7]; // rgb of luminance 1, factor on the tint's luminance: woods, meadow, scree, rock, snow, crops, soil
uniform vec4 contour;       // rgb, strength
uniform vec4 contour_lit;   // rgb of lines toward the light, 1 where lines are illuminated
uniform vec3 contour_turn;  // their width along the light and across it, how fast they turn
uniform vec4 contour_shape; // interval, width, every how many is heavy, z factor
uniform vec4 imagery;       // corner, 1 / size
uniform vec4 imagery_size;  // texel, 1 where there is one, 1 where it is shaded
uniform sampler2D imagery_texture;
uniform float shade_gain, shade_detail, sky_most;
uniform vec3 sides[4];
uniform vec4 side_shares;
out vec4 shown;

struct Reading { float height; vec2 gradient; };

Reading height_on(vec2 place, int level) {
  ivec2 size = textureSize(heights, level);
  vec2 at = clamp(place * vec2(size) - 0.5, vec2(0.0), vec2(size - 1));
  ivec2 first = min(ivec2(at), max(size - 2, ivec2(0)));
  ivec2 next = min(first + 1, size - 1);
  vec2 part = at - vec2(first);
  float sw = texelFetch(heights, first, level).r;
  float se = texelFetch(heights, ivec2(next.x, first.y), level).r;
  float nw = texelFetch(heights, ivec2(first.x, next.y), level).r;
  float ne = texelFetch(heights, next, level).r;
  vec2 rise = vec2(mix(se - sw, ne - nw, part.y), mix(nw - sw, ne - se, part.x));
  return Reading(mix(mix(sw, se, part.x), mix(nw, ne, part.x), part.y), rise * grid.zw * vec2(size) / grid_size.xy);
}

// The slopes of the ground that is curved between posts, as GroundMap::with_halved_cells has them; its bilinear gradient is that
// of the sides of the cell between opposite ones.
vec2 curved_slopes(vec2 place, vec2 gradient) {
  vec2 size = vec2(textureSize(slopes, 0));
  vec2 at = clamp(place * size - 0.5, vec2(0.0), size - 1.0);
  vec2 first = min(floor(at), max(size - 2.0, vec2(0.0)));
  vec2 part = at - first;
  vec2 low = (first + 0.5) / size;
  vec2 high = (first + 1.5) / size;
  vec2 from = vec2(textureLod(slopes, vec2(low.x, place.y), 0.0).x, textureLod(slopes, vec2(place.x, low.y), 0.0).y);
  vec2 to = vec2(textureLod(slopes, vec2(high.x, place.y), 0.0).x, textureLod(slopes, vec2(place.x, high.y), 0.0).y);
  vec2 rest = 1.0 - part;
  return from * rest * (1.0 - 3.0 * part) + to * part * (3.0 * part - 2.0) + 6.0 * part * rest * gradient * curved_rise;
}

vec3 water_at(float height) {
  int above = 1;
  while (above < 8 && bathymetry[above].x <= height) above += 1;
  vec4 low = bathymetry[above - 1];
  vec4 high = bathymetry[above];
  return mix(low.yzw, high.yzw, clamp((height - low.x) / (high.x - low.x), 0.0, 1.0));
}

struct Noise { float uneven; float patches; float fine; vec2 form; float ridge; vec2 at; float longest_m; };

vec2 noise_values(uvec2 at) {
  uint bits = at.x * 2376512323u + at.y * 3625334849u;
  bits = (bits ^ (bits >> 15)) * 739982445u;
  bits = (bits ^ (bits >> 12)) * 695872825u;
  bits ^= bits >> 15;
  return vec2(uvec2(bits & 65535u, bits >> 16)) / 32768.0 - 1.0;
}

${AREA_SHADER}
vec2 gully_wave(float turns) {
  float past = turns - floor(turns + 0.5);
  float part = 2.0 * abs(past);
  float rise = 24.0 * part * (1.0 - part);
  return vec2(1.0 - 2.0 * part * part * (3.0 - 2.0 * part), past < 0.0 ? rise : -rise);
}

Noise cover_noise(vec2 at, float mean_pixel_m, float longest_m, vec2 ground_rise) {
  float ground_steep = length(ground_rise);
  float gullies = NOISE_MOST_GULLIES * smoothstep(NOISE_GULLY_RISE.x, NOISE_GULLY_RISE.y, ground_steep);
  Noise sum = Noise(0.0, 0.0, 0.0, vec2(0.0), 0.0, at, longest_m);
  float wave_m = NOISE_FIRST_M;
  float faint = 1.0;
  vec2 turn = vec2(1.0, 0.0);
  vec2 wider = vec2(0.0);
  float widest = NOISE_FORM_CELLS * cover_more.y;
  for (float octave = 0.0; octave < NOISE_OCTAVES; octave += 1.0) {
    float shown = clamp(2.0 * wave_m / (NOISE_WAVE_PX * mean_pixel_m) - 1.0, 0.0, 1.0);
    if (shown > 0.0) {
      vec2 place = vec2(turn.x * at.x - turn.y * at.y, turn.y * at.x + turn.x * at.y) / wave_m + NOISE_BENT * wider;
      vec2 cell = floor(place);
      vec2 part = place - cell;
      vec2 smoothed = part * part * (3.0 - 2.0 * part);
      vec2 steep = 6.0 * part * (1.0 - part);
      uvec2 corner = uvec2(ivec2(cell));
      vec2 sw = noise_values(corner);
      vec2 se = noise_values(corner + uvec2(1u, 0u));
      vec2 nw = noise_values(corner + uvec2(0u, 1u));
      vec2 ne = noise_values(corner + uvec2(1u, 1u));
      vec2 south = mix(sw, se, smoothed.x);
      vec2 north = mix(nw, ne, smoothed.x);
      vec2 value = mix(south, north, smoothed.y);
      vec2 rise = vec2(mix(se.x - sw.x, ne.x - nw.x, smoothed.y), north.x - south.x) * steep;
      wider = value;
      float share = NOISE_SHARE * shown;
      if (octave >= NOISE_FIRST_FINE) faint *= NOISE_FAINTER;
      sum.uneven += share * faint * value.x;
      if (octave < NOISE_FIRST_FINE) sum.patches += share * value.y; else sum.fine += share * value.y;
      float within = clamp((widest - wave_m) / (0.75 * widest), 0.0, 1.0);
      vec2 branched = ground_rise + NOISE_BRANCHED * ground_steep * sum.form;
      vec2 contour = vec2(-branched.y, branched.x) / max(length(branched), 1e-6);
      vec2 level = vec2(turn.x * contour.x - turn.y * contour.y, turn.y * contour.x + turn.x * contour.y);
      float along = NOISE_GULLIES * dot(part, level);
      vec2 waves_sw = gully_wave(along + 0.5 * (sw.x + 1.0));
      vec2 waves_se = gully_wave(along - NOISE_GULLIES * level.x + 0.5 * (se.x + 1.0));
      vec2 waves_nw = gully_wave(along - NOISE_GULLIES * level.y + 0.5 * (nw.x + 1.0));
      vec2 waves_ne = gully_wave(along - NOISE_GULLIES * (level.x + level.y) + 0.5 * (ne.x + 1.0));
      vec2 waves_south = mix(waves_sw, waves_se, smoothed.x);
      vec2 waves_north = mix(waves_nw, waves_ne, smoothed.x);
      vec2 waves = mix(waves_south, waves_north, smoothed.y);
      vec2 blend = vec2(mix(waves_se.x - waves_sw.x, waves_ne.x - waves_nw.x, smoothed.y), waves_north.x - waves_south.x);
      vec2 gully_rise = NOISE_GULLY_HEIGHT * (blend * steep + NOISE_GULLIES * waves.y * level);
      float ridged = mix(value.x, NOISE_GULLY_HEIGHT * waves.x, gullies);
      vec2 ridged_rise = mix(rise, gully_rise, gullies);
      float away = sqrt(ridged * ridged + NOISE_CREST * NOISE_CREST);
      float crest = -ridged / away;
      vec2 back = vec2(
        turn.x * ridged_rise.x + turn.y * ridged_rise.y,
        turn.x * ridged_rise.y - turn.y * ridged_rise.x
      );
      sum.form += back * (share * faint * within * crest);
      sum.ridge += share * faint * within * 2.0 * (NOISE_MEAN_AWAY - away);
    }
    wave_m *= NOISE_FINER;
    turn = vec2(NOISE_TURN.x * turn.x - NOISE_TURN.y * turn.y, NOISE_TURN.y * turn.x + NOISE_TURN.x * turn.y);
  }
  return sum;
}

vec3 covered_by(vec3 color, vec3 tint, float own, vec4 cover, float hue, float share) {
  return mix(color, mix(tint, cover.rgb * own, hue) * cover.w, COVER_MOST * share);
}

float strata_wave(float height, float change, float uneven, float wave_m) {
  float shown = clamp(2.0 * wave_m / (GRAIN_WAVE_PX * max(change, 1e-6)) - 1.0, 0.0, 1.0);
  return shown * noise(vec2(height / wave_m + 2.0 * uneven, 0.5));
}

float field_tone(vec2 at, float pixel_m) {
  float shown = area_shown(FIELD_M.x, pixel_m);
  if (shown <= 0.0) return 0.0;
  AreaParcel parcel = area_parcel(at, FIELD_M.x);
  vec2 place = area_turned(at, normalize(parcel.own + vec2(1e-3, 0.0)));
  float whole = noise_values(parcel.cell + uint(AREA_SALTS.y)).x;
  float inside = clamp(parcel.inside_m / pixel_m + 0.5, 0.0, 1.0);
  return shown * inside * (AREA_PARCEL_TONE * whole + area_strip(place, FIELD_M.y, 0.0, pixel_m, parcel.cell).x);
}

vec3 with_cover(vec3 tint, float height_m, float change, vec2 slope, float sky_share, Noise here) {
  slope *= cover.z;
  float shade = clamp(-slope.y * cover.w, -1.0, 1.0);
  float height = height_m + COVER_UNEVEN_M * here.uneven + COVER_ASPECT_M * shade;
  float rise = length(slope) + COVER_UNEVEN_RISE * here.uneven;
  float hollow = clamp(1.0 - sky_share, 0.0, 1.0);
  float moist = cover_more.x + dot(COVER_MOISTER, vec4(height_m, shade, hollow, here.uneven));
  float above_trees = smoothstep(cover.x - COVER_MEADOW_M.x, cover.x, height);
  float below_snow = 1.0 - smoothstep(cover.y - COVER_MEADOW_M.y, cover.y, height);
  float green = smoothstep(COVER_WOODS_MOISTURE.x, COVER_WOODS_MOISTURE.y, moist);
  float copses = smoothstep(COVER_COPSES.x, COVER_COPSES.y, here.patches + here.fine);
  float sloping = smoothstep(COVER_WOODS_RISE.x, COVER_WOODS_RISE.y, rise);
  float wild = smoothstep(COVER_WILD.x * cover.x, COVER_WILD.y * cover.x, height);
  float woods = (1.0 - above_trees) * green * mix(copses, 1.0, max(sloping, COVER_WILD_WOODS * wild));
  float fields = COVER_FIELD_MEADOW * green * (1.0 - wild) * clamp(0.5 + here.patches, 0.0, 1.0);
  float meadow = mix(fields, below_snow, above_trees);
  float bare = mix(COVER_DRY_RISE, 1.0, smoothstep(0.0, COVER_WOODS_MOISTURE.y, moist));
  float scree = max(above_trees, 1.0 - green) * smoothstep(COVER_SCREE_RISE.x * bare, COVER_SCREE_RISE.y * bare, rise);
  float rock = smoothstep(COVER_ROCK_RISE.x * bare, COVER_ROCK_RISE.y * bare, rise);
  float snow = smoothstep(cover.y - COVER_MEADOW_M.z, cover.y + COVER_MEADOW_M.z, height) * (1.0 - rock);
  float own = dot(tint, vec3(0.2126, 0.7152, 0.0722));
  float wet = smoothstep(COVER_HUE_MOISTURE.x, COVER_HUE_MOISTURE.y, cover_more.x);
  float climb = smoothstep(COVER_HUE_CLIMB.x * cover.x, COVER_HUE_CLIMB.y * cover.x, height) * wet;
  float grown = mix(COVER_HUE.x, COVER_HUE.y, climb);
  vec3 color = covered_by(tint, tint, own, cover_colors[1], mix(COVER_HUE.x, grown, COVER_MEADOW_CLIMB), meadow);
  float farmed = smoothstep(COVER_FARMED_MOISTURE.x, COVER_FARMED_MOISTURE.y, moist)
    * (1.0 - smoothstep(COVER_FARMED_RISE.x, COVER_FARMED_RISE.y, rise)) * (1.0 - wild) * (1.0 - above_trees);
  if (farmed > 0.0) {
    float plot = field_tone(here.at, max(here.longest_m, COVER_LEAST_PIXEL_M));
    float tone = clamp(plot + COVER_FARMED_PATCHES * here.patches, -1.0, 1.0);
    vec4 other = tone < 0.0 ? cover_colors[1] : cover_colors[6];
    color = covered_by(color, tint, own, mix(cover_colors[5], other, abs(tone)), COVER_HUE.x, farmed);
  }
  color = covered_by(color, tint, own, cover_colors[0], grown, woods);
  color = covered_by(color, tint, own, cover_colors[2], COVER_HUE.x, scree);
  color = covered_by(color, tint, own, cover_colors[3], COVER_HUE.x, rock);
  color = covered_by(color, cover_colors[4].rgb * own, own, cover_colors[4], COVER_HUE.x, snow);
  float open = max(1.0 - snow, 0.0);
  float wooded = woods * (1.0 - rock) * open;
  float strata = strata_wave(height_m, change, here.uneven, COVER_STRATA_M.x)
    + strata_wave(height_m, change, here.uneven, COVER_STRATA_M.y)
    + strata_wave(height_m, change, here.uneven, COVER_STRATA_M.z);
  float layered = max(rock, scree * (1.0 - green)) * open;
  float ridges = COVER_RIDGES * here.ridge * min(length(slope), 1.0) * cover_more.z;
  float bushy = (1.0 - above_trees) * (1.0 - woods) * (1.0 - rock) * (1.0 - farmed) * open;
  float shrubs = bushy * smoothstep(COVER_SHRUBS.x, COVER_SHRUBS.y, here.fine + 0.5 * here.patches);
  color = mix(color, cover_colors[0].rgb * (own * cover_colors[0].w), COVER_SHRUB_SHARE * shrubs);
  float rough = mix(COVER_TUFTS, COVER_CROWNS, wooded);
  float texture_share = (COVER_PATCHES * here.patches + rough * here.fine) * open + ridges;
  return color * max(1.0 + texture_share + COVER_STRATA * layered * strata, 0.3);
}

vec2 small_form(vec4 post, Noise here) {
  float rise = min(length(post.xy), 1.0);
  float dry = max(1.0 - 4.0 * max(post.w, 0.0), 0.0);
  return here.form * ((COVER_FORM_LEVEL / cover.z + COVER_FORM_RISE * rise) * dry * cover_more.z);
}

float contour_fade(float spacing, float per_pixel) {
  return clamp((spacing / per_pixel - 4.0) / 6.0, 0.0, 1.0);
}

float contour_cover(float height, float per_pixel, float width_px) {
  float interval = contour_shape.x;
  if (ramp_range.z < 0.5 || !(per_pixel > interval * 1e-6)) return 0.0;
  float line = round(height / interval);
  float every = contour_shape.z;
  bool heavy = line - every * floor(line / every) < 0.5;
  float minor = contour_fade(interval, per_pixel);
  float width = width_px * (heavy ? 1.0 + minor : 1.0);
  float strength = heavy ? contour_fade(interval * every, per_pixel) : minor;
  return clamp(width * 0.5 + 0.5 - abs(height - line * interval) / per_pixel, 0.0, 1.0) * strength;
}

float soft_brightness(float brightness) {
  const float dark = RELIEF_TOE - RELIEF_DARKEST;
  const float bright = RELIEF_BRIGHTEST - RELIEF_SHOULDER;
  if (brightness < RELIEF_TOE) return RELIEF_DARKEST + dark * dark / (dark + RELIEF_TOE - brightness);
  if (brightness > RELIEF_SHOULDER) return RELIEF_BRIGHTEST - bright * bright / (bright + brightness - RELIEF_SHOULDER);
  return brightness;
}

vec3 relief_lit(vec3 albedo, float height, vec4 post, float sky_share, vec2 place, float received) {
  float z_factor = contour_shape.w;
  vec3 normal = normalize(vec3(-post.xy * z_factor, 1.0));
  vec3 form = normalize(vec3(-textureLod(slopes, place, grid_size.z).xy * z_factor, 1.0));
  float side_light = 0.0;
  for (int index = 0; index < 4; index += 1) side_light += max(dot(normal, sides[index]), 0.0) * side_shares[index];
  float facing = max(dot(normal, to_sun), 0.0);
  float upright = max(to_sun.z, 0.0);
  float shade = dot(RELIEF_SHARES, vec3(facing, side_light, max(dot(form, to_sun), 0.0)));
  float lost = RELIEF_SHARES.x * facing * (1.0 - post.z * received);
  float level = dot(RELIEF_SHARES, vec3(upright, RELIEF_SIDE_RISE, upright));
  float elevation = (height - ramp_range.x) * ramp_range.y;
  float contrast = mix(RELIEF_LOW_CONTRAST, 1.0, clamp(elevation / 0.75, 0.0, 1.0));
  float relief = contrast * (shade - level);
  float shadow = contrast * lost;
  float shade_share = max(1.0 - post.z * received * facing / max(upright, RELIEF_LEAST_SINE), 0.0);
  float detail = shade_detail * shade_share * dot(normal - form, to_sun);
  float detailed = 1.0 + RELIEF_MOST_DETAIL * detail / (RELIEF_MOST_DETAIL + abs(detail));
  float brightness = detailed * soft_brightness(1.0 + (relief < 0.0 ? shade_gain : RELIEF_GAIN) * relief - RELIEF_GAIN * shadow);
  vec3 hue = mix(RELIEF_COOL, RELIEF_WARM, clamp(0.5 + 1.2 * (relief - shadow), 0.0, 1.0)) / mix(RELIEF_COOL, RELIEF_WARM, 0.5);
  vec3 gray = vec3(dot(albedo, vec3(0.2126, 0.7152, 0.0722)));
  vec3 deep = max(albedo + (albedo - gray) * RELIEF_FILL_CHROMA, vec3(0.0));
  vec3 fill = cover.z > 0.0 ? deep * RELIEF_FILL * clamp(1.0 - brightness, 0.0, 1.0) : vec3(0.0);
  float glare = cover.z > 0.0 ? RELIEF_GLARE * max((brightness - 1.0) / (RELIEF_BRIGHTEST - 1.0), 0.0) : 0.0;
  return (mix(albedo, gray * RELIEF_GLARE_COLOR, glare) * hue * brightness + fill) * mix(RELIEF_CLOSED, 1.0, sky_share);
}

void main() {
  vec2 right_m = dFdx(world.xy);
  vec2 down_m = dFdy(world.xy);
  float pixel_m = max(length(right_m), length(down_m));
  vec2 at = (world.xy - grid.xy) * grid.zw;
  vec2 place = (clamp(at, vec2(0.0), grid_size.xy - 1.0) + 0.5) / grid_size.xy;
  float across = length(right_m * grid.zw);
  float down = length(down_m * grid.zw);
  float lod = clamp(log2(max(sqrt(across * down), 1e-6)), 0.0, grid_size.w);
  int level = int(lod);
  Reading reading = height_on(place, level);
  float part = lod - float(level);
  if (part > 0.0) {
    Reading coarse = height_on(place, min(level + 1, int(grid_size.w)));
    reading.height = mix(reading.height, coarse.height, part);
    reading.gradient = mix(reading.gradient, coarse.gradient, part);
  }
  vec4 post = texture(slopes, place);
  float wide = clamp(-log2(max(sqrt(across * down), 1e-6)), 0.0, 1.0);
  if (curved_rise > 0.0 && wide > 0.0) post.xy = mix(post.xy, curved_slopes(place, reading.gradient), wide);
  float sky_share = texture(skies, place).r * sky_most;
  vec2 wet_change = vec2(dFdx(post.w), dFdy(post.w));
  float covered = symbol_cover();
  if (covered <= 0.0) discard;
  vec4 color = surface();
  if (area_share > 0.5) {
    float mean_m = sqrt(length(right_m) * length(down_m));
    color = base_color * tint * area_color(world.xy, mean_m, pixel_m, abs(2.0 * at_texture.x - 1.0));
  }
  float grain = 1.0;
  if ((is_map > 0.5 || is_natural > 0.5) && ramp_range.w > 0.5) {
    float sum = waves(world.xy, pixel_m, GRAIN_WAVES_M, GRAIN_SHARES);
    grain = 1.0 + (GRAIN_LEVEL + (GRAIN_STEEP - GRAIN_LEVEL) * clamp(length(post.xy), 0.0, 1.0)) * sum;
  }
  float water_share = is_water;
  float unlit = 0.0;
  Noise here = Noise(0.0, 0.0, 0.0, vec2(0.0), 0.0, vec2(0.0), 0.0);
  vec4 shaded = post;
  if (cover.z > 0.0) {
    here = cover_noise(world.xy, sqrt(length(right_m) * length(down_m)), pixel_m, post.xy * cover.z);
    shaded.xy += small_form(post, here);
  }
  if (is_map > 0.5) {
    float per_pixel = length(vec2(dot(reading.gradient, right_m), dot(reading.gradient, down_m)));
    vec3 ink = contour.rgb;
    float line_width = contour_shape.y;
    if (contour_lit.w > 0.5) {
      vec2 downhill = -reading.gradient / max(length(reading.gradient), 1e-30);
      float facing = dot(downhill, to_sun.xy / max(length(to_sun.xy), 1e-30));
      line_width *= contour_turn.x + contour_turn.y * abs(facing);
      ink = mix(ink, contour_lit.rgb, clamp(0.5 + facing * contour_turn.z, 0.0, 1.0));
    }
    float lines = contour_cover(reading.height, per_pixel, line_width) * contour.a;
    float away = (post.w - 0.5) / max(length(wet_change), 1e-4);
    float water = clamp(away + 0.5, 0.0, 1.0);
    float shore = 1.0 - WATER_SHORE * clamp(WATER_SHORE_PX - abs(away), 0.0, 1.0);
    float off_shore = clamp((post.w - 0.75) * 4.0, 0.0, 1.0);
    vec3 deep = water_at(reading.height);
    vec3 blue = mix(mix(shallow.rgb, deep, clamp(off_shore / shallow.w, 0.0, 1.0)), min(deep, open_water.rgb),
      clamp((off_shore - shallow.w) / (1.0 - shallow.w), 0.0, 1.0));
    vec3 land = texture(ramp, vec2((reading.height - ramp_range.x) * ramp_range.y, 0.5)).rgb;
    if (cover.z > 0.0) land = with_cover(land, reading.height, per_pixel, post.xy, sky_share, here);
    land = mix(land, undergrowth.rgb, clamp(-post.w, 0.0, 1.0) * undergrowth.w) * grain;
    float wet = clamp(4.0 * post.w - 1.0, 0.0, 1.0);
    vec3 bare = mix(land * (1.0 - WATER_WET * wet * wet), blue, water) * shore;
    vec2 part_of = (world.xy - imagery.xy) * imagery.zw;
    vec4 draped = texture(imagery_texture,
      clamp(vec2(part_of.x, 1.0 - part_of.y), imagery_size.xy * 0.5, 1.0 - imagery_size.xy * 0.5));
    bool within = imagery_size.z > 0.5 && all(greaterThanEqual(part_of, vec2(0.0))) && all(lessThanEqual(part_of, vec2(1.0)));
    float share = within ? draped.a : 0.0;
    color = vec4(mix(mix(bare, draped.rgb, share), ink, lines * (1.0 - water)), 1.0);
    water_share = water * (1.0 - share);
    unlit = imagery_size.w > 0.5 ? share : 0.0;
  } else {
    color.rgb *= is_natural > 0.5 ? grain : 1.0;
    if (alpha_mode == 1 && color.a < cutoff) discard;
  }
  vec3 light = mix(relief_lit(color.rgb, reading.height, shaded, sky_share, place, sun_share(vec3(0.0, 0.0, 1.0))), color.rgb, unlit);
  if (is_hatching > 0.5) light = color.rgb;
  light = mirror_sky(light, water_share, pixel_m);
  shown = seen(light, (alpha_mode == 2 ? color.a : 1.0) * covered);
}`;

const SOLID_SHADER = `${COMMON}
uniform float in_all_light;
out vec4 shown;

void main() {
  vec4 color = surface();
  if (alpha_mode == 1) {
    // Sharpened, so that each of a pixel's samples is either inside or outside.
    color.a = clamp((color.a - cutoff) / max(fwidth(color.a), 1e-3) + 0.5, 0.0, 1.0);
    if (color.a <= 0.0) discard;
  }
  vec3 face = cross(dFdx(world), dFdy(world));
  face *= dot(face, from_eye()) > 0.0 ? -1.0 : 1.0;
  vec3 given = gl_FrontFacing ? side : -side;
  vec3 normal = normalize(dot(given, given) > 0.0 ? given : face);
  vec3 light = color.rgb;
  if (is_hatching < 0.5) {
    float received = in_all_light > 0.5 || dot(normal, to_sun) <= 0.0 ? 1.0 : sun_share(normalize(face));
    vec3 direct = sun * (max(dot(normal, to_sun), 0.0) * received);
    light = color.rgb * (direct + mix(bounce, sky, normal.z * 0.5 + 0.5));
  }
  light = mirror_sky(light, is_water, max(length(dFdx(world.xy)), length(dFdy(world.xy))));
  shown = seen(light, alpha_mode == 0 ? 1.0 : color.a);
}`;

// The feature, and the depth in meters as bits.
const PICK_SHADER = `${COMMON}
out uvec2 shown;

void main() {
  if (symbol_cover() < 0.5 || (alpha_mode != 0 && surface().a < (alpha_mode == 1 ? cutoff : 0.5))) discard;
  shown = uvec2(feature_id, floatBitsToUint(along));
}`;

const SHADOW_SHADER = `${COMMON}
void main() {
  if (alpha_mode == 1 && surface().a < cutoff) discard;
}`;

const BACKDROP_VERTEX = `#version 300 es
out vec2 place;
void main() {
  place = vec2(float((gl_VertexID << 1) & 2), float(gl_VertexID & 2)) * 2.0 - 1.0;
  gl_Position = vec4(place, 0.9999999, 1.0);
}`;

const BACKDROP_SHADER = `#version 300 es
precision highp float;
uniform vec3 forward;
uniform vec4 right, up, haze, zenith;
uniform vec3 studio_top, studio_bottom;
uniform float horizon, studio;
in vec2 place;
out vec4 shown;

vec3 srgb_from_linear(vec3 c) {
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, c * 12.92, lessThanEqual(c, vec3(0.0031308)));
}

void main() {
  vec3 ray = normalize(forward + right.xyz * (place.x / right.w) + up.xyz * (place.y / up.w));
  float rise = max(ray.z, 0.0);
  vec3 sky = mix(haze.rgb, zenith.rgb, rise * (2.0 - rise) * (rise * (1.0 + horizon) / (rise + horizon)));
  shown = vec4(mix(srgb_from_linear(sky), mix(studio_bottom, studio_top, place.y * 0.5 + 0.5), studio), 1.0);
}`;
