//! The subject of a height query: an elevation file, or the ground of a scene.
//!
//! Every command and the HTTP service query through [`Dataset`], so that they give the same answers: whether the elevation is
//! kept in memory, as a small file is, or read where a query needs it.

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use glam::DVec2;
use rayon::prelude::*;

use crate::dem::{self, OpenDemError, OpenedDem};
use crate::ground::{self, GroundError, QueriedGround};
use crate::windowed_elevation::{GroundReach, WindowedElevation};
use sandtable_dem::hints::DemOptions;
use sandtable_geom::crs::{Crs, CrsError};
use sandtable_raster::answer::{Answer, Status};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::Raster;
use sandtable_raster::stats::Stats;
use sandtable_raster::warp::metric_crs::off_scale;
use sandtable_raster::windows::MOST_KEPT_SAMPLES;
use sandtable_remote::address::is_address_path;
use sandtable_scene::build::SceneGround;
use sandtable_scene::scene_file::{OpenSceneError, is_scene_file, open_phase_ground, open_scene_ground};
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::query::batch::HeightSlices;
use sandtable_terrain::query::service::HeightService;
use sandtable_terrain::query::source::source_heights_apart;
use sandtable_terrain::query::{Interpolation, Surface};

/// Options for opening a dataset.
#[derive(Clone)]
pub struct DatasetOptions {
    /// Options for an elevation file.
    pub dem: DemOptions,
    /// Folders that a scene may read besides the parent of its own.
    pub allowed: Vec<PathBuf>,
    /// The most samples of an elevation file that is read whole and kept. A larger one is read where queries need it, if its
    /// format allows that. Default 2²⁰, which are read in some milliseconds.
    pub most_kept: u64,
}

impl Default for DatasetOptions {
    fn default() -> Self {
        Self { dem: DemOptions::default(), allowed: Vec::new(), most_kept: MOST_KEPT_SAMPLES }
    }
}

/// An elevation file, or a scene.
pub struct Dataset {
    name: String,
    content: DatasetContent,
    warning: Option<String>,
    /// The folders that it may read, of a scene.
    allowed: Vec<PathBuf>,
}

enum DatasetContent {
    /// The ground is made at the first query: an elevation file in degrees must be warped for it.
    Raster {
        raster: Arc<Raster>,
        ground: OnceLock<Result<HeightService, Arc<GroundError>>>,
    },
    /// Too large to be kept.
    Windows(Box<WindowedElevation>),
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
    Read { dataset: String, source: Arc<DemErrorKind> },
    #[error("{dataset}")]
    Datum { dataset: String, source: CrsError },
    #[error(
        "{dataset} has no overviews, and all of it would be fetched for a small map: copy the file here, or give it overviews (gdaladdo)"
    )]
    FarAway { dataset: String },
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

