//! All draped features, cut patch by patch, so that a frame cuts again only the patches that changed.
//!
//! Plans are divided once along the borders of the terrain's patches. A patch's part can then be cut to the displayed
//! triangles without a look at its neighbors, and stays right until one of its own triangles changes; where only some
//! change, only what lies on these is cut again:
//!
//! ```text
//!   ┌────────┬────────┬────────┐
//!   │      ══╪════════╪══      │   a road in three parts; the middle patch changed,
//!   │        │▒▒▒▒▒▒▒▒│        │   so its part alone is cut again
//!   └────────┴────────┴────────┘
//! ```
//!
//! Cost: memory grows with the parts, time of [`Drapes::recut`] with the displayed triangles under what is cut again; nothing
//! is looked at in patches that are not named.

use std::sync::Arc;

use glam::DVec2;
use rayon::prelude::*;

use crate::cut_part::CutPart;
use crate::drape::check_clearance;
use crate::plan::{PlanMesh, PlanVertex, TextureMap};
use sandtable_draw::list::DrawMesh;
use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;
use sandtable_mesh::sink::MeshSink;
use sandtable_terrain::triangle_surface::{SurfaceTriangle, TriangleSurface};

/// Parts smaller than this are rounding, in square meters.
const SLIVER_M2: f64 = 1e-7;

/// The triangles after which a ribbon goes on in another part: where the ground changes, whole parts are copied and sent, and
/// each takes some memory.
const PART_TRIANGLES: usize = 48;

/// The borders of patches: rising world X of the borders that run north, and Y of those that run east, the outermost
/// among them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Borders {
    /// One more than there are columns of patches.
    pub east: Vec<f64>,
    /// One more than there are rows.
    pub north: Vec<f64>,
}

impl Borders {
    fn columns(&self) -> usize {
        self.east.len().saturating_sub(1)
    }

    /// The number of patches.
    pub fn patch_count(&self) -> usize {
        self.columns() * self.north.len().saturating_sub(1)
    }

    /// How far beside its patch a part may lie, in meters: world positions are f32.
    fn rounding_m(&self) -> f64 {
        let ends =
            [&self.east, &self.north].into_iter().flat_map(|borders| [borders.first(), borders.last()]);
        ends.flatten().fold(0.0, |most, &border| f64::max(most, border.abs())) * f64::from(f32::EPSILON)
    }

    /// Columns and rows of the patches that a rectangle meets.
    fn meeting(&self, rect: &Rect) -> impl Iterator<Item = (usize, usize)> + use<> {
        let span = |borders: &[f64], low: f64, high: f64| {
            let first = borders.partition_point(|&border| border <= low).saturating_sub(1);
            let end = borders.partition_point(|&border| border < high).min(borders.len().saturating_sub(1));
            first..end
        };
        let columns = span(&self.east, rect.min.x, rect.max.x);
        let rows = span(&self.north, rect.min.y, rect.max.y);
        rows.flat_map(move |row| columns.clone().map(move |column| (column, row)))
    }

    /// The corners of a patch, counter-clockwise.
    fn window(&self, (column, row): (usize, usize)) -> [DVec2; 4] {
        let [west, east] = [self.east[column], self.east[column + 1]];
        let [south, north] = [self.north[row], self.north[row + 1]];
        [(west, south), (east, south), (east, north), (west, north)].map(DVec2::from)
    }
}

/// A patch whose draped features must be cut again.
#[derive(Clone, Debug, PartialEq)]
pub struct StalePatch {
    /// Its number.
    pub patch: usize,
    /// Boxes, in world space, around all of its displayed triangles that have changed since it was last cut; `None` for all
    /// of them.
    pub areas: Option<Vec<Rect>>,
}

impl StalePatch {
    /// A patch whose triangles may all have changed.
    pub fn whole(patch: usize) -> Self {
        Self { patch, areas: None }
    }
}

/// The parts of ribbons in one patch, by their places among the plans given.
type PatchParts = Vec<(usize, PlanMesh)>;

/// The draped features, by patch.
#[derive(Clone, Debug, Default)]
pub struct Drapes {
    parts: DrapeParts,
    /// By patch, each part cut to the ground as it was displayed when the patch was last cut; none where it never was.
    cut: Vec<Vec<CutPart>>,
}

/// The draped features by patch, before they are cut: to be cut on another thread.
#[derive(Clone, Debug, Default)]
pub struct DrapeParts(Arc<Vec<PatchParts>>);

/// Parts that were cut on another thread.
#[derive(Clone, Debug)]
pub struct CutDrapes {
    of: DrapeParts,
    patches: Vec<(usize, Vec<CutPart>)>,
}

