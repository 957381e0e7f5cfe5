//! Queries of elevation of any size, in any coordinate system.

use std::path::Path;
use std::sync::Arc;

use glam::DVec2;

use crate::api::dem::Dem;
use crate::api::error::Error;
use crate::api::terrain::Terrain;
use sandtable_annotate::chart_sight::SightChart;
use sandtable_dem::hints::DemOptions;
use sandtable_geom::crs::Crs;
use sandtable_query::dataset::{Dataset, DatasetOptions, QueryError, transform};
use sandtable_query::positions::InputLine;
use sandtable_query::profile::GroundProfile;
use sandtable_query::sight::{SightQuery, SightReport};
use sandtable_query::viewshed::raster;
use sandtable_query::windowed_elevation::GroundReach;
use sandtable_raster::answer::Answer;
use sandtable_terrain::profile::Sampling;
use sandtable_terrain::query::batch::HeightSlices;
use sandtable_terrain::query::{Interpolation, Surface};
use sandtable_terrain::sight::viewshed::{ViewshedOptions, viewshed};

/// Elevation to query: a file, the tiles in a folder, a raster in memory, or the ground of a scene.
///
/// A file of more than a million samples stays on disk where its format allows that, and a query reads what it needs of it.
/// Positions are in any coordinate system. Answers are those of the commands `height`, `profile`, `los` and `viewshed`, to the
/// last bit.
///
/// ```
/// use sandtable::{Crs, DVec2, Elevation, HeightSlices, Interpolation, Status, Surface};
/// let elevation = Elevation::open("assets/jacksboro/dem.tif")?;
/// let at = [DVec2::new(-84.2, 36.3), DVec2::new(0.0, 0.0)];
/// let (mut heights_m, mut statuses) = ([0.0; 2], [Status::Ok; 2]);
/// let out = HeightSlices { heights_m: &mut heights_m, statuses: &mut statuses };
/// elevation.heights(Surface::Source, Interpolation::Bilinear, (&Crs::wgs84(), &at), out)?;
/// assert_eq!(statuses, [Status::Ok, Status::Outside]);
/// assert_eq!(heights_m[0].round(), 375.0);
/// # Ok::<(), sandtable::Error>(())
/// ```
pub struct Elevation {
    pub(crate) dataset: Dataset,
}

