//! Line symbols for one camera: roads and rivers where they would be drawn narrower than their class needs.
//!
//! ```text
//!  centerline ─► vertices that show ─► legs in view, short against their distance ─► a width at each vertex
//!             ─► runs that are too narrow ─► stroked in plan: casing and fill ─► draped
//! ```
//!
//! The symbol of a bridge lies on the ground below as long as the deck lies over it on the picture, too; else it is raised to
//! the deck.
//!
//! A width on the picture depends on the depth of a vertex and, where the camera looks across the ground at a low angle,
//! on the line's direction. It is taken at each vertex for the level ground there. On a straight leg the width that a
//! depth needs is straight too, so that few vertices are enough.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3, Vec2};
use rayon::prelude::*;

use crate::line_scale::LineScale;
use crate::line_view::{self, LineView};
use sandtable_draw::list::{DrawMesh, FeatureId};
use sandtable_earthworks::alignment::{Alignment, Support, Width};
use sandtable_geom::polyline::Polyline;
use sandtable_geom::profile::Profile;
use sandtable_geom::segment;
use sandtable_geom::simplify::simplified;
use sandtable_geom::spline;
use sandtable_mesh::sink::MeshSink;
use sandtable_ribbon::drape::Draper;
use sandtable_ribbon::plan::{PlanMesh, PlanVertex};
use sandtable_ribbon::stroke::{StrokeOptions, StrokePath, stroke};
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::symbols::{DeckLine, LineSymbol, drawn_width_m};
use sandtable_scene::vertical_scale::VerticalScale;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_terrain::water_cover::WaterCover;
use sandtable_view::camera::Camera;

/// How much wider than its fill a casing is on either side, in pixels of a picture 1080 lines high.
const CASING_PX: f64 = 0.75;

/// Symbols narrower than this have no casing: it would be more of them than the fill.
const LEAST_CASED_PX: f64 = 2.0;

/// How far a vertex that is left out may lie from the line, in pixels.
const SLACK_PX: f64 = 0.3;

/// How far beside the picture a line is still drawn, in pixels: more than half of the widest symbol.
const MARGIN_PX: f64 = 12.0;

/// The longest leg, as a share of its distance from the eye: perspective changes widths along it by as much.
const LONGEST_LEG: f64 = 0.1;

/// A dash of a track and the gap after it, in pixels of a picture 1080 lines high.
const DASH_PX: [f64; 2] = [7.0, 4.0];

/// How many times as wide as it is a line is drawn where nothing but a symbol is left of it.
const ALL_SYMBOL: f64 = 2.5;

/// Sides of a round end.
const CAP_SIDES: u32 = 4;

/// The shortest leg that is divided, in widths of the line: near the eye the line is wide enough.
const SHORTEST_LEG: f64 = 8.0;

/// How much wider a casing is than its fill at most, in what the fill is wider than the line.
const CASING_RISE: f64 = 2.0;

/// Legs of a river longer than this are smoothed, in pixels: shorter ones are as fine as the picture.
const COARSE_PX: f64 = 8.0;

/// The length of the pieces that a smoothed leg is drawn in, in pixels: they turn by a few degrees each.
const SMOOTH_PX: f64 = 4.0;

/// The most of them: a leg that crosses half of the picture is as coarse as its neighbors.
const MOST_PIECES: f64 = 12.0;

/// The narrowest that a line is, in pixels: about a tenth of a pixel's light.
const NARROWEST_PX: f64 = 0.15;

/// The casing of a river is nothing where that is narrower than the first of these, in pixels of a picture 1080 lines high,
/// and whole where it is as wide as the second.
const CASED_RIVER_PX: [f64; 2] = [1.4, 2.2];

/// How often the leg on which a river reaches the sea is halved: to a thousandth of it.
const SHORE_STEPS: u32 = 10;

/// How far on the picture a deck lies from the ground below it at the least whose symbol lies on it, in pixels of a picture
/// 1080 lines high: less is hidden by the symbol's own width.
const APART_PX: f64 = 1.5;

/// In how many steps that is looked for along a deck.
const DECK_STEPS: u32 = 32;

/// How far above the parapets the casing and the fill of a symbol on a deck lie, in meters: they hide the deck, and the fill
/// the casing.
const CASING_ABOVE_M: f64 = 0.1;
const FILL_ABOVE_M: f64 = 0.3;

