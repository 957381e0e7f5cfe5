//! Layers of sight on a picture: tints of seen and hidden ground, lines of sight, ranges.

use std::f64::consts::TAU;

use glam::{DVec2, UVec2, Vec2};

use crate::graphic_colors::{self, HIDDEN, SEEN, side_color};
use crate::graphic_lines::{GraphicPen, GraphicView, LINE_PX, LineLook};
use crate::placed_text::{PlacedCourse, PlacedText};
use crate::post_tint::{PostTint, TintPlan};
use sandtable_description::words::{RangeExtent, ViewshedTint};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;
use sandtable_geom::azimuth::heading;
use sandtable_mesh::sink::MeshSink;
use sandtable_ribbon::plan::{PlanMesh, PlanVertex};
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::seen_ground::{PostFrame, SceneSight, SceneViewshed, SeenPosts, SightedLine};
use sandtable_scene::sight_layers::SceneRange;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::sight::line::SightEnd;
use sandtable_terrain::sight::viewshed::{PostVisibility, Viewshed};

/// Lines of sight to seen and to hidden ground.
const SEEN_LINE: LineLook =
    LineLook { color: graphic_colors::SEEN_LINE, is_dashed: false, width_px: LINE_PX };
const HIDDEN_LINE: LineLook =
    LineLook { color: graphic_colors::HIDDEN_LINE, is_dashed: false, width_px: LINE_PX };

/// The marks of observers.
const OBSERVER_LINE: LineLook =
    LineLook { color: Srgba::opaque(10, 10, 10), is_dashed: false, width_px: LINE_PX };

/// The share of light that the fill of a range stops.
const FILL_ALPHA: u8 = 84;

/// The radius of the ring about a target and an observer, in text heights.
const MARK_EM: f64 = 0.6;

/// The tints of seen and hidden ground and of ranges, in drawing order; they are the same for every camera.
pub(super) fn tints(scene: &SceneModel) -> Vec<TintPlan> {
    let (layers, lattice) = (&scene.sight, &*scene.lattice);
    let of_viewsheds = layers.viewsheds.iter().filter_map(|layer| {
        let colors = match layer.tint {
            ViewshedTint::Both => [Some(SEEN), Some(HIDDEN)],
            ViewshedTint::Seen => [Some(SEEN), None],
            ViewshedTint::Hidden => [None, Some(HIDDEN)],
        };
        viewshed_tint(layer, lattice, colors)
    });
    let of_ranges = layers.ranges.iter().filter_map(|range| {
        let Srgba([red, green, blue, _]) = side_color(range.side);
        let fill = Srgba([red, green, blue, FILL_ALPHA]);
        match range.fill {
            RangeExtent::Seen => viewshed_tint(&range.sight, lattice, [Some(fill), None]),
            RangeExtent::All => Some(TintPlan {
                plan: sector_plan(range),
                color: fill,
                texture: None,
                feature: range.feature,
            }),
            _ => None,
        }
    });
    of_viewsheds.chain(of_ranges).collect()
}

/// The colors of the lines of sight and of ranges.
pub(super) fn line_colors(scene: &SceneModel) -> impl Iterator<Item = Srgba> {
    let ranges = scene.sight.ranges.iter().map(|range| side_color(range.side));
    [SEEN_LINE, HIDDEN_LINE, OBSERVER_LINE].map(|look| look.color).into_iter().chain(ranges)
}

/// Draws the lines of sight and of ranges and notes their texts.
pub(super) fn draw(
    scene: &SceneModel,
    view: &GraphicView<'_>,
    pen: &mut GraphicPen,
    texts: &mut Vec<PlacedText>,
) {
    let layers = &scene.sight;
    layers.ranges.iter().for_each(|range| draw_range(range, scene, view, pen, texts));
    layers.sights.iter().for_each(|sight| draw_sight(sight, scene, view, pen));
    for layer in &layers.viewsheds {
        for observer in &layer.observers {
            mark_observer(observer.observer, scene, view, layer.feature, pen);
        }
    }
}

