//! Terrain analyses of elevation and scenes.

use std::sync::Arc;

use crate::api::dem::Dem;
use crate::api::elevation::Elevation;
use crate::api::error::Error;
use crate::api::scene::Scene;
use sandtable_analysis::outcome::PostValues;
use sandtable_base::message::suggest::{quoted, remedy};
use sandtable_catalog::kind::AnalysisKind;
use sandtable_catalog::{kind, kinds};
use sandtable_export::features::analysis_json::{catalog_json, outcome_json};
use sandtable_export::features::outcome::outcome_geojson;
use sandtable_geom::crs::Crs;
use sandtable_query::analysis::{AnalyzeError, Analyzed, WrittenArgument, analyze, bare_land};
use sandtable_query::analysis_bands::OutcomeWindows;
use sandtable_query::dataset::Dataset;
use sandtable_scene::land::land_of;
use sandtable_scene::scene_file::build_land;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::vertical_scale::VerticalScale;
use sandtable_terrain::stop_flag::StopFlag;

/// What an analysis gives: that of the command `analyze`, to the last bit.
///
/// ```
/// use sandtable::Elevation;
/// let elevation = Elevation::open("assets/jacksboro/dem.tif")?;
/// let slope = elevation.analyze("slope", &[("unit", "degrees")], &elevation.crs())?;
/// let raster = slope.raster().expect("slope gives a raster");
/// assert_eq!((raster.size(), slope.unit()), ((374, 393), "°"));
/// # Ok::<(), sandtable::Error>(())
/// ```
pub struct Analysis {
    kind: &'static AnalysisKind,
    arguments: Vec<WrittenArgument>,
    analyzed: Analyzed,
}

/// A class of the values of an analysis.
#[derive(Clone, Debug, PartialEq)]
pub struct AnalysisClass {
    /// Its name.
    pub label: String,
    /// The least value of it; it ends where the next begins.
    pub from: f32,
    /// Red, green, blue and opacity of its tint.
    pub tint: [u8; 4],
}

/// An analysis that is not made.
#[derive(Debug, thiserror::Error)]
pub enum AnalysisFailure {
    /// There is no such kind.
    #[error("there is no analysis {}; {}", quoted(.0), remedy(.0, &kinds().map(|kind| kind.name).collect::<Vec<_>>(), "the kinds are"))]
    Kind(String),
    /// It has no outcome.
    #[error(transparent)]
    Analyze(#[from] AnalyzeError),
}

/// The kinds of analysis with their parameters, sources and limits, as a JSON list.
pub fn analysis_kinds() -> String {
    catalog_json().to_string()
}

fn asked(
    name: &str,
    arguments: &[(&str, &str)],
) -> Result<(&'static AnalysisKind, Vec<WrittenArgument>), Error> {
    let kind = kind(name).ok_or_else(|| AnalysisFailure::Kind(name.to_owned()))?;
    let written = |&(name, text): &(&str, &str)| WrittenArgument { name: name.into(), text: text.into() };
    Ok((kind, arguments.iter().map(written).collect()))
}

fn failed(error: AnalyzeError) -> Error {
    AnalysisFailure::from(error).into()
}

impl Elevation {
    /// Analyzes the ground by a kind of [`analysis_kinds`], with arguments as the command has them: names in `snake_case` and
    /// texts. Positions are in coordinates of `crs`.
    ///
    /// # Errors
    /// [`Error::Analysis`].
    pub fn analyze(&self, kind: &str, arguments: &[(&str, &str)], crs: &Crs) -> Result<Analysis, Error> {
        self.analyze_until(kind, arguments, crs, &StopFlag::default())
    }

    /// [`Elevation::analyze`] as long as another thread does not stop it; [`StopFlag::share`] says how much of it is done.
    ///
    /// # Errors
    /// [`Error::Analysis`], also where it was stopped.
    pub fn analyze_until(
        &self,
        kind: &str,
        arguments: &[(&str, &str)],
        crs: &Crs,
        stop: &StopFlag,
    ) -> Result<Analysis, Error> {
        let (kind, arguments) = asked(kind, arguments)?;
        let land = bare_land(&self.dataset, (kind, &arguments), crs).map_err(failed)?;
        let analyzed = analyze(&self.dataset, land, (kind, &arguments), crs, stop);
        Ok(Analysis { kind, analyzed: analyzed.map_err(failed)?, arguments })
    }
}

impl Scene {
    /// The system of its map coordinates, as its file states it.
    pub fn crs(&self) -> Crs {
        self.model.stated_crs.clone()
    }

