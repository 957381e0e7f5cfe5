// Draws triangles to the stored pages of a level, as the light sees them. There are no colors and no depths: each fragment
// raises the heights of its texel, whose page it looks up.

@group(0) @binding(2) var<storage, read_write> heights: array<atomic<u32>>;

// Whether the ground is drawn, and not solids.
override on_ground: bool = false;
// Whether any of the materials drawn has holes.
override masked: bool = false;

struct Cast {
    @builtin(position) clip: vec4f,
    @location(0) height: f32, // meters from the eye toward the light
    @location(1) uv: vec2f,
    @location(2) alpha: f32,
    @location(3) @interpolate(flat) material: u32,
}

// The picture's merged_vertex, as the light sees it.
@vertex
fn merged_cast(corner: Corner, owner: Owner) -> Cast {
    return cast_of(corner.position, corner, owner);
}

// The picture's placed_vertex, as the light sees it.
@vertex
fn placed_cast(corner: Corner, owner: Owner, place: Place) -> Cast {
    let world_from_mesh = mat4x4f(place.x_axis, place.y_axis, place.z_axis, place.origin);
    return cast_of((world_from_mesh * vec4f(corner.position, 1.0)).xyz, corner, owner);
}

fn cast_of(world: vec3f, corner: Corner, owner: Owner) -> Cast {
    let offset = world - level.eye.xyz;
    let across = vec2f(dot(level.across[0].xyz, offset), dot(level.across[1].xyz, offset));
    let texels = (across - vec2f(level.across[0].w, level.across[1].w)) * level.toward.w - level.tile.xy;
    // Rows of texels run down the target.
    let clip = (texels * level.tile.zw - 1.0) * vec2f(1.0, -1.0);
    let height = dot(level.toward.xyz, offset);
    return Cast(vec4f(clip, 0.5, 1.0), height, corner.uv, corner.color.a, owner.material);
}

// AlphaMask's level of a texture for a texel of the map: that whose texels are nearest in size.
fn mask_level(right: vec2f, down: vec2f) -> f32 {
    let size = vec2f(textureDimensions(base_texture, 0));
    let longer = max(dot(right * size, right * size), dot(down * size, down * size));
    return f32(((bitcast<u32>(max(longer, 1.0) * 2.0) >> 23u) - 127u) / 2u);
}

@fragment
fn cast_shadow(in: Cast, @builtin(front_facing) is_lit: bool) {
    let surface = material_of(in.material);
    if masked {
        let most = f32(textureNumLevels(base_texture) - 1u);
        let mip = min(mask_level(dpdx(in.uv), dpdy(in.uv)), most);
        let texel = textureSampleLevel(base_texture, base_sampler, in.uv, surface.flags.y, mip);
        let shown = select(1.0, texel.a, (surface.flags.x & TEXTURED) != 0u);
        let is_hole = shown * in.alpha * surface.base_color.a < surface.cutoff.x;
        if (surface.flags.x & MASK) != 0u && is_hole {
            return;
        }
    }
    let at = vec2u(in.clip.xy) + vec2u(level.tile.xy);
    let page = at / u32(PAGE);
    if any(page >= level.pages.xy) {
        return;
    }
    let number = numbers[level.pages.z + page.y * level.pages.x + page.x];
    if number == 0u {
        return;
    }
    let within = at % u32(PAGE);
    let texel = ((number - 1u) * u32(PAGE) + within.y) * u32(PAGE) + within.x;
    let code = code_of(in.height);
    if on_ground {
        atomicMax(&heights[level.pages.w + texel], code);
        return;
    }
    atomicMax(&heights[texel], code);
    if level.contact.x > 0.0 && !is_lit && (surface.flags.x & TWO_SIDED) == 0u {
        // The least height has the greatest inverted code.
        atomicMax(&heights[2u * level.pages.w + texel], ~code);
    }
}