/// The tint of the seen and the hidden posts of a viewshed over `lattice`; `None` where nobody looked.
pub(super) fn seen_tint(seen: &Viewshed, lattice: &Lattice) -> Option<TintPlan> {
    let place = (&PostFrame::of(lattice), lattice.origin());
    posts_tint(seen, place, [Some(SEEN), Some(HIDDEN)], FeatureId::GROUND)
}

fn viewshed_tint(layer: &SceneViewshed, lattice: &Lattice, colors: [Option<Srgba>; 2]) -> Option<TintPlan> {
    let SeenPosts { viewshed, frame } = layer.seen(lattice)?;
    posts_tint(viewshed, (frame, lattice.origin()), colors, layer.feature)
}

/// The seen and the hidden posts in two colors; `None` where nobody looked.
fn posts_tint(
    seen: &Viewshed,
    (frame, origin): (&PostFrame, DVec2),
    colors: [Option<Srgba>; 2],
    feature: FeatureId,
) -> Option<TintPlan> {
    let rows = seen.posts.len() as u32 / seen.columns;
    let beside = colors.into_iter().flatten().next().unwrap_or(Srgba::WHITE);
    let tint = PostTint { size: UVec2::new(seen.columns, rows), frame, origin, beside, feature };
    // Only the posts that somebody looked at.
    let is_looked_at =
        |index: usize| matches!(seen.posts[index], PostVisibility::Visible | PostVisibility::Hidden);
    tint.plan(is_looked_at, |index| match seen.posts[index] {
        PostVisibility::Visible => colors[0],
        PostVisibility::Hidden => colors[1],
        PostVisibility::Beyond | PostVisibility::NoData => None,
    })
}

/// The sector as a fan of triangles.
fn sector_plan(range: &SceneRange) -> PlanMesh {
    let mut plan = PlanMesh::default();
    let Some(&radius_m) = range.distances_m.last() else { return plan };
    let center = plan.vertex(PlanVertex { at: range.at, uv: Vec2::ZERO });
    let rim: Vec<_> =
        range.ring(radius_m).into_iter().map(|at| plan.vertex(PlanVertex { at, uv: Vec2::ZERO })).collect();
    // Azimuths turn clockwise.
    rim.windows(2).for_each(|pair| plan.triangle([center, pair[1], pair[0]]));
    plan
}

/// Rings and sides of a range; where sight counts, dashed where the ground there is hidden.
fn draw_range(
    range: &SceneRange,
    scene: &SceneModel,
    view: &GraphicView<'_>,
    pen: &mut GraphicPen,
    texts: &mut Vec<PlacedText>,
) {
    let color = side_color(range.side);
    let azimuths = range.azimuths_deg();
    let is_sector = range.sector.width_deg < 360.0;
    let middle = azimuths[azimuths.len() / 2];
    for (&radius_m, pieces) in range.distances_m.iter().zip(&*range.pieces_seen(&scene.lattice)) {
        let places = range.ring(radius_m);
        let mut piece: Vec<DVec2> = vec![places[0]];
        let mut was_seen = None;
        for (pair, &seen) in places.windows(2).zip(pieces) {
            if was_seen.is_some_and(|was| was != seen) {
                view.draw(
                    pen,
                    &piece,
                    LineLook { color, is_dashed: was_seen == Some(false), width_px: LINE_PX },
                    range.feature,
                );
                piece = vec![pair[0]];
            }
            piece.push(pair[1]);
            was_seen = Some(seen);
        }
        view.draw(
            pen,
            &piece,
            LineLook { color, is_dashed: was_seen == Some(false), width_px: LINE_PX },
            range.feature,
        );
        let text = distance_text(radius_m);
        let azimuth = if is_sector { middle } else { view.up_azimuth_deg(range.at) };
        texts.push(level_text(view, range.at + heading(azimuth) * radius_m, text, color, range.feature));
    }
    if let (true, Some(&farthest_m)) = (is_sector, range.distances_m.last()) {
        for side in [range.sector.from_deg, range.sector.from_deg + range.sector.width_deg] {
            let side = [range.at, range.at + heading(side) * farthest_m];
            view.draw(pen, &side, LineLook { color, is_dashed: false, width_px: LINE_PX }, range.feature);
        }
    }
    let mark = circle(range.at, MARK_EM * view.em_at(range.at));
    view.draw(pen, &mark, LineLook { color, is_dashed: false, width_px: LINE_PX }, range.feature);
    if !range.name.is_empty() {
        let mut name = level_text(view, range.at, range.name.clone(), color, range.feature);
        name.toward =
            view.on_ground(range.at - heading(view.up_azimuth_deg(range.at)) * view.em_at(range.at));
        texts.push(name);
    }
}