/// A symbol, draped.
pub(super) struct DrapedSymbol<'a> {
    /// The line.
    pub symbol: &'a LineSymbol,
    /// Its outline; empty for the narrowest.
    pub casing: DrawMesh,
    /// Its inside.
    pub fill: DrawMesh,
    /// Whether it lies on the deck of its bridge.
    pub is_raised: bool,
}

/// How the ribbons of a feature show beside its symbols.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum RibbonShow {
    /// Symbols take the place of all that is in view.
    Replaced,
    /// In its true width.
    Shown,
}

/// The symbols of a picture.
#[derive(Default)]
pub(super) struct Symbols<'a> {
    /// The lines that have any in view.
    pub draped: Vec<DrapedSymbol<'a>>,
    /// The look of each road or river in view.
    pub shows: BTreeMap<FeatureId, RibbonShow>,
}

/// A symbol in plan.
pub(super) struct PlannedSymbol<'a> {
    /// The line.
    pub symbol: &'a LineSymbol,
    /// Its outline; empty for the narrowest.
    pub casing: PlanMesh,
    /// Its inside.
    pub fill: PlanMesh,
    /// The deck that it lies on where it would lie beside it on the ground.
    pub deck: Option<&'a DeckLine>,
}

/// The symbols that `camera` sees by `scale`, on the ground that it is shown.
pub(super) fn symbols<'a>(
    scene: &'a SceneModel,
    camera: &Camera,
    scale: LineScale<'_>,
    displayed: &dyn TriangleSurface,
) -> Symbols<'a> {
    let mesh = |draper: &mut Draper, plan: &PlanMesh, deck: Option<&DeckLine>, above_m: f64| {
        let mut mesh = draper.drape(plan, displayed);
        if let Some(deck) = deck {
            raise(&mut mesh, |at| scene.scale.world_z(deck.level_at(at)) + deck.parapet_m + above_m);
        }
        mesh
    };
    let draped = |draper: &mut Draper, planned: PlannedSymbol<'a>| {
        let PlannedSymbol { symbol, casing, fill, deck } = planned;
        DrapedSymbol {
            symbol,
            casing: mesh(draper, &casing, deck, CASING_ABOVE_M),
            fill: mesh(draper, &fill, deck, FILL_ABOVE_M),
            is_raised: deck.is_some(),
        }
    };
    let (draped, shows) = planned_with(scene, camera, scale, SymbolUv::Share, draped);
    Symbols { draped, shows }
}

/// Raises a mesh on the ground to `z` where that is higher: a wide symbol does not sink into the slopes where a bridge ends.
fn raise(mesh: &mut DrawMesh, z: impl Fn(DVec2) -> f64) {
    for vertex in &mut mesh.vertices {
        let [x, y, ground_z] = vertex.position;
        vertex.position[2] = ground_z.max(z(DVec2::new(f64::from(x), f64::from(y))) as f32);
        vertex.normal = [0.0, 0.0, 1.0];
    }
}

/// What the texture coordinates of symbols say.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum SymbolUv {
    /// U of a fill how much of a symbol each place is, see [`SymbolVertex::symbolic_share`].
    Share,
    /// U how far across the line each place is: 0 and 1 at the edges, 0.5 in the middle.
    Across,
}

/// The symbols that `camera` sees by `scale`, and how the ribbons beside them show.
pub(super) fn planned<'a>(
    scene: &'a SceneModel,
    camera: &Camera,
    scale: LineScale<'_>,
) -> (Vec<PlannedSymbol<'a>>, BTreeMap<FeatureId, RibbonShow>) {
    planned_with(scene, camera, scale, SymbolUv::Share, |_, symbol| symbol)
}

