//! The description of a picture for programs, as JSON beside it: how it was seen, of what it was made, and where on it
//! everything is.

use std::path::Path;

use glam::Vec3;
use serde_json::{Value, json};

use crate::picture::DrawnView;
use crate::picture_buffers::{PictureBuffers, ShownFeature};
use sandtable_annotate::report::{AnnotationReport, LabelMove, SheetBox};
use sandtable_annotate::sheet_frame::SheetFrame;
use sandtable_files::disk;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::SceneView;
use sandtable_view::camera::{Camera, ViewProjection};
use sandtable_view::panorama::Panorama;

/// The half of a sidecar that is known before annotations are painted.
pub struct SidecarDraft(Value);

impl SidecarDraft {
    /// The scene of a file with this fingerprint, the camera, and the features that the picture shows.
    pub fn new(
        scene: &SceneModel,
        (scene_file, fingerprint): (&Path, &str),
        view: &SceneView,
        drawn: &DrawnView,
    ) -> Self {
        let buffers = PictureBuffers { scene, camera: &drawn.camera, rendering: &drawn.picture };
        let (width, height) = (drawn.picture.pixels.width(), drawn.picture.pixels.height());
        let all = f64::from(width) * f64::from(height);
        let feature = |shown: &ShownFeature| {
            let [[left, top], [right, bottom]] = [shown.min, shown.max];
            json!({
                "feature": shown.feature.0,
                "name": scene.feature_name(shown.feature),
                "box": [left, top, right, bottom],
                "pixels": shown.pixels,
                "share": shown.pixels as f64 / all,
            })
        };
        let corner = drawn.frame.as_ref().map_or((0, 0), SheetFrame::picture_corner);
        Self(json!({
            "program": concat!("sandtable ", env!("CARGO_PKG_VERSION")),
            "scene": {
                "file": disk::file_name(scene_file),
                "sha256": fingerprint,
                "files": scene.files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>(),
                "title": scene.title,
                "phase": scene.phase,
                "crs": scene.crs.name(),
                "vertical_exaggeration": scene.scale.0,
            },
            "picture": { "width": width, "height": height, "at": [corner.0, corner.1] },
            "camera": match &drawn.panorama {
                Some(seen) => panorama(scene, &view.name, seen),
                None => camera(scene, &view.name, &drawn.camera),
            },
            "features": buffers.shown_features().iter().map(feature).collect::<Vec<_>>(),
        }))
    }

    /// The whole, with what became of labels: boxes in pixels of the picture that the camera sees, left, top, right and
    /// bottom.
    pub fn finished(self, report: &AnnotationReport) -> Value {
        let Self(mut whole) = self;
        let corners = |area: &SheetBox| json!([area.min.x, area.min.y, area.max.x, area.max.y]);
        let boxes_of = |text: &String| -> Vec<Value> {
            let own = report.boxes.iter().filter(|area| area.text.as_ref() == Some(text));
            own.map(corners).collect()
        };
        let moved = |text: &String| report.moved.iter().find(|moved| moved.text == *text);
        let placed = report.placed.iter().map(|text| {
            let reason = match moved(text).map(|moved| moved.to) {
                None => Value::Null,
                Some(LabelMove::Led) => "no position beside its place is free".into(),
                Some(LabelMove::OffLine) => "its line or area has no room for the letters".into(),
            };
            json!({ "text": text, "state": "placed", "reason": reason, "boxes": boxes_of(text) })
        });
        let dropped = [
            (&report.hidden, "terrain or something on it hides its place"),
            (&report.outside, "its place is outside the picture, or too close to its border"),
            (&report.crowded_out, "no position near its place is free"),
        ];
        let dropped = dropped.into_iter().flat_map(|(texts, reason)| {
            texts.iter().map(move |text| json!({ "text": text, "state": "dropped", "reason": reason }))
        });
        let furniture = report.boxes.iter().filter(|area| area.text.is_none());
        whole["labels"] = placed.chain(dropped).collect();
        whole["shortened"] = report.shortened.clone().into();
        whole["furniture"] = furniture.map(corners).collect();
        whole["symbols"] = json!({
            "placed": report.symbols.placed, "hidden": report.symbols.hidden,
            "outside": report.symbols.outside, "reduced": report.symbols.reduced,
            "listed": report.symbols.listed, "counted": report.symbols.counted,
            "without_room": report.symbols.crowded_out,
        });
        whole
    }
}

/// A panorama in map coordinates: column `x` shows the azimuth `from_deg + x / pixels_per_degree`, and row `y` the tangent
/// `(horizon_row - y) / pixels_per_radian` above the horizon.
fn panorama(scene: &SceneModel, name: &str, panorama: &Panorama) -> Value {
    let eye = panorama.eye.as_dvec3() + scene.lattice.origin().extend(0.0);
    let per_radian = panorama.pixels_per_radian();
    json!({
        "name": name,
        "eye": eye.to_array(),
        "projection": {
            "kind": "panorama",
            "from_deg": panorama.from_rad.to_degrees(),
            "span_deg": panorama.span_rad.to_degrees(),
            "pixels_per_degree": per_radian.to_radians(),
            "pixels_per_radian": per_radian,
            "horizon_row": panorama.horizon_row,
        },
    })
}

/// The camera in map coordinates: eastings, northings and elevations as they are drawn, with the exaggeration.
fn camera(scene: &SceneModel, name: &str, camera: &Camera) -> Value {
    let origin = scene.lattice.origin();
    let eye = camera.eye().as_dvec3() + origin.extend(0.0);
    let axis = |axis: Vec3| axis.to_array();
    let projection = match camera.projection() {
        ViewProjection::Perspective { tan_half_fov } => json!({
            "kind": "perspective",
            "field_of_view_deg": 2.0 * libm::atanf(tan_half_fov).to_degrees(),
        }),
        ViewProjection::Parallel(frame) => json!({
            "kind": "parallel",
            "span_m": [2.0 * frame.half_m.x, 2.0 * frame.half_m.y],
            "scale": camera.scale_denominator(),
            "dpi": frame.dpi,
        }),
    };
    let (near_m, far_m) = camera.planes();
    json!({
        "name": name,
        "eye": eye.to_array(),
        "right": axis(camera.right()),
        "up": axis(camera.up()),
        "forward": axis(camera.forward()),
        "projection": projection,
        "near_m": near_m,
        "far_m": far_m,
    })
}
