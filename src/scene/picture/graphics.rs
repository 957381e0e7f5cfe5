//! Tactical graphics for one camera: lines of one width on the picture, laid over everything else on the ground.
//!
//! ```text
//!  points ─► text height in meters ─► drawing in the plane ─► strokes: legs in view, short on the picture
//!        ─► dashes ─► stroked in plan with the width of a pixel there ─► draped: all casings, then all lines
//! ```
//!
//! A graphic is drawn for the picture's scale where it lies: its text height is a number of pixels at the mean distance of
//! its points. So a tooth is as large as a letter on every picture, and the same graphic has more of them seen from near.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use crate::description::words::GraphicStatus;
use crate::draw::color::Srgba;
use crate::draw::list::{DepthLayer, DrawList, DrawMesh, FeatureId, MaterialId};
use crate::draw::material::{AlphaMode, Material, NormalSource};
use crate::earthworks::alignment::{Alignment, Support, Width};
use crate::geom::polyline::Polyline;
use crate::geom::profile::Profile;
use crate::geom::rect::Rect;
use crate::geom::segment;
use crate::geom::simplify::simplified;
use crate::ribbon::area;
use crate::ribbon::drape::drape;
use crate::ribbon::plan::PlanMesh;
use crate::ribbon::stroke::{StrokeOptions, StrokePath, stroke};
use crate::scene::SceneModel;
use crate::scene::graphics::SceneGraphic;
use crate::scene::picture::add_mesh;
use crate::scene::picture::graphic_colors::{graphic_color, opposing};
use crate::scene::picture::line_scale::LineScale;
use crate::scene::picture::symbols::cap;
use crate::symbology::graphic::drawing::{GraphicDrawing, GraphicInput, StrokeDash, StrokeSide, TextCourse};
use crate::terrain::full_resolution::FullResolution;
use crate::terrain::triangle_surface::TriangleSurface;
use crate::view::camera::Camera;
use crate::view::frustum::Frustum;

/// Over all ribbons, whose layers are below 16, and over tints of sight.
pub(super) const LAYER: u8 = 200;

/// The height of a graphic's text, in pixels of a picture 1080 lines high.
const EM_PX: f64 = 14.0;

/// The smallest part of a graphic's size that its text height is: a graphic of a few pixels is not all teeth.
const SMALLEST: f64 = 1.0 / 8.0;

/// The width of a line, and of the light casing on either side, in pixels of a picture 1080 lines high.
const LINE_PX: f64 = 2.4;
const CASING_PX: f64 = 1.0;

/// The casing's color: as light as paper, and seen through.
const CASING: Srgba = Srgba([255, 255, 250, 150]);

/// A dash and the gap after it, in pixels of a picture 1080 lines high.
const DASH_PX: [f64; 2] = [10.0, 6.0];

/// How far a vertex that is left out may lie from the line, in pixels.
const SLACK_PX: f64 = 0.25;

/// The longest piece of a line, in pixels where it is nearest: widths change along it with the distance, and long pieces
/// are tried against much ground that they do not meet.
const LONGEST_PX: f64 = 40.0;

/// How often a leg is halved at most: enough for one from here to the horizon.
const MOST_HALVES: u32 = 14;

/// How far beside the picture a line is still drawn, in pixels.
const MARGIN_PX: f64 = 12.0;

/// How many times as tall as wide an upright figure is drawn at most, where the ground is seen at a low angle.
const MOST_STRETCH: f64 = 2.5;

/// A text of a graphic, on the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedText {
    /// What it says; lines are separated by line feeds.
    pub text: String,
    /// The place it belongs to, world space.
    pub at: Vec3,
    /// A place on the side of it on which the text is; the same place for a text centered on it.
    pub toward: Vec3,
    /// How it follows a line.
    pub course: PlacedCourse,
    /// Its color, that of the graphic's lines.
    pub color: Srgba,
    /// The feature it belongs to.
    pub feature: FeatureId,
}

/// How a text follows a line on the ground: the parts of it that are in the frustum, their vertices close together.
#[derive(Clone, Debug, PartialEq)]
pub enum PlacedCourse {
    /// It does not: it is level, at its place.
    Level,
    /// On the line, at both ends.
    Ends(Vec<Vec<Vec3>>),
    /// Beside it, once.
    Once(Vec<Vec<Vec3>>),
    /// Beside it, again and again.
    Repeated(Vec<Vec<Vec3>>),
}

