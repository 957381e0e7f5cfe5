//! Builds digital terrain models from elevation and features, queries their heights, and renders annotated pictures of
//! them.
//!
//! Open a model and ask a height, in meters, at map coordinates:
//!
//! ```
//! use sandtable::{DVec2, Surface, Terrain};
//! let terrain = Terrain::open("assets/jacksboro/dem.tif")?;
//! let z = terrain.height(Surface::Ground, DVec2::new(750_000.0, 4_018_000.0))?;
//! assert_eq!(z.round(), 490.0);
//! # Ok::<(), sandtable::Error>(())
//! ```
//!
//! Refine the ground for a camera, to within a pixel, and take its triangles:
//!
//! ```
//! use sandtable::{DVec3, Terrain};
//! let terrain = Terrain::open("assets/jacksboro/dem.tif")?;
//! let (eye, target) = (DVec3::new(750_000.0, 4_010_000.0, 2_000.0), DVec3::new(750_000.0, 4_018_000.0, 400.0));
//! let camera = terrain.camera(eye, target, (1280, 720))?;
//! let mesh = terrain.mesh_for(&camera, 1.0);
//! assert!((1_000..200_000).contains(&mesh.triangles.len()));
//! # Ok::<(), sandtable::Error>(())
//! ```
//!
//! Load a scene, render a view of it and save the picture:
//!
//! ```
//! use sandtable::Scene;
//! # let folder = std::env::temp_dir().join(format!("sandtable-doc-{}", std::process::id()));
//! # std::fs::create_dir_all(&folder).expect("a folder for the picture");
//! let scene = Scene::open("scenes/road.toml")?;
//! let view = scene.view("front")?.with_size(320, 180);
//! scene.render(&view)?.save(folder.join("road.png"))?;
//! # std::fs::remove_dir_all(folder).ok();
//! # Ok::<(), sandtable::Error>(())
//! ```
//!
//! What an observer two meters above the ground sees, as a raster of zeros and ones:
//!
//! ```
//! use sandtable::{DVec2, SightEnd, Terrain, ViewshedOptions};
//! let terrain = Terrain::open("assets/jacksboro/dem.tif")?;
//! let observer = SightEnd { at: DVec2::new(750_000.0, 4_018_000.0), above_m: 2.0 };
//! let seen = terrain.viewshed(&ViewshedOptions::new(observer))?;
//! assert_eq!(seen.size(), (374, 393));
//! # Ok::<(), sandtable::Error>(())
//! ```
//!
//! World space is right-handed: X east, Y north, Z up, meters from the south-west post. Map coordinates are those of
//! the terrain's or scene's coordinate system. [`architecture`] draws the modules below.

#[doc = include_str!("ARCHITECTURE.md")]
pub mod architecture {}

mod api;

pub use glam::{DVec2, DVec3};

pub use crate::api::analysis::{Analysis, AnalysisClass, AnalysisFailure, analysis_kinds};
pub use crate::api::dem::Dem;
pub use crate::api::elevation::Elevation;
pub use crate::api::error::Error;
pub use crate::api::plan::{GatheredPlan, WorkPlan};
#[cfg(feature = "cli")]
pub use crate::api::program::run_program;
pub use crate::api::scene::{Picture, Scene, SceneOptions, View};
pub use crate::api::scene_data::{FeatureLayer, SceneData};
pub use crate::api::symbol::Symbol;
pub use crate::api::terrain::Terrain;
pub use sandtable_annotate::chart::ChartText;
pub use sandtable_annotate::chart_ground::ChartPoint;
pub use sandtable_annotate::chart_sight::{SightBlocker, SightChart};
pub use sandtable_base::limits::set_limit::set_limit;
pub use sandtable_base::limits::work_limit::LimitError;
#[cfg(feature = "cli")]
pub use sandtable_cli::invocation::{Invocation, RestartCommand};
pub use sandtable_dem::hints::DemOptions;
pub use sandtable_description::finding::{Finding, Severity};
pub use sandtable_geom::crs::Crs;
pub use sandtable_geom::position::Position;
pub use sandtable_mesh::trimesh::TriMesh;
pub use sandtable_query::profile::GroundProfile;
pub use sandtable_query::sight::{SightQuery, SightReport};
pub use sandtable_raster::answer::{Answer, Status};
pub use sandtable_raster::raster::Samples;
pub use sandtable_remote::access::RemoteAccess;
pub use sandtable_remote::address::AllowedHost;
pub use sandtable_sheet::step_watch::StepWatch;
pub use sandtable_terrain::hillshade::HillshadeOptions;
pub use sandtable_terrain::profile::{ProfileStation, ProfileSummary, Sampling};
pub use sandtable_terrain::query::batch::HeightSlices;
pub use sandtable_terrain::query::choice::WordError;
pub use sandtable_terrain::query::service::{HeightService, Snapshot};
pub use sandtable_terrain::query::{Interpolation, Surface};
pub use sandtable_terrain::sight::Curvature;
pub use sandtable_terrain::sight::line::{Blocker, SightEnd};
pub use sandtable_terrain::sight::rise::Rise;
pub use sandtable_terrain::sight::viewshed::{Sector, ViewshedOptions};
pub use sandtable_terrain::stop_flag::StopFlag;
pub use sandtable_vector::feature_table::{ColumnValues, FeatureColumn};
pub use sandtable_view::camera::Camera;
