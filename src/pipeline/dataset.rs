//! The subject of a height query: an elevation file, or the ground of a scene.
//!
//! Every command and the HTTP service query through [`Dataset`], so that they give the same answers.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use glam::DVec2;
use rayon::prelude::*;

use crate::dem::answer::Answer;
use crate::dem::raster::Raster;
use crate::dem::warp::metric_crs::off_scale;
use crate::geom::crs::{Crs, CrsError};
use crate::pipeline::dem::{self, DemOptions, OpenDemError};
use crate::pipeline::ground::{self, GroundError};
use crate::pipeline::scene_file::{OpenSceneError, open_scene_ground};
use crate::scene::SceneGround;
use crate::terrain::query::service::HeightService;
use crate::terrain::query::source::source_heights;
use crate::terrain::query::{Interpolation, Surface};

/// Options for opening a dataset.
#[derive(Clone, Default)]
pub struct DatasetOptions {
    /// Options for an elevation file.
    pub dem: DemOptions,
    /// Folders that a scene may read besides the parent of its own.
    pub allowed: Vec<PathBuf>,
}

/// An elevation file, or a scene.
pub struct Dataset {
    name: String,
    content: DatasetContent,
}

enum DatasetContent {
    /// The ground is made at the first query: an elevation file in degrees must be warped for it.
    Raster {
        raster: Arc<Raster>,
        ground: OnceLock<Result<HeightService, Arc<GroundError>>>,
        warning: Option<String>,
    },
    Scene(SceneGround),
}

/// A dataset that cannot be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The elevation cannot be opened.
    #[error(transparent)]
    Dem(#[from] OpenDemError),
    /// The scene cannot be opened.
    #[error(transparent)]
    Scene(#[from] OpenSceneError),
}

/// A query that has no answer.
#[derive(Clone, Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum QueryError {
    #[error("{dataset}")]
    Ground { dataset: String, source: Arc<GroundError> },
    #[error("{dataset}")]
    Datum { dataset: String, source: CrsError },
    #[error("{what} {},{}", at.x, at.y)]
    Position {
        /// The role of the position, such as `observer`.
        what: String,
        at: DVec2,
        source: CrsError,
    },
    #[error("{what} {},{}: {}", at.x, at.y, absence(*answer))]
    NoGround {
        /// The role of the position, such as `observer`.
        what: String,
        at: DVec2,
        answer: Answer,
    },
}

fn absence(answer: Answer) -> &'static str {
    match answer {
        Answer::NoData => "the elevation model has no data there",
        _ => "this lies outside the elevation model",
    }
}

