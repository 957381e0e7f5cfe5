//! Lines of one width on the picture, on the ground that a camera sees.
//!
//! ```text
//!  points ─► legs in view, short on the picture ─► dashes ─► stroked in plan with the width of a pixel there ─► draped
//! ```

use std::collections::BTreeMap;

use glam::{DVec2, DVec3, Vec3};

use crate::add_mesh;
use crate::line_scale::LineScale;
use crate::line_view::{self, LineView};
use crate::symbols::cap;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DepthLayer, DrawList, DrawMesh, FeatureId, MaterialId};
use sandtable_draw::material::{AlphaMode, Material, NormalSource};
use sandtable_earthworks::alignment::{Alignment, Support, Width};
use sandtable_geom::polyline::Polyline;
use sandtable_geom::profile::Profile;
use sandtable_geom::segment;
use sandtable_geom::simplify::simplified;
use sandtable_ribbon::drape::drape;
use sandtable_ribbon::plan::PlanMesh;
use sandtable_ribbon::stroke::{StrokeOptions, StrokePath, stroke};
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_view::camera::Camera;

/// Over all ribbons, whose layers are below 16.
pub const LAYER: u8 = 200;

/// The height of a graphic's text, in pixels of a picture 1080 lines high.
const EM_PX: f64 = 14.0;

/// The width of a line, and of the light casing on either side, in pixels of a picture 1080 lines high.
pub const LINE_PX: f64 = 3.0;
const CASING_PX: f64 = 1.2;

/// The casing's color: as light as paper, and seen through.
pub const CASING: Srgba = Srgba([255, 255, 250, 170]);

/// A dash and the gap after it, in pixels of a picture 1080 lines high.
const DASH_PX: [f64; 2] = [10.0, 6.0];

/// How far a vertex that is left out may lie from the line, in pixels.
const SLACK_PX: f64 = 0.25;

/// The longest piece of a line, in pixels where it is nearest: widths change along it with the distance, and long pieces
/// are tried against much ground that they do not meet.
const LONGEST_PX: f64 = 40.0;

/// How often a leg is halved at most: enough for one from here to the horizon.
const MOST_HALVES: u32 = 14;

/// How far to each side of a line the ground is looked at for its slope, in pixels.
const PROBE_PX: f64 = 5.0;

/// The most that a line grows on the ground because that is seen at a low angle.
const MOST_GROWTH: f64 = 3.0;

/// How far beside the picture a line is still drawn, in pixels.
const MARGIN_PX: f64 = 12.0;

/// How many times as tall as wide an upright figure is drawn at most, where the ground is seen at a low angle.
const MOST_STRETCH: f64 = 2.5;

/// What lies over what, the lower first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum LineOrder {
    /// Under other lines and marks, as links lie under the posts that they join.
    Under,
    /// By feature.
    #[default]
    ByFeature,
}

/// Lines in plan, by order, color and feature: their casings, and the lines.
#[derive(Default)]
pub struct GraphicPen {
    drawn: BTreeMap<(LineOrder, FeatureId, [u8; 4]), [PlanMesh; 2]>,
    order: LineOrder,
    grounds: BTreeMap<(FeatureId, [u8; 4]), PlanMesh>,
}

impl GraphicPen {
    /// Sets the order of what is drawn from now on.
    pub fn set_order(&mut self, order: LineOrder) {
        self.order = order;
    }

    /// The plan of the lines of a color, to add filled figures to.
    pub fn plan(&mut self, color: Srgba, feature: FeatureId) -> &mut PlanMesh {
        &mut self.drawn.entry((self.order, feature, color.0)).or_default()[1]
    }

    /// The plan of ground of a color, which lies under all lines.
    pub fn ground(&mut self, color: Srgba, feature: FeatureId) -> &mut PlanMesh {
        self.grounds.entry((feature, color.0)).or_default()
    }

    /// The plans of grounds and casings, and of lines.
    pub fn into_plans(self) -> [Vec<LinePlan>; 2] {
        let grounds = self.grounds.into_iter();
        let ground = |((feature, color), plan)| LinePlan { plan, color: Srgba(color), feature };
        let (mut casings, mut lines): (Vec<LinePlan>, Vec<LinePlan>) =
            (grounds.map(ground).collect(), Vec::new());
        for ((_, feature, color), [casing, line]) in self.drawn {
            casings.push(LinePlan { plan: casing, color: CASING, feature });
            lines.push(LinePlan { plan: line, color: Srgba(color), feature });
        }
        [casings, lines]
    }