/// A part of a draw list: what is draped with one color.
struct DrapedPart {
    color: Srgba,
    mesh: DrawMesh,
    feature: FeatureId,
}

/// What one graphic adds.
#[derive(Default)]
struct DrapedGraphic {
    casings: Vec<DrapedPart>,
    lines: Vec<DrapedPart>,
    texts: Vec<PlacedText>,
}

/// Adds the graphics that `camera` sees, and returns their texts.
pub(super) fn add(
    list: &mut DrawList,
    scene: &SceneModel,
    camera: &Camera,
    displayed: &dyn TriangleSurface,
) -> Vec<PlacedText> {
    if scene.graphics.is_empty() {
        return Vec::new();
    }
    let view = GraphicView::new(scene, camera, displayed);
    let draped: Vec<DrapedGraphic> =
        scene.graphics.par_iter().filter_map(|graphic| view.draped(graphic)).collect();
    let mut materials = Materials { list, made: BTreeMap::new() };
    let (mut casings, mut lines, mut texts) = (Vec::new(), Vec::new(), Vec::new());
    for graphic in draped {
        casings.extend(graphic.casings);
        lines.extend(graphic.lines);
        texts.extend(graphic.texts);
    }
    casings.into_iter().chain(lines).for_each(|part| materials.add(part));
    texts
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
        let material = *self.made.entry(part.color.0).or_insert_with(|| {
            self.list.add_material(Material {
                name: "graphic".into(),
                base_color: part.color,
                alpha: if part.color.0[3] == 255 { AlphaMode::Opaque } else { AlphaMode::Blend },
                normals: NormalSource::Ground,
                ..Material::default()
            })
        });
        add_mesh(self.list, part.mesh, material, DepthLayer::Draped(LAYER), part.feature);
    }
}

/// A vertex of a line in view.
#[derive(Clone, Copy, Debug)]
struct LineVertex {
    at: DVec2,
    /// Meters in a pixel of a picture 1080 lines high, across the line.
    px_m: f64,
}

/// The view of a picture with graphics.
pub(super) struct GraphicView<'a> {
    camera: &'a Camera,
    displayed: &'a dyn TriangleSurface,
    ground: FullResolution<'a>,
    frustum: Frustum,
    extent: Rect,
    z: [f32; 2],
    scale: LineScale<'a>,
}

impl<'a> GraphicView<'a> {
    pub(super) fn new(scene: &'a SceneModel, camera: &'a Camera, displayed: &'a dyn TriangleSurface) -> Self {
        let lattice = scene.ground().lattice();
        let (min, max) = scene.bounds;
        Self {
            camera,
            displayed,
            ground: FullResolution { lattice },
            frustum: Frustum::new(camera),
            extent: lattice.extent(),
            z: [min.z, max.z],
            scale: LineScale::new(camera),
        }
    }

    fn draped(&self, graphic: &SceneGraphic) -> Option<DrapedGraphic> {
        let em_m = self.em_m(graphic)?;
        let input = GraphicInput {
            points: &graphic.points,
            em_m,
            up: self.up(graphic.points[0]),
            width_m: graphic.width_m,
            fields: &graphic.fields,
        };
        let drawing = graphic.kind.draw(&input);
        let color = graphic_color(graphic.side, graphic.kind.tint);
        let other = graphic_color(opposing(graphic.side), graphic.kind.tint);
        let mut draped = DrapedGraphic::default();
        self.drape_strokes(graphic, &drawing, [color, other], &mut draped);
        let mut fill = PlanMesh::default();
        drawing.fills.iter().for_each(|ring| area::fill(&counter_clockwise(ring), &[], 1.0, &mut fill));
        draped.lines.push(self.part(&fill, color, graphic.feature));
        draped.texts = drawing
            .texts
            .into_iter()
            .map(|text| {
                let at = self.on_ground(text.at);
                PlacedText {
                    at,
                    toward: self.on_ground(text.at + text.toward * em_m),
                    course: match &text.course {
                        TextCourse::Level => PlacedCourse::Level,
                        TextCourse::Ends(line) => PlacedCourse::Ends(self.pieces(line)),
                        TextCourse::Once(line) => PlacedCourse::Once(self.pieces(line)),
                        TextCourse::Repeated(line) => PlacedCourse::Repeated(self.pieces(line)),
                    },
                    text: text.text,
                    color,
                    feature: graphic.feature,
                }
            })
            .collect();
        Some(draped)
    }

