//! From a view of a scene to an annotated picture in memory: list, draw, annotate.

use std::str::FromStr;

use crate::annotate::paint::annotate;
use crate::annotate::report::AnnotationReport;
use crate::draw::pixels::Pixels;
use crate::pipeline::choice::{Choice, Word, word};
use crate::pipeline::labels;
use crate::render::{RenderBackend, RenderError, render};
use crate::scene::picture::{ViewDraw, build_draw_list, camera};
use crate::scene::{Scene, View};
use crate::view::camera::CameraError;

/// The size of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureSize {
    /// Pixels across, 16 to 16384.
    pub width: u32,
    /// Pixels down, 16 to 16384.
    pub height: u32,
}

/// A text that is not the size of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PictureSizeError {
    /// The text is not two numbers.
    #[error("write width and height as in 1920x1080")]
    Form,
    /// A side is too short or too long.
    #[error("each side must lie between 16 and 16384 pixels")]
    Range,
}

impl FromStr for PictureSize {
    type Err = PictureSizeError;

    fn from_str(text: &str) -> Result<Self, PictureSizeError> {
        let sides = text.split_once(['x', 'X', '×']);
        let size = sides.and_then(|(width, height)| {
            Some(Self { width: width.parse().ok()?, height: height.parse().ok()? })
        });
        let size = size.ok_or(PictureSizeError::Form)?;
        let is_valid = [size.width, size.height].iter().all(|side| (16..=16384).contains(side));
        if is_valid { Ok(size) } else { Err(PictureSizeError::Range) }
    }
}

impl Choice for RenderBackend {
    const CHOICES: &'static [Word<Self>] = &[
        word(Self::Cpu, "cpu", "The processor"),
        word(Self::Gpu, "gpu", "A graphics adapter; needs the Cargo feature `gpu`"),
    ];
}

/// An annotated picture and what it was made of.
pub struct RenderedView {
    /// The picture, opaque.
    pub pixels: Pixels,
    /// What was drawn.
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
    scene: &Scene,
    view: &View,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_two_numbers_within_range() {
        assert_eq!("640x480".parse(), Ok(PictureSize { width: 640, height: 480 }));
        for wrong in ["640", "640x", "0x0", "99999x10", "-4x20", "axb"] {
            assert!(wrong.parse::<PictureSize>().is_err(), "{wrong}");
        }
    }
}
