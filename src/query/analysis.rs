//! Terrain analyses of a dataset: arguments from text, and the land.

use std::path::Path;
use std::sync::Arc;

use glam::DVec2;

use crate::analysis_extent;
use crate::dataset::{Dataset, DatasetOptions, OpenError, QueryError};
use crate::ground::{GroundError, QueriedGround};
use crate::positions::{PositionArgument, position_list};
use crate::post_raster::post_header;
use crate::windowed_elevation::GroundReach;
use sandtable_analysis::arguments::{AnalysisArguments, ArgumentValue};
use sandtable_analysis::error::AnalysisError;
use sandtable_analysis::extent::{LandExtent, PlacedOutcome, ground_part, run_within};
use sandtable_analysis::land::Land;
use sandtable_analysis::outcome::Outcome;
use sandtable_base::message::suggest::{quoted, remedy};
use sandtable_catalog::kind::AnalysisKind;
use sandtable_catalog::parameter::{
    AnalysisParameter, EXTENT, PHASE_PREFIX, ParameterDefault, ParameterForm, SOURCE_GROUND,
};
use sandtable_files::scratch_file::ScratchError;
use sandtable_geom::crs::{Crs, CrsError};
use sandtable_raster::raster::{Raster, Samples};
use sandtable_scene::analyses::ground_at_posts;
use sandtable_scene::scene_file::OpenSceneError;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::query::Surface;
use sandtable_terrain::stop_flag::StopFlag;

/// An argument as users write it, and its parameter's name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrittenArgument {
    /// The name.
    pub name: String,
    /// The value.
    pub text: String,
}

/// An analysis that has no outcome.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum AnalyzeError {
    /// An argument is wrong.
    #[error("`{name}`: {problem}")]
    Argument { name: String, problem: String },
    #[error(transparent)]
    Query(Box<QueryError>),
    #[error(transparent)]
    Ground(Box<GroundError>),
    /// The ground to compare with cannot be opened.
    #[error("`{name}`")]
    Other { name: String, source: Box<OpenError> },
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// A scene that exaggerates heights cannot be built true to scale.
    #[error(transparent)]
    Scene(Box<OpenSceneError>),
    /// There is no disk for what is known meanwhile.
    #[error(transparent)]
    Scratch(#[from] ScratchError),
    /// A kind that reaches everywhere cannot be cut into parts.
    #[error(
        "{kind} cannot be cut into parts: land from everywhere has an effect on its values; run `analyze {kind}`, where \
         `--extent` limits the land"
    )]
    Whole { kind: &'static str },
    /// A kind that can be cut into parts where it states how far it looks.
    #[error(
        "`{key}`: {kind} can be cut into parts where it is stated: all ground within it has an effect on a value; state it, or \
         run `analyze {kind}`"
    )]
    Unlimited { kind: &'static str, key: &'static str },
}

impl From<QueryError> for AnalyzeError {
    fn from(error: QueryError) -> Self {
        Self::Query(error.into())
    }
}

impl From<GroundError> for AnalyzeError {
    fn from(error: GroundError) -> Self {
        Self::Ground(error.into())
    }
}

impl AnalyzeError {
    /// The parameter that is at fault, where one is.
    pub fn key(&self) -> Option<&str> {
        match self {
            Self::Argument { name, .. } | Self::Other { name, .. } => Some(name),
            Self::Analysis(error) => error.key(),
            Self::Unlimited { key, .. } => Some(key),
            Self::Query(_) | Self::Ground(_) | Self::Scene(_) | Self::Scratch(_) | Self::Whole { .. } => None,
        }
    }

    fn argument(name: &str, problem: impl Into<String>) -> Self {
        Self::Argument { name: name.to_owned(), problem: problem.into() }
    }
}

/// The datasets that an argument may name as another ground.
#[derive(Clone, Copy)]
pub enum OtherGrounds<'a> {
    /// Every file that can be opened.
    Files,
    /// Those that are known by name; none is opened.
    Named(&'a (dyn Fn(&str) -> Option<&'a Dataset> + Sync)),
}

/// An analysis that was made: its land and what it gives.
pub struct Analyzed {
    /// The ground of the land; values of rasters are those of its posts.
    pub ground: Arc<Lattice>,
    /// The system of the land and of features.
    pub crs: Crs,
    /// What the analysis gives.
    pub outcome: Outcome,
}

