//! Renders a view of a scene to an annotated picture in memory.

use crate::annotate::paint::annotate;
use crate::annotate::report::AnnotationReport;
use crate::draw::pixels::Pixels;
use crate::message::choice::{Choice, ChoiceWord, word};
use crate::pipeline::labels;
use crate::render::{RenderBackend, RenderError, render};
use crate::scene::picture::{ViewDraw, build_draw_list, camera};
use crate::scene::{SceneModel, SceneView};
use crate::view::camera::CameraError;

/// The size of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureSize {
    /// Pixels across, 16 to 16384.
    pub width: u32,
    /// Pixels down, 16 to 16384.
    pub height: u32,
}

impl Choice for RenderBackend {
    const CHOICES: &'static [ChoiceWord<Self>] = &[
        word(Self::Cpu, "cpu", "The processor"),
        word(Self::Gpu, "gpu", "A graphics adapter; needs the Cargo feature `gpu`"),
    ];
}

/// An annotated picture and its draw list.
pub struct RenderedView {
    /// The picture, opaque.
    pub pixels: Pixels,
    /// The draw list.
    pub drawn: ViewDraw,
    /// Which annotations were placed and which were not.
    pub annotations: AnnotationReport,
}

/// A picture that cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The view's camera sees nothing.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The scene cannot be drawn.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// The annotated picture of a view, drawn on the current `rayon` pool. `progress` is called with the name of each step
/// as it begins.
///
/// # Errors
/// See [`PictureError`].
pub fn render_view(
    scene: &SceneModel,
    view: &SceneView,
    size: PictureSize,
    backend: RenderBackend,
    progress: &dyn Fn(&'static str),
) -> Result<RenderedView, PictureError> {
    let camera = camera(scene, view, (size.width, size.height))?;
    let drawn = build_draw_list(scene, &camera, progress);
    progress("drawing");
    let mut picture = render(&drawn.list, &camera, backend)?;
    progress("annotating");
    let annotations = labels::annotations(scene, &camera, &picture);
    let annotations = annotate(&mut picture.pixels, &annotations);
    Ok(RenderedView { pixels: picture.pixels, drawn, annotations })
}
