//! The color of a lake: lighter along its shore and deeper in its middle, as the sea of an elevation model is.
//!
//! The lake's outline is drawn on a small grid, the distances from its shore are found there, and the colors that they mean
//! become a texture that spans the lake.

use std::collections::BTreeMap;

use glam::{DVec2, Vec2};

use crate::line_scale::LineScale;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawMesh, FeatureId};
use sandtable_draw::pixels::Pixels;
use sandtable_draw::water::WaterColor;
use sandtable_geom::distance_field::{RegionGrid, distances_m};
use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;
use sandtable_ribbon::plan::PlanMesh;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::water_shore::OPEN_SHARE;

/// Cells along the longer side of a lake: its color changes from shore to middle, over some tens of them.
const CELLS: f64 = 96.0;

/// Lakes shorter than this have one color, in pixels of a picture 1080 lines high: nobody sees where their middle is.
const LEAST_PX: f64 = 40.0;

/// The most lakes with colors of their own, those that look the longest: 64 textures of a few kilobytes.
const MOST_LAKES: usize = 64;

/// The outlines of the lakes that look large enough for colors of their own, by feature.
pub(super) fn large_lakes<'a>(
    scene: &'a SceneModel,
    scale: &LineScale<'_>,
) -> BTreeMap<FeatureId, LakeOutline<'a>> {
    let least = f64::from(scene.bounds.0.z);
    longest_lakes(scene, |bounds| {
        let length_m = bounds.size().max_element();
        let length_px = length_m / (scale.px * scale.nearest_meters_per_px(bounds, least));
        (length_px >= LEAST_PX).then_some(length_px)
    })
}

/// The outlines of the lakes that `length` takes for the longest, by feature; it returns `None` for those to leave out.
pub(super) fn longest_lakes<'a>(
    scene: &'a SceneModel,
    length: impl Fn(&Rect) -> Option<f64>,
) -> BTreeMap<FeatureId, LakeOutline<'a>> {
    let mut lakes: BTreeMap<FeatureId, Vec<&[DVec2]>> = BTreeMap::new();
    for shore in scene.symbols.iter().filter(|symbol| symbol.surface == RibbonSurface::ShoreLine) {
        lakes.entry(shore.feature).or_default().push(shore.alignment.line.points());
    }
    let mut large: Vec<(f64, FeatureId, LakeOutline<'a>)> = Vec::new();
    for (feature, rings) in lakes {
        let bounds = Rect::around(rings.iter().copied().flatten().copied());
        if let Some(length) = length(&bounds) {
            large.push((length, feature, LakeOutline { bounds, rings }));
        }
    }
    large.sort_by(|a, b| b.0.total_cmp(&a.0));
    large.into_iter().take(MOST_LAKES).map(|(_, feature, outline)| (feature, outline)).collect()
}

/// A lake's shore: its outer ring and its islands.
pub(super) struct LakeOutline<'a> {
    bounds: Rect,
    rings: Vec<&'a [DVec2]>,
}

impl LakeOutline<'_> {
    /// The texture that spans the lake.
    pub fn tint(&self) -> LakeTint {
        let size = self.bounds.size();
        let cell_m = size.max_element() / CELLS;
        // A cell more on every side, so that what repeats is not seen.
        let window = self.bounds.grown(1.5 * cell_m);
        let [columns, rows] = (window.size() / cell_m).ceil().to_array().map(|count| (count as u32).max(2));
        let step = window.size() / DVec2::new(f64::from(columns), f64::from(rows));
        let mut is_water = Vec::with_capacity((columns * rows) as usize);
        for row in 0..rows {
            let north = window.max.y - (f64::from(row) + 0.5) * step.y;
            is_water.extend(self.row(north, window.min.x, step.x, columns));
        }
        let off_m = distances_m(&is_water, RegionGrid { columns: columns as usize, step_m: step.to_array() });
        let farthest_m = off_m.iter().copied().fold(0.0, f64::max);
        let color = |x: u32, y: u32| {
            let share = off_m[(y * columns + x) as usize] / (OPEN_SHARE * farthest_m).max(f64::MIN_POSITIVE);
            Srgba::from_linear(WaterColor::tint(0.0, share as f32))
        };
        LakeTint { window, pixels: Pixels::from_fn(columns, rows, color) }
    }

    /// Whether the middles of a row of cells lie in the lake, by the crossings of its outline to the west of each.
    fn row(&self, north: f64, west: f64, step_m: f64, columns: u32) -> Vec<bool> {
        let crossings = polygon::crossings(self.rings.iter().copied(), north);
        let is_in = |column: u32| {
            let middle = west + (f64::from(column) + 0.5) * step_m;
            crossings.partition_point(|&crossing| crossing < middle) % 2 == 1
        };
        (0..columns).map(is_in).collect()
    }
}

/// The colors of a lake.
pub(super) struct LakeTint {
    /// The part of the plan that the texture spans.
    window: Rect,
    /// The texture, its first row the northernmost.
    pub pixels: Pixels,
}

impl LakeTint {
    /// Lays the texture over a draped lake.
    pub fn lay_over(&self, lake: &mut DrawMesh) {
        for vertex in &mut lake.vertices {
            let [x, y, _] = vertex.position.map(f64::from);
            vertex.uv = self.uv(DVec2::new(x, y)).to_array();
        }
    }

    /// The plan of a lake, with coordinates of this texture.
    pub fn laid_over(&self, lake: &PlanMesh) -> PlanMesh {
        let mut laid = lake.clone();
        laid.vertices.iter_mut().for_each(|vertex| vertex.uv = self.uv(vertex.at));
        laid
    }

    fn uv(&self, at: DVec2) -> Vec2 {
        let part = (at - self.window.min) / self.window.size();
        Vec2::new(part.x as f32, 1.0 - part.y as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lake_is_lightest_along_its_shore_and_around_its_island() {
        let ring = |points: &[(f64, f64)]| points.iter().map(|&point| DVec2::from(point)).collect::<Vec<_>>();
        let outer = ring(&[(0.0, 0.0), (960.0, 0.0), (960.0, 480.0), (0.0, 480.0), (0.0, 0.0)]);
        let island = ring(&[(200.0, 200.0), (200.0, 280.0), (280.0, 280.0), (280.0, 200.0), (200.0, 200.0)]);
        let outline =
            LakeOutline { bounds: Rect::around(outer.iter().copied()), rings: vec![&outer, &island] };
        let tint = outline.tint();
        let (columns, rows) = (tint.pixels.width(), tint.pixels.height());
        assert!((95..105).contains(&columns) && (45..60).contains(&rows), "{columns}x{rows}");
        let light = |x: f64, y: f64| {
            let [u, v] = [x / 960.0 * 96.0 + 1.5, (480.0 - y) / 480.0 * 48.0 + 1.5];
            tint.pixels.at(u as u32, v as u32).linear().element_sum()
        };
        assert!(light(5.0, 240.0) > light(100.0, 100.0) && light(100.0, 100.0) > light(600.0, 240.0));
        assert!(light(240.0, 240.0) > light(330.0, 240.0), "the island");
        assert_eq!(Srgba::from_linear(WaterColor::tint(0.0, 1.0)), WaterColor::OPEN);
        let mut mesh = DrawMesh::default();
        tint.lay_over(&mut mesh);
    }
}