/// The land of a dataset without what lies on its ground: as much of it as the analysis needs, where that is read from disk.
///
/// # Errors
/// [`AnalyzeError::Query`], [`AnalyzeError::Ground`], and [`AnalyzeError::Argument`] of an extent.
pub fn bare_land(
    dataset: &Dataset,
    (kind, arguments): (&'static AnalysisKind, &[WrittenArgument]),
    crs: &Crs,
) -> Result<Land, AnalyzeError> {
    let frame = frame(dataset)?;
    if frame.lattice.holds_all() {
        return Ok(Land::bare(frame.lattice, frame.crs));
    }
    let posts = posts_of((kind, arguments), crs, (&frame.lattice, &frame.crs))?;
    bare_posts(dataset, &frame, posts)
}

/// The land of posts of the ground of a dataset, of which `frame` holds a few, without what lies on it.
pub(crate) fn bare_posts(
    dataset: &Dataset,
    frame: &QueriedGround,
    posts: PostRect,
) -> Result<Land, AnalyzeError> {
    let corners = [posts.first, posts.last].map(|post| frame.lattice.map_position(post));
    let ground = dataset.ground(&GroundReach { crs: &frame.crs, at: &corners, around_m: 0.0 })?;
    let part = ground_part(&ground.lattice, posts).map_err(GroundError::from)?;
    Ok(Land::bare(part, ground.crs))
}

/// The posts of the ground of a dataset that the analysis needs.
///
/// # Errors
/// As [`bare_land`].
pub fn needed_posts(
    dataset: &Dataset,
    analysis: (&'static AnalysisKind, &[WrittenArgument]),
    crs: &Crs,
) -> Result<PostRect, AnalyzeError> {
    let frame = frame(dataset)?;
    posts_of(analysis, crs, (&frame.lattice, &frame.crs))
}

/// The ground of a dataset with a few of its posts, or all where they are in memory.
///
/// # Errors
/// There is no ground.
pub fn frame(dataset: &Dataset) -> Result<QueriedGround, QueryError> {
    dataset.ground(&GroundReach { crs: &dataset.crs(), at: &[], around_m: 0.0 })
}

fn posts_of(
    (kind, arguments): (&'static AnalysisKind, &[WrittenArgument]),
    crs: &Crs,
    (ground, land_crs): (&Lattice, &Crs),
) -> Result<PostRect, AnalyzeError> {
    let Some(extent) = extent(arguments, crs, land_crs)? else { return Ok(PostRect::all(ground)) };
    let arguments = read(kind, arguments, crs, land_crs)?;
    extent.needed_posts(&arguments, ground).map_err(of_extent)
}

/// The argument `extent`, brought from `crs` to `land_crs`; `None` where it is not stated.
///
/// # Errors
/// [`AnalyzeError::Argument`]: the text is no extent.
pub fn extent(
    arguments: &[WrittenArgument],
    crs: &Crs,
    land_crs: &Crs,
) -> Result<Option<LandExtent>, AnalyzeError> {
    let written = arguments.iter().find(|argument| argument.name == EXTENT.name);
    written
        .map(|argument| analysis_extent::parse(&argument.text, crs, land_crs).map_err(of_extent))
        .transpose()
}

pub(crate) fn of_extent(problem: String) -> AnalyzeError {
    AnalyzeError::argument(EXTENT.name, problem)
}

/// Analyzes the land of a dataset, or the part of it that the argument `extent` states. Positions of `arguments` are in
/// coordinates of `crs`, and another ground is a file.
///
/// # Errors
/// See [`AnalyzeError`].
pub fn analyze(
    dataset: &Dataset,
    land: Land,
    analysis: (&'static AnalysisKind, &[WrittenArgument]),
    crs: &Crs,
    stop: &StopFlag,
) -> Result<Analyzed, AnalyzeError> {
    analyze_among((dataset, OtherGrounds::Files), land, analysis, crs, stop)
}

/// [`analyze`] with the datasets that may be another ground.
///
/// # Errors
/// See [`AnalyzeError`].
pub fn analyze_among(
    grounds: (&Dataset, OtherGrounds<'_>),
    land: Land,
    (kind, arguments): (&'static AnalysisKind, &[WrittenArgument]),
    crs: &Crs,
    stop: &StopFlag,
) -> Result<Analyzed, AnalyzeError> {
    let extent = extent(arguments, crs, &land.crs)?;
    let arguments = read(kind, arguments, crs, &land.crs)?;
    let compared = |land: &Land| compared(grounds, &arguments, land);
    let PlacedOutcome { ground, outcome } = run_within(&land, &arguments, extent.as_ref(), compared, stop)?;
    Ok(Analyzed { ground, crs: land.crs, outcome })
}

/// The ground that an analysis compares with, at the posts of the land; `None` for one that states none.
pub(crate) fn compared(
    grounds: (&Dataset, OtherGrounds<'_>),
    arguments: &AnalysisArguments,
    land: &Land,
) -> Result<Option<Arc<Lattice>>, AnalyzeError> {
    let mut parameters = arguments.kind().parameters.iter();
    let Some(parameter) = parameters.find(|parameter| parameter.form == ParameterForm::Ground) else {
        return Ok(None);
    };
    let file = arguments.word(parameter.name);
    if file.is_empty() {
        return Ok(None);
    }
    other_ground((parameter.name, &file), grounds, land).map(Some)
}

/// The heights of an elevation file or scene at the posts of the land, NaN where it has none: of `file`, or of the dataset's
/// own elevation before earthworks where that is `source`.
fn other_ground(
    (name, file): (&str, &str),
    (dataset, others): (&Dataset, OtherGrounds<'_>),
    land: &Land,
) -> Result<Arc<Lattice>, AnalyzeError> {
    let unreadable =
        |source: OpenError| AnalyzeError::Other { name: name.to_owned(), source: Box::new(source) };
    let opened;
    let (other, surface) = match others {
        _ if file == SOURCE_GROUND => (dataset, Surface::Source),
        OtherGrounds::Files if file.starts_with(PHASE_PREFIX) => {
            opened = dataset.in_phase(&file[PHASE_PREFIX.len()..]).map_err(unreadable)?;
            (&opened, Surface::Ground)
        }
        OtherGrounds::Files => {
            opened = Dataset::open(Path::new(file), &DatasetOptions::default()).map_err(unreadable)?;
            (&opened, Surface::Ground)
        }
        OtherGrounds::Named(find) => {
            let unknown = || AnalyzeError::argument(name, format!("there is no dataset {}", quoted(file)));
            (find(file).ok_or_else(unknown)?, Surface::Ground)
        }
    };
    let heights = |interpolation, at: &[DVec2]| other.heights(surface, interpolation, &land.crs, at);
    ground_at_posts(&land.ground, surface, heights)?
        .ok_or_else(|| AnalyzeError::argument(name, format!("{file} has no ground at the posts of the land")))
}

/// The arguments of a kind from what users wrote, without the extent, positions brought from `crs` to `land_crs`.
///
/// # Errors
/// [`AnalyzeError::Argument`]: a name that the kind does not know, a value out of its range or of another form, a parameter
/// that is required and missing.
pub fn read(
    kind: &'static AnalysisKind,
    written: &[WrittenArgument],
    crs: &Crs,
    land_crs: &Crs,
) -> Result<AnalysisArguments, AnalyzeError> {
    let mut arguments = AnalysisArguments::new(kind);
    for WrittenArgument { name, text } in written.iter().filter(|argument| argument.name != EXTENT.name) {
        let Some(parameter) = kind.parameter(name) else {
            let names: Vec<&str> = kind.all_parameters().map(|parameter| parameter.name).collect();
            let help = remedy(name, &names, "it has none");
            return Err(AnalyzeError::argument(
                name,
                format!("the analysis {} does not have it; {help}", kind.name),
            ));
        };
        let value = value(parameter, text, crs, land_crs)
            .map_err(|problem| AnalyzeError::argument(parameter.name, problem))?;
        arguments = arguments.with(parameter.name, value);
    }
    let is_stated =
        |parameter: &AnalysisParameter| written.iter().any(|argument| argument.name == parameter.name);
    let required = kind.parameters.iter().filter(|parameter| parameter.default == ParameterDefault::Required);
    match required.into_iter().find(|parameter| !is_stated(parameter)) {
        Some(missing) => Err(AnalyzeError::argument(
            missing.name,
            format!("{} must be stated: {}", kind.name, missing.doc),
        )),
        None => Ok(arguments),
    }
}

fn value(
    parameter: &AnalysisParameter,
    text: &str,
    crs: &Crs,
    land_crs: &Crs,
) -> Result<ArgumentValue, String> {
    match parameter.form {
        ParameterForm::Number { least, greatest } => {
            number(text, (least, greatest), parameter.unit).map(ArgumentValue::Number)
        }
        ParameterForm::Numbers { least, greatest } => {
            let numbers: Vec<f64> = text
                .split(',')
                .map(|text| number(text, (least, greatest), parameter.unit))
                .collect::<Result<_, _>>()?;
            match numbers.is_sorted_by(|low, high| low < high) {
                true => Ok(ArgumentValue::Numbers(numbers)),
                false => Err(format!("{text} does not rise; write each number greater than the one before")),
            }
        }
        ParameterForm::Word(words) => match words.contains(&text) {
            true => Ok(ArgumentValue::Word(text.to_owned())),
            false => Err(format!("{} is none of its words; {}", quoted(text), remedy(text, words, ""))),
        },
        ParameterForm::Points { least } => points(text, least, crs, land_crs),
        ParameterForm::Line => points(text, 2, crs, land_crs),
        ParameterForm::Area => points(text, 3, crs, land_crs),
        ParameterForm::Vehicle | ParameterForm::Ground | ParameterForm::Extent => {
            Ok(ArgumentValue::Word(text.to_owned()))
        }
    }
}

fn number(text: &str, (least, greatest): (f64, f64), unit: &str) -> Result<f64, String> {
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let wanted = format!("write a number from {least} to {greatest}{unit}");
    let number: f64 = text.trim().parse().map_err(|_| format!("{} is no number; {wanted}", quoted(text)))?;
    match (least..=greatest).contains(&number) {
        true => Ok(number),
        false => Err(format!("{number} is out of range; {wanted}")),
    }
}

/// Positions as [`position_list`] reads them, in the land's system.
fn points(text: &str, least: usize, crs: &Crs, land_crs: &Crs) -> Result<ArgumentValue, String> {
    let place = |position: PositionArgument| {
        let written = position.written(crs)?;
        crs.transform(land_crs, written.at)
    };
    let points: Result<Vec<DVec2>, CrsError> = position_list(text)?.into_iter().map(place).collect();
    let points = points.map_err(|error| error.to_string())?;
    match points.len() >= least {
        true => Ok(ArgumentValue::Points(points)),
        false => Err(format!(
            "it needs at least {least} position{}, found {}; write them with semicolons between",
            if least == 1 { "" } else { "s" },
            points.len()
        )),
    }
}

/// The raster of the heights of a ground, north up.
pub fn ground_raster(ground: &Lattice, crs: &Crs) -> Raster {
    let columns = ground.columns() as usize;
    let rows = ground.heights().chunks_exact(columns).rev();
    let header = post_header(ground, crs, ("ground", "Float32"), -9999.0);
    Raster { samples: Samples::F32(rows.flatten().copied().collect()), ..header }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_slope(name: &str, text: &str) -> Result<AnalysisArguments, String> {
        let kind = sandtable_catalog::kind("slope").expect("a kind");
        let written = [WrittenArgument { name: name.into(), text: text.into() }];
        read(kind, &written, &Crs::local(), &Crs::local()).map_err(|error| error.to_string())
    }

    #[test]
    fn a_word_is_read_and_another_is_refused_with_the_nearest() {
        assert_eq!(read_slope("unit", "degrees").map(|read| read.word("unit")), Ok("degrees".to_owned()));
        let refused = read_slope("unit", "degree").expect_err("no word");
        assert!(refused.starts_with("`unit`: ") && refused.contains("degrees"), "{refused}");
    }

    #[test]
    fn a_parameter_of_no_kind_is_refused_by_its_name() {
        let refused = read_slope("units", "degrees").expect_err("no parameter");
        assert!(refused.contains("`units`") && refused.contains("unit"), "{refused}");
    }

    #[test]
    fn too_few_positions_are_counted() {
        assert_eq!(
            points("1,2", 2, &Crs::local(), &Crs::local()),
            Err("it needs at least 2 positions, found 1; write them with semicolons between".into())
        );
        assert_eq!(
            points("1,2; 3,4", 2, &Crs::local(), &Crs::local()),
            Ok(ArgumentValue::Points(vec![DVec2::new(1.0, 2.0), DVec2::new(3.0, 4.0)]))
        );
    }
}
