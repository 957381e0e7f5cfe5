//! The first pass: the elevation files to the ground lattice.

use std::borrow::Cow;
use std::sync::Arc;

use glam::DVec2;

use crate::assets::Assets;
use crate::elevation::{BESIDE, ReadElevation, nothing_within};
use crate::planned_pictures::ElevationNeed;
use crate::scene_findings::SceneFindings;
use sandtable_base::message::suggest::quoted;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::finding_code::FindingCode;
use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;
use sandtable_raster::crop::crop;
use sandtable_raster::largest_rectangle::{largest_rectangle, outside};
use sandtable_raster::raster::Raster;
use sandtable_raster::undeclared::{NodataSign, undeclared_nodata};
use sandtable_raster::void_counts::VoidCounts;
use sandtable_raster::windows::Windows;
use sandtable_raster::{voids, warp};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::source_raster::SourceRaster;

/// The raster as read and the lattice made of it.
pub struct LoadedGround {
    /// The raster as read; tiles joined, voids filled where the scene file says so. Of large files, only what the extent
    /// needs, or means of squares of samples.
    pub source: Arc<SourceRaster>,
    /// The heights in the scene's system, before earthworks.
    pub lattice: Lattice,
    /// The scene's system.
    pub crs: Crs,
    /// The system that the scene file or its elevation states in meters: the scene's but where its lengths are not true.
    pub stated_crs: Crs,
    /// A note where the two differ; it is among `findings`.
    pub scale_note: Option<String>,
    /// The findings, for the user.
    pub findings: SceneFindings,
    /// The side of the squares of samples that its heights are means of, where pictures show nested grounds of more samples.
    pub nests_step: Option<u32>,
    /// The raster of all samples, where its heights are means of them.
    pub all_samples: Option<Box<dyn Windows + Send>>,
}

/// Reads the document's elevation files, as far as they are needed, and brings them to a metric system.
///
/// # Errors
/// A file cannot be read, several are not tiles of one raster, or they cannot be brought to the scene's
/// system.
pub fn load(
    document: &Document,
    assets: &Assets,
    need: ElevationNeed<'_>,
) -> Result<LoadedGround, Diagnostic> {
    let dem = &document.terrain.dem;
    let (mut findings, span) = (SceneFindings::new(document), dem.span().unwrap_or_default());
    let mut read = ReadElevation::new(document, assets, need, &mut findings)?;
    for note in &read.held.notes {
        // Of several files the note names the one that it is about.
        let message = match &dem[..] {
            [tile] => format!("'{}': {note}", quoted(&tile.file)),
            _ => note.clone(),
        };
        findings.add(FindingCode::ElevationGuessed, span.clone(), message);
    }
    for found in undeclared_nodata(&read.held) {
        let (evidence, value) = (&found.evidence, found.written());
        let message = format!("{evidence}: if that means no data, say `nodata = {value}` under [terrain]");
        let code = match found.sign {
            NodataSign::UsualValue => FindingCode::UndeclaredNoData,
            NodataSign::FlatMargin => FindingCode::FlatMargin,
        };
        findings.add(code, span.clone(), message);
    }
    let mut filled = None;
    match document.terrain.fill_voids {
        Some(true) => {
            findings.add(FindingCode::VoidsFilled, span.clone(), voids::fill(&mut read.held).note())
        }
        // The source stays as it is read: the ground alone is without holes.
        None if VoidCounts::of(&read.held).voids > 0 => {
            let mut ground = read.held.clone();
            findings.add(FindingCode::VoidsFilled, span.clone(), voids::fill(&mut ground).note());
            filled = Some(ground);
        }
        None | Some(false) => {}
    }
    let metric = metric(document, &read, filled.as_ref().unwrap_or(&read.held), &mut findings)?;
    let crs = metric.crs.clone().or(document.crs.clone()).unwrap_or_else(Crs::local);
    let scale_note = read.off_scale.as_ref().map(ToString::to_string);
    if let Some(note) = &scale_note {
        findings.add(FindingCode::LengthsNotTrue, span, note.as_str());
    }
    let stated_crs = read.off_scale.map_or_else(|| crs.clone(), |off| off.stated);
    let is_source = matches!(metric, Cow::Borrowed(_)) && filled.is_none();
    let other = (!is_source).then(|| Lattice::from_raster(&metric));
    drop(metric);
    let made = match other {
        Some(lattice) => lattice.map(|lattice| (SourceRaster::from(Arc::new(read.held)), lattice)),
        None => SourceRaster::with_lattice(read.held),
    };
    let (source, lattice) = made.map_err(|error| document.error(dem, error))?;
    let (source, nests_step, all_samples) = (Arc::new(source), read.nests_step, read.all_samples);
    Ok(LoadedGround { source, lattice, crs, stated_crs, scale_note, findings, nests_step, all_samples })
}

