//! Renders a view of a scene to an annotated picture in memory.

use crate::labels::{self, AnnotatedGround};
use crate::look::{apply_look, night_ink};
use crate::panorama::{draw_panorama, panorama_annotations};
use sandtable_annotate::paint::{ComposedSheet, compose_sheet};
use sandtable_annotate::report::AnnotationReport;
use sandtable_annotate::sheet_frame::SheetFrame;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::words::StylePreset;
use sandtable_draw::pixels::Pixels;
use sandtable_picture::nested::build_nested_draw_list;
use sandtable_picture::nested_ground::{NestedGround, NestedHeights, nested_grounds};
use sandtable_picture::{ViewDraw, build_draw_list, camera};
use sandtable_render::backend_name::BackendName;
use sandtable_render::drawn_rows::DrawnRows;
use sandtable_render::picture::Rendering;
use sandtable_render::{RenderBackend, RenderError, render_counted};
use sandtable_scene::framing::shaped_page::page_size;
use sandtable_scene::planned_pictures::NearGround;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::{SceneView, ViewAim};
use sandtable_view::camera::{Camera, CameraError};
use sandtable_view::panorama::Panorama;

/// The size of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureSize {
    /// Pixels across, 16 to 16384.
    pub width: u32,
    /// Pixels down, 16 to 16384.
    pub height: u32,
}

impl PictureSize {
    /// The size of a view's paper; without paper, 1920 × 1080, or as many pixels in the shape of what a view by parallel rays
    /// shows whose scale is fitted.
    pub fn of(scene: &SceneModel, view: &SceneView) -> Self {
        let picture_size = |(width, height): (u32, u32)| {
            page_frame(scene, Self { width, height }).map_or((width, height), |frame| frame.picture_size())
        };
        let (width, height) = page_size(scene, view, picture_size);
        Self { width, height }
    }
}

/// How pictures of a renderer show ground near the eye: adapters draw no nested grounds.
pub fn near_ground(backend: BackendName) -> NearGround {
    match backend {
        BackendName::Cpu => NearGround::Nested,
        BackendName::Gpu => NearGround::Whole,
    }
}