/// What `finish` makes of each of [`planned`], on any thread, with what that thread drapes with; texture coordinates have the
/// meaning `uv`.
pub(super) fn planned_with<'a, T: Send>(
    scene: &'a SceneModel,
    camera: &Camera,
    scale: LineScale<'_>,
    uv: SymbolUv,
    finish: impl Fn(&mut Draper, PlannedSymbol<'a>) -> T + Sync,
) -> (Vec<T>, BTreeMap<FeatureId, RibbonShow>) {
    let lines = LineView::new(scene, camera, scale);
    let view = SymbolView { lines, scale: scene.scale, water: scene.water() };
    let seen = |symbol: &'a LineSymbol| {
        let seen = view.seen(symbol, LineSmoothing::None);
        // Beside a ribbon in its true width a line keeps to the centerline that both have.
        if symbol.surface == RibbonSurface::River && seen.show == Some(RibbonShow::Replaced) {
            return view.seen(symbol, LineSmoothing::Curves);
        }
        seen
    };
    let seen: Vec<_> = scene.symbols.par_iter().map(|symbol| (symbol, seen(symbol))).collect();
    let mut shows = BTreeMap::new();
    // A shore lies beside its lake and does not take its place.
    let in_place = seen.iter().filter(|(symbol, _)| symbol.surface != RibbonSurface::ShoreLine);
    for (symbol, show) in in_place.filter_map(|(symbol, seen)| Some((symbol, seen.show?))) {
        let most = shows.entry(symbol.feature).or_insert(show);
        *most = show.max(*most);
    }
    let plan = |draper: &mut Draper, (symbol, seen): (&'a LineSymbol, SeenLine)| {
        let dashed: Vec<Vec<SymbolVertex>>;
        let runs = if symbol.surface == RibbonSurface::Track {
            dashed = seen.runs.iter().flat_map(|run| dashes(run, symbol.least_px)).collect();
            &dashed
        } else {
            &seen.runs
        };
        let strokes = |part: SymbolPart| {
            let mut plan = PlanMesh::default();
            runs.iter().for_each(|run| stroke_run(run, part, uv, &mut plan));
            plan
        };
        let casing = if symbol.widest_px() >= LEAST_CASED_PX {
            strokes(SymbolPart::Casing)
        } else {
            PlanMesh::default()
        };
        let deck = symbol.deck.as_ref().filter(|deck| view.shows_apart(deck));
        finish(draper, PlannedSymbol { symbol, casing, fill: strokes(SymbolPart::Fill), deck })
    };
    let narrow = seen.into_par_iter().filter(|(_, seen)| !seen.runs.is_empty());
    (narrow.map_init(Draper::default, plan).collect(), shows)
}

/// A vertex of a line in view.
#[derive(Clone, Copy, Debug)]
struct SymbolVertex {
    at: DVec2,
    true_m: f64,
    drawn_m: f64,
    casing_m: f64,
    show: RibbonShow,
    /// Whether it is where a river reaches the sea or a lake of the elevation model.
    is_mouth: bool,
}

impl SymbolVertex {
    /// 0 where the line is as wide as it is, 1 where it is so much wider that only a symbol is left of it.
    fn symbolic_share(&self) -> f64 {
        ((self.drawn_m / self.true_m.max(1e-6) - 1.0) / (ALL_SYMBOL - 1.0)).clamp(0.0, 1.0)
    }

    /// The vertex `part` of the way to another.
    fn toward(&self, to: &Self, part: f64) -> Self {
        let blend = |from: f64, to: f64| from + (to - from) * part;
        Self {
            at: self.at.lerp(to.at, part),
            true_m: blend(self.true_m, to.true_m),
            drawn_m: blend(self.drawn_m, to.drawn_m),
            casing_m: blend(self.casing_m, to.casing_m),
            show: self.show,
            is_mouth: false,
        }
    }
}

/// A part of a symbol.
#[derive(Clone, Copy, PartialEq, Eq)]
enum SymbolPart {
    Casing,
    Fill,
}

/// Whether a line that is coarser than the picture is made a curve.
#[derive(Clone, Copy, PartialEq, Eq)]
enum LineSmoothing {
    None,
    Curves,
}

/// What a camera sees of a line.
#[derive(Default)]
struct SeenLine {
    /// The parts that are too narrow.
    runs: Vec<Vec<SymbolVertex>>,
    /// `None` where it is out of view.
    show: Option<RibbonShow>,
}

/// A point of a centerline on the ground.
#[derive(Clone, Copy)]
struct LinePoint {
    at: DVec3,
    station_m: f64,
    /// Along the line, of length 1.
    along: DVec2,
}

impl LinePoint {
    fn middle(&self, other: &Self, along: DVec2) -> Self {
        Self { at: self.at.midpoint(other.at), station_m: self.station_m.midpoint(other.station_m), along }
    }
}

struct SymbolView<'a> {
    lines: LineView<'a>,
    scale: VerticalScale,
    /// The water that the elevations show, on the lattice.
    water: &'a WaterCover,
}

