// The covers of areas, by the formulas of src/draw/area_texture.rs.
//
// What is used here is declared in shader.wgsl, which this file is appended to.

// The numbers of a material's AreaTexture, behind its `Surface`.
fn area_numbers(index: u32, number: u32) -> vec4f {
    return bitcast<vec4f>(material_bits(index, 3u + number));
}

fn area_shown(wide_m: f32, pixel_m: f32) -> f32 {
    return clamp(2.0 * wide_m / (AREA_PART_PX * pixel_m) - 1.0, 0.0, 1.0);
}

// A place by axes of which the first runs along `axis`.
fn area_turned(at: vec2f, axis: vec2f) -> vec2f {
    return vec2f(axis.x * at.x + axis.y * at.y, axis.x * at.y - axis.y * at.x);
}

// The share of a pixel that a line covers whose middle is so far away.
fn area_line(wide_m: f32, away_m: f32, pixel_m: f32) -> f32 {
    let sides = clamp((vec2f(0.5, -0.5) * wide_m - away_m) / pixel_m + 0.5, vec2f(0.0), vec2f(1.0));
    return sides.x - sides.y;
}

fn two_noises(at: vec2f) -> vec2f {
    let cell = floor(at);
    let part = at - cell;
    let smoothed = part * part * (3.0 - 2.0 * part);
    let corner = vec2u(vec2i(cell));
    let south = mix(noise_values(corner), noise_values(corner + vec2u(1u, 0u)), smoothed.x);
    let north = mix(noise_values(corner + vec2u(0u, 1u)), noise_values(corner + vec2u(1u, 1u)), smoothed.x);
    return mix(south, north, smoothed.y);
}

// A wave of the noise that moves the strip in which an area fades.
fn area_wave(at: vec2f, wave_m: f32, pixel_m: f32) -> f32 {
    return clamp(2.0 * wave_m / (NOISE_WAVE_PX * pixel_m) - 1.0, 0.0, 1.0) * two_noises(at / wave_m).x;
}

// The sums of the noise, and those that bend.
fn area_noise(at: vec2f, first_m: f32, pixel_m: f32) -> vec4f {
    var sum = vec4f(0.0);
    var height = 1.0;
    var wave_m = first_m;
    var turn = vec2f(1.0, 0.0);
    for (var octave = 0.0; octave < AREA_OCTAVES; octave += 1.0) {
        let shown = clamp(2.0 * wave_m / (NOISE_WAVE_PX * pixel_m) - 1.0, 0.0, 1.0);
        if shown > 0.0 {
            let place = vec2f(turn.x * at.x - turn.y * at.y, turn.y * at.x + turn.x * at.y) / wave_m;
            let value = two_noises(place) * (NOISE_SHARE * shown);
            sum += vec4f(value, value * height);
        }
        height *= NOISE_FINER;
        wave_m *= NOISE_FINER;
        turn = vec2f(NOISE_TURN.x * turn.x - NOISE_TURN.y * turn.y, NOISE_TURN.y * turn.x + NOISE_TURN.x * turn.y);
    }
    return sum;
}

// Parcel.
struct AreaParcel {
    cell: vec2u,
    own: vec2f,
    inside_m: f32,
}

fn area_parcel(at: vec2f, parcel_m: f32) -> AreaParcel {
    let grid = at / parcel_m;
    let corner = floor(grid);
    var first = vec3f(1e9, 0.0, 0.0);
    var second = vec3f(1e9, 0.0, 0.0);
    var found = AreaParcel(vec2u(0u), vec2f(0.0), 0.0);
    for (var index = 0; index < 9; index += 1) {
        let cell = corner + vec2f(f32(index % 3) - 1.0, f32(index / 3) - 1.0);
        let salted = vec2u(vec2i(cell)) + u32(AREA_SALTS.x);
        let hash = noise_values(salted);
        let away = cell + 0.5 + AREA_PARCEL_JITTER * hash - grid;
        let here = vec3f(dot(away, away), away);
        if here.x < first.x {
            second = first;
            first = here;
            found.cell = salted;
            found.own = hash;
        } else if here.x < second.x {
            second = here;
        }
    }
    let apart = max(length(second.yz - first.yz), 1e-3);
    found.inside_m = (second.x - first.x) / (2.0 * apart) * parcel_m;
    return found;
}

fn area_strip_number(row: f32, column: f32, own: vec2u) -> vec2f {
    return noise_values(vec2u(vec2i(vec2f(row, column))) + own);
}

fn area_strip_tone(row: f32, x: f32, piece_m: f32, pixel_m: f32, own: vec2u) -> f32 {
    let along = x / piece_m + area_strip_number(row, 0.0, own).x - 0.5;
    let before = floor(along);
    let part = clamp((along - before - 0.5) * piece_m / pixel_m + 0.5, 0.0, 1.0);
    return mix(area_strip_number(row, before, own).y, area_strip_number(row, before + 1.0, own).y, part);
}