    /// The lines draped on the displayed ground: grounds and casings, then lines.
    pub fn draped(&self, displayed: &dyn TriangleSurface) -> [Vec<DrapedPart>; 2] {
        let part = |plan: &PlanMesh, color: Srgba, feature: FeatureId| {
            let mesh = drape(plan, displayed);
            DrapedPart { color, mesh, feature }
        };
        let grounds = self.grounds.iter().map(|((feature, color), plan)| part(plan, Srgba(*color), *feature));
        let casings = self.drawn.iter().map(|((_, feature, _), plans)| part(&plans[0], CASING, *feature));
        let casings = grounds.chain(casings);
        let lines =
            self.drawn.iter().map(|((_, feature, color), plans)| part(&plans[1], Srgba(*color), *feature));
        [casings.collect(), lines.collect()]
    }
}

/// Lines of one color in plan.
pub struct LinePlan {
    /// Their triangles.
    pub plan: PlanMesh,
    /// Their color.
    pub color: Srgba,
    /// Whose they are.
    pub feature: FeatureId,
}

/// A part of a draw list: what is draped with one color.
pub struct DrapedPart {
    color: Srgba,
    mesh: DrawMesh,
    feature: FeatureId,
}

/// Adds parts of a draw list, one material a color.
pub fn add_parts(list: &mut DrawList, parts: impl Iterator<Item = DrapedPart>) {
    let mut materials = Materials { list, made: BTreeMap::new() };
    parts.for_each(|part| materials.add(part));
}

/// The look of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineLook {
    /// Its color.
    pub color: Srgba,
    /// Whether it is dashed.
    pub is_dashed: bool,
    /// Its width, in pixels of a picture 1080 lines high.
    pub width_px: f64,
}

/// The materials of graphics, one a color.
struct Materials<'a> {
    list: &'a mut DrawList,
    made: BTreeMap<[u8; 4], MaterialId>,
}

impl Materials<'_> {
    fn add(&mut self, part: DrapedPart) {
        if part.mesh.triangles.is_empty() {
            return;
        }
        let material = *self.made.entry(part.color.0).or_insert_with(|| add_material(self.list, part.color));
        add_mesh(self.list, part.mesh, material, DepthLayer::Draped(LAYER), part.feature);
    }
}

/// Adds the material of lines of a color.
pub fn add_material(list: &mut DrawList, color: Srgba) -> MaterialId {
    list.add_material(Material {
        name: "graphic".into(),
        base_color: color,
        alpha: if color.0[3] == 255 { AlphaMode::Opaque } else { AlphaMode::Blend },
        normals: NormalSource::Ground,
        ..Material::default()
    })
}

/// A vertex of a line in view.
#[derive(Clone, Copy, Debug)]
pub struct LineVertex {
    /// World X and Y.
    pub at: DVec2,
    /// Meters in a pixel of a picture 1080 lines high, across the line.
    pub px_m: f64,
}

/// The view of a picture with graphics.
pub struct GraphicView<'a> {
    lines: LineView<'a>,
}

impl<'a> GraphicView<'a> {
    pub fn new(scene: &'a SceneModel, camera: &'a Camera) -> Self {
        Self { lines: LineView::new(scene, camera, LineScale::new(camera)) }
    }

    /// For an eye that turns around where `camera` is: each place as if it were in the picture's middle.
    pub fn around(scene: &'a SceneModel, camera: &'a Camera) -> Self {
        Self { lines: LineView::new(scene, camera, LineScale::around(camera)) }
    }

    /// Draws a line with its casing.
    pub fn draw(&self, pen: &mut GraphicPen, points: &[DVec2], look: LineLook, feature: FeatureId) {
        let [casing, line] = pen.drawn.entry((pen.order, feature, look.color.0)).or_default();
        for run in self.runs(points, look.is_dashed) {
            stroke_run(&run, look.width_px + 2.0 * CASING_PX, casing);
            stroke_run(&run, look.width_px, line);
        }
    }

    /// Draws a line without a casing.
    pub fn draw_bare(&self, pen: &mut GraphicPen, points: &[DVec2], look: LineLook, feature: FeatureId) {
        let plan = pen.plan(look.color, feature);
        self.runs(points, look.is_dashed).iter().for_each(|run| stroke_run(run, look.width_px, plan));
    }

