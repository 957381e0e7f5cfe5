//! A view of a scene to a finished picture, in memory: build the draw list, render, annotate.
//!
//! Nothing is read, written, printed or timed here, so that the program, its tests and its benchmark make their
//! pictures the same way. What is done next is told to the caller, who may show it or time it.

use image::ImageEncoder;

use crate::annotate::paint::annotate;
use crate::annotate::report::AnnotationReport;
use crate::app::arguments::{Backend, PictureSize};
use crate::app::failure::CliError;
use crate::app::labels;
use crate::draw::pixels::Pixels;
use crate::render::{RenderBackend, render};
use crate::scene::picture::{ViewDraw, build_draw_list, camera};
use crate::scene::{Scene, View};

/// An annotated picture with what it was made from.
pub struct Finished {
    /// The picture, opaque.
    pub pixels: Pixels,
    /// What was drawn.
    pub shot: ViewDraw,
    /// What became of the labels.
    pub report: AnnotationReport,
}

/// The annotated picture of `size` that `view` has of `scene`, drawn on the current `rayon` pool. `step` is
/// called with what is done next.
///
/// # Errors
/// The view's camera cannot see anything, or `backend` cannot draw: no adapter, for one.
pub fn picture_of(
    scene: &Scene,
    view: &View,
    size: PictureSize,
    backend: Backend,
    step: &dyn Fn(&'static str),
) -> Result<Finished, CliError> {
    let camera = camera(scene, view, (size.width, size.height)).map_err(CliError::input)?;
    let shot = build_draw_list(scene, &camera, step);
    step("drawing");
    let backend = match backend {
        Backend::Cpu => RenderBackend::Cpu,
        Backend::Gpu => RenderBackend::Gpu,
    };
    let mut picture = render(&shot.list, &camera, backend).map_err(CliError::input)?;
    step("annotating");
    let annotations = labels::annotations(scene, &camera, &picture);
    let report = annotate(&mut picture.pixels, &annotations);
    Ok(Finished { pixels: picture.pixels, shot, report })
}

/// The bytes of `pixels` as a PNG file without alpha.
///
/// # Errors
/// The picture is empty.
pub fn png(pixels: &Pixels) -> Result<Vec<u8>, CliError> {
    let rgb: Vec<u8> = pixels.data().iter().flat_map(|color| [color.0[0], color.0[1], color.0[2]]).collect();
    let mut png = Vec::new();
    image::codecs::png::PngEncoder::new(&mut png)
        .write_image(&rgb, pixels.width(), pixels.height(), image::ExtendedColorType::Rgb8)
        .map_err(CliError::input)?;
    Ok(png)
}
