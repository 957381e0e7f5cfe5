//! Tints of the ground by posts: a value a post as a color of the ground.
//!
//! A tint is a texture with a texel a post (of large ground a texel a square of posts), laid over the ground as one quad that
//! is cut to the displayed triangles like every ribbon. So no renderer knows of it, and its border is as smooth as the
//! texture's filter makes it.

use glam::{DVec2, UVec2, Vec4};

use crate::graphic_lines::LAYER;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawList, FeatureId, MaterialId};
use sandtable_draw::material::{AlphaMode, Material, NormalSource};
use sandtable_draw::pixels::Pixels;
use sandtable_mesh::sink::MeshSink;
use sandtable_ribbon::plan::{PlanMesh, PlanVertex};
use sandtable_scene::seen_ground::PostFrame;
use sandtable_terrain::lattice::Post;

/// Tints lie under lines.
pub(super) const TINT_LAYER: u8 = LAYER - 1;

/// The most texels of a tint along either side: finer than any picture shows at once.
const MOST_TEXELS: u32 = 2048;

/// A tint in plan.
pub(super) struct TintPlan {
    /// Its triangles.
    pub plan: PlanMesh,
    /// Its color, or a factor of its texture's.
    pub color: Srgba,
    /// What it shows where.
    pub texture: Option<Pixels>,
    /// The feature that it belongs to.
    pub feature: FeatureId,
}

/// How a tint of posts is drawn.
pub(super) struct PostTint<'a> {
    /// The posts eastward and northward.
    pub size: UVec2,
    /// Their places.
    pub frame: &'a PostFrame,
    /// The map coordinates of world X and Y 0.
    pub origin: DVec2,
    /// The color of which texels without any hold nothing, so that a border does not blend toward black.
    pub beside: Srgba,
    /// Whose it is.
    pub feature: FeatureId,
}

impl PostTint<'_> {
    /// The tint within the smallest rectangle of the posts that are `within`, each in its `color`, if any; `None` where no
    /// post is.
    pub fn plan(
        &self,
        within: impl Fn(usize) -> bool,
        color: impl Fn(usize) -> Option<Srgba>,
    ) -> Option<TintPlan> {
        let Self { size, frame, origin, beside, feature } = *self;
        let index = |column: u32, row: u32| row as usize * size.x as usize + column as usize;
        let mut corners: Option<[UVec2; 2]> = None;
        for row in 0..size.y {
            let Some(first) = (0..size.x).find(|&column| within(index(column, row))) else { continue };
            let last = (first..size.x).rfind(|&column| within(index(column, row))).unwrap_or(first);
            let (low, high) = (UVec2::new(first, row), UVec2::new(last, row));
            corners = Some(corners.map_or([low, high], |[min, max]| [min.min(low), max.max(high)]));
        }
        let [min, max] = corners?;
        let posts = max - min + 1;
        let stride = posts.max_element().div_ceil(MOST_TEXELS).max(1);
        let texels = posts.map(|side| side.div_ceil(stride));
        let pixels = Pixels::from_fn(texels.x, texels.y, |x, y| {
            // V runs downward, rows upward.
            let from = min + UVec2::new(x, texels.y - 1 - y) * stride;
            let to = (from + stride - 1).min(max);
            let (mut sum, mut count) = (Vec4::ZERO, 0.0f32);
            for row in from.y..=to.y {
                for column in from.x..=to.x {
                    count += 1.0;
                    if let Some(Srgba([red, green, blue, alpha])) = color(index(column, row)) {
                        let share = f32::from(alpha);
                        sum += Vec4::new(
                            f32::from(red) * share,
                            f32::from(green) * share,
                            f32::from(blue) * share,
                            share,
                        );
                    }
                }
            }
            blended(sum, count, beside)
        });
        let first = frame.map_position(Post { column: min.x, row: min.y }) - origin;
        let texel_m = frame.cell * f64::from(stride);
        // A post is in the middle of its texel; the tint ends half a texel from the border, where the texture would repeat.
        let posts_m = frame.cell * (posts - 1).as_dvec2();
        let offset = frame.cell * f64::from(stride - 1) / 2.0;
        let corner = |share: DVec2| {
            let at = first + posts_m * share;
            let texel = (at - first - offset) / texel_m + 0.5;
            let uv = DVec2::new(texel.x, f64::from(texels.y) - texel.y) / texels.as_dvec2();
            PlanVertex { at, uv: uv.as_vec2() }
        };
        let mut plan = PlanMesh::default();
        let ids = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y].map(|share| plan.vertex(corner(share)));
        plan.triangle([ids[0], ids[1], ids[2]]);
        plan.triangle([ids[0], ids[2], ids[3]]);
        Some(TintPlan { plan, color: Srgba::WHITE, texture: Some(pixels), feature })
    }
}

/// The mean of colors weighted by their alpha; where there is none, `beside` that nothing shows of.
fn blended(sum: Vec4, count: f32, beside: Srgba) -> Srgba {
    let byte = |value: f32| (value + 0.5).clamp(0.0, 255.0) as u8;
    if sum.w > 0.0 {
        let color = sum / sum.w;
        return Srgba([byte(color.x), byte(color.y), byte(color.z), byte(sum.w / count)]);
    }
    let Srgba([red, green, blue, _]) = beside;
    Srgba([red, green, blue, 0])
}

/// Adds the material of a tint.
pub(super) fn add_material(list: &mut DrawList, color: Srgba, texture: Option<Pixels>) -> MaterialId {
    let texture = texture.map(|pixels| list.add_texture(pixels));
    list.add_material(Material {
        name: "tint".into(),
        base_color: color,
        texture,
        alpha: AlphaMode::Blend,
        normals: NormalSource::Ground,
        ..Material::default()
    })
}
