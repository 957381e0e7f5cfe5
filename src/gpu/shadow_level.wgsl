// What the drawing of a shadow map's level reads and writes. Texels of a map lie page by page in one buffer: heights of
// solids, then of the ground, then of the undersides of solids, as codes.

// LevelConstants.
struct Level {
    eye: vec4f,              // xyz
    across: array<vec4f, 2>, // xyz of the axes across the light; corner of the first texel, meters from the eye
    toward: vec4f,           // xyz toward the light; texels per meter
    tile: vec4f,             // first texel that is drawn; 2 / the sides of what is drawn, in texels
    pages: vec4u,            // columns and rows of pages; first entry in `numbers`, which is that in the table; texels of the map
    stored: vec4u,           // pages of the maps before; pages of the levels before
    contact: vec4f,          // 1 where undersides count; how far above the ground they lie that do not touch it, meters
}

@group(0) @binding(0) var<uniform> level: Level;
// The number of each page from 1, 0 where none is stored.
@group(0) @binding(1) var<storage, read> numbers: array<u32>;

// A code that rises with a height; 0 is below all of them.
fn code_of(height: f32) -> u32 {
    let bits = bitcast<u32>(height);
    return select(bits | 0x80000000u, ~bits, bits >= 0x80000000u);
}

fn height_of(code: u32) -> f32 {
    let height = bitcast<f32>(select(~code, code & 0x7fffffffu, code >= 0x80000000u));
    return select(height, f32(NOTHING), code == 0u);
}