    fn drape_strokes(
        &self,
        graphic: &SceneGraphic,
        drawing: &GraphicDrawing,
        colors: [Srgba; 2],
        draped: &mut DrapedGraphic,
    ) {
        let mut casing = PlanMesh::default();
        let mut lines = [PlanMesh::default(), PlanMesh::default()];
        for stroke in &drawing.strokes {
            let is_dashed = stroke.dash == StrokeDash::Dashed || graphic.status == GraphicStatus::Planned;
            let side = usize::from(stroke.side == StrokeSide::Opposing);
            for run in self.runs(&stroke.points, is_dashed) {
                stroke_run(&run, LINE_PX + 2.0 * CASING_PX, &mut casing);
                stroke_run(&run, LINE_PX, &mut lines[side]);
            }
        }
        draped.casings.push(self.part(&casing, CASING, graphic.feature));
        for (plan, color) in lines.iter().zip(colors) {
            draped.lines.push(self.part(plan, color, graphic.feature));
        }
    }

    fn part(&self, plan: &PlanMesh, color: Srgba, feature: FeatureId) -> DrapedPart {
        let mut mesh = DrawMesh::default();
        drape(plan, self.displayed, &mut mesh);
        DrapedPart { color, mesh, feature }
    }

    /// The height of a graphic's text in meters; `None` where all of it is behind the eye.
    fn em_m(&self, graphic: &SceneGraphic) -> Option<f64> {
        let forward = self.camera.forward().as_dvec3();
        let eye = self.camera.eye().as_dvec3();
        let near = f64::from(self.camera.planes().0);
        let places: Vec<Vec3> = graphic.points.iter().map(|&at| self.on_ground(at)).collect();
        let size = self.camera.size();
        let is_shown = |place: &&Vec3| {
            self.camera.project(**place).is_some_and(|seen| {
                let share = [seen.pixel.x / size.0 as f32, seen.pixel.y / size.1 as f32];
                share.iter().all(|share| (0.0..=1.0).contains(share))
            })
        };
        // Of a graphic that is partly in view what is in view counts.
        let shown: Vec<&Vec3> = places.iter().filter(is_shown).collect();
        let counted = if shown.is_empty() { places.iter().collect() } else { shown };
        let depths = counted.into_iter().map(|place| (place.as_dvec3() - eye).dot(forward));
        let logs: Vec<f64> = if self.camera.parallel_frame().is_some() {
            vec![libm::log(self.scale.meters_per_px_at(1.0))]
        } else {
            depths
                .filter(|&depth_m| depth_m > near)
                .map(|depth_m| libm::log(self.scale.meters_per_px_at(depth_m)))
                .collect()
        };
        if logs.is_empty() {
            return None;
        }
        let px_m = libm::exp(logs.iter().sum::<f64>() / logs.len() as f64);
        let em_m = EM_PX * self.scale.px * px_m;
        let size_m = Rect::around(graphic.points.iter().copied()).size().length();
        Some(if size_m > 0.0 { em_m.min(size_m * SMALLEST) } else { em_m })
    }

    /// Upward on the picture at a place, in the plane, as long as an upright figure is to be stretched there.
    fn up(&self, at: DVec2) -> DVec2 {
        let (forward, up) = (self.camera.forward().as_dvec3(), self.camera.up().as_dvec3());
        let way = (forward.truncate() + up.truncate()).try_normalize().unwrap_or(DVec2::Y);
        let ray = if self.camera.parallel_frame().is_some() {
            forward
        } else {
            (self.on_ground(at).as_dvec3() - self.camera.eye().as_dvec3()).normalize_or(forward)
        };
        let seen = -ray.z * f64::from(self.camera.stretch());
        way * (1.0 / seen.max(1.0 / MOST_STRETCH)).clamp(1.0, MOST_STRETCH)
    }

    fn on_ground(&self, at: DVec2) -> Vec3 {
        at.as_vec2().extend(self.z_at(at) as f32)
    }

    fn z_at(&self, at: DVec2) -> f64 {
        self.ground.displayed_z(at).unwrap_or(f64::from(self.z[0]))
    }