    /// Analyzes the ground and what lies on it, true to scale, as [`Elevation::analyze`].
    ///
    /// # Errors
    /// [`Error::Analysis`]; [`Error::OpenScene`] where its heights are exaggerated and it cannot be opened again.
    pub fn analyze(&self, kind: &str, arguments: &[(&str, &str)], crs: &Crs) -> Result<Analysis, Error> {
        self.analyze_until(kind, arguments, crs, &StopFlag::default())
    }

    /// [`Scene::analyze`] as long as another thread does not stop it, as [`Elevation::analyze_until`].
    ///
    /// # Errors
    /// As for [`Scene::analyze`]; [`Error::Analysis`] also where it was stopped.
    pub fn analyze_until(
        &self,
        kind: &str,
        arguments: &[(&str, &str)],
        crs: &Crs,
        stop: &StopFlag,
    ) -> Result<Analysis, Error> {
        let (kind, arguments) = asked(kind, arguments)?;
        let model = self.true_to_scale()?;
        let dataset = Dataset::from_scene(&self.origin.path.display().to_string(), model);
        let land = land_of(model, kind.layers);
        let analyzed = analyze(&dataset, land, (kind, &arguments), crs, stop);
        Ok(Analysis { kind, analyzed: analyzed.map_err(failed)?, arguments })
    }
}

impl Scene {
    /// The scene with heights true to scale: opened again and kept, where the file exaggerates them.
    fn true_to_scale(&self) -> Result<&SceneModel, Error> {
        if self.model.scale == VerticalScale(1.0) {
            return Ok(&self.model);
        }
        if let Some(kept) = self.true_to_scale.get() {
            return Ok(kept);
        }
        let opened = build_land(&self.origin, &|_| ())?;
        // Another thread that was first opened the same.
        Ok(self.true_to_scale.get_or_init(|| Box::new(opened)))
    }
}

impl Analysis {
    /// Its kind, source, limits, arguments, figures, tables and notes, as a JSON object.
    pub fn json(&self) -> String {
        outcome_json(self.kind, &self.arguments, &self.analyzed.outcome).to_string()
    }

    /// The system of its raster and features.
    pub fn crs(&self) -> &Crs {
        &self.analyzed.crs
    }

    /// A value for each post, from the north-west, NaN where there is none; `None` of a kind that gives none.
    pub fn raster(&self) -> Option<Dem> {
        let Analyzed { ground, crs, outcome } = &self.analyzed;
        let windows = OutcomeWindows::new(outcome.raster.as_ref()?, ground, crs);
        Some(Dem { raster: Arc::new(windows.raster()) })
    }

    /// Whether the values are codes of a byte, of which 255 is none.
    pub fn has_codes(&self) -> bool {
        let values = self.analyzed.outcome.raster.as_ref().map(|raster| &raster.values);
        matches!(values, Some(PostValues::Codes(_)))
    }

    /// What the values are, such as `slope`; the kind's name where it gives no raster.
    pub fn name(&self) -> &'static str {
        self.analyzed.outcome.raster.as_ref().map_or(self.kind.name, |raster| raster.name)
    }

    /// The unit of the values; empty where they have none.
    pub fn unit(&self) -> &'static str {
        self.analyzed.outcome.raster.as_ref().map_or("", |raster| raster.unit)
    }

    /// The classes of the values.
    pub fn classes(&self) -> Vec<AnalysisClass> {
        let classes = self.analyzed.outcome.raster.iter().flat_map(|raster| &raster.classes);
        classes
            .map(|class| AnalysisClass {
                label: class.label.clone(),
                from: class.from,
                tint: class.look.tint,
            })
            .collect()
    }

    /// Its points, lines and areas in its system, as GeoJSON: a collection without those of its classes.
    pub fn features(&self) -> String {
        outcome_geojson(&self.analyzed.outcome, self.kind.title)
    }
}