pub(super) fn level_text(
    view: &GraphicView<'_>,
    at: DVec2,
    text: String,
    color: Srgba,
    feature: FeatureId,
) -> PlacedText {
    let at = view.on_ground(at);
    PlacedText { text, at, toward: at, course: PlacedCourse::Level, color, feature, is_repeat: false }
}

fn distance_text(radius_m: f64) -> String {
    if radius_m >= 1000.0 {
        format!("{} km", (radius_m / 10.0).round() / 100.0)
    } else {
        format!("{radius_m:.0} m")
    }
}

/// Lines of sight: green over ground that is seen, red over hidden ground; each target ringed by whether it is seen itself.
fn draw_sight(sight: &SceneSight, scene: &SceneModel, view: &GraphicView<'_>, pen: &mut GraphicPen) {
    let (origin, observer) = (scene.lattice.origin(), sight.observer);
    for (target, line) in sight.targets.iter().zip(&*sight.lines(&scene.lattice)) {
        let Some(SightedLine { stretches, is_clear }) = line else { return };
        let length_m = observer.at.distance(target.at);
        let at = |station_m: f64| observer.at.lerp(target.at, station_m / length_m) - origin;
        let mut from_m = 0.0;
        for stretch in stretches {
            if stretch.from_m > from_m {
                view.draw(pen, &[at(from_m), at(stretch.from_m)], HIDDEN_LINE, sight.feature);
            }
            view.draw(pen, &[at(stretch.from_m), at(stretch.to_m)], SEEN_LINE, sight.feature);
            from_m = stretch.to_m;
        }
        if from_m < length_m {
            view.draw(pen, &[at(from_m), at(length_m)], HIDDEN_LINE, sight.feature);
        }
        let look = if *is_clear { SEEN_LINE } else { HIDDEN_LINE };
        let place = target.at - origin;
        view.draw(pen, &circle(place, MARK_EM * view.em_at(place)), look, sight.feature);
    }
    mark_observer(observer, scene, view, sight.feature, pen);
}

/// The mark of an observer: a triangle about the place.
fn mark_observer(
    observer: SightEnd,
    scene: &SceneModel,
    view: &GraphicView<'_>,
    feature: FeatureId,
    pen: &mut GraphicPen,
) {
    let at = observer.at - scene.lattice.origin();
    let radius_m = 1.3 * MARK_EM * view.em_at(at);
    let up_deg = view.up_azimuth_deg(at);
    let corner = |turn: u32| at + heading(up_deg + 120.0 * f64::from(turn)) * radius_m;
    view.draw(pen, &[0, 1, 2, 3].map(corner), OBSERVER_LINE, feature);
}

pub(super) fn circle(center: DVec2, radius_m: f64) -> Vec<DVec2> {
    let corner = |step: u32| {
        let angle = TAU * f64::from(step) / 24.0;
        center + DVec2::new(libm::cos(angle), libm::sin(angle)) * radius_m
    };
    (0..=24).map(corner).collect()
}