/// The part of the elevation that the scene is made of, in a metric system; `source` is what is read of it, without voids.
fn metric<'a>(
    document: &Document,
    read: &ReadElevation,
    source: &'a Raster,
    findings: &mut SceneFindings,
) -> Result<Cow<'a, Raster>, Diagnostic> {
    let failed = |error| document.error(&document.terrain.dem, error);
    let Some(extent) = &read.extent else {
        let metric = warp::to_metric(source, document.crs.as_ref()).map_err(failed)?;
        return Ok(match warp::resamples(source, document.crs.as_ref()).map_err(failed)? {
            true => straightened(metric, source, document, findings),
            false => metric,
        });
    };
    let part = read.part(source, &extent.source, BESIDE);
    let warped = |part: Raster| Ok(warp::to_metric(&part, extent.crs.as_ref()).map_err(failed)?.into_owned());
    let part = part.map(warped).transpose()?;
    part.and_then(|part| crop(&part, &extent.ground, 0))
        .map(Cow::Owned)
        .ok_or_else(|| nothing_within(document))
}

/// A raster that was warped without the empty wedges that this leaves along its sides: the largest rectangle that holds
/// data all through. Where the data has a ragged border of its own, such as a coast, so that this would cost too much of
/// it, the wedges alone are cut.
fn straightened<'a>(
    warped: Cow<'a, Raster>,
    source: &Raster,
    document: &Document,
    findings: &mut SceneFindings,
) -> Cow<'a, Raster> {
    /// Of the ground between the wedges, the share that may not be lost to the border of the data.
    const LITTLE_LOST: f64 = 0.8;
    /// Where less is kept nothing is cut: a model that lies so far aslant is better seen whole.
    const LEAST_KEPT: f64 = 0.5;
    let cut_of = |outside: &[bool]| {
        let inside = outside.iter().filter(|outside| !**outside).count() as u64;
        (largest_rectangle(outside, warped.width), inside)
    };
    let (mut rect, mut inside) = cut_of(&outside(&warped));
    if rect.area() == warped.samples.len() as u64 {
        return warped;
    }
    if (rect.area() as f64) < inside as f64 * LITTLE_LOST {
        let framed = warp::framed(source);
        let frame = warp::to_metric(&framed, document.crs.as_ref()).ok();
        let Some(frame) = frame.filter(|frame| (frame.width, frame.height) == (warped.width, warped.height))
        else {
            return warped;
        };
        let (between_wedges, inside_frame) = cut_of(&outside(&frame));
        if (rect.area() as f64) < between_wedges.area() as f64 * LITTLE_LOST {
            (rect, inside) = (between_wedges, inside_frame);
        }
    }
    let kept = rect.area() as f64 / inside.max(1) as f64;
    if kept < LEAST_KEPT {
        return warped;
    }
    let center = |column: u32, row: u32| {
        warped.map_from_grid.transform_point2(DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5))
    };
    let far = (rect.left + rect.width - 1, rect.top + rect.height - 1);
    let beside = warped.spacing().min_element() / 4.0;
    let part = Rect::around([center(rect.left, rect.top), center(far.0, far.1)]).grown(beside);
    let Some(part) = crop(&warped, &part, 0) else { return warped };
    let cut = (1.0 - kept) * 100.0;
    let system = warped.crs.as_ref().map_or("north up", Crs::name);
    let message = format!(
        "{cut:.1} % of the elevation model is cut off along its border, so that its edges are straight in {system}; \
         `extent` under [terrain] names another part"
    );
    findings.add(FindingCode::BorderCut, document.terrain.dem.span().unwrap_or_default(), message);
    Cow::Owned(part)
}
