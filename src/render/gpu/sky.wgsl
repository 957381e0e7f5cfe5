// The sky behind everything, by Lighting::sky_at: one triangle that covers the picture.
//
// `Frame` is declared in shader.wgsl, which this file is appended to.

@vertex
fn sky_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4f(corner * 2.0 - 1.0, 0.0, 1.0);
}

@fragment
fn sky_color(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let x = (pixel.x / frame.depth.z * 2.0 - 1.0) / frame.right.w;
    let y = (1.0 - pixel.y / frame.depth.w * 2.0) / frame.up.w;
    let ray = normalize(frame.forward.xyz + frame.right.xyz * x + frame.up.xyz * y);
    return vec4f(mix(frame.haze.rgb, frame.zenith.rgb, sqrt(max(ray.z, 0.0))), 1.0);
}
