//! The values of a picture at each pixel: position, elevation and feature.

use std::path::Path;

use glam::{DAffine2, DMat2, DVec2, Vec2, Vec3};
use rayon::prelude::*;

use crate::picture::{PictureError, PictureSize, framed_camera};
use sandtable_annotate::sheet_frame::SheetFrame;
use sandtable_dem::tiff::write::write_described;
use sandtable_description::finding::Finding;
use sandtable_description::finding_code::FindingCode;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;
use sandtable_draw::pixels::Pixels;
use sandtable_files::disk::{self, WriteFileError};
use sandtable_files::output_files::OutputFiles;
use sandtable_files::png::encode_png;
use sandtable_picture::build_shapes;
use sandtable_raster::raster::{Raster, Samples};
use sandtable_render::cpu::render_buffers;
use sandtable_render::picture::Rendering;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::{SceneView, ViewAim};
use sandtable_view::camera::Camera;

/// The buffers of a picture and what is needed to read them.
#[derive(Clone, Copy)]
pub struct PictureBuffers<'a> {
    /// The scene.
    pub scene: &'a SceneModel,
    /// How it was seen.
    pub camera: &'a Camera,
    /// Depths and features.
    pub rendering: &'a Rendering,
}

/// The place that a pixel shows.
#[derive(Clone, Debug, PartialEq)]
pub struct PickedPlace {
    /// Map coordinates in the scene's system.
    pub at: DVec2,
    /// Meters, true to scale.
    pub elevation_m: f64,
    /// Meters from the eye, in a straight line; along the viewing direction where rays are parallel.
    pub distance_m: f64,
    /// What it belongs to.
    pub feature: FeatureId,
}

