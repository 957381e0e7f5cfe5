// Turns the heights of a level that is drawn to the textures that the picture reads.

@group(0) @binding(2) var<storage, read> heights: array<u32>;
// The greatest codes of each page's texels: of solids, of the ground.
@group(0) @binding(3) var<storage, read_write> highest: array<vec2u>;
@group(0) @binding(4) var stored_texels: texture_storage_2d<rg32float, write>;
@group(0) @binding(5) var stored_pages: texture_storage_2d<rgba32uint, write>;

const LANES = 256u;

var<workgroup> highest_solid: atomic<u32>;
var<workgroup> highest_ground: atomic<u32>;

// The heights of a texel, without solids that float.
fn codes_at(texel: u32) -> vec2u {
    let ground = heights[level.pages.w + texel];
    if level.contact.x > 0.0 {
        let underside = heights[2u * level.pages.w + texel];
        if underside != 0u && height_of(~underside) - height_of(ground) > level.contact.y {
            return vec2u(0u, ground);
        }
    }
    return vec2u(heights[texel], ground);
}

// Stores the texels of a page, and finds its highest.
@compute @workgroup_size(256)
fn finish_page(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let own = level.stored.y + group.x;
    let stored = level.stored.x + own;
    let corner = vec2u(stored % PAGE_COLUMNS, stored / PAGE_COLUMNS) * u32(PAGE);
    var greatest = vec2u(0u);
    for (var texel = lane; texel < u32(PAGE * PAGE); texel += LANES) {
        let codes = codes_at(own * u32(PAGE * PAGE) + texel);
        let solid_and_ground = vec4f(height_of(codes.x), height_of(codes.y), 0.0, 0.0);
        textureStore(stored_texels, corner + vec2u(texel % u32(PAGE), texel / u32(PAGE)), solid_and_ground);
        greatest = max(greatest, codes);
    }
    atomicMax(&highest_solid, greatest.x);
    atomicMax(&highest_ground, greatest.y);
    workgroupBarrier();
    if lane == 0u {
        highest[own] = vec2u(atomicLoad(&highest_solid), atomicLoad(&highest_ground));
    }
}

// Stores the entries of the table: the number of each page, and the highest of it and of the pages around it.
@compute @workgroup_size(64)
fn finish_table(@builtin(global_invocation_id) id: vec3u) {
    let size = level.pages.xy;
    if id.x >= size.x * size.y {
        return;
    }
    let number = numbers[level.pages.z + id.x];
    var greatest = vec2u(0u);
    if number > 0u {
        let page = vec2u(id.x % size.x, id.x / size.x);
        let low = max(page, vec2u(1u)) - 1u;
        let high = min(page + 1u, size - 1u);
        for (var y = low.y; y <= high.y; y += 1u) {
            for (var x = low.x; x <= high.x; x += 1u) {
                let near = numbers[level.pages.z + y * size.x + x];
                if near > 0u {
                    greatest = max(greatest, highest[near - 1u]);
                }
            }
        }
    }
    let stored = select(0u, level.stored.x + number, number > 0u);
    let bits = vec2u(bitcast<u32>(height_of(greatest.x)), bitcast<u32>(height_of(greatest.y)));
    let entry = level.pages.z + id.x;
    textureStore(stored_pages, vec2u(entry % TABLE_COLUMNS, entry / TABLE_COLUMNS), vec4u(stored, bits, 0u));
}