impl DrapeParts {
    /// The parts in `patches` cut to what is displayed there.
    ///
    /// # Panics
    /// Where a number is not that of a patch.
    pub fn cut(&self, patches: &[usize], ground: &dyn TriangleSurface) -> CutDrapes {
        let cut = |&patch: &usize| {
            (patch, self.0[patch].iter().map(|(_, plan)| CutPart::of(plan, ground)).collect())
        };
        let patches = if self.0.is_empty() { Vec::new() } else { patches.par_iter().map(cut).collect() };
        CutDrapes { of: self.clone(), patches }
    }

    fn in_patch(&self, patch: usize) -> &[(usize, PlanMesh)] {
        self.0.get(patch).map_or(&[], Vec::as_slice)
    }
}

impl Drapes {
    /// Divides `plans` along the borders; nothing is cut to the ground yet. Patches are numbered row by row from the
    /// south-west.
    pub fn new<'a>(borders: &Borders, plans: impl IntoIterator<Item = &'a PlanMesh>) -> Self {
        let mut patches = vec![PatchParts::new(); borders.patch_count()];
        for (ribbon, plan) in plans.into_iter().enumerate() {
            divide(ribbon, plan, borders, &mut patches);
        }
        Self { cut: vec![Vec::new(); patches.len()], parts: DrapeParts(Arc::new(patches)) }
    }

    /// The draped features before they are cut.
    pub fn parts(&self) -> &DrapeParts {
        &self.parts
    }

    /// Exchanges the cut features of patches with those that were cut on another thread. Does nothing where that was cut
    /// of other parts; returns whether it was of these.
    pub fn exchange(&mut self, other: &mut CutDrapes) -> bool {
        let is_own = Arc::ptr_eq(&self.parts.0, &other.of.0);
        if is_own {
            for (patch, cut) in &mut other.patches {
                std::mem::swap(&mut self.cut[*patch], cut);
            }
        }
        is_own
    }

    /// Cuts the parts in `stale` to what is displayed there now. The refiner gives these patches: those it changed,
    /// those that came into view, and those that went. What lies beside the areas that changed stays as it was cut.
    ///
    /// # Panics
    /// Where a number is not that of a patch.
    pub fn recut(&mut self, stale: &[StalePatch], ground: &dyn TriangleSurface) {
        if self.cut.is_empty() {
            return;
        }
        let cut: Vec<Vec<Option<CutPart>>> = stale.par_iter().map(|of| self.cut_again(of, ground)).collect();
        for (of, cut) in stale.iter().zip(cut) {
            let held = &mut self.cut[of.patch];
            held.resize(cut.len(), CutPart::default());
            let renewed = held.iter_mut().zip(cut);
            renewed.filter_map(|(held, cut)| Some((held, cut?))).for_each(|(held, cut)| *held = cut);
        }
    }

    /// Each part of a patch cut again; `None` for those that lie as they were cut.
    fn cut_again(&self, of: &StalePatch, ground: &dyn TriangleSurface) -> Vec<Option<CutPart>> {
        let held = &self.cut[of.patch];
        let cut = |(at, (_, plan)): (usize, &(usize, PlanMesh))| match (held.get(at), &of.areas) {
            (Some(cut), Some(areas)) => cut.recut(plan, ground, areas),
            _ => Some(CutPart::of(plan, ground)),
        };
        self.parts.in_patch(of.patch).iter().enumerate().map(cut).collect()
    }

    /// The ribbons in a patch, as places among the plans given, and the cut of each of their parts, the same memory as long as
    /// that is not cut again; none if it was never cut.
    pub fn in_patch(&self, patch: usize) -> impl Iterator<Item = (usize, &Arc<DrawMesh>)> {
        let cut = self.cut.get(patch).into_iter().flatten();
        self.parts.in_patch(patch).iter().zip(cut).map(|((ribbon, _), cut)| (*ribbon, cut.mesh()))
    }

    /// The ribbons in a patch, cut or not, as places among the plans given.
    pub fn held(&self, patch: usize) -> impl Iterator<Item = usize> {
        self.parts.in_patch(patch).iter().map(|(ribbon, _)| *ribbon)
    }

    /// Whether a patch has draped features.
    pub fn is_occupied(&self, patch: usize) -> bool {
        !self.parts.in_patch(patch).is_empty()
    }

    /// The number of patches with draped features.
    pub fn occupied(&self) -> usize {
        self.parts.0.iter().filter(|parts| !parts.is_empty()).count()
    }

    /// The largest clearance in meters between the cut features and the displayed ground: 0 but for rounding if every
    /// patch that changed was cut again. See [`check_clearance`].
    pub fn check(&self, ground: &dyn TriangleSurface) -> f64 {
        let cut: Vec<&Arc<DrawMesh>> = self.cut.iter().flatten().map(CutPart::mesh).collect();
        cut.par_iter().map(|mesh| check_clearance(mesh, ground)).reduce(|| 0.0, f64::max)
    }

    /// [`Drapes::check`] in some patches, where nothing may be displayed beside them.
    pub fn check_in(&self, borders: &Borders, patches: &[usize], ground: &dyn TriangleSurface) -> f64 {
        let of_patch = |&patch: &usize| {
            let window = Rect::around(borders.window((patch % borders.columns(), patch / borders.columns())));
            let own = WindowSurface { ground, window: window.grown(-borders.rounding_m()) };
            let cut = self.cut.get(patch).into_iter().flatten();
            cut.map(|cut| check_clearance(cut.mesh(), &own)).fold(0.0, f64::max)
        };
        patches.par_iter().map(of_patch).reduce(|| 0.0, f64::max)
    }
}

