// Copies colors to a texture that does not encode them itself: one triangle that covers the picture.

@group(0) @binding(0) var colors: texture_2d<f32>;

@vertex
fn encode_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4f(corner * 2.0 - 1.0, 0.0, 1.0);
}

@fragment
fn encode_color(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let linear = textureLoad(colors, vec2u(pixel.xy), 0).rgb;
    let low = linear * 12.92;
    let high = 1.055 * pow(linear, vec3f(1.0 / 2.4)) - 0.055;
    return vec4f(select(high, low, linear <= vec3f(0.0031308)), 1.0);
}
