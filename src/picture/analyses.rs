//! Analyses on a picture: tints of their classes with hatching, and their points, lines and areas.

use glam::{DVec2, UVec2};

use crate::analysis_look::{feature_color, hatch_color, is_print, is_seen, printed, property};
use crate::class_hatching::HatchedRaster;
use crate::graphic_lines::{GraphicPen, GraphicView, LineLook, LineOrder};
use crate::placed_text::{PlacedCourse, PlacedText};
use crate::post_tint::{PostTint, TintPlan};
use crate::sight::{circle, level_text};
use sandtable_analysis::outcome::{FeatureRole, Hatching, OutcomeFeature, OutcomeShape, PropertyValue};
use sandtable_draw::color::Srgba;
use sandtable_geom::azimuth::heading;
use sandtable_geom::polygon::counter_clockwise;
use sandtable_ribbon::area;
use sandtable_scene::analyses::SceneAnalysis;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::seen_ground::PostFrame;

/// The radius of marks of places in text heights.
const MARK_EM: f64 = 0.5;

/// How far from the border of the ground lines end, in text heights: farther than they are wide.
const INSIDE_EM: f64 = 0.3;

/// How far below its place a name begins in text heights: the mark stays free.
const NAME_EM: f64 = 0.8;

/// The width of an avenue's line, in pixels of a picture 1080 lines high.
const AVENUE_PX: f64 = 5.0;

/// The half width and the length of an avenue's head in text heights; those of thinner lines are smaller.
const HEAD_EM: [f64; 2] = [0.9, 1.7];

/// The share of light that the fill of a site stops, of 255.
const SITE_ALPHA: u8 = 70;

/// The tints of analyses, in drawing order; they are the same for every camera.
pub(super) fn tints(scene: &SceneModel) -> Vec<TintPlan> {
    scene.analyses.iter().filter_map(|analysis| tint(analysis, scene)).collect()
}

/// The tint of an analysis of the scene's land; `None` where it has none.
pub(super) fn tint(analysis: &SceneAnalysis, scene: &SceneModel) -> Option<TintPlan> {
    let raster = analysis.tinted_raster()?;
    let (classes, lattice) = (&raster.classes, &*analysis.ground);
    if is_print(scene) && classes.iter().any(|class| class.look.hatching != Hatching::None) {
        return None;
    }
    let colors: Vec<Option<Srgba>> = classes
        .iter()
        .map(|class| Some(Srgba(class.look.tint)).filter(|Srgba([.., alpha])| *alpha > 0))
        .collect();
    let numbers = raster.class_numbers();
    let color = |index: usize| colors.get(usize::from(numbers[index])).copied().flatten();
    let tint = PostTint {
        size: UVec2::new(lattice.columns(), lattice.rows()),
        frame: &PostFrame::of(lattice),
        origin: scene.lattice.origin(),
        beside: colors.iter().flatten().next().copied().unwrap_or(Srgba::WHITE),
        feature: analysis.feature,
    };
    tint.plan(|index| color(index).is_some(), color)
}

/// The colors of all that [`draw`] draws of an analysis.
pub(super) fn colors(analysis: &SceneAnalysis, scene: &SceneModel) -> Vec<Srgba> {
    let classes = analysis.hatched_raster().into_iter().flat_map(|raster| &raster.classes);
    let of_classes = classes.map(|class| printed(scene, hatch_color(class.look.tint)));
    let of_features =
        analysis.shown_features().iter().map(|feature| printed(scene, feature_color(analysis, feature)));
    of_classes.chain(of_features.flat_map(|color| [color, site_fill(color)])).collect()
}

/// The fill of a site with lines of this color.
fn site_fill(Srgba([red, green, blue, _]): Srgba) -> Srgba {
    Srgba([red, green, blue, SITE_ALPHA])
}

/// Draws the hatching and the features of the scene's analyses, and of one that is tried, and notes their texts.
pub(super) fn draw(
    (scene, tried): (&SceneModel, Option<&SceneAnalysis>),
    view: &GraphicView<'_>,
    pen: &mut GraphicPen,
    texts: &mut Vec<PlacedText>,
) {
    for analysis in scene.analyses.iter().chain(tried) {
        if let Some(raster) = analysis.hatched_raster() {
            HatchedRaster { raster, analysis, scene }.draw(view, pen);
        }
        let drawing = FeatureDrawing { analysis, view, scene, origin: scene.lattice.origin() };
        for feature in analysis.shown_features() {
            pen.set_order(order(feature));
            drawing.draw(feature, pen, texts);
        }
        pen.set_order(LineOrder::default());
    }
}