impl SymbolView<'_> {
    /// Whether the ground under a deck lies beside it on the picture.
    fn shows_apart(&self, deck: &DeckLine) -> bool {
        let is_apart = |step: u32| {
            let station_m = deck.line.length() * f64::from(step) / f64::from(DECK_STEPS);
            let at = deck.line.at(station_m);
            self.lines.ground.displayed_z(at).is_some_and(|ground_z| {
                let rise_m = self.scale.world_z(deck.level.at(station_m)) - ground_z;
                self.lines.scale.rise_px(at.extend(ground_z), rise_m) > APART_PX
            })
        };
        (0..=DECK_STEPS).any(is_apart)
    }

    fn seen(&self, symbol: &LineSymbol, smoothing: LineSmoothing) -> SeenLine {
        let mut seen = SeenLine::default();
        let mut end = None;
        for leg in self.points(&symbol.alignment.line, smoothing).windows(2) {
            self.divide([leg[0], leg[1]], symbol, &mut |part| {
                let Some((part, mouths)) = self.ashore(part, symbol) else { return };
                let mut part = part.map(|point| self.vertex(symbol, &point));
                part.iter_mut().zip(mouths).for_each(|(vertex, is_mouth)| vertex.is_mouth = is_mouth);
                seen.show = seen.show.max(part.iter().map(|vertex| vertex.show).max());
                if part.iter().any(|vertex| vertex.show == RibbonShow::Replaced) {
                    match seen.runs.last_mut().filter(|_| end == Some(part[0].at)) {
                        Some(run) => run.push(part[1]),
                        None => seen.runs.push(part.to_vec()),
                    }
                    end = Some(part[1].at);
                }
            });
        }
        seen
    }

    /// Calls `visit` with the parts of a leg that may be in view, in order, each short against its distance.
    fn divide(&self, leg: [LinePoint; 2], symbol: &LineSymbol, visit: &mut impl FnMut([LinePoint; 2])) {
        let [from, to] = leg;
        let places = leg.map(|point| point.at);
        let nearest_m = self.lines.nearest_m(places);
        let margin_m = MARGIN_PX * self.lines.scale.px * self.lines.scale.meters_per_px_at(nearest_m);
        if !self.lines.may_see(places, margin_m) {
            return;
        }
        let length_m = from.at.distance(to.at);
        if length_m > LONGEST_LEG * nearest_m && length_m > SHORTEST_LEG * symbol.alignment.width.widest_m() {
            let direction = (to.at - from.at).truncate().normalize_or_zero();
            let middle = from.middle(&to, direction);
            let middle = LinePoint { at: middle.at.truncate().extend(self.z_at(middle.at)), ..middle };
            self.divide([from, middle], symbol, visit);
            self.divide([middle, to], symbol, visit);
        } else {
            visit(leg);
        }
    }

    /// The part of a river's leg that is not under water of the elevation model, and which of its ends are mouths; `None`
    /// where all of it is under water, which shows it as what it is.
    fn ashore(&self, leg: [LinePoint; 2], symbol: &LineSymbol) -> Option<([LinePoint; 2], [bool; 2])> {
        if symbol.surface != RibbonSurface::River || self.water.is_water.is_empty() {
            return Some((leg, [false; 2]));
        }
        let is_under =
            |point: &LinePoint| self.water.is_under(self.lines.ground.lattice, point.at.truncate());
        let are_under = [is_under(&leg[0]), is_under(&leg[1])];
        if are_under[0] == are_under[1] {
            return (!are_under[0]).then_some((leg, [false; 2]));
        }
        let (mut dry, mut wet) = if are_under[0] { (leg[1], leg[0]) } else { (leg[0], leg[1]) };
        for _ in 0..SHORE_STEPS {
            let middle = dry.middle(&wet, dry.along);
            *if is_under(&middle) { &mut wet } else { &mut dry } = middle;
        }
        Some(if are_under[0] { ([dry, leg[1]], [true, false]) } else { ([leg[0], dry], [false, true]) })
    }

    fn vertex(&self, symbol: &LineSymbol, point: &LinePoint) -> SymbolVertex {
        let meters_per_px = self.lines.scale.px * self.lines.scale.meters_per_px(point.at, point.along);
        let true_m = symbol.alignment.width.at(point.station_m);
        let growth = symbol.growth_at(point.station_m);
        let whole_m = drawn_width_m(true_m, symbol.least_px * growth.max(1.0), meters_per_px);
        let show = if whole_m > true_m { RibbonShow::Replaced } else { RibbonShow::Shown };
        let shown_m = true_m * symbol.shown_share(point.station_m);
        let drawn_m = (whole_m * growth.min(1.0)).max(shown_m).max(NARROWEST_PX * meters_per_px);
        // Where a symbol begins beside the ribbon that is wide enough, its casing begins with nothing.
        let casing_m = (2.0 * CASING_PX * meters_per_px).min(CASING_RISE * (whole_m - true_m));
        let casing_m = drawn_m + casing_m * cased_share(symbol, growth);
        SymbolVertex { at: point.at.truncate(), true_m, drawn_m, casing_m, show, is_mouth: false }
    }

    fn z_at(&self, at: DVec3) -> f64 {
        self.lines.ground.displayed_z(at.truncate()).unwrap_or(at.z)
    }

    /// The vertices of a line without those that cannot be told from a straight line.
    fn points(&self, line: &Polyline, smoothing: LineSmoothing) -> Vec<LinePoint> {
        let z = f64::from(self.lines.z[0]);
        let on_ground = |&at: &DVec2| at.extend(self.z_at(at.extend(z)));
        let (flat, stations) = match smoothing {
            LineSmoothing::None => (line.points().to_vec(), line.stations().to_vec()),
            LineSmoothing::Curves => self.curve(line),
        };
        let points: Vec<DVec3> = flat.iter().map(on_ground).collect();
        let eye = self.lines.camera.eye().as_dvec3();
        let slack_m = |at: &DVec3| SLACK_PX * self.lines.scale.meters_per_px_at(at.distance(eye));
        let slacks_m: Vec<f64> = points.iter().map(slack_m).collect();
        let off = |from: usize, to: usize, index: usize| {
            segment::distance_squared((flat[from], flat[to]), flat[index]).sqrt() / slacks_m[index]
        };
        let kept = simplified(flat.len(), 1.0, off);
        let direction = |from: usize, to: usize| {
            let way = |place: usize| flat[kept[place]];
            (way(to) - way(from)).normalize_or_zero()
        };
        let last = kept.len() - 1;
        let along = |place: usize| {
            let [before, after] =
                [place.saturating_sub(1), place.min(last - 1)].map(|from| direction(from, from + 1));
            (before + after).try_normalize().unwrap_or(after)
        };
        let point = |(place, &index): (usize, &usize)| LinePoint {
            at: points[index],
            station_m: stations[index],
            along: along(place),
        };
        kept.iter().enumerate().map(point).collect()
    }

    /// A line with curves for the legs that are coarse on the picture, and the stations of its vertices on the line itself.
    fn curve(&self, line: &Polyline) -> (Vec<DVec2>, Vec<f64>) {
        let (points, stations) = (line.points(), line.stations());
        let eye = self.lines.camera.eye().as_dvec3();
        let (mut flat, mut along) = (vec![points[0]], vec![stations[0]]);
        for leg in 0..points.len() - 1 {
            let (from_m, length_m) = (stations[leg], stations[leg + 1] - stations[leg]);
            // No place of the leg is nearer than its middle less half of it.
            let middle = points[leg].midpoint(points[leg + 1]);
            let middle = middle.extend(self.z_at(middle.extend(f64::from(self.lines.z[0]))));
            let depth_m = (middle.distance(eye) - length_m / 2.0).max(length_m);
            let length_px = length_m / self.lines.scale.meters_per_px_at(depth_m);
            if length_px > COARSE_PX {
                let count = (length_px / SMOOTH_PX).ceil().min(MOST_PIECES);
                flat.extend(spline::along_leg(points, leg, count as u32));
                along.extend((1..count as u32).map(|step| from_m + length_m * f64::from(step) / count));
            }
            flat.push(points[leg + 1]);
            along.push(stations[leg + 1]);
        }
        (flat, along)
    }
}

