//! What a question about heights is asked of: an elevation file, or the ground of a scene.
//!
//! Every command and the HTTP service ask through here, so that they cannot but give the same answer.

use std::ffi::OsStr;
use std::path::Path;
use std::sync::{Arc, OnceLock};

use glam::DVec2;
use rayon::prelude::*;

use crate::app::arguments::{Access, StatedHeights};
use crate::app::dem::read_raster;
use crate::app::failure::CliError;
use crate::app::{ground, load};
use crate::dem::raster::Raster;
use crate::geom::crs::{Crs, CrsError};
use crate::terrain::query::service::HeightService;
use crate::terrain::query::source::source_heights;
use crate::terrain::query::{Answer, Interpolation, Surface};

/// An elevation file, or a scene.
pub struct Dataset {
    name: String,
    kind: DatasetKind,
}

enum DatasetKind {
    /// The ground is made when it is first asked for: an elevation file in degrees must be warped for it.
    File {
        raster: Arc<Raster>,
        crs: Crs,
        ground: OnceLock<Result<HeightService, String>>,
    },
    Scene(HeightService),
}

impl Dataset {
    /// Opens the elevation file or, where the name ends in `.toml`, the scene at `path`.
    ///
    /// # Errors
    /// It cannot be had or read; the message names it.
    pub fn open(path: &Path, heights: StatedHeights, access: &Access) -> Result<Self, CliError> {
        let name = path.display().to_string();
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(OsStr::new("toml"))) {
            let ground = load::scene_ground(path, access)?;
            return Ok(Self { name, kind: DatasetKind::Scene(ground.heights) });
        }
        let raster = Arc::new(read_raster(path, heights)?);
        let crs = raster.crs.clone().unwrap_or_else(Crs::local);
        Ok(Self { name, kind: DatasetKind::File { raster, crs, ground: OnceLock::new() } })
    }

    /// The system that positions are given in where nobody says another: the file's or the scene's.
    pub fn crs(&self) -> Crs {
        match &self.kind {
            DatasetKind::File { crs, .. } => crs.clone(),
            DatasetKind::Scene(service) => service.snapshot().crs().clone(),
        }
    }

    /// What is asked where nobody says: of a file, what it holds; of a scene, its ground.
    pub fn usual_surface(&self) -> Surface {
        match &self.kind {
            DatasetKind::File { .. } => Surface::Source,
            DatasetKind::Scene(_) => Surface::Ground,
        }
    }

    /// The service on the ground, in meters.
    ///
    /// # Errors
    /// The elevation file has no place in meters; the message names it.
    pub fn service(&self) -> Result<&HeightService, CliError> {
        match &self.kind {
            DatasetKind::Scene(service) => Ok(service),
            DatasetKind::File { raster, ground, .. } => ground
                .get_or_init(|| ground::service(raster))
                .as_ref()
                .map_err(|reason| CliError::input(format!("{}: {reason}", self.name))),
        }
    }

    /// The heights at positions in coordinates of `from`, in order.
    ///
    /// The source of a file that names no system is taken to lie in `from`. A position that cannot be brought to the
    /// surface's system lies [`Answer::Outside`].
    ///
    /// # Errors
    /// The shift between the two datums is not known. As for [`Dataset::service`], where a surface other than the source is
    /// asked for.
    ///
    /// # Panics
    /// Where `out` is not as long as `at`.
    pub fn heights(
        &self,
        surface: Surface,
        interpolation: Interpolation,
        from: &Crs,
        at: &[DVec2],
        out: &mut [Answer],
    ) -> Result<(), CliError> {
        assert_eq!(at.len(), out.len(), "one answer per position");
        if surface == Surface::Source {
            let source = self.source();
            let to = source.crs.as_ref().unwrap_or(from);
            self.check_way(from, to)?;
            source_heights(&source, from, interpolation, at, out);
            return Ok(());
        }
        let epoch = self.service()?.snapshot();
        if from == epoch.crs() {
            epoch.heights(surface, interpolation, at, out);
            return Ok(());
        }
        self.check_way(from, epoch.crs())?;
        let brought = |&at: &DVec2| from.transform(epoch.crs(), at).unwrap_or(DVec2::NAN);
        let brought: Vec<DVec2> = at.par_iter().map(brought).collect();
        epoch.heights(surface, interpolation, &brought, out);
        Ok(())
    }

    /// Whether anything can be brought from one system to the other at all: what cannot is not merely outside.
    fn check_way(&self, from: &Crs, to: &Crs) -> Result<(), CliError> {
        match from.transform(to, DVec2::ZERO) {
            Err(error @ CrsError::Datum { .. }) => Err(CliError::input(format!("{}: {error}", self.name))),
            _ => Ok(()),
        }
    }

    /// The raster as read.
    pub fn source(&self) -> Arc<Raster> {
        match &self.kind {
            DatasetKind::File { raster, .. } => Arc::clone(raster),
            DatasetKind::Scene(service) => Arc::clone(service.snapshot().source()),
        }
    }
}