/// A ground whose heights are asked for inside a window alone: positions beside it are those of its border.
struct WindowSurface<'a> {
    ground: &'a dyn TriangleSurface,
    window: Rect,
}

impl TriangleSurface for WindowSurface<'_> {
    fn visit_facets(&self, rect: &Rect, visit: &mut dyn FnMut(&SurfaceTriangle)) {
        self.ground.visit_facets(rect, visit);
    }

    fn displayed_z(&self, at: DVec2) -> Option<f64> {
        self.ground.displayed_z(at.clamp(self.window.min, self.window.max))
    }
}

/// The part that the next triangle of a ribbon in a patch belongs to; ribbons are handed in one after the other.
fn part(parts: &mut PatchParts, ribbon: usize) -> &mut PlanMesh {
    let takes_more =
        |(last, part): &(usize, PlanMesh)| *last == ribbon && part.triangles.len() < PART_TRIANGLES;
    if !parts.last().is_some_and(takes_more) {
        parts.push((ribbon, PlanMesh::default()));
    }
    &mut parts.last_mut().expect("there is one now").1
}

/// Adds each triangle of a plan to the parts it has in the patches it meets.
fn divide(ribbon: usize, plan: &PlanMesh, borders: &Borders, patches: &mut [PatchParts]) {
    let (mut piece, mut scratch) = (Vec::new(), Vec::new());
    for corners in plan.corners() {
        let texture = TextureMap::of(corners);
        for (column, row) in borders.meeting(&Rect::around(corners.map(|corner| corner.at))) {
            piece.clear();
            piece.extend(corners.map(|corner| corner.at));
            polygon::clip_convex(&mut piece, &mut scratch, &borders.window((column, row)));
            if piece.len() < 3 || polygon::doubled_area(&piece) < 2.0 * SLIVER_M2 {
                continue;
            }
            let part = part(&mut patches[row * borders.columns() + column], ribbon);
            let ids: Vec<_> =
                piece.iter().map(|&at| part.vertex(PlanVertex { at, uv: texture.at(at) })).collect();
            polygon::fan(&ids).for_each(|corners| part.triangle(corners));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stroke::{StrokeOptions, StrokePath, stroke};
    use sandtable_earthworks::alignment::Alignment;
    use sandtable_geom::polyline::Polyline;

    fn borders() -> Borders {
        Borders { east: vec![0.0, 40.0, 80.0, 100.0], north: vec![0.0, 40.0, 70.0] }
    }

    fn road() -> PlanMesh {
        let line = Polyline::new([(5.0, 10.0), (60.0, 38.0), (95.0, 66.0)].map(DVec2::from), 0.0);
        let mut plan = PlanMesh::default();
        let alignment = Alignment::on_ground(line.expect("a line"), 6.0);
        stroke(&StrokePath::alone(&alignment), &StrokeOptions::default(), &mut plan);
        plan
    }

    #[test]
    fn the_parts_are_the_whole_and_each_lies_in_its_patch() {
        let (borders, road) = (borders(), road());
        let drapes = Drapes::new(&borders, [&road]);
        let mut area = 0.0;
        for (index, parts) in drapes.parts.0.iter().enumerate() {
            let [low, _, high, _] = borders.window((index % 3, index / 3));
            for (ribbon, part) in parts {
                assert_eq!(*ribbon, 0);
                area += part.area_m2();
                assert!(
                    part.vertices
                        .iter()
                        .all(|v| v.at.cmpge(low - 1e-9).all() && v.at.cmple(high + 1e-9).all())
                );
            }
        }
        assert!((area - road.area_m2()).abs() < 1e-6, "{area}");
        assert!(drapes.occupied() >= 4);
    }

    #[test]
    fn what_lies_off_the_patches_has_no_part() {
        let mut plan = PlanMesh::default();
        let ids = [(-20.0, -9.0), (-10.0, -9.0), (-15.0, 0.0)]
            .map(|at| plan.vertex(PlanVertex { at: DVec2::from(at), uv: glam::Vec2::ZERO }));
        plan.triangle(ids);
        assert_eq!(Drapes::new(&borders(), [&plan]).occupied(), 0);
    }
}