/// A picture without annotations and its draw list.
pub struct DrawnView {
    /// How it was seen, but for a panorama.
    pub camera: Camera,
    /// The picture, opaque, with depths and features.
    pub picture: Rendering,
    /// The draw list.
    pub drawn: ViewDraw,
    /// The page that it is part of; `None` where it is the page.
    pub frame: Option<SheetFrame>,
    /// How a panorama was seen, whose `camera` is one in perspective toward its middle.
    pub panorama: Option<Panorama>,
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
    /// A renderer that draws no panoramas.
    #[error("a panorama is drawn by the processor: leave out --backend gpu")]
    PanoramaBackend,
    /// Positions of the pixels of a panorama.
    #[error("the pixels of a panorama have no positions: take a camera in perspective from the same place")]
    PanoramaPixels,
    /// The samples of ground near the eye cannot be read.
    #[error(transparent)]
    Elevation(#[from] Diagnostic),
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

/// About how much memory a picture takes while it is made, with its draw list and its ground map, in bytes.
pub fn bytes_of_making(drawn: &ViewDraw, pixels: &Pixels) -> u64 {
    /// Colors, depths and features, the sheet, and what is painted and packed of it.
    const PER_PIXEL: u64 = 32;
    /// Corners and indices, and the faces and shadows of a part of them.
    const PER_TRIANGLE: u64 = 250;
    /// Six numbers, and those of the coarser levels.
    const PER_POST: u64 = 32;
    let posts = drawn.list.ground.as_ref().map_or(0, |map| map.posts.len());
    pixels.data().len() as u64 * PER_PIXEL
        + drawn.list.triangle_count() as u64 * PER_TRIANGLE
        + posts as u64 * PER_POST
}

/// The first half of [`render_view`]: the picture without annotations, as large as the margin of a page of `size` leaves it.
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
    draw_view_counted(scene, view, size, backend, progress, &DrawnRows::default())
}

/// [`draw_view`], which counts in `drawn` the rows that the processor has drawn of the step that draws.
///
/// # Errors
/// See [`PictureError`].
pub fn draw_view_counted(
    scene: &SceneModel,
    view: &SceneView,
    size: PictureSize,
    backend: RenderBackend,
    progress: &dyn Fn(&'static str),
    drawn: &DrawnRows,
) -> Result<DrawnView, PictureError> {
    if let ViewAim::Panorama(panorama) = &view.aim {
        return draw_panorama(scene, panorama, size, backend, progress);
    }
    let (mut camera, frame) = framed_camera(scene, view, size)?;
    let nested = match backend {
        RenderBackend::Cpu => nested_grounds(scene, &camera, progress)?,
        RenderBackend::Gpu(_) => Vec::new(),
    };
    let draw = if nested.is_empty() {
        build_draw_list(scene, &camera, progress)
    } else {
        camera = nested_camera(scene, &nested, view, size)?;
        build_nested_draw_list(scene, &nested, &camera, progress)
    };
    drop(nested);
    progress("drawing");
    let mut picture = render_counted(&draw.list, &camera, backend, progress, drawn)?;
    apply_look(scene, Some((&draw.list, &camera)), &mut picture);
    Ok(DrawnView { camera, picture, drawn: draw, frame, panorama: None })
}

/// The frame of a page of `size`; `None` where the picture is the page.
pub fn page_frame(scene: &SceneModel, size: PictureSize) -> Option<SheetFrame> {
    let furniture = &scene.furniture;
    let has_title = furniture.title && (scene.title.is_some() || scene.subtitle.is_some());
    let page = (size.width, size.height);
    SheetFrame::new(furniture.layout, page, has_title, furniture.classification.is_some())
}

/// The camera of a view on a page of `size`, and the page's frame where the picture is not the page.
///
/// # Errors
/// See [`CameraError`].
pub fn framed_camera(
    scene: &SceneModel,
    view: &SceneView,
    size: PictureSize,
) -> Result<(Camera, Option<SheetFrame>), CameraError> {
    let frame = page_frame(scene, size);
    let page = (size.width, size.height);
    let camera = camera(scene, view, frame.as_ref().map_or(page, SheetFrame::picture_size))?;
    Ok((camera, frame))
}

/// The camera of a view of a scene with nested grounds: its eye is above the finest ground, and what it is fitted to is the finest
/// that holds all of it.
fn nested_camera(
    scene: &SceneModel,
    nested: &[NestedGround],
    view: &SceneView,
    size: PictureSize,
) -> Result<Camera, CameraError> {
    let shown =
        |ground: &&NestedGround| view.shown().is_some_and(|shown| ground.rect().contains_rect(&shown));
    if let Some(ground) = nested.iter().rev().find(shown) {
        let (camera, _) = framed_camera(&ground.scene, &view.moved(-ground.origin), size)?;
        return Ok(camera.moved(ground.origin.as_vec2().extend(0.0)));
    }
    let lifted = NestedHeights::new(nested).lifted_view(scene, view);
    Ok(framed_camera(scene, &lifted, size)?.0)
}

/// The second half of [`render_view`]: paints the annotations.
pub fn annotate_view(scene: &SceneModel, view: DrawnView, progress: &dyn Fn(&'static str)) -> RenderedView {
    let ComposedView { sheet, drawn, annotations } = compose_view(scene, view, progress);
    RenderedView { pixels: sheet.painted(), drawn, annotations }
}

/// A picture with its annotations laid out and not yet painted.
pub struct ComposedView {
    /// The page.
    pub sheet: ComposedSheet,
    /// The draw list.
    pub drawn: ViewDraw,
    /// Which annotations were placed and which were not.
    pub annotations: AnnotationReport,
}

/// As [`annotate_view`], for formats that keep letters and lines as such.
pub fn compose_view(scene: &SceneModel, view: DrawnView, progress: &dyn Fn(&'static str)) -> ComposedView {
    progress("annotating");
    let DrawnView { camera, picture, drawn, frame, panorama } = view;
    let annotations = match &panorama {
        Some(panorama) => panorama_annotations(scene, panorama, &picture),
        None => {
            let (graphics, nested) = (&drawn.graphic_texts, &drawn.nested);
            let shown = AnnotatedGround { graphics, nested, list: Some(&drawn.list) };
            labels::annotations(scene, &camera, &picture, frame.as_ref(), &shown)
        }
    };
    let (mut sheet, annotations) = compose_sheet(picture.pixels, &annotations);
    if scene.preset == Some(StylePreset::Night) {
        sheet.recolor(&night_ink);
    }
    ComposedView { sheet, drawn, annotations }
}