// The tone of the piece of a strip, and the share of a border between strips.
fn area_strip(place: vec2f, strip_m: f32, border_m: f32, pixel_m: f32, own: vec2u) -> vec2f {
    let along = place.y / strip_m - 0.5;
    let below = floor(along);
    let piece_m = AREA_STRIP_LENGTH * strip_m;
    let shown = area_shown(strip_m, pixel_m);
    let wide_m = AREA_STRIP_BORDER.y * border_m;
    let mean_line = 0.5 * (1.0 - AREA_STRIP_BORDER.x) * wide_m / strip_m;
    if shown <= 0.0 {
        return vec2f(0.0, mean_line);
    }
    let across_m = (along - below - 0.5) * strip_m;
    let first = area_strip_tone(below, place.x, piece_m, pixel_m, own);
    let second = area_strip_tone(below + 1.0, place.x, piece_m, pixel_m, own);
    let line = area_line(wide_m, abs(across_m), pixel_m);
    let lined = step(AREA_STRIP_BORDER.x, area_strip_number(below, 0.0, own).x);
    let tone = mix(first, second, clamp(across_m / pixel_m + 0.5, 0.0, 1.0));
    return vec2f(shown * tone, mix(mean_line, lined * line, shown));
}

// The share of the nearest figure and how far it turns to the north-west. `figures` and `radii` are those of AreaTexture.
fn area_figure(place: vec2f, noise: f32, pixel_m: f32, own: vec2u, figures: vec4f, radii: vec4f) -> vec2f {
    let lattice = place / figures.xy;
    let corner = floor(lattice - 0.5);
    var nearest = 1e9;
    var facing = 0.0;
    var radius = 1.0;
    for (var index = 0; index < 4; index += 1) {
        let cell = corner + vec2f(f32(index % 2), f32(index / 2));
        let hash = noise_values(vec2u(vec2i(cell)) + own + u32(AREA_SALTS.y));
        let away = lattice - cell - 0.5 - figures.z * hash;
        let sides = radii.x + fract(hash * 61.0) * (radii.y - radii.x);
        let rectangle = max(abs(away.x / sides.x), abs(away.y / sides.y));
        let ratio = mix(length(away) / sides.x, rectangle, figures.w) + radii.w * noise;
        if ratio < nearest {
            nearest = ratio;
            facing = mix((away.y - away.x) * 0.70710678 / sides.x, select(-1.0, 1.0, away.y > 0.0), figures.w);
            radius = min(sides.x, sides.y) * min(figures.x, figures.y);
        }
    }
    return vec2f(clamp((1.0 - nearest) * radius / pixel_m + 0.5, 0.0, 1.0), clamp(facing, -1.0, 1.0));
}

fn area_color(index: u32, at: vec2f, mean_m: f32, longest_m: f32, inward: f32) -> vec4f {
    let ground = area_numbers(index, 0u);
    let tones = area_numbers(index, 3u);
    let sizes = area_numbers(index, 4u);
    let rows = area_numbers(index, 5u);
    let figures = area_numbers(index, 6u);
    let radii = area_numbers(index, 7u);
    var shares = area_numbers(index, 8u).xy;
    let noise = area_noise(at, sizes.x, mean_m);
    let bent = at + noise.zw * rows.z;
    var light = 1.0 + tones.w * noise.x;
    var tone = noise.y;
    var place = area_turned(bent, NOISE_TURN);
    var inside_m = AREA_ALONE_M;
    var own = vec2u(0u);
    if sizes.y > 0.0 {
        let shown = area_shown(sizes.y, longest_m);
        tone = 0.0;
        if shown > 0.0 {
            let parcel = area_parcel(bent, sizes.y);
            let axis = normalize(parcel.own + vec2f(1e-3, 0.0));
            place = area_turned(bent, axis);
            inside_m = parcel.inside_m;
            own = parcel.cell;
            shares.y = mix(shares.y, area_line(sizes.z, inside_m, longest_m), shown);
            tone = shown * noise_values(own + u32(AREA_SALTS.y)).x;
            if sizes.w > 0.0 {
                let strip = area_strip(place, sizes.w, sizes.z, longest_m, own);
                tone = mix(tone, AREA_PARCEL_TONE * tone + strip.x, shown);
                shares.y = mix(shares.y, max(shares.y, strip.y), shown);
            }
        }
    }
    if rows.x > 0.0 {
        let across = place.y / rows.x;
        light += rows.y * area_shown(rows.x, longest_m) * (1.0 - 4.0 * abs(across - floor(across) - 0.5));
    }
    if figures.y > 0.0 {
        let shown = area_shown(min(figures.x, figures.y), longest_m);
        if shown > 0.0 {
            let figure = area_figure(place, noise.x, longest_m, own, figures, radii);
            let margin = inside_m - 0.5 * sizes.z - AREA_FIGURE_MARGIN * figures.y;
            let kept = figure.x * clamp(margin / longest_m + 0.5, 0.0, 1.0);
            shares.x = mix(shares.x, kept, shown);
            light += rows.w * figure.y * kept * shown;
        }
    }
    var color = mix(vec4f(ground.rgb + tones.rgb * tone, ground.a), area_numbers(index, 1u), shares.x);
    color = mix(color, area_numbers(index, 2u), shares.y);
    if radii.z > 0.0 {
        let moved = AREA_FADE_MOVED
            * (area_wave(at, AREA_FADE_M, mean_m) + 0.5 * area_wave(at, AREA_FADE_M * NOISE_FINER, mean_m));
        let within = inward * (1.0 - inward) * 4.0;
        let fade = smoothstep(0.0, 1.0, inward + moved * within);
        color.a *= mix(0.5, fade, area_shown(AREA_FADE_WIDE_M, longest_m));
    }
    return vec4f(max(color.rgb * max(light, 0.2), vec3f(0.0)), color.a);
}
