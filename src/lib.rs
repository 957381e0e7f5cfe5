//! Elevation models and the things that stand on them, made into scenes and pictures that can be trusted.
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

#![cfg_attr(
    not(feature = "internals"),
    allow(
        dead_code,
        rustdoc::private_intra_doc_links,
        reason = "tests, benches and their readers use the rest"
    )
)]

#[doc = include_str!("ARCHITECTURE.md")]
pub mod architecture {}
#[doc(hidden)]
#[cfg(feature = "cli")]
pub mod cli;
#[doc(hidden)]
#[cfg(feature = "serve")]
pub mod serve;
#[doc(hidden)]
#[cfg(feature = "viewer")]
pub mod viewer;

cfg_if::cfg_if! {
    if #[cfg(feature = "internals")] {
        pub mod annotate;
        pub mod archive;
        pub mod bytes;
        pub mod dem;
        pub mod description;
        pub mod draw;
        pub mod earthworks;
        pub mod export;
        pub mod geom;
        pub mod limits;
        pub mod mesh;
        pub mod message;
        pub mod model;
        pub mod pipeline;
        pub mod remote;
        pub mod render;
        pub mod ribbon;
        pub mod roam;
        pub mod scene;
        pub mod structure;
        pub mod symbology;
        pub mod terrain;
        pub mod vector;
        pub mod view;
    } else {
        mod annotate;
        mod archive;
        mod bytes;
        mod dem;
        mod description;
        mod draw;
        mod earthworks;
        mod export;
        mod geom;
        mod limits;
        mod mesh;
        mod message;
        mod model;
        mod pipeline;
        mod remote;
        mod render;
        mod ribbon;
        mod roam;
        mod scene;
        mod structure;
        mod symbology;
        mod terrain;
        mod vector;
        mod view;
    }
}

pub use glam::{DVec2, DVec3};

pub use crate::dem::answer::{Answer, Status};
pub use crate::dem::raster::Samples;
pub use crate::dem::read::DemOptions;
pub use crate::description::finding::{Finding, Severity};
pub use crate::geom::crs::Crs;
pub use crate::limits::{set_limit::set_limit, work_limit::LimitError};
pub use crate::mesh::trimesh::TriMesh;
pub use crate::pipeline::api::plan::{GatheredPlan, WorkPlan};
pub use crate::pipeline::api::scene::{Picture, Scene, SceneOptions, View};
pub use crate::pipeline::api::{dem::Dem, elevation::Elevation, error::Error, terrain::Terrain};
pub use crate::pipeline::sight::{SightQuery, SightReport};
pub use crate::pipeline::{choice::WordError, profile::GroundProfile};
pub use crate::remote::{access::RemoteAccess, address::AllowedHost};
pub use crate::terrain::hillshade::HillshadeOptions;
pub use crate::terrain::profile::{ProfileStation, ProfileSummary, Sampling};
pub use crate::terrain::query::service::{HeightService, Snapshot};
pub use crate::terrain::query::{Interpolation, Surface, batch::HeightSlices};
pub use crate::terrain::sight::viewshed::{Sector, ViewshedOptions};
pub use crate::terrain::sight::{Curvature, line::Blocker, line::SightEnd, rise::Rise};
pub use crate::view::camera::Camera;
