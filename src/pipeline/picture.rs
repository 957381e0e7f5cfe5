//! Renders a view of a scene to an annotated picture in memory.

use crate::annotate::paint::annotate;
use crate::annotate::report::AnnotationReport;
use crate::draw::pixels::Pixels;
use crate::message::choice::{Choice, ChoiceWord, word};
use crate::pipeline::labels;
use crate::render::picture::Rendering;
use crate::render::{RenderBackend, RenderError, render};
use crate::scene::picture::{ViewDraw, build_draw_list, camera};
use crate::scene::{SceneModel, SceneView};
use crate::view::camera::{Camera, CameraError};

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

/// A picture without annotations and its draw list.
pub struct DrawnView {
    /// How it was seen.
    pub camera: Camera,
    /// The picture, opaque, with depths and features.
    pub picture: Rendering,
    /// What was drawn.
    pub drawn: ViewDraw,
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
    Ok(annotate_view(scene, draw_view(scene, view, size, backend, progress)?, progress))
}

/// The first half of [`render_view`]: the picture without annotations.
///
/// # Errors
/// See [`PictureError`].
pub fn draw_view(
    scene: &SceneModel,
    view: &SceneView,
    size: PictureSize,
    backend: RenderBackend,
    progress: &dyn Fn(&'static str),
) -> Result<DrawnView, PictureError> {
    let camera = camera(scene, view, (size.width, size.height))?;
    let drawn = build_draw_list(scene, &camera, progress);
    progress("drawing");
    let picture = render(&drawn.list, &camera, backend)?;
    Ok(DrawnView { camera, picture, drawn })
}

/// The second half of [`render_view`]: paints the annotations.
pub fn annotate_view(scene: &SceneModel, view: DrawnView, progress: &dyn Fn(&'static str)) -> RenderedView {
    progress("annotating");
    let DrawnView { camera, mut picture, drawn } = view;
    let annotations = labels::annotations(scene, &camera, &picture, &drawn.graphic_texts);
    let annotations = annotate(&mut picture.pixels, &annotations);
    RenderedView { pixels: picture.pixels, drawn, annotations }
}
