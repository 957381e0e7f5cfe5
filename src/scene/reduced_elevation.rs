//! Elevation of more samples than a scene needs: means of squares of them, read in windows or from an overview of the file.

use crate::finer_elevation::level_samples;
use crate::framing::shown_step::{UnreadGround, shown_step};
use crate::planned_pictures::{
    ElevationNeed, NearGround, PlannedPictures, depends_on_samples, show_panorama,
};
use crate::scene_findings::SceneFindings;
use sandtable_base::limits::{PICTURED_SAMPLES, RASTER_SAMPLES, REDUCED_SAMPLES};
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::finding_code::FindingCode;
use sandtable_geom::crs::Crs;
use sandtable_raster::raster::Raster;
use sandtable_raster::reduced::reduced;
use sandtable_raster::warp::metric_windows::MetricSystem;
use sandtable_raster::windows::Windows;

/// Means of samples are held everywhere where they are fewer than this many times the samples that pictures read whole.
const MOST_MEANS: u64 = 2;

/// What a finding adds where a scene [depends on samples](depends_on_samples).
const EXACT: &str = "; printed heights and visibility use all samples";

/// A smaller raster.
pub(super) struct ReducedElevation {
    /// The raster.
    pub raster: Raster,
    /// The side of the squares of samples that each of its samples is the mean of, where pictures show nested grounds of
    /// more samples in it.
    pub nests_step: Option<u32>,
    /// The raster of all samples.
    pub whole: Box<dyn Windows + Send>,
}

/// The smaller raster of one that is too large for the memory, or for what pictures show of it; `None` where all of it is
/// needed and fits.
pub(super) fn reduced_as_needed(
    document: &Document,
    mut windows: Box<dyn Windows + Send>,
    need: ElevationNeed<'_>,
    findings: &mut SceneFindings,
) -> Result<Option<ReducedElevation>, Diagnostic> {
    let dem = &document.terrain.dem;
    let (width, height) = windows.size();
    let shown = match need {
        ElevationNeed::Pictures(pictures) => shown_by(pictures, document, &mut windows)?,
        ElevationNeed::All | ElevationNeed::AllThatFit | ElevationNeed::Nested { .. } => 1,
    };
    let fitting = fitting_step((width, height));
    let nests = nests(need, document)
        && (shown == 1 || samples((width, height), shown) >= MOST_MEANS * PICTURED_SAMPLES.get());
    let step = if nests { least_step((width, height), level_samples()) } else { shown.max(fitting) };
    if step == 1 {
        return Ok(None);
    }
    let of_overview = windows.overview(step).map(|(held, mut overview)| reduced(&mut overview, step / held));
    let raster = of_overview.unwrap_or_else(|| reduced(&mut windows, step));
    let raster = raster.map_err(|error| document.error(dem, error))?;
    let span = dem.span().unwrap_or_default();
    let exact = if depends_on_samples(document) { EXACT } else { "" };
    if nests {
        let message = format!(
            "of the {width} x {height} samples of the elevation model pictures take all that they show near the eye; beyond, each \
             height is the mean of up to {step} x {step} of them{exact}"
        );
        findings.add(FindingCode::SamplesAveraged, span, message);
    } else if fitting > shown {
        let message = format!(
            "the elevation model has {width} x {height} samples, more than the {RASTER_SAMPLES} of a scene: each height is \
             that of {step} x {step} of them{exact}"
        );
        let help = "name a part with `extent`, which is taken in full";
        findings.add_with_help(FindingCode::ElevationReduced, span, message, help);
    } else {
        let message = format!(
            "of the {width} x {height} samples of the elevation model the picture shows {step} x {step} within a pixel: each \
             height is their mean{exact}"
        );
        findings.add(FindingCode::SamplesAveraged, span, message);
    }
    Ok(Some(ReducedElevation { raster, nests_step: nests.then_some(step), whole: windows }))
}

/// Whether pictures may show nested grounds of more samples than the scene's. A panorama has ground near its eye on all sides, and
/// takes the scene's.
fn nests(need: ElevationNeed<'_>, document: &Document) -> bool {
    match need {
        ElevationNeed::Pictures(pictures) => {
            pictures.near == NearGround::Nested && !show_panorama(pictures, document)
        }
        ElevationNeed::All | ElevationNeed::AllThatFit | ElevationNeed::Nested { .. } => false,
    }
}

/// The number of means of `step` × `step` samples of a raster.
fn samples((width, height): (u32, u32), step: u32) -> u64 {
    u64::from(width / step) * u64::from(height / step)
}

/// The side of the smallest squares of samples of which a raster has no more than `most`, a power of two.
fn least_step(size: (u32, u32), most: u64) -> u32 {
    (0..31).map(|power| 1 << power).find(|step| samples(size, *step) <= most).unwrap_or(1 << 31)
}

/// The side of the squares of samples of which a raster of `size` has no more than pictures show of one that is too large for
/// the memory; 1 for one that is not.
fn fitting_step(size: (u32, u32)) -> u32 {
    if samples(size, 1) <= RASTER_SAMPLES.get() { 1 } else { least_step(size, REDUCED_SAMPLES.get()).max(2) }
}

/// [`shown_step`] of elevation that is not read yet.
fn shown_by(
    pictures: &PlannedPictures,
    document: &Document,
    windows: &mut Box<dyn Windows + Send>,
) -> Result<u32, Diagnostic> {
    let MetricSystem { crs, off_scale } = MetricSystem::of(windows, document.crs.as_ref())
        .map_err(|error| document.error(&document.terrain.dem, error))?;
    let crs = crs.or(document.crs.clone()).unwrap_or_else(Crs::local);
    let stated_crs = off_scale.map_or_else(|| crs.clone(), |off| off.stated);
    let whole = windows.metadata().without_samples();
    Ok(shown_step(pictures, document, &UnreadGround { whole: &whole, crs: &crs, stated_crs: &stated_crs }))
}