/// The features of an analysis on a picture.
struct FeatureDrawing<'a> {
    analysis: &'a SceneAnalysis,
    view: &'a GraphicView<'a>,
    scene: &'a SceneModel,
    /// The map coordinates of world X and Y 0.
    origin: DVec2,
}

impl FeatureDrawing<'_> {
    fn draw(&self, feature: &OutcomeFeature, pen: &mut GraphicPen, texts: &mut Vec<PlacedText>) {
        let color = printed(self.scene, feature_color(self.analysis, feature));
        let is_dashed = feature.role == FeatureRole::Link && !is_seen(feature);
        let look = LineLook { color, is_dashed, width_px: width_px(feature) };
        match &feature.shape {
            OutcomeShape::Point(at) => self.draw_point(feature, *at - self.origin, look, pen, texts),
            OutcomeShape::Line(line) => {
                let line: Vec<DVec2> = line.iter().map(|at| *at - self.origin).collect();
                self.draw_line(feature, &line, look, pen, texts);
            }
            OutcomeShape::Area(rings) => {
                let rings: Vec<Vec<DVec2>> =
                    rings.iter().map(|ring| ring.iter().map(|at| *at - self.origin).collect()).collect();
                self.draw_area(feature, &rings, look, pen, texts);
            }
        }
    }

    fn stroke(&self, line: &[DVec2], look: LineLook, pen: &mut GraphicPen) {
        let line: Vec<DVec2> = line.iter().map(|&at| self.inside(at)).collect();
        self.view.draw(pen, &line, look, self.analysis.feature);
    }

    /// A place so far within the border of the ground that a line there lies on it.
    fn inside(&self, at: DVec2) -> DVec2 {
        let extent = self.scene.lattice.extent();
        let inset_m = (INSIDE_EM * self.view.em_at(at)).min(extent.size().min_element() / 4.0);
        at.clamp(extent.min + inset_m, extent.max - inset_m)
    }

    fn draw_point(
        &self,
        feature: &OutcomeFeature,
        at: DVec2,
        look: LineLook,
        pen: &mut GraphicPen,
        texts: &mut Vec<PlacedText>,
    ) {
        let Some(em_m) = self.view.em_m(&[at]) else { return };
        let radius_m = MARK_EM * em_m;
        if feature.role == FeatureRole::Post {
            let up_deg = self.view.up_azimuth_deg(at);
            let corner = |turn: u32| at + heading(up_deg + 120.0 * f64::from(turn)) * radius_m * 1.4;
            self.stroke(&[0, 1, 2, 3].map(corner), look, pen);
            area::fill(&[2, 1, 0].map(corner), &[], 1.0, pen.plan(look.color, self.analysis.feature));
        } else {
            self.stroke(&circle(at, radius_m), look, pen);
        }
        self.name_beside(feature, at, look.color, texts);
    }

    fn draw_line(
        &self,
        feature: &OutcomeFeature,
        line: &[DVec2],
        look: LineLook,
        pen: &mut GraphicPen,
        texts: &mut Vec<PlacedText>,
    ) {
        self.stroke(line, look, pen);
        if let FeatureRole::Corridor | FeatureRole::Haul = feature.role {
            self.draw_head(line, look, pen);
        }
        let middle = line[line.len() / 2];
        let name = match feature.role {
            FeatureRole::Route => &self.analysis.name,
            FeatureRole::Isoline | FeatureRole::Stream | FeatureRole::FormLine | FeatureRole::Link => {
                &feature.name
            }
            _ => return self.name_beside(feature, middle, look.color, texts),
        };
        if !name.is_empty() {
            let text = level_text(self.view, middle, name.clone(), look.color, self.analysis.feature);
            texts.push(PlacedText { course: PlacedCourse::Once(self.view.pieces(line)), ..text });
        }
    }

    /// The head of an avenue, at its end.
    fn draw_head(&self, line: &[DVec2], look: LineLook, pen: &mut GraphicPen) {
        let Some((&tip, before)) = line.split_last() else { return };
        let Some(em_m) = self.view.em_m(&[tip]) else { return };
        let [half_m, length_m] = HEAD_EM.map(|em| em * em_m * (look.width_px / AVENUE_PX));
        let from = before.iter().rev().find(|at| at.distance(tip) >= length_m).or(line.first());
        let Some(along) = from.and_then(|from| (tip - *from).try_normalize()) else { return };
        let (tip, base) = (tip + along * (length_m * 0.5), tip - along * (length_m * 0.5));
        let ring = [tip, base + along.perp() * half_m, base - along.perp() * half_m];
        let ring = ring.map(|at| self.inside(at));
        area::fill(&ring, &[], 1.0, pen.plan(look.color, self.analysis.feature));
    }

    fn draw_area(
        &self,
        feature: &OutcomeFeature,
        rings: &[Vec<DVec2>],
        look: LineLook,
        pen: &mut GraphicPen,
        texts: &mut Vec<PlacedText>,
    ) {
        let Some((outer, holes)) = rings.split_first().filter(|(outer, _)| outer.len() > 2) else { return };
        if feature.role == FeatureRole::Site {
            let turned = |ring: &Vec<DVec2>| -> Vec<DVec2> {
                counter_clockwise(ring).into_iter().map(|at| self.inside(at)).collect()
            };
            let holes: Vec<Vec<DVec2>> = holes.iter().map(turned).collect();
            let fill = site_fill(look.color);
            area::fill(&turned(outer), &holes, 1.0, pen.ground(fill, self.analysis.feature));
        }
        for ring in rings.iter().filter(|ring| ring.len() > 1) {
            let closed: Vec<DVec2> = ring.iter().chain(ring.first()).copied().collect();
            self.stroke(&closed, look, pen);
        }
        let middle = outer.iter().sum::<DVec2>() / outer.len() as f64;
        if feature.role != FeatureRole::Site {
            if !feature.name.is_empty() {
                texts.push(self.text(feature, middle, look.color));
            }
            return;
        }
        // A site that is smaller than its mark on the picture has the mark.
        let em_m = self.view.em_at(middle);
        if middle.distance(outer[0]) < MARK_EM * em_m {
            self.stroke(&circle(middle, MARK_EM * em_m), look, pen);
        }
        let down = heading(self.view.up_azimuth_deg(middle)) * -em_m;
        let south = outer.iter().map(|at| (*at - middle).dot(down.normalize_or_zero())).fold(0.0, f64::max);
        let below = middle + down.normalize_or_zero() * (south - MARK_EM * em_m).max(0.0);
        self.name_beside(feature, below, look.color, texts);
    }

    fn text(&self, feature: &OutcomeFeature, at: DVec2, color: Srgba) -> PlacedText {
        level_text(self.view, at, feature.name.clone(), color, self.analysis.feature)
    }

    /// The name of a feature below its place.
    fn name_beside(&self, feature: &OutcomeFeature, at: DVec2, color: Srgba, texts: &mut Vec<PlacedText>) {
        if feature.name.is_empty() {
            return;
        }
        let down = heading(self.view.up_azimuth_deg(at)) * -self.view.em_at(at);
        let (at, toward) = (at + down * NAME_EM, self.view.on_ground(at + down * 2.0));
        texts.push(PlacedText { toward, ..self.text(feature, at, color) });
    }
}

/// Links lie under the posts that they join, and under all else that has a place of its own.
fn order(feature: &OutcomeFeature) -> LineOrder {
    if feature.role == FeatureRole::Link { LineOrder::Under } else { LineOrder::default() }
}

/// The width of a feature's lines, in pixels of a picture 1080 lines high.
fn width_px(feature: &OutcomeFeature) -> f64 {
    match feature.role {
        FeatureRole::Place | FeatureRole::Post => 2.4,
        FeatureRole::Route => 4.2,
        FeatureRole::Corridor => AVENUE_PX,
        FeatureRole::Haul => 2.4,
        FeatureRole::Isoline => match property(feature, "is_index") {
            Some(PropertyValue::Truth(true)) => 2.2,
            _ => 1.2,
        },
        FeatureRole::Stream => match property(feature, "order") {
            Some(PropertyValue::Whole(order)) => 1.0 + 0.7 * (*order).clamp(1, 8) as f64,
            _ => 1.7,
        },
        FeatureRole::FormLine => 2.8,
        FeatureRole::Site | FeatureRole::Outline => 2.2,
        FeatureRole::Link => 2.6,
    }
}