/// The share of its casing that a line has whose least width has grown so.
fn cased_share(symbol: &LineSymbol, growth: f64) -> f64 {
    let [none, all] = CASED_RIVER_PX;
    match symbol.order {
        Some(_) => ((symbol.least_px * growth - none) / (all - none)).clamp(0.0, 1.0),
        None => 1.0,
    }
}

/// The dashes of a line whose width is `least_px` on the picture.
fn dashes(run: &[SymbolVertex], least_px: f64) -> Vec<Vec<SymbolVertex>> {
    let length_px = |from: &SymbolVertex, to: &SymbolVertex| {
        let mean_m_per_px = 0.5 * (from.drawn_m + to.drawn_m) / least_px;
        from.at.distance(to.at) / mean_m_per_px
    };
    line_view::dashes(run, DASH_PX, length_px, SymbolVertex::toward)
}

/// Strokes a part of a symbol along a run of vertices, its ends round; the casing of a mouth is open toward the water.
fn stroke_run(run: &[SymbolVertex], part: SymbolPart, uv: SymbolUv, plan: &mut PlanMesh) {
    let options = StrokeOptions::default();
    let first = plan.vertices.len();
    let Some(line) = Polyline::new(run.iter().map(|vertex| vertex.at), 0.0) else { return };
    let along =
        |of: fn(&SymbolVertex) -> f64| Profile::new(line.stations().to_vec(), run.iter().map(of).collect());
    let (widths, shares) = match part {
        SymbolPart::Casing => (along(|vertex| vertex.casing_m), None),
        SymbolPart::Fill => (along(|vertex| vertex.drawn_m), along(SymbolVertex::symbolic_share)),
    };
    let Some(widths) = widths else { return };
    let points = line.points();
    let last = points.len() - 1;
    for [end, inner] in [[0, 1], [last, last - 1]] {
        if part == SymbolPart::Casing && run[end].is_mouth {
            continue;
        }
        let outward = (points[end] - points[inner]).normalize_or_zero();
        let lengths = line.stations()[end] / options.texture_length_m;
        let middle = plan.vertices.len();
        cap(points[end], outward * widths.values()[end] / 2.0, lengths, plan);
        if uv == SymbolUv::Across {
            plan.vertices[middle].uv.x = 0.5;
        }
    }
    let alignment = Alignment { line, level: None, width: Width::Varying(widths), support: Support::Ground };
    stroke(&StrokePath::alone(&alignment), &options, plan);
    let Some(shares) = shares.filter(|_| uv == SymbolUv::Share) else { return };
    for vertex in &mut plan.vertices[first..] {
        let station_m = f64::from(vertex.uv.y) * options.texture_length_m;
        vertex.uv = Vec2::new(shares.at(station_m) as f32, 0.5);
    }
}