    /// The height of a text at places, in meters: that of their mean distance. `None` where all are behind the eye.
    pub fn em_m(&self, places: &[DVec2]) -> Option<f64> {
        let near = f64::from(self.lines.camera.planes().0);
        if self.lines.camera.parallel_frame().is_some() {
            return Some(EM_PX * self.lines.scale.px * self.lines.scale.meters_per_px_at(1.0));
        }
        let places: Vec<Vec3> = places.iter().map(|&at| self.on_ground(at)).collect();
        let (width, height) = self.lines.camera.size();
        let is_shown = |place: &&Vec3| {
            let turns = self.lines.frustum.is_none();
            !turns
                && self.lines.camera.project(**place).is_some_and(|seen| {
                    let shares = [seen.pixel.x / width as f32, seen.pixel.y / height as f32];
                    shares.iter().all(|share| (0.0..=1.0).contains(share))
                })
        };
        // Of what is partly in view, that part counts.
        let shown: Vec<&Vec3> = places.iter().filter(is_shown).collect();
        let counted = if shown.is_empty() { places.iter().collect() } else { shown };
        let depths = counted.into_iter().map(|place| self.depth_m(place.as_dvec3()));
        let logs: Vec<f64> = depths
            .filter(|&depth_m| depth_m > near)
            .map(|depth_m| libm::log(self.lines.scale.meters_per_px_at(depth_m)))
            .collect();
        let mean = logs.iter().sum::<f64>() / logs.len() as f64;
        (!logs.is_empty()).then(|| EM_PX * self.lines.scale.px * libm::exp(mean))
    }

    /// The height of a text at a place in meters; 1 behind the eye, where nothing shows.
    pub fn em_at(&self, at: DVec2) -> f64 {
        self.em_m(&[at]).unwrap_or(1.0)
    }

    /// Upward on the picture at a place, clockwise from north in degrees.
    pub fn up_azimuth_deg(&self, at: DVec2) -> f64 {
        let up = self.up(at);
        libm::atan2(up.x, up.y).to_degrees()
    }

    /// The direction upward on the picture at a place, in the plane; its length is the stretch of an upright figure
    /// there.
    pub fn up(&self, at: DVec2) -> DVec2 {
        let offset = self.on_ground(at).as_dvec3() - self.lines.camera.eye().as_dvec3();
        let [_, up, forward] = self.lines.scale.axes(offset);
        let way = (forward.truncate() + up.truncate()).try_normalize().unwrap_or(DVec2::Y);
        let ray =
            if self.lines.camera.parallel_frame().is_some() { forward } else { offset.normalize_or(forward) };
        let seen = -ray.z * f64::from(self.lines.camera.stretch());
        way * (1.0 / seen.max(1.0 / MOST_STRETCH)).clamp(1.0, MOST_STRETCH)
    }

    /// A place on the finest ground.
    pub fn on_ground(&self, at: DVec2) -> Vec3 {
        at.as_vec2().extend(self.z_at(at) as f32)
    }

    fn z_at(&self, at: DVec2) -> f64 {
        self.lines.ground.displayed_z(at).unwrap_or(f64::from(self.lines.z[0]))
    }

    /// The parts of a line in view, in world space.
    pub fn pieces(&self, line: &[DVec2]) -> Vec<Vec<Vec3>> {
        let runs = self.runs(line, false);
        runs.iter().map(|run| run.iter().map(|vertex| self.on_ground(vertex.at)).collect()).collect()
    }

    /// The parts of a line in view, its vertices close together on the picture; its dashes where it is dashed.
    pub fn runs(&self, points: &[DVec2], is_dashed: bool) -> Vec<Vec<LineVertex>> {
        let places: Vec<DVec3> = points.iter().map(|&at| at.extend(self.z_at(at))).collect();
        let eye = self.lines.camera.eye().as_dvec3();
        let slack = |at: &DVec3| SLACK_PX * self.lines.scale.meters_per_px_at(at.distance(eye));
        let slacks_m: Vec<f64> = places.iter().map(slack).collect();
        let off = |from: usize, to: usize, index: usize| {
            let distance = segment::distance_squared((points[from], points[to]), points[index]).sqrt();
            // A ring has no length from its first to its last point.
            let distance = if distance.is_nan() { points[from].distance(points[index]) } else { distance };
            distance / slacks_m[index]
        };
        let kept = simplified(points.len(), 1.0, off);
        let mut runs: Vec<Vec<LineVertex>> = Vec::new();
        let mut end = None;
        for pair in kept.windows(2) {
            self.divide([places[pair[0]], places[pair[1]]], 0, &mut |[from, to]| {
                let along = (to - from).truncate().normalize_or_zero();
                let [from, to] =
                    [from, to].map(|at| LineVertex { at: at.truncate(), px_m: self.px_m(at, along) });
                match runs.last_mut().filter(|_| end == Some(from.at)) {
                    Some(run) => run.push(to),
                    None => runs.push(vec![from, to]),
                }
                end = Some(to.at);
            });
        }
        if is_dashed { runs.iter().flat_map(|run| dashes(run)).collect() } else { runs }
    }

