// What shows where nothing is drawn, by src/draw/backdrop.rs.
//
// `Frame` is declared in shader.wgsl, which this file is appended to.

@fragment
fn sky_color(@builtin(position) in_tile: vec4f) -> @location(0) vec4f {
    let pixel = in_tile.xy + frame.tile_first.xy;
    let down = pixel.y / frame.depth.w;
    let studio = mix(frame.studio_top.rgb, frame.studio_bottom.rgb, down);
    let x = (pixel.x / frame.depth.z * 2.0 - 1.0) / frame.right.w;
    let y = (1.0 - down * 2.0) / frame.up.w;
    let ray = normalize(frame.forward.xyz + frame.right.xyz * x + frame.up.xyz * y);
    return vec4f(select(sky_at(ray), studio, frame.studio_top.w > 0.5), 1.0);
}
