// Copies colors to a texture that does not encode them itself.

@group(0) @binding(0) var colors: texture_2d<f32>;

@fragment
fn encode_color(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let linear = textureLoad(colors, vec2u(pixel.xy), 0).rgb;
    let low = linear * 12.92;
    let high = 1.055 * pow(linear, vec3f(1.0 / 2.4)) - 0.055;
    return vec4f(select(high, low, linear <= vec3f(0.0031308)), 1.0);
}