impl QueryError {
    /// The name of the dataset that is at fault; `None` where the query is.
    pub fn dataset(&self) -> Option<&str> {
        match self {
            Self::Ground { dataset, .. }
            | Self::Read { dataset, .. }
            | Self::Datum { dataset, .. }
            | Self::FarAway { dataset } => Some(dataset),
            Self::Position { .. } | Self::NoGround { .. } => None,
        }
    }
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
        if is_scene_file(path) {
            let ground = open_scene_ground(path, &options.allowed)?;
            let allowed = options.allowed.clone();
            return Ok(Self { name, content: DatasetContent::Scene(ground), warning: None, allowed });
        }
        // What is far away is read where it is needed, however small it is.
        let most_kept = if is_address_path(path) { 0 } else { options.most_kept };
        let (content, warning) = match dem::open_either(path, &options.dem, most_kept)? {
            OpenedDem::Kept(mosaic) => {
                let warning = dem::warning(path, &mosaic);
                let raster = Arc::new(mosaic.raster);
                (DatasetContent::Raster { raster, ground: OnceLock::new() }, warning)
            }
            OpenedDem::Windows(windows) => {
                let elevation = WindowedElevation::new(windows);
                let warning = dem::header_warning(path, elevation.header());
                (DatasetContent::Windows(Box::new(elevation)), warning)
            }
        };
        Ok(Self { name, content, warning, allowed: Vec::new() })
    }

    /// The ground of the scene file in the phase called `phase`.
    ///
    /// # Errors
    /// See [`OpenError`]; elevation has no phases.
    pub fn in_phase(&self, phase: &str) -> Result<Self, OpenError> {
        let DatasetContent::Scene(_) = &self.content else {
            return Err(OpenSceneError::NoPhase { name: phase.to_owned(), names: Vec::new() }.into());
        };
        let ground = open_phase_ground(Path::new(&self.name), &self.allowed, phase)?;
        let (name, content) = (self.name.clone(), DatasetContent::Scene(ground));
        Ok(Self { name, content, warning: None, allowed: self.allowed.clone() })
    }

    /// The dataset of the ground of a built scene, which messages call `name`.
    pub fn from_scene(name: &str, scene: &SceneModel) -> Self {
        Self::from_ground(name, SceneGround::of(scene))
    }

    /// The dataset of a scene's ground, which messages call `name`.
    pub fn from_ground(name: &str, ground: SceneGround) -> Self {
        let content = DatasetContent::Scene(ground);
        Self { name: name.to_owned(), content, warning: None, allowed: Vec::new() }
    }

    /// The dataset of a raster in memory, which messages call `name`.
    pub fn from_raster(name: &str, raster: Arc<Raster>) -> Self {
        let content = DatasetContent::Raster { raster, ground: OnceLock::new() };
        Self { name: name.to_owned(), content, warning: None, allowed: Vec::new() }
    }

    /// The dataset of elevation that stays on disk, which messages call `name`.
    #[cfg(test)]
    pub(crate) fn from_windows(name: &str, elevation: WindowedElevation) -> Self {
        let content = DatasetContent::Windows(Box::new(elevation));
        Self { name: name.to_owned(), content, warning: None, allowed: Vec::new() }
    }

    /// A warning for the user about the files, where there is one.
    pub fn warning(&self) -> Option<&str> {
        self.warning.as_deref()
    }

    /// What reading the files left out or guessed, a sentence each for the user, of a scene only of files that the ground
    /// is made of.
    pub fn reading_notes(&self) -> Vec<String> {
        match &self.content {
            DatasetContent::Scene(ground) => ground.reading_notes.clone(),
            _ => dem::reading_notes(Path::new(&self.name), &self.header()),
        }
    }

    /// A note for the user where the ground lies in another system than [`Dataset::crs`] because lengths in that are not
    /// true. It does not concern heights of the source.
    pub fn ground_note(&self) -> Option<String> {
        let note = match &self.content {
            // A raster without ground says so when its ground is made.
            DatasetContent::Raster { raster, .. } => off_scale(raster, None).ok()?.map(|off| off.to_string()),
            DatasetContent::Windows(elevation) => {
                elevation.plan().ok()?.off_scale().map(|off| off.to_string())
            }
            DatasetContent::Scene(ground) => ground.scale_note.clone(),
        };
        note.map(|note| format!("{}: {note}", self.name))
    }

    /// The coordinate system of positions unless the caller states another: the file's or the scene's.
    pub fn crs(&self) -> Crs {
        match &self.content {
            DatasetContent::Raster { raster, .. } => raster.crs.clone().unwrap_or_else(Crs::local),
            DatasetContent::Windows(elevation) => elevation.header().crs.clone().unwrap_or_else(Crs::local),
            DatasetContent::Scene(ground) => ground.stated_crs.clone(),
        }
    }

    /// The surface that is queried unless the caller states another: the source of a file, the ground of a scene.
    pub fn default_surface(&self) -> Surface {
        match &self.content {
            DatasetContent::Raster { .. } | DatasetContent::Windows(_) => Surface::Source,
            DatasetContent::Scene(_) => Surface::Ground,
        }
    }

    /// The raster as read; its samples may be left out.
    pub fn header(&self) -> Arc<Raster> {
        match &self.content {
            DatasetContent::Raster { raster, .. } => Arc::clone(raster),
            DatasetContent::Windows(elevation) => Arc::clone(elevation.header()),
            DatasetContent::Scene(ground) => Arc::clone(ground.heights.snapshot().source_header()),
        }
    }

    /// The raster as read, with all its samples.
    ///
    /// # Errors
    /// [`QueryError::Read`]: samples on disk cannot be read, or are too many.
    pub fn raster(&self) -> Result<Arc<Raster>, QueryError> {
        match &self.content {
            DatasetContent::Windows(elevation) => elevation.read().map(Arc::new).map_err(self.unreadable()),
            DatasetContent::Scene(ground) => Ok(Arc::clone(ground.heights.snapshot().source())),
            DatasetContent::Raster { raster, .. } => Ok(Arc::clone(raster)),
        }
    }

    /// The files that a scene was made of, besides the scene file itself; `None` for an elevation file.
    pub fn scene_files(&self) -> Option<&[PathBuf]> {
        match &self.content {
            DatasetContent::Scene(ground) => Some(&ground.files),
            DatasetContent::Raster { .. } | DatasetContent::Windows(_) => None,
        }
    }

    /// The least and the greatest height of the surface that is queried by default, meters; all of the elevation is read for it
    /// where it is not kept. Zeros where there is none.
    ///
    /// # Errors
    /// [`QueryError::Read`].
    pub fn height_range(&self) -> Result<(f64, f64), QueryError> {
        let (low, high) = match &self.content {
            DatasetContent::Raster { raster, .. } => {
                let Stats { min, max, .. } = Stats::new(raster);
                in_meters(raster, (min, max))
            }
            DatasetContent::Windows(elevation) => {
                let fault = |fault| QueryError::Read { dataset: self.name.clone(), source: Arc::new(fault) };
                in_meters(elevation.header(), elevation.range().map_err(fault)?)
            }
            DatasetContent::Scene(ground) => {
                let (low, high) = ground.heights.snapshot().lattice().height_range();
                (f64::from(low), f64::from(high))
            }
        };
        Ok(if low <= high { (low, high) } else { (0.0, 0.0) })
    }

    /// Whether queries read from disk.
    pub fn reads_windows(&self) -> bool {
        matches!(self.content, DatasetContent::Windows(_))
    }

    /// The ground in meters as far as a query reaches: all of it where it is kept in memory.
    ///
    /// # Errors
    /// [`QueryError::Ground`].
    pub fn ground(&self, reach: &GroundReach) -> Result<QueriedGround, QueryError> {
        match &self.content {
            DatasetContent::Windows(elevation) => elevation.ground(reach).map_err(self.no_ground()),
            _ => Ok(QueriedGround::from(&*self.service()?.snapshot())),
        }
    }

    /// The elevation that stays on disk; `None` of a dataset that is kept in memory.
    pub(crate) fn windowed(&self) -> Option<&WindowedElevation> {
        match &self.content {
            DatasetContent::Windows(elevation) => Some(elevation),
            _ => None,
        }
    }

    /// [`QueryError::Ground`] of this dataset.
    pub(crate) fn without_ground(&self, error: Arc<GroundError>) -> QueryError {
        self.no_ground()(error)
    }

    /// Makes what queries for the ground in meters need beforehand.
    ///
    /// # Errors
    /// [`QueryError::Ground`].
    pub fn prepare_ground(&self) -> Result<(), QueryError> {
        match &self.content {
            DatasetContent::Windows(elevation) => elevation.plan().map(drop).map_err(self.no_ground()),
            _ => self.service().map(drop),
        }
    }

    /// [`Dataset::prepare_ground`] where that is done or has failed; `None` where it is not done yet.
    pub fn prepared_ground(&self) -> Option<Result<(), QueryError>> {
        let is_prepared = match &self.content {
            DatasetContent::Raster { ground, .. } => ground.get().is_some(),
            DatasetContent::Windows(elevation) => elevation.is_planned(),
            DatasetContent::Scene(_) => true,
        };
        is_prepared.then(|| self.prepare_ground())
    }

    /// The height service on the ground in meters; `None` of a dataset that is not kept in memory.
    ///
    /// # Errors
    /// [`QueryError::Ground`].
    pub fn kept_service(&self) -> Result<Option<&HeightService>, QueryError> {
        if self.reads_windows() { Ok(None) } else { self.service().map(Some) }
    }

    /// The height service on the ground in meters, of a dataset that is kept in memory.
    fn service(&self) -> Result<&HeightService, QueryError> {
        match &self.content {
            DatasetContent::Scene(ground) => Ok(&ground.heights),
            DatasetContent::Raster { raster, ground, .. } => {
                let made = ground.get_or_init(|| ground::height_service(raster).map_err(Arc::new));
                made.as_ref().map_err(|error| self.no_ground()(Arc::clone(error)))
            }
            DatasetContent::Windows(_) => unreachable!("no service is made of what is not kept"),
        }
    }

    fn no_ground(&self) -> impl Fn(Arc<GroundError>) -> QueryError + '_ {
        |source| QueryError::Ground { dataset: self.name.clone(), source }
    }

    /// What messages call it.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// [`QueryError::Read`] of this dataset.
    pub(crate) fn unreadable(&self) -> impl Fn(DemErrorKind) -> QueryError + '_ {
        |fault| QueryError::Read { dataset: self.name.clone(), source: Arc::new(fault) }
    }

    /// The heights at positions in coordinates of `from`, in order.
    ///
    /// The source of a file without a coordinate system is taken to lie in `from`. A position that cannot be brought to
    /// the surface's system is [`Answer::Outside`].
    ///
    /// # Errors
    /// [`QueryError::Datum`], [`QueryError::Read`]; for another surface than the source, [`QueryError::Ground`].
    pub fn heights(
        &self,
        surface: Surface,
        interpolation: Interpolation,
        from: &Crs,
        at: &[DVec2],
    ) -> Result<Vec<Answer>, QueryError> {
        let (mut heights_m, mut statuses) = (vec![f64::NAN; at.len()], vec![Status::Outside; at.len()]);
        let out = HeightSlices { heights_m: &mut heights_m, statuses: &mut statuses };
        self.heights_apart(surface, interpolation, from, at, out)?;
        Ok(statuses.iter().zip(heights_m).map(|(status, height_m)| status.with_height(height_m)).collect())
    }

    /// [`Dataset::heights`] as heights and statuses in slices of their own.
    ///
    /// # Errors
    /// As [`Dataset::heights`]; `out` then means nothing.
    ///
    /// # Panics
    /// Where the slices are not as long as `at`.
    pub fn heights_apart(
        &self,
        surface: Surface,
        interpolation: Interpolation,
        from: &Crs,
        at: &[DVec2],
        mut out: HeightSlices<'_>,
    ) -> Result<(), QueryError> {
        if surface == Surface::Source {
            let source = self.header();
            self.check_datums(from, source.crs.as_ref().unwrap_or(from))?;
            match &self.content {
                DatasetContent::Windows(elevation) => {
                    let answers = elevation.source_heights(from, interpolation, at);
                    out.put(&answers.map_err(self.unreadable())?);
                }
                _ => source_heights_apart(&source, from, interpolation, at, out),
            }
            return Ok(());
        }
        if let DatasetContent::Windows(elevation) = &self.content {
            let crs = elevation.ground_crs().map_err(self.no_ground())?;
            let at = self.on_ground(from, &crs, at)?;
            out.put(&elevation.ground_heights(surface, interpolation, &at).map_err(self.no_ground())?);
            return Ok(());
        }
        let snapshot = self.service()?.snapshot();
        let at = self.on_ground(from, snapshot.crs(), at)?;
        snapshot.heights_apart(surface, interpolation, &at, out);
        Ok(())
    }

    /// Positions in the ground's system; NaN where they have no place in it.
    fn on_ground<'a>(&self, from: &Crs, to: &Crs, at: &'a [DVec2]) -> Result<Cow<'a, [DVec2]>, QueryError> {
        if from == to {
            return Ok(Cow::Borrowed(at));
        }
        self.check_datums(from, to)?;
        let transformed = |&at: &DVec2| from.transform(to, at).unwrap_or(DVec2::NAN);
        Ok(Cow::Owned(at.par_iter().map(transformed).collect()))
    }

    fn check_datums(&self, from: &Crs, to: &Crs) -> Result<(), QueryError> {
        check_datums(from, to).map_err(|source| QueryError::Datum { dataset: self.name.clone(), source })
    }
}

/// The least and the greatest sample of a raster in meters.
fn in_meters(raster: &Raster, (low, high): (f64, f64)) -> (f64, f64) {
    (low * raster.meters_per_z, high * raster.meters_per_z)
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
