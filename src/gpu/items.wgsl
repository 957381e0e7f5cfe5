// What shaders read of items: corners, where they are placed, and materials.

struct Corner {
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) color: vec4f,
}

// Whose a corner is.
struct Owner {
    @location(4) feature: u32,
    @location(5) material: u32,
}

// The place of an item.
struct Place {
    @location(6) x_axis: vec4f,
    @location(7) y_axis: vec4f,
    @location(8) z_axis: vec4f,
    @location(9) origin: vec4f,
}

struct Surface {
    base_color: vec4f, // linear rgb, straight alpha
    flags: vec4u,      // x: bits of the constants below; y: layer of its texture
    cutoff: vec4f,     // x: alpha below it is a hole, for the color where MASK is set, for the feature too where BLEND is
}

const FROM_GROUND_NORMAL = 1u;
const FROM_GROUND_ALBEDO = 2u;
const MASK = 4u;
const BLEND = 8u;
const WATER = 16u;
const IN_ALL_LIGHT = 32u;
const HATCHING = 64u;
const NATURAL = 128u;
const TEXTURED = 256u;
const EDGES = 512u;
const AREA = 1024u;
const TWO_SIDED = 2048u;

// Materials in a row of their table, and texels of each.
const TABLE_MATERIALS = 64u;
const MATERIAL_TEXELS = 12u;

// The bits of every material's `Surface`; the first is the bare ground's.
@group(1) @binding(0) var material_table: texture_2d<u32>;
// Colors multiplied by alpha where the item is not opaque, so that unseen colors count for nothing.
@group(1) @binding(1) var base_texture: texture_2d_array<f32>;
@group(1) @binding(2) var base_sampler: sampler;

fn material_bits(index: u32, texel: u32) -> vec4u {
    let column = index % TABLE_MATERIALS * MATERIAL_TEXELS + texel;
    return textureLoad(material_table, vec2u(column, index / TABLE_MATERIALS), 0);
}

fn material_of(index: u32) -> Surface {
    let color = bitcast<vec4f>(material_bits(index, 0u));
    return Surface(color, material_bits(index, 1u), bitcast<vec4f>(material_bits(index, 2u)));
}
