//! Tactical graphics for one camera, laid over everything else on the ground.
//!
//! A graphic is drawn for the picture's scale where it lies: its text height is a number of pixels at the mean distance of
//! its points. So a tooth is as large as a letter on every picture, and the same graphic has more of them seen from near.

use rayon::prelude::*;

use glam::DVec2;

use crate::graphic_colors::{graphic_color, ground_color, opposing_color};
use crate::graphic_lines::{DrapedPart, GraphicPen, GraphicView, LINE_PX, LineLook};
use crate::placed_text::{PlacedCourse, PlacedText};
use sandtable_description::words::GraphicStatus;
use sandtable_draw::color::Srgba;
use sandtable_geom::polygon::counter_clockwise;
use sandtable_geom::rect::Rect;
use sandtable_ribbon::area;
use sandtable_scene::scene_graphic::{GraphicStyle, SceneGraphic};
use sandtable_scene::scene_model::SceneModel;
use sandtable_symbology::graphic::drawing::{FillInk, StrokeDash, StrokeSide, TextCourse};
use sandtable_terrain::triangle_surface::TriangleSurface;

/// The smallest part of a graphic's size that its text height is: a graphic of a few pixels is not all teeth.
const SMALLEST: f64 = 1.0 / 8.0;

/// The graphics that a camera sees: casings, lines, and texts.
pub(super) fn draped(
    scene: &SceneModel,
    view: &GraphicView<'_>,
    displayed: &dyn TriangleSurface,
) -> ([Vec<DrapedPart>; 2], Vec<PlacedText>) {
    let drawn = each(scene, view, |pen| pen.draped(displayed));
    let (mut parts, mut texts) = ([Vec::new(), Vec::new()], Vec::new());
    for ([casings, lines], more) in drawn {
        parts[0].extend(casings);
        parts[1].extend(lines);
        texts.extend(more);
    }
    (parts, texts)
}

/// What `finish` makes of each graphic in view, and its texts.
pub(super) fn each<T: Send>(
    scene: &SceneModel,
    view: &GraphicView<'_>,
    finish: impl Fn(GraphicPen) -> T + Sync,
) -> Vec<(T, Vec<PlacedText>)> {
    let finished = |graphic| drawn(graphic, view).map(|(pen, texts)| (finish(pen), texts));
    scene.graphics.par_iter().filter_map(finished).collect()
}

/// The colors that graphics are drawn in.
pub(super) fn colors(scene: &SceneModel) -> impl Iterator<Item = Srgba> {
    scene.graphics.iter().flat_map(|graphic| {
        let tint = graphic.kind.tint;
        let lines = match &graphic.style {
            Some(style) => vec![line_color(graphic), style.fill.unwrap_or(line_color(graphic))],
            None => vec![graphic_color(graphic.side, tint), opposing_color(graphic.side, tint)],
        };
        lines.into_iter().chain(ground_colors(graphic))
    })
}

/// The color of a graphic's lines and texts.
fn line_color(graphic: &SceneGraphic) -> Srgba {
    let style = graphic.style.as_ref();
    let stated = style.and_then(|style| style.stroke.or(style.fill));
    stated.unwrap_or_else(|| graphic_color(graphic.side, graphic.kind.tint))
}

/// The colors of the ground within a graphic, which do not depend on the camera.
fn ground_colors(graphic: &SceneGraphic) -> Vec<Srgba> {
    let size_m = Rect::around(graphic.points.iter().copied()).size().length();
    let drawing = graphic.kind.draw(&graphic.input((size_m * SMALLEST).max(1.0), DVec2::Y));
    let colors = drawing.fills.iter().filter_map(|fill| match fill.ink {
        FillInk::Ground(color) => Some(ground_color(color)),
        _ => None,
    });
    colors.collect()
}

/// One graphic in plan; `None` where all of it is behind the eye.
fn drawn(graphic: &SceneGraphic, view: &GraphicView<'_>) -> Option<(GraphicPen, Vec<PlacedText>)> {
    let em_m = view.em_m(&graphic.points)?;
    let size_m = Rect::around(graphic.points.iter().copied()).size().length();
    let em_m = if size_m > 0.0 { em_m.min(size_m * SMALLEST) } else { em_m };
    let drawing = graphic.kind.draw(&graphic.input(em_m, view.up(graphic.points[0])));
    let own = line_color(graphic);
    let other = opposing_color(graphic.side, graphic.kind.tint);
    let mut pen = GraphicPen::default();
    if let Some(style) = &graphic.style {
        draw_plain(graphic, style, view, &mut pen);
    }
    let strokes = if graphic.style.is_some() { &[] } else { &drawing.strokes[..] };
    for stroke in strokes {
        let color = match stroke.side {
            StrokeSide::Own => own,
            StrokeSide::Opposing => other,
        };
        let is_dashed = match stroke.dash {
            StrokeDash::Status => graphic.status == GraphicStatus::Planned,
            StrokeDash::Dashed => true,
            StrokeDash::Hatch => false,
        };
        view.draw(
            &mut pen,
            &stroke.points,
            LineLook { color, is_dashed, width_px: LINE_PX },
            graphic.feature,
        );
    }
    for fill in &drawing.fills {
        let plan = match fill.ink {
            FillInk::Own => pen.plan(own, graphic.feature),
            FillInk::Opposing => pen.plan(other, graphic.feature),
            FillInk::Ground(color) => pen.ground(ground_color(color), graphic.feature),
        };
        area::fill(&counter_clockwise(&fill.ring), &[], 1.0, plan);
    }
    let texts = drawing
        .texts
        .into_iter()
        .map(|text| PlacedText {
            at: view.on_ground(text.at),
            toward: view.on_ground(text.at + text.toward * em_m),
            course: match &text.course {
                TextCourse::Level => PlacedCourse::Level,
                TextCourse::Ends(line) => PlacedCourse::Ends(view.pieces(line)),
                TextCourse::Once(line) => PlacedCourse::Once(view.pieces(line)),
                TextCourse::Repeated(line) => PlacedCourse::Repeated(view.pieces(line)),
            },
            text: text.text,
            color: own,
            feature: graphic.feature,
            is_repeat: text.is_repeat,
        })
        .collect();
    Some((pen, texts))
}

/// Draws an overlay's line, area or point in the style of its file.
fn draw_plain(graphic: &SceneGraphic, style: &GraphicStyle, view: &GraphicView<'_>, pen: &mut GraphicPen) {
    if let Some(fill) = style.fill {
        let holes: Vec<Vec<DVec2>> = style.holes.iter().map(|hole| counter_clockwise(hole)).collect();
        area::fill(&counter_clockwise(&graphic.points), &holes, 1.0, pen.plan(fill, graphic.feature));
    }
    let Some(color) = style.stroke.filter(|_| graphic.points.len() > 1) else { return };
    let look = LineLook { color, is_dashed: style.is_dashed, width_px: style.width_px };
    let rings = style.holes.iter().map(Vec::as_slice);
    for ring in [graphic.points.as_slice()].into_iter().chain(rings) {
        let mut points = ring.to_vec();
        if graphic.kind.is_area() {
            points.extend(ring.first().copied());
        }
        view.draw(pen, &points, look, graphic.feature);
    }
}
