//! Ground in meters: heights, meshes and viewsheds.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use glam::{DVec2, DVec3, Vec3};

use crate::api::dem::Dem;
use crate::api::error::Error;
use sandtable_geom::crs::Crs;
use sandtable_mesh::trimesh::TriMesh;
use sandtable_query::bounded_mesh::{BoundedMesh, MeshError};
use sandtable_query::ground;
use sandtable_query::post_raster::hillshade_raster;
use sandtable_query::viewshed::raster;
use sandtable_raster::answer::Answer;
use sandtable_roam::layout::DEFAULT_PATCH;
use sandtable_roam::measured_ground::MeasuredGround;
use sandtable_scene::vertical_scale::VerticalScale;
use sandtable_terrain::hillshade::HillshadeOptions;
use sandtable_terrain::query::service::{HeightService, Snapshot};
use sandtable_terrain::query::{Interpolation, Surface};
use sandtable_terrain::sight::viewshed::{ViewshedOptions, viewshed};
use sandtable_view::camera::Camera;

/// The vertical field of view of [`Terrain::camera`]: 46°, about that of a camera's normal lens.
const FOV_Y_RAD: f32 = 0.8;

/// The distance of its near plane.
const NEAR_M: f32 = 0.5;

/// The ground in meters: a lattice of heights in a metric coordinate system.
///
/// What refinement needs (errors, patch heights) is measured once, when a mesh is first made.
pub struct Terrain {
    heights: HeightService,
    ground: Arc<Snapshot>,
    measured: MeasuredGround,
    bounds: OnceLock<(Vec3, Vec3)>,
}

impl Terrain {
    /// Reads elevation, as [`Dem::open`] does, and brings it to meters: a model in degrees to the UTM zone of its center.
    ///
    /// # Errors
    /// [`Error::OpenDem`], [`Error::Ground`], [`Error::Mesh`] where there are too many posts.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::new(&Dem::open(path)?)
    }

    /// The ground of an elevation model.
    ///
    /// # Errors
    /// [`Error::Ground`], [`Error::Mesh`] where there are too many posts.
    pub fn new(dem: &Dem) -> Result<Self, Error> {
        Self::from_heights(ground::height_service(&dem.raster)?)
    }

    /// The ground of a height service.
    pub(in crate::api) fn from_heights(heights: HeightService) -> Result<Self, Error> {
        let ground = heights.snapshot();
        let lattice = Arc::clone(ground.lattice());
        let (columns, rows) = (lattice.columns(), lattice.rows());
        let measured =
            MeasuredGround::new(lattice, DEFAULT_PATCH).ok_or(MeshError::TooLarge { columns, rows })?;
        Ok(Self { heights, ground, measured, bounds: OnceLock::new() })
    }

    /// The coordinate system of positions.
    pub fn crs(&self) -> &Crs {
        self.ground.crs()
    }

    /// The map coordinates of the south-west and north-east post.
    pub fn extent(&self) -> (DVec2, DVec2) {
        let extent = self.ground.lattice().map_extent();
        (extent.min, extent.max)
    }

    /// Answers heights one by one and in batches, from many threads.
    pub fn heights(&self) -> &HeightService {
        &self.heights
    }

    /// The height in meters of a surface at map coordinates: on the finest triangles of the ground, bilinear in the
    /// source.
    ///
    /// # Errors
    /// [`Error::NoHeight`] with the reason.
    pub fn height(&self, surface: Surface, at: DVec2) -> Result<f64, Error> {
        let interpolation =
            if surface == Surface::Source { Interpolation::Bilinear } else { Interpolation::Planar };
        let answer = self.ground.height(surface, interpolation, at);
        answer.height_m().ok_or(Error::NoHeight(at, answer.kind()))
    }

    /// A camera at `eye` that looks at `target`, both in map coordinates and meters of height, with a picture of `width`
    /// and `height` pixels and a vertical field of view of 46°.
    ///
    /// # Errors
    /// [`Error::Camera`].
    pub fn camera(&self, eye: DVec3, target: DVec3, (width, height): (u32, u32)) -> Result<Camera, Error> {
        let lattice = self.ground.lattice();
        let origin = lattice.origin().extend(0.0);
        let (eye, target) = ((eye - origin).as_vec3(), (target - origin).as_vec3());
        let measure = || VerticalScale(1.0).ground(lattice).bounds(lattice.height_range());
        let &(min, max) = self.bounds.get_or_init(measure);
        let far_m = 2.0 * (eye.distance(min).max(eye.distance(max)) + 1000.0);
        Ok(Camera::new(eye, target, FOV_Y_RAD, (width, height), (NEAR_M, far_m))?)
    }

    /// The ground's triangles in the camera's view, refined until no vertex that is left out would move the picture by
    /// more than `tolerance_px` pixels. Positions are meters from the south-west post.
    pub fn mesh_for(&self, camera: &Camera, tolerance_px: f32) -> TriMesh {
        let mut mesh = TriMesh::default();
        self.measured.displayed_to(camera, tolerance_px).emit(&mut mesh);
        mesh
    }

    /// The mesh of the whole ground with few triangles, at no post farther than `max_error_m` from it: measured, not
    /// estimated. Positions are meters from the south-west post.
    ///
    /// # Errors
    /// [`Error::Mesh`].
    pub fn mesh_within(&self, max_error_m: f64) -> Result<TriMesh, Error> {
        Ok(BoundedMesh::new(self.ground.lattice(), max_error_m)?.to_mesh())
    }

    /// The hillshade of the ground, a gray for each post: 1 facing away from the sun, 255 facing it, no data (0 in a file)
    /// where there is none. Equal to `gdaldem hillshade` within one gray level.
    pub fn hillshade(&self, options: &HillshadeOptions) -> Dem {
        let lattice = self.ground.lattice();
        Dem { raster: Arc::new(hillshade_raster(lattice, options, self.crs())) }
    }

    /// The viewshed of an observer as a raster: 1 in sight, 0 hidden, no data (255 in a file) for posts that were not
    /// examined.
    ///
    /// # Errors
    /// [`Error::NoHeight`] at the observer.
    pub fn viewshed(&self, options: &ViewshedOptions) -> Result<Dem, Error> {
        let lattice = self.ground.lattice();
        let seen = viewshed(lattice, options)
            .map_err(|answer: Answer| Error::NoHeight(options.observer.at, answer.kind()))?;
        Ok(Dem { raster: Arc::new(raster(lattice, &seen, self.crs())) })
    }
}