impl Dataset {
    /// Opens the scene at `path` where the name ends in `.toml`, else the elevation there.
    ///
    /// # Errors
    /// See [`OpenError`].
    pub fn open(path: &Path, options: &DatasetOptions) -> Result<Self, OpenError> {
        let name = path.display().to_string();
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml")) {
            let ground = open_scene_ground(path, &options.allowed)?;
            return Ok(Self { name, content: DatasetContent::Scene(ground) });
        }
        let mosaic = dem::open(path, &options.dem)?;
        let warning = dem::warning(path, &mosaic);
        let raster = Arc::new(mosaic.raster);
        Ok(Self { name, content: DatasetContent::Raster { raster, ground: OnceLock::new(), warning } })
    }

    /// A warning for the user about the files, where there is one.
    pub fn warning(&self) -> Option<&str> {
        match &self.content {
            DatasetContent::Raster { warning, .. } => warning.as_deref(),
            DatasetContent::Scene(_) => None,
        }
    }

    /// A note for the user where the ground lies in another system than [`Dataset::crs`] because lengths in that are not
    /// true. It does not concern heights of the source.
    pub fn ground_note(&self) -> Option<String> {
        let note = match &self.content {
            // A raster without ground says so when its ground is made.
            DatasetContent::Raster { raster, .. } => off_scale(raster, None).ok()?.map(|off| off.to_string()),
            DatasetContent::Scene(ground) => ground.scale_note.clone(),
        };
        note.map(|note| format!("{}: {note}", self.name))
    }

    /// The coordinate system of positions unless the caller states another: the file's or the scene's.
    pub fn crs(&self) -> Crs {
        match &self.content {
            DatasetContent::Raster { raster, .. } => raster.crs.clone().unwrap_or_else(Crs::local),
            DatasetContent::Scene(ground) => ground.stated_crs.clone(),
        }
    }

    /// The surface that is queried unless the caller states another: the source of a file, the ground of a scene.
    pub fn default_surface(&self) -> Surface {
        match &self.content {
            DatasetContent::Raster { .. } => Surface::Source,
            DatasetContent::Scene(_) => Surface::Ground,
        }
    }

    /// The raster as read.
    pub fn source(&self) -> Arc<Raster> {
        match &self.content {
            DatasetContent::Raster { raster, .. } => Arc::clone(raster),
            DatasetContent::Scene(ground) => Arc::clone(ground.heights.snapshot().source()),
        }
    }

    /// The height service on the ground in meters.
    ///
    /// # Errors
    /// [`QueryError::Ground`].
    pub fn service(&self) -> Result<&HeightService, QueryError> {
        match &self.content {
            DatasetContent::Scene(ground) => Ok(&ground.heights),
            DatasetContent::Raster { raster, ground, .. } => {
                ground.get_or_init(|| ground::height_service(raster).map_err(Arc::new)).as_ref().map_err(
                    |error| QueryError::Ground { dataset: self.name.clone(), source: Arc::clone(error) },
                )
            }
        }
    }

    /// [`Dataset::service`] where the ground is made or has failed; `None` where it is not made yet.
    pub fn service_if_made(&self) -> Option<Result<&HeightService, QueryError>> {
        match &self.content {
            DatasetContent::Raster { ground, .. } if ground.get().is_none() => None,
            _ => Some(self.service()),
        }
    }

    /// The heights at positions in coordinates of `from`, in order.
    ///
    /// The source of a file without a coordinate system is taken to lie in `from`. A position that cannot be brought to
    /// the surface's system is [`Answer::Outside`].
    ///
    /// # Errors
    /// [`QueryError::Datum`]; for another surface than the source, [`QueryError::Ground`].
    pub fn heights(
        &self,
        surface: Surface,
        interpolation: Interpolation,
        from: &Crs,
        at: &[DVec2],
    ) -> Result<Vec<Answer>, QueryError> {
        let mut answers = vec![Answer::Outside; at.len()];
        if surface == Surface::Source {
            let source = self.source();
            self.check_datums(from, source.crs.as_ref().unwrap_or(from))?;
            source_heights(&source, from, interpolation, at, &mut answers);
            return Ok(answers);
        }
        let snapshot = self.service()?.snapshot();
        if from == snapshot.crs() {
            snapshot.heights(surface, interpolation, at, &mut answers);
            return Ok(answers);
        }
        self.check_datums(from, snapshot.crs())?;
        let transformed = |&at: &DVec2| from.transform(snapshot.crs(), at).unwrap_or(DVec2::NAN);
        let transformed: Vec<DVec2> = at.par_iter().map(transformed).collect();
        snapshot.heights(surface, interpolation, &transformed, &mut answers);
        Ok(answers)
    }

    fn check_datums(&self, from: &Crs, to: &Crs) -> Result<(), QueryError> {
        check_datums(from, to).map_err(|source| QueryError::Datum { dataset: self.name.clone(), source })
    }
}

/// Checks that the shift between the datums of two systems is known, which does not depend on the position.
///
/// # Errors
/// [`CrsError::Datum`].
pub fn check_datums(from: &Crs, to: &Crs) -> Result<(), CrsError> {
    match from.transform(to, DVec2::ZERO) {
        Err(error @ CrsError::Datum { .. }) => Err(error),
        _ => Ok(()),
    }
}

/// A position in another coordinate system; `what` names it in messages.
///
/// # Errors
/// [`QueryError::Position`].
pub fn transform(what: &str, from: &Crs, to: &Crs, at: DVec2) -> Result<DVec2, QueryError> {
    from.transform(to, at).map_err(|source| QueryError::Position { what: what.to_owned(), at, source })
}