    /// Meters of the ground as it is, across a line through `at` along `along`, in a pixel of a picture 1080 lines high
    /// across the line. On a slope that faces the eye that is less than on level ground.
    fn px_m(&self, at: DVec3, along: DVec2) -> f64 {
        let square_m = self.lines.scale.px * self.lines.scale.meters_per_px_at(self.depth_m(at));
        if self.lines.frustum.is_none() {
            return self.lines.scale.px * self.lines.scale.meters_per_px(at, along);
        }
        let reach_m = PROBE_PX * square_m;
        let pixel = |way: DVec2| {
            let place = at.truncate() + way * reach_m;
            self.lines.camera.project(self.on_ground(place)).map(|seen| seen.pixel.as_dvec2())
        };
        let across = along.perp();
        let [Some(left), Some(right), Some(ahead), Some(behind)] =
            [across, -across, along, -along].map(pixel)
        else {
            return self.lines.scale.px * self.lines.scale.meters_per_px(at, along);
        };
        let wide_px = (left - right).perp_dot((ahead - behind).normalize_or_zero()).abs();
        let px_m = 2.0 * reach_m * self.lines.scale.px / wide_px.max(f64::MIN_POSITIVE);
        px_m.clamp(square_m, square_m * MOST_GROWTH)
    }

    /// How far a place is from the eye along the view.
    fn depth_m(&self, at: DVec3) -> f64 {
        let offset = at - self.lines.camera.eye().as_dvec3();
        if self.lines.frustum.is_none() {
            offset.length()
        } else {
            offset.dot(self.lines.camera.forward().as_dvec3())
        }
    }

    /// Calls `visit` with the parts of a leg that may be in view, in order, each short on the picture.
    fn divide(&self, leg: [DVec3; 2], halves: u32, visit: &mut impl FnMut([DVec3; 2])) {
        let [from, to] = leg;
        let px_m = self.lines.scale.px * self.lines.scale.meters_per_px_at(self.lines.nearest_m(leg));
        if !self.lines.may_see(leg, MARGIN_PX * px_m) {
            return;
        }
        if from.distance(to) > LONGEST_PX * px_m && halves < MOST_HALVES {
            let middle = from.midpoint(to).truncate();
            let middle = middle.extend(self.z_at(middle));
            self.divide([from, middle], halves + 1, visit);
            self.divide([middle, to], halves + 1, visit);
        } else {
            visit(leg);
        }
    }
}

/// The dashes of a run of vertices.
fn dashes(run: &[LineVertex]) -> Vec<Vec<LineVertex>> {
    let length_px =
        |from: &LineVertex, to: &LineVertex| from.at.distance(to.at) / (0.5 * (from.px_m + to.px_m));
    let toward = |from: &LineVertex, to: &LineVertex, part: f64| LineVertex {
        at: from.at.lerp(to.at, part),
        px_m: from.px_m + (to.px_m - from.px_m) * part,
    };
    line_view::dashes(run, DASH_PX, length_px, toward)
}

/// Strokes a run of vertices with a width in pixels, its ends round.
pub fn stroke_run(run: &[LineVertex], width_px: f64, plan: &mut PlanMesh) {
    let options = StrokeOptions::default();
    let Some(line) = Polyline::new(run.iter().map(|vertex| vertex.at), 0.0) else { return };
    let widths: Vec<f64> = run.iter().map(|vertex| vertex.px_m * width_px).collect();
    // Vertices in one place are one.
    if widths.len() != line.points().len() {
        return;
    }
    let points = line.points();
    let last = points.len() - 1;
    for [end, inner] in [[0, 1], [last, last - 1]] {
        let outward = (points[end] - points[inner]).normalize_or_zero();
        cap(points[end], outward * widths[end] / 2.0, 0.0, plan);
    }
    let Some(widths) = Profile::new(line.stations().to_vec(), widths) else { return };
    let alignment = Alignment { line, level: None, width: Width::Varying(widths), support: Support::Ground };
    stroke(&StrokePath::alone(&alignment), &options, plan);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_under_lies_under_all_else_whatever_its_color_and_feature() {
        let (post, link, later) =
            (Srgba::opaque(20, 20, 20), Srgba::opaque(30, 130, 60), Srgba::opaque(0, 0, 0));
        let mut pen = GraphicPen::default();
        pen.plan(post, FeatureId(3));
        pen.set_order(LineOrder::Under);
        pen.plan(link, FeatureId(3));
        pen.plan(link, FeatureId(9));
        pen.set_order(LineOrder::default());
        pen.plan(later, FeatureId(9));
        let [_, lines] = pen.into_plans();
        let drawn: Vec<(Srgba, FeatureId)> = lines.iter().map(|plan| (plan.color, plan.feature)).collect();
        let expected =
            [(link, FeatureId(3)), (link, FeatureId(9)), (post, FeatureId(3)), (later, FeatureId(9))];
        assert_eq!(drawn, expected);
    }
}