/// Half a disc about a line's end, `lengths` of the texture along it, on the side of `outward`, which is as long as its
/// radius.
pub(super) fn cap(center: DVec2, outward: DVec2, lengths: f64, plan: &mut PlanMesh) {
    let uv = Vec2::new(0.0, lengths as f32);
    let mut vertex = |at: DVec2| plan.vertex(PlanVertex { at, uv });
    let middle = vertex(center);
    let corner = |index: u32| {
        let angle = std::f64::consts::PI * (f64::from(index) / f64::from(CAP_SIDES) - 0.5);
        vertex(center + DVec2::new(libm::cos(angle), libm::sin(angle)).rotate(outward))
    };
    let rim: Vec<_> = (0..=CAP_SIDES).map(corner).collect();
    rim.windows(2).for_each(|pair| plan.triangle([middle, pair[0], pair[1]]));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_and_gaps_keep_their_length_on_the_picture_as_the_line_recedes() {
        // A line on which a pixel grows from one meter to three.
        let vertex = |step: u32| {
            let x = f64::from(step) * 10.0;
            let drawn_m = 1.0 + x / 500.0;
            let at = DVec2::new(x, 0.0);
            SymbolVertex {
                at,
                true_m: 0.5,
                drawn_m,
                casing_m: drawn_m,
                show: RibbonShow::Replaced,
                is_mouth: false,
            }
        };
        let run: Vec<SymbolVertex> = (0..=100).map(vertex).collect();
        let dashes = dashes(&run, 1.0);
        // ∫ dx / (1 + x / 500) from 0 to 1000 is 549 pixels.
        assert_eq!(dashes.len(), (549.3 / (DASH_PX[0] + DASH_PX[1])) as usize + 1);
        for pair in dashes.windows(2) {
            let [from, to, next] = [pair[0][0], pair[0][pair[0].len() - 1], pair[1][0]];
            let px = |a: SymbolVertex, b: SymbolVertex| a.at.distance(b.at) / (0.5 * (a.drawn_m + b.drawn_m));
            assert!((px(from, to) - DASH_PX[0]).abs() < 0.05, "{from:?} {to:?}");
            assert!((px(to, next) - DASH_PX[1]).abs() < 0.05, "{to:?} {next:?}");
        }
    }
}
