// The ground of a frame with one sample a pixel, shaded once a pixel after its depths are drawn. Where triangles are small,
// drivers that draw with the processor otherwise shade each of their pixels many times over.
//
// What is used here is declared in shader.wgsl, which this file is appended to.

@group(2) @binding(0) var ground_depths: texture_depth_2d;

// The depth of the ground at a pixel; 0 where there is none, and beyond the picture.
fn depth_at(pixel: vec2i) -> f32 {
    let is_beyond = any(pixel < vec2i(0)) || any(pixel >= vec2i(textureDimensions(ground_depths)));
    return select(textureLoad(ground_depths, max(pixel, vec2i(0)), 0), 0.0, is_beyond);
}

// From the eye to what a pixel's center shows at a depth: `projected` undone.
fn offset_at(pixel: vec2i, depth: f32) -> vec3f {
    let part = (vec2f(pixel) + 0.5) / frame.depth.zw * 2.0 - 1.0;
    let across = frame.right.xyz * (part.x / frame.right.w) - frame.up.xyz * (part.y / frame.up.w);
    let parallel = across + frame.forward.xyz * ((frame.depth.x - depth) / frame.depth.y);
    let central = (across + frame.forward.xyz) * (frame.depth.x / (depth + frame.depth.y));
    return select(central, parallel, is_parallel());
}

// What a pixel spans in a direction: up to the neighbor whose depth is nearer to its own, which lies on the same slope.
fn spanned(pixel: vec2i, depth: f32, step: vec2i) -> vec3f {
    let after = depth_at(pixel + step);
    let before = depth_at(pixel - step);
    let here = offset_at(pixel, depth);
    let is_after = after > 0.0 && (before <= 0.0 || abs(after - depth) <= abs(before - depth));
    if is_after {
        return offset_at(pixel + step, after) - here;
    }
    return select(vec3f(0.0), here - offset_at(pixel - step, before), before > 0.0);
}

@fragment
fn ground_pixel(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(position.xy);
    let depth = depth_at(pixel);
    let world = frame.eye.xyz + offset_at(pixel, depth);
    let span = Footprint(spanned(pixel, depth, vec2i(1, 0)), spanned(pixel, depth, vec2i(0, 1)));
    let ground = on_ground(vec4f(1.0), FROM_GROUND_NORMAL | FROM_GROUND_ALBEDO, world, span);
    let light = mirrored(ground.light, ground.water_share, world, span);
    return vec4f(in_haze(light, world), 1.0);
}
