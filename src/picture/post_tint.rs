//! Tints of the ground by posts: a value a post as a color of the ground.
//!
//! A tint is a texture with a texel a post (of large ground a texel a square of posts), laid over the ground as one quad that
//! is cut to the displayed triangles like every ribbon. So no renderer knows of it, and its border is as smooth as the
//! texture's filter makes it.

use glam::{DVec2, UVec2, Vec3, Vec4};
use rayon::prelude::*;

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
        within: impl Fn(usize) -> bool + Sync,
        color: impl Fn(usize) -> Option<Srgba> + Sync,
    ) -> Option<TintPlan> {
        let Self { size, frame, origin, beside, feature } = *self;
        let index = |column: u32, row: u32| row as usize * size.x as usize + column as usize;
        let of_row = |row: u32| {
            let first = (0..size.x).find(|&column| within(index(column, row)))?;
            let last = (first..size.x).rfind(|&column| within(index(column, row))).unwrap_or(first);
            Some([UVec2::new(first, row), UVec2::new(last, row)])
        };
        let [min, max] = (0..size.y)
            .into_par_iter()
            .filter_map(of_row)
            .reduce_with(|[min, max], [low, high]| [min.min(low), max.max(high)])?;
        let posts = max - min + 1;
        let stride = posts.max_element().div_ceil(MOST_TEXELS).max(1);
        let texels = posts.map(|side| side.div_ceil(stride));
        let texel = |x: u32, y: u32| {
            // V runs downward, rows upward.
            let from = min + UVec2::new(x, texels.y - 1 - y) * stride;
            let to = (from + stride - 1).min(max);
            let of_posts =
                || (from.y..=to.y).flat_map(|row| (from.x..=to.x).map(move |column| (column, row)));
            let first = color(index(from.x, from.y));
            if of_posts().all(|(column, row)| color(index(column, row)) == first) {
                return seen(first, beside);
            }
            mean(of_posts().map(|(column, row)| color(index(column, row))), beside)
        };
        let rows = (0..texels.y).into_par_iter().flat_map_iter(|y| (0..texels.x).map(move |x| (x, y)));
        let pixels = Pixels::from_data(texels.x, texels.y, rows.map(|(x, y)| texel(x, y)).collect())?;
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

/// A color; where nothing shows of it, `beside`.
fn seen(color: Option<Srgba>, Srgba([red, green, blue, _]): Srgba) -> Srgba {
    color.filter(|Srgba([.., alpha])| *alpha > 0).unwrap_or(Srgba([red, green, blue, 0]))
}

/// The mean of colors weighted by their alpha; where there is none, `beside` that nothing shows of.
fn mean(colors: impl Iterator<Item = Option<Srgba>>, beside: Srgba) -> Srgba {
    let (mut sum, mut count) = (Vec4::ZERO, 0.0f32);
    for color in colors {
        count += 1.0;
        if let Some(Srgba([red, green, blue, alpha])) = color {
            let share = f32::from(alpha);
            sum += Vec3::new(f32::from(red), f32::from(green), f32::from(blue)).extend(1.0) * share;
        }
    }
    let byte = |value: f32| (value + 0.5).clamp(0.0, 255.0) as u8;
    let shown = (sum.w > 0.0).then(|| {
        let color = sum / sum.w;
        Srgba([byte(color.x), byte(color.y), byte(color.z), byte(sum.w / count)])
    });
    shown.unwrap_or_else(|| seen(None, beside))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_colors_are_their_own_mean_and_what_is_not_seen_is_beside() {
        let beside = Srgba([1, 2, 3, 200]);
        for color in
            [None, Some(Srgba([9, 8, 7, 0])), Some(Srgba([250, 180, 60, 90])), Some(Srgba([255, 1, 0, 255]))]
        {
            for count in [1, 4, 9, 64, 289] {
                assert_eq!(
                    mean(std::iter::repeat_n(color, count), beside),
                    seen(color, beside),
                    "{color:?} {count}"
                );
            }
        }
        assert_eq!(seen(None, beside), Srgba([1, 2, 3, 0]));
        let half = [Some(Srgba([200, 100, 0, 80])), None];
        assert_eq!(mean(half.into_iter(), beside), Srgba([200, 100, 0, 40]));
    }
}