/// The place that a view shows at each of `pixels`, columns and rows from the upper left corner; `None` for sky, and
/// beside the picture. Nothing is lit or colored for it.
///
/// # Errors
/// See [`PictureError`].
pub fn pick(
    scene: &SceneModel,
    view: &SceneView,
    size: PictureSize,
    pixels: &[[u32; 2]],
    progress: &dyn Fn(&'static str),
) -> Result<Vec<Option<PickedPlace>>, PictureError> {
    if let ViewAim::Panorama(_) = view.aim {
        return Err(PictureError::PanoramaPixels);
    }
    let (camera, frame) = framed_camera(scene, view, size)?;
    let (left, top) = frame.as_ref().map_or((0, 0), SheetFrame::picture_corner);
    let list = build_shapes(scene, &camera, progress).list;
    progress("drawing");
    let rendering = render_buffers(&list, &camera).map_err(sandtable_render::RenderError::from)?;
    let buffers = PictureBuffers { scene, camera: &camera, rendering: &rendering };
    // In the margin of a page is nothing of the scene.
    let place = |&[column, row]: &[u32; 2]| buffers.place(column.checked_sub(left)?, row.checked_sub(top)?);
    Ok(pixels.iter().map(place).collect())
}

impl PictureBuffers<'_> {
    fn size(&self) -> [u32; 2] {
        [self.rendering.pixels.width(), self.rendering.pixels.height()]
    }

    /// The feature and the world position at a pixel's center; `None` for sky, and beside the picture.
    fn world(&self, column: u32, row: u32) -> Option<(FeatureId, Vec3)> {
        let [width, height] = self.size();
        let index =
            (column < width && row < height).then(|| row as usize * width as usize + column as usize)?;
        let depth_m = self.rendering.depth_m[index];
        let center = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
        let at = self.camera.point_at(center, depth_m);
        depth_m.is_finite().then_some((self.rendering.features[index], at))
    }

    /// The place that a pixel shows at its center.
    pub fn place(&self, column: u32, row: u32) -> Option<PickedPlace> {
        let (feature, at) = self.world(column, row)?;
        let distance = match self.camera.parallel_frame() {
            Some(_) => (at - self.camera.eye()).dot(self.camera.forward()),
            None => at.distance(self.camera.eye()),
        };
        Some(PickedPlace {
            at: self.scene.lattice.map_point(at),
            elevation_m: self.scene.scale.elevation_m(f64::from(at.z)),
            distance_m: f64::from(distance),
            feature,
        })
    }

    /// Writes `depth.tif` and `elevation.tif` in meters without data for sky, `normal.png`, `feature.tif` with the number
    /// of a feature at each pixel (0 for sky, 1 for ground) and `features.csv` with their names, all into `folder`, among the other
    /// `files`. In a plan the rasters have the scene's georeference. They are of the picture as it is drawn: where its ground is of
    /// means of samples, the rasters say so in their description.
    ///
    /// # Errors
    /// A file cannot be written, or would replace one of the scene's.
    pub fn write(&self, files: &mut OutputFiles, folder: &Path) -> Result<(), WriteFileError> {
        let Rendering { depth_m, features, .. } = self.rendering;
        let finite = |&depth_m: &f32| if depth_m.is_finite() { depth_m } else { f32::NAN };
        let description = self.description();
        let depths = Samples::F32(depth_m.par_iter().map(finite).collect());
        let elevation = |(column, row)| match self.world(column, row) {
            Some((_, at)) => self.scene.scale.elevation_m(at.z),
            None => f32::NAN,
        };
        let elevations = Samples::F32(self.each_pixel(elevation));
        // The plinth is the last number there is.
        let numbers = features.iter().map(|feature| f64::from(feature.0));
        let numbers = Samples::F64(numbers.collect());
        for (name, samples) in
            [("depth.tif", depths), ("elevation.tif", elevations), ("feature.tif", numbers)]
        {
            let path = folder.join(name);
            disk::check_output(&path, &self.scene.files)?;
            files.write(&path, &write_described(&self.raster(samples), &description).bytes)?;
        }
        self.write_normals(files, folder)?;
        let path = folder.join("features.csv");
        disk::check_output(&path, &self.scene.files)?;
        files.write(&path, self.feature_table().as_bytes())
    }

    /// Of which samples of the elevation the picture's ground is made; empty where that is of all.
    fn description(&self) -> String {
        let is_of_means = |finding: &&Finding| {
            matches!(finding.code, FindingCode::SamplesAveraged | FindingCode::ElevationReduced)
        };
        let found = self.scene.findings.iter().find(is_of_means);
        found.map_or_else(String::new, |finding| finding.message.clone())
    }

    fn each_pixel<T: Send>(&self, value: impl Fn((u32, u32)) -> T + Sync) -> Vec<T> {
        let [width, height] = self.size();
        let row = |row: u32| (0..width).map(|column| value((column, row))).collect::<Vec<T>>();
        (0..height).into_par_iter().flat_map_iter(row).collect()
    }

    fn raster(&self, samples: Samples) -> Raster {
        let [width, height] = self.size();
        let frame = self.plan_frame();
        Raster {
            driver: "GTiff",
            data_type: if matches!(samples, Samples::F32(_)) { "Float32" } else { "UInt32" },
            width,
            height,
            samples,
            meters_per_z: 1.0,
            states_z_unit: true,
            map_from_grid: frame.unwrap_or(DAffine2 {
                matrix2: DMat2::from_diagonal(DVec2::new(1.0, -1.0)),
                translation: DVec2::ZERO,
            }),
            georeferenced: frame.is_some(),
            crs: frame.map(|_| self.scene.crs.clone()),
            ..Raster::without_place(1, 1)
        }
    }

    /// From pixels to map coordinates, where every ray is upright.
    fn plan_frame(&self) -> Option<DAffine2> {
        let camera = self.camera;
        let is_plan = camera.parallel_frame().is_some() && camera.forward().truncate() == Vec2::ZERO;
        let corner = |x: f32, y: f32| camera.ray_origin(Vec2::new(x, y)).truncate().as_dvec2();
        let [width, height] = self.size().map(|side| side as f32);
        let [west_north, east_north, west_south] =
            [corner(0.0, 0.0), corner(width, 0.0), corner(0.0, height)];
        is_plan.then(|| DAffine2 {
            matrix2: DMat2::from_cols(
                (east_north - west_north) / f64::from(width),
                (west_south - west_north) / f64::from(height),
            ),
            translation: self.scene.lattice.origin() + west_north,
        })
    }

    /// Unit normals in world space, their X, Y and Z from -1 to 1 as red, green and blue; transparent for sky. Each is that
    /// of the surface through a pixel's neighbors, on the sides where the depth changes less.
    fn write_normals(&self, files: &mut OutputFiles, folder: &Path) -> Result<(), WriteFileError> {
        let normal = |(column, row): (u32, u32)| {
            let Some((_, at)) = self.world(column, row) else { return Srgba([0; 4]) };
            let toward = |before: Option<(u32, u32)>, after: (u32, u32)| {
                let before =
                    before.and_then(|(column, row)| self.world(column, row)).map(|(_, other)| at - other);
                let after = self.world(after.0, after.1).map(|(_, other)| other - at);
                match (before, after) {
                    (Some(before), Some(after)) if after.length() < before.length() => after,
                    (Some(step), _) | (None, Some(step)) => step,
                    (None, None) => Vec3::ZERO,
                }
            };
            let right = toward(column.checked_sub(1).map(|column| (column, row)), (column + 1, row));
            let down = toward(row.checked_sub(1).map(|row| (column, row)), (column, row + 1));
            let normal = down.cross(right).normalize_or_zero();
            let [red, green, blue] = normal.to_array().map(|part| (part * 127.5 + 127.5).round() as u8);
            Srgba([red, green, blue, 255])
        };
        let [width, height] = self.size();
        let mut pixels = Pixels::filled(width, height, Srgba([0; 4]));
        pixels.data_mut().copy_from_slice(&self.each_pixel(normal));
        let path = folder.join("normal.png");
        disk::check_output(&path, &self.scene.files)?;
        files.write(&path, &encode_png(&pixels))
    }

    /// The features that the picture shows, with the pixels that each covers and the box around them.
    pub fn shown_features(&self) -> Vec<ShownFeature> {
        let [width, _] = self.size();
        let mut shown = std::collections::BTreeMap::<FeatureId, ShownFeature>::new();
        for (index, &feature) in self.rendering.features.iter().enumerate() {
            if feature == FeatureId::NONE {
                continue;
            }
            let at = [(index % width as usize) as u32, (index / width as usize) as u32];
            let own = shown.entry(feature).or_insert(ShownFeature { feature, pixels: 0, min: at, max: at });
            own.pixels += 1;
            own.min = [own.min[0].min(at[0]), own.min[1].min(at[1])];
            own.max = [own.max[0].max(at[0]), own.max[1].max(at[1])];
        }
        shown.into_values().collect()
    }

    fn feature_table(&self) -> String {
        let mut text = String::from("feature,name,pixels,left,top,right,bottom\n");
        for ShownFeature { feature, pixels, min, max } in self.shown_features() {
            let name = self.scene.feature_name(feature).replace('"', "\"\"");
            let [[left, top], [right, bottom]] = [min, max];
            text.push_str(&format!("{},\"{name}\",{pixels},{left},{top},{right},{bottom}\n", feature.0));
        }
        text
    }
}

/// A feature on a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShownFeature {
    /// Which.
    pub feature: FeatureId,
    /// How many pixels show it at their center.
    pub pixels: u64,
    /// Column and row of the upper left of them.
    pub min: [u32; 2],
    /// Column and row of the lower right of them.
    pub max: [u32; 2],
}
