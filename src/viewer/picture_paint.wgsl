// Shows the scene's picture in its place among the panels, stretched where it has fewer pixels.

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var picture_sampler: sampler;

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec4f,
}

@vertex
fn whole_view(@builtin(vertex_index) index: u32) -> Corner {
    let corner = vec2f(f32((50u >> index) & 1u), f32((44u >> index) & 1u));
    return Corner(vec4f(corner * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0), 0.0, 1.0), vec4f(corner, 0.0, 1.0));
}

// On a texture that takes colors as they are shown.
@fragment
fn encoded_color(corner: Corner) -> @location(0) vec4f {
    return textureSample(picture, picture_sampler, corner.uv.xy);
}

// On a texture that encodes colors itself.
@fragment
fn linear_color(corner: Corner) -> @location(0) vec4f {
    let color = textureSampleLevel(picture, picture_sampler, corner.uv.xy, 0.0).rgb;
    let high = pow((color + 0.055) / 1.055, vec3f(2.4));
    return vec4f(select(high, color / 12.92, color <= vec3f(0.04045)), 1.0);
}
