//! Makes the annotations of a picture from its scene and camera.

use crate::contour_marks::contour_marks;
use crate::graphic_texts::{GraphicTexts, graphic_texts};
use crate::grid::{grid_over, picture_grid};
use crate::legend::legend_entries;
use crate::legend_overlay::overlay_entries;
use crate::legend_symbols::symbol_entries;
use crate::line_labels::{is_seen, line_label};
use crate::margin::margin_notes;
use crate::military::picture_symbols;
use crate::picture_middle::{ground_in_middle, north_arrow};
use crate::rim::rim_marks;
use crate::rock_hachures::rock_strokes;
use sandtable_annotate::annotation::{Annotations, PictureLabel};
use sandtable_annotate::cover::SceneCover;
use sandtable_annotate::legend::Legend;
use sandtable_annotate::scale_bar::ScaleBar;
use sandtable_annotate::sheet_frame::SheetFrame;
use sandtable_description::words::SheetLayout;
use sandtable_draw::bathymetry::with_bathymetry;
use sandtable_draw::list::{DrawList, FeatureId};
use sandtable_picture::nested_ground::NestedHeights;
use sandtable_picture::placed_text::PlacedText;
use sandtable_render::picture::Rendering;
use sandtable_scene::label_course::LabelCourse;
use sandtable_scene::scene_label::SceneLabel;
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::Camera;

/// The data of a picture that its scene alone does not have.
pub struct AnnotatedGround<'a> {
    /// The texts of tactical graphics.
    pub graphics: &'a [PlacedText],
    /// The heights of its nested grounds.
    pub nested: &'a NestedHeights,
    /// What was drawn; without it contour lines have no numbers.
    pub list: Option<&'a DrawList>,
}

/// The annotations of a picture: labels with their positions on it, and furniture, round it where `frame` says so.
pub fn annotations(
    scene: &SceneModel,
    camera: &Camera,
    picture: &Rendering,
    frame: Option<&SheetFrame>,
    shown: &AnnotatedGround<'_>,
) -> Annotations {
    let nested = shown.nested;
    let furniture = &scene.furniture;
    let is_bare = is_bare(scene);
    let shows = |is_wanted: bool| is_wanted && !is_bare;
    let has_classes = shows(furniture.classes.unwrap_or(frame.is_some()));
    let grid = grid_over(scene, camera, picture);
    let (mut labels, mut line_labels) = (Vec::new(), Vec::new());
    let lifted: Vec<SceneLabel> =
        scene.labels.iter().map(|label| nested.lifted_label(scene, label)).collect();
    for label in &lifted {
        let at_place = project(label, camera, picture);
        match label.course {
            LabelCourse::Place => labels.extend(at_place),
            _ => line_labels.extend(line_label(label, at_place, camera, picture)),
        }
    }
    let GraphicTexts { fixed, along } = graphic_texts(shown.graphics, camera, picture);
    line_labels.extend(along);
    Annotations {
        labels,
        line_labels,
        rock: shown.list.map(|list| rock_strokes(scene, list, camera, picture)).unwrap_or_default(),
        contours: shown.list.and_then(|list| contour_marks(scene, list, camera, picture)),
        fixed_texts: fixed,
        font: scene.font.clone(),
        symbols: picture_symbols(scene, nested, camera, picture),
        rim: rim_marks(scene, nested, camera, grid.as_ref()),
        margin: frame.map(|frame| {
            let note = grid.as_ref().map(|grid| grid.note.as_str());
            margin_notes(scene, camera, (frame, ground_in_middle(scene, camera, picture)), note)
        }),
        grid: grid.map(|grid| picture_grid(&grid, scene, nested, camera, picture)),
        title: scene.title.clone().filter(|_| shows(furniture.title)),
        subtitle: scene.subtitle.clone().filter(|_| shows(furniture.title)),
        north: shows(furniture.north_arrow).then(|| north_arrow(scene, camera, picture)),
        scale_bar: if shows(furniture.scale_bar) { scale_bar(camera, picture) } else { None },
        legend: (shows(furniture.legend) && !is_all_imagery(scene)).then(|| legend(scene)),
        classes: if has_classes {
            let over_ground = [overlay_entries(scene, picture), symbol_entries(scene, camera, picture)];
            legend_entries(scene, picture).into_iter().chain(over_ground.into_iter().flatten()).collect()
        } else {
            Vec::new()
        },
        cover: Some(cover(picture)),
        ..Annotations::default()
    }
}

/// Whether a picture of the ground hides all colors by height, so that a legend of them would say nothing.
fn is_all_imagery(scene: &SceneModel) -> bool {
    let (min, max) = scene.bounds;
    scene.imagery.as_ref().is_some_and(|imagery| imagery.covers(min.truncate(), max.truncate()))
}

/// Whether a picture has nothing but labels and the grid.
pub(crate) fn is_bare(scene: &SceneModel) -> bool {
    scene.furniture.layout == SheetLayout::None
}

/// Where the picture shows the scene and not its background.
pub(crate) fn cover(picture: &Rendering) -> SceneCover {
    let (width, height) = (picture.pixels.width(), picture.pixels.height());
    SceneCover::new(width, height, |x, y| picture.features[(y * width + x) as usize] != FeatureId::NONE)
}

fn project(label: &SceneLabel, camera: &Camera, picture: &Rendering) -> Option<PictureLabel> {
    let ground = camera.project(label.ground)?;
    let top = camera.project(label.anchor)?;
    Some(PictureLabel {
        text: label.text.clone(),
        anchor_px: ground.pixel,
        top_px: (label.anchor != label.ground).then_some(top.pixel),
        depth_m: ground.depth_m,
        visible: is_seen(picture, ground.pixel, ground.depth_m) || is_seen(picture, top.pixel, top.depth_m),
        kind: label.kind,
        rank: label.rank,
        size: label.size,
    })
}

/// The scale bar of a map's scale or, in perspective, for the distance of the ground at the picture's center, or at the first pixel with ground below it.
fn scale_bar(camera: &Camera, picture: &Rendering) -> Option<ScaleBar> {
    if let Some(bar) = ScaleBar::of_map(camera) {
        return Some(bar);
    }
    let (width, height) = (picture.pixels.width() as usize, picture.pixels.height() as usize);
    let middle = (height / 2..height).map(|row| picture.depth_m[row * width + width / 2]);
    let distance_m = middle.into_iter().find(|depth| depth.is_finite())?;
    Some(ScaleBar::at_distance(camera, distance_m))
}

fn legend(scene: &SceneModel) -> Legend {
    let (low_m, high_m) = scene.height_range_m;
    let datum = scene.heights.snapshot().source_header().vertical_datum.clone();
    Legend {
        ramp: scene.shore_m().map_or_else(|| scene.ramp(), |shore_m| with_bathymetry(&scene.ramp(), shore_m)),
        low_m,
        high_m,
        vertical_exaggeration: scene.scale.0,
        model_enlargement: enlargement(scene),
        has_inferred_cover: scene.cover().is_some(),
        has_voids: scene.has_voids(),
        contour_interval: scene.contours.map(|contours| contours.interval_m),
        vertical_datum: datum.map(|name| format!("Heights: {name}")),
    }
}

/// Models drawn at more than this many times their size are symbols; trees and the like differ by less.
const ENLARGED: f32 = 2.0;

/// The greatest scale of a model, where it makes a symbol of it.
fn enlargement(scene: &SceneModel) -> Option<f32> {
    let greatest = scene.placements.iter().map(|placement| placement.scale).fold(0.0, f32::max);
    (greatest > ENLARGED).then_some(greatest)
}
