//! The texts of tactical graphics, projected to the picture.

use glam::{Vec2, Vec3};

use crate::line_labels::{is_seen, visible_pieces};
use sandtable_annotate::annotation::{LineLabel, LinePlacement, OverlayText};
use sandtable_description::words::LabelKind;
use sandtable_picture::placed_text::{PlacedCourse, PlacedText};
use sandtable_render::picture::Rendering;
use sandtable_view::camera::Camera;

/// Half of the width of a graphic's line with its casing, in pixels of a picture 1080 lines high.
const HALF_LINE_PX: f32 = 2.4;

/// The rank of texts of graphics: before names of the ground.
const RANK: f64 = -1.0;

/// Texts at their places, and texts along lines.
pub struct GraphicTexts {
    /// At their places.
    pub fixed: Vec<OverlayText>,
    /// Along lines.
    pub along: Vec<LineLabel>,
}

/// The texts of graphics on a picture.
pub fn graphic_texts(texts: &[PlacedText], camera: &Camera, picture: &Rendering) -> GraphicTexts {
    let mut found = GraphicTexts { fixed: Vec::new(), along: Vec::new() };
    for text in texts {
        let (line, placement) = match &text.course {
            PlacedCourse::Level => {
                found.fixed.extend(fixed(text, camera, picture));
                continue;
            }
            PlacedCourse::Ends(line) => (line, LinePlacement::Ends),
            PlacedCourse::Once(line) => (line, LinePlacement::Once),
            PlacedCourse::Repeated(line) => (line, LinePlacement::Repeated),
        };
        found.along.push(along(text, line, placement, camera, picture));
    }
    found
}

fn fixed(text: &PlacedText, camera: &Camera, picture: &Rendering) -> Option<OverlayText> {
    let at = camera.project(text.at)?;
    let toward = camera.project(text.toward).map_or(at.pixel, |toward| toward.pixel);
    Some(OverlayText {
        text: text.text.clone(),
        at_px: at.pixel,
        toward_px: toward - at.pixel,
        ink: Some(text.color),
        visible: is_seen(picture, at.pixel, at.depth_m),
    })
}

fn along(
    text: &PlacedText,
    line: &[Vec<Vec3>],
    placement: LinePlacement,
    camera: &Camera,
    picture: &Rendering,
) -> LineLabel {
    let path_px: Vec<Vec<Vec2>> =
        line.iter().flat_map(|piece| visible_pieces(piece, camera, picture)).collect();
    LineLabel {
        text: text.text.replace('\n', "  "),
        path_px,
        half_width_px: HALF_LINE_PX * picture.pixels.height() as f32 / 1080.0,
        placement,
        kind: LabelKind::Point,
        ink: Some(text.color),
        rank: RANK,
        size: 1.0,
        shield: None,
        fallback: None,
    }
}