impl Elevation {
    /// Opens an elevation file with its sidecars, the tiles in a folder, or the ground of a scene (`.toml`).
    ///
    /// # Errors
    /// [`Error::OpenDem`], [`Error::OpenScene`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::open_with(path, &DemOptions::default())
    }

    /// [`Elevation::open`] with what the elevation file does not state.
    ///
    /// # Errors
    /// [`Error::OpenDem`], [`Error::OpenScene`].
    pub fn open_with(path: impl AsRef<Path>, options: &DemOptions) -> Result<Self, Error> {
        let options = DatasetOptions { dem: options.clone(), ..DatasetOptions::default() };
        Ok(Self { dataset: Dataset::open(path.as_ref(), &options)? })
    }

    /// Queries of an elevation model in memory.
    pub fn new(dem: &Dem) -> Self {
        Self { dataset: Dataset::from_raster("the elevation model", Arc::clone(&dem.raster)) }
    }

    /// Columns and rows of samples.
    pub fn size(&self) -> (u32, u32) {
        let header = self.dataset.header();
        (header.width, header.height)
    }

    /// The georeference of the samples, as [`Dem::geotransform`].
    pub fn geotransform(&self) -> [f64; 6] {
        self.dataset.header().geotransform()
    }

    /// The coordinate system of the file or the scene; [`Crs::local`] where none is stated.
    pub fn crs(&self) -> Crs {
        self.dataset.crs()
    }

    /// The vertical datum of the heights, in the file's words; `None` where not stated.
    pub fn vertical_datum(&self) -> Option<String> {
        self.dataset.header().vertical_datum.clone()
    }

    /// A sentence about tiles that contradict each other; `None` where none do.
    pub fn warning(&self) -> Option<&str> {
        self.dataset.warning()
    }

    /// What reading the files left out or guessed, a sentence each; of a scene only of files that its ground is made of.
    pub fn notes(&self) -> Vec<String> {
        self.dataset.reading_notes()
    }

    /// The surface of most queries: the source of a file, the ground of a scene.
    pub fn default_surface(&self) -> Surface {
        self.dataset.default_surface()
    }

    /// The heights of a surface at positions in coordinates of `crs`, and why there is none where there is none.
    ///
    /// # Errors
    /// [`Error::Query`]: the samples cannot be read, the datum of `crs` has no known shift, or there is no ground.
    ///
    /// # Panics
    /// Where the slices of `out` are not as long as `at`.
    pub fn heights(
        &self,
        surface: Surface,
        interpolation: Interpolation,
        (crs, at): (&Crs, &[DVec2]),
        out: HeightSlices<'_>,
    ) -> Result<(), Error> {
        Ok(self.dataset.heights_apart(surface, interpolation, crs, at, out)?)
    }

    /// The ground along a line of at least two vertices in coordinates of `crs`: a station wherever it bends.
    ///
    /// # Errors
    /// [`Error::Query`], [`Error::Profile`].
    pub fn profile(
        &self,
        (crs, vertices): (&Crs, &[DVec2]),
        sampling: Sampling,
    ) -> Result<GroundProfile, Error> {
        let ground = self.dataset.ground(&GroundReach { crs, at: vertices, around_m: 0.0 })?;
        let line = InputLine { vertices: vertices.to_vec(), crs: crs.clone(), notes: Vec::new() };
        Ok(GroundProfile::new(&ground, line, sampling)?)
    }

    /// Whether one position sees another, what blocks it first, and how much is missing.
    ///
    /// # Errors
    /// [`Error::Query`].
    pub fn line_of_sight(&self, query: SightQuery) -> Result<SightReport, Error> {
        let at = query.ends.map(|end| end.at);
        let ground = self.dataset.ground(&GroundReach { crs: &query.crs, at: &at, around_m: 0.0 })?;
        Ok(SightReport::new(&ground, query)?)
    }

    /// What a chart of the line of sight shows, as `sandtable los -o` draws it: the ground and its visible parts, all heights
    /// less the drop of the curved Earth, so that the line is straight.
    ///
    /// # Errors
    /// [`Error::Query`].
    pub fn sight_chart(&self, query: SightQuery, title: String) -> Result<SightChart, Error> {
        let at = query.ends.map(|end| end.at);
        let ground = self.dataset.ground(&GroundReach { crs: &query.crs, at: &at, around_m: 0.0 })?;
        Ok(SightReport::new(&ground, query)?.chart(&ground, title)?)
    }

    /// The viewshed of an observer whose position is in coordinates of `crs`, as [`Terrain::viewshed`]. Where the file stays
    /// on disk the raster covers the square around the range.
    ///
    /// # Errors
    /// [`Error::Query`].
    pub fn viewshed(&self, crs: &Crs, options: &ViewshedOptions) -> Result<Dem, Error> {
        let stated = options.observer.at;
        let reach = GroundReach { crs, at: &[stated], around_m: options.range_m };
        let ground = self.dataset.ground(&reach)?;
        let mut options = *options;
        options.observer.at = transform("the observer at", crs, &ground.crs, stated)?;
        let no_ground =
            |answer: Answer| QueryError::NoGround { what: "the observer at".into(), at: stated, answer };
        let seen = viewshed(&ground.lattice, &options).map_err(no_ground)?;
        Ok(Dem { raster: Arc::new(raster(&*ground.held_lattice()?, &seen, &ground.crs)) })
    }

    /// The samples as read, all of them in memory.
    ///
    /// # Errors
    /// [`Error::Query`]: they cannot be read, or are more than a raster in memory has.
    pub fn dem(&self) -> Result<Dem, Error> {
        Ok(Dem { raster: self.dataset.raster()? })
    }

    /// The ground in meters, all of it in memory.
    ///
    /// # Errors
    /// [`Error::Query`], [`Error::Ground`], [`Error::Mesh`] where there are too many posts.
    pub fn terrain(&self) -> Result<Terrain, Error> {
        match self.dataset.kept_service()? {
            Some(heights) => Terrain::from_heights(heights.clone()),
            None => Terrain::new(&self.dem()?),
        }
    }
}