    /// The parts of a line in view, in world space.
    fn pieces(&self, line: &[DVec2]) -> Vec<Vec<Vec3>> {
        let runs = self.runs(line, false);
        runs.iter().map(|run| run.iter().map(|vertex| self.on_ground(vertex.at)).collect()).collect()
    }

    /// The parts of a line in view, its vertices close together on the picture; its dashes where it is dashed.
    fn runs(&self, points: &[DVec2], is_dashed: bool) -> Vec<Vec<LineVertex>> {
        let places: Vec<DVec3> = points.iter().map(|&at| at.extend(self.z_at(at))).collect();
        let eye = self.camera.eye().as_dvec3();
        let slack = |at: &DVec3| SLACK_PX * self.scale.meters_per_px_at(at.distance(eye));
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
                let [from, to] = [from, to].map(|at| LineVertex {
                    at: at.truncate(),
                    px_m: self.scale.px * self.scale.meters_per_px(at, along),
                });
                match runs.last_mut().filter(|_| end == Some(from.at)) {
                    Some(run) => run.push(to),
                    None => runs.push(vec![from, to]),
                }
                end = Some(to.at);
            });
        }
        if is_dashed { runs.iter().flat_map(|run| dashes(run)).collect() } else { runs }
    }

    /// Calls `visit` with the parts of a leg that may be in view, in order, each short on the picture.
    fn divide(&self, leg: [DVec3; 2], halves: u32, visit: &mut impl FnMut([DVec3; 2])) {
        let [from, to] = leg;
        let nearest_m = self.nearest_m(leg);
        let px_m = self.scale.px * self.scale.meters_per_px_at(nearest_m);
        let reach = Rect::around([from.truncate(), to.truncate()]).grown(MARGIN_PX * px_m);
        let [low, high] = self.z;
        let [min, max] = [(reach.min, low), (reach.max, high)].map(|(at, z)| at.as_vec2().extend(z));
        if !(reach.meets(&self.extent) && self.frustum.may_see(min, max)) {
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

    /// How near a leg comes to the eye; infinite for parallel rays.
    fn nearest_m(&self, [from, to]: [DVec3; 2]) -> f64 {
        if self.camera.parallel_frame().is_some() {
            return f64::INFINITY;
        }
        let (eye, leg) = (self.camera.eye().as_dvec3(), to - from);
        let part = ((eye - from).dot(leg) / leg.length_squared()).clamp(0.0, 1.0);
        eye.distance(from + leg * part)
    }
}

/// The dashes of a run of vertices.
fn dashes(run: &[LineVertex]) -> Vec<Vec<LineVertex>> {
    let period_px = DASH_PX[0] + DASH_PX[1];
    let mut dashes: Vec<Vec<LineVertex>> = vec![Vec::from_iter(run.first().copied())];
    let mut along_px = 0.0;
    for leg in run.windows(2) {
        let length_px = leg[0].at.distance(leg[1].at) / (0.5 * (leg[0].px_m + leg[1].px_m));
        let mut from_px = 0.0;
        while from_px < length_px {
            let is_dash = along_px < DASH_PX[0];
            let end_px = if is_dash { DASH_PX[0] } else { period_px };
            let to_px = (from_px + end_px - along_px).min(length_px);
            let part = to_px / length_px;
            let vertex = LineVertex {
                at: leg[0].at.lerp(leg[1].at, part),
                px_m: leg[0].px_m + (leg[1].px_m - leg[0].px_m) * part,
            };
            along_px += to_px - from_px;
            from_px = to_px;
            if is_dash {
                dashes.last_mut().expect("there is always one").push(vertex);
                if along_px >= DASH_PX[0] - 1e-9 {
                    along_px = DASH_PX[0];
                }
            } else if along_px >= period_px - 1e-9 {
                dashes.push(vec![vertex]);
                along_px = 0.0;
            }
        }
    }
    dashes.retain(|dash| dash.len() > 1);
    dashes
}

/// Strokes a run of vertices with a width in pixels, its ends round.
fn stroke_run(run: &[LineVertex], width_px: f64, plan: &mut PlanMesh) {
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

/// A ring counter-clockwise.
fn counter_clockwise(ring: &[DVec2]) -> Vec<DVec2> {
    let mut ring = ring.to_vec();
    if crate::geom::polygon::doubled_area(&ring) < 0.0 {
        ring.reverse();
    }
    ring
}
