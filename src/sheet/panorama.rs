//! Draws a panorama: its strips by the processor, then the names of the peaks in sight.

use rayon::prelude::*;

use crate::labels::{cover, is_bare};
use crate::line_labels::is_seen;
use crate::look::apply_look;
use crate::peaks_in_sight::{Peak, peaks};
use crate::picture::{DrawnView, PictureError, PictureSize};
use sandtable_annotate::annotation::{Annotations, PanoramaMarks, PictureLabel, SkylineName};
use sandtable_description::words::LabelKind;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawList, FeatureId};
use sandtable_draw::pixels::Pixels;
use sandtable_picture::panorama::{HorizonDrop, build_panorama_draw_list};
use sandtable_render::cpu::{self, RenderQuality};
use sandtable_render::picture::Rendering;
use sandtable_render::{RenderBackend, RenderError};
use sandtable_scene::framing::panorama_frame::panorama;
use sandtable_scene::label_course::LabelCourse;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::PanoramaView;
use sandtable_view::panorama::{Panorama, PanoramaStrip};

/// Peaks without a name on a picture, one in so many degrees at the most: more would be figures all over.
const DEGREES_PER_HEIGHT: f32 = 6.0;

/// The picture of a panorama without annotations.
///
/// # Errors
/// A renderer other than the processor's, and see [`PictureError`].
pub fn draw_panorama(
    scene: &SceneModel,
    view: &PanoramaView,
    size: PictureSize,
    backend: RenderBackend,
    progress: &dyn Fn(&'static str),
) -> Result<DrawnView, PictureError> {
    if let RenderBackend::Gpu(_) = backend {
        return Err(PictureError::PanoramaBackend);
    }
    let panorama = panorama(scene, view, (size.width, size.height));
    let drawn = build_panorama_draw_list(scene, &panorama, progress)?;
    progress("drawing");
    let mut picture = rendered(&drawn.list, &panorama)?;
    apply_look(scene, None, &mut picture);
    Ok(DrawnView { camera: panorama.guide()?, picture, drawn, frame: None, panorama: Some(panorama) })
}

/// A draw list as an eye sees it that turns around; depths are distances in plan.
fn rendered(list: &DrawList, panorama: &Panorama) -> Result<Rendering, PictureError> {
    let strips = panorama.strips()?;
    let render = |strip: &PanoramaStrip| cpu::render(list, &strip.camera, &RenderQuality::default());
    let pictures: Result<Vec<Rendering>, _> = strips.par_iter().map(render).collect();
    let pictures = pictures.map_err(RenderError::from)?;
    let (width, height) = panorama.size;
    let count = width as usize * height as usize;
    let mut whole = Rendering {
        pixels: Pixels::filled(width, height, Srgba::WHITE),
        depth_m: vec![f32::INFINITY; count],
        features: vec![FeatureId::NONE; count],
    };
    for (PanoramaStrip { columns, first_row, .. }, picture) in strips.iter().zip(&pictures) {
        let wide = (columns.end - columns.start) as usize;
        // From depth along the strip's middle to distance.
        let oblique = |column: usize| {
            let aside = (column as f32 + 0.5 - wide as f32 * 0.5) / panorama.pixels_per_radian();
            (1.0 + aside * aside).sqrt()
        };
        for row in 0..height as usize {
            let from = (row + *first_row as usize) * wide;
            let to = row * width as usize + columns.start as usize;
            whole.pixels.data_mut()[to..to + wide].copy_from_slice(&picture.pixels.data()[from..from + wide]);
            whole.features[to..to + wide].copy_from_slice(&picture.features[from..from + wide]);
            for column in 0..wide {
                whole.depth_m[to + column] = picture.depth_m[from + column] * oblique(column);
            }
        }
    }
    Ok(whole)
}

/// The annotations of a panorama: a scale of azimuths, the peaks in sight, and other names at places that it shows.
pub fn panorama_annotations(scene: &SceneModel, panorama: &Panorama, picture: &Rendering) -> Annotations {
    let drop = HorizonDrop::new(scene, panorama);
    let shows_title = scene.furniture.title && !is_bare(scene);
    let labels = scene
        .labels
        .iter()
        .filter(|label| label.kind != LabelKind::Summit && label.course == LabelCourse::Place);
    let placed = labels.filter_map(|label| {
        let [ground, top] = [label.ground, label.anchor].map(|at| panorama.project(drop.lowered(at)));
        let (ground, top) = (ground?, top?);
        let is_visible =
            is_seen(picture, ground.pixel, ground.depth_m) || is_seen(picture, top.pixel, top.depth_m);
        Some(PictureLabel {
            text: label.text.clone(),
            anchor_px: ground.pixel,
            top_px: (label.anchor != label.ground).then_some(top.pixel),
            depth_m: ground.depth_m,
            visible: is_visible,
            kind: label.kind,
            rank: label.rank,
            size: label.size,
        })
    });
    Annotations {
        labels: placed.collect(),
        panorama: Some(PanoramaMarks {
            from_deg: f64::from(panorama.from_rad).to_degrees(),
            span_deg: f64::from(panorama.span_rad).to_degrees(),
            peaks: skyline_names(scene, panorama, &drop),
        }),
        font: scene.font.clone(),
        title: scene.title.clone().filter(|_| shows_title),
        subtitle: scene.subtitle.clone().filter(|_| shows_title),
        cover: Some(cover(picture)),
        ..Annotations::default()
    }
}

fn skyline_names(scene: &SceneModel, panorama: &Panorama, drop: &HorizonDrop) -> Vec<SkylineName> {
    let most = (panorama.span_rad.to_degrees() / DEGREES_PER_HEIGHT).ceil() as usize;
    let mut unnamed = 0;
    let name = |peak: Peak| {
        let seen = panorama.project(drop.lowered(peak.world))?;
        let is_wanted = peak.name.is_some();
        unnamed += usize::from(!is_wanted);
        let is_kept = is_wanted || unnamed <= most;
        is_kept.then(|| SkylineName { text: peak.text(), at_px: seen.pixel, is_wanted })
    };
    let in_sight = peaks(scene, panorama.eye).into_iter().filter(|peak| peak.is_in_sight);
    in_sight.filter_map(name).collect()
}
