//! The first pass: the elevation file, or the tiles of one, to the ground lattice.

use std::borrow::Cow;
use std::cell::RefCell;
use std::sync::Arc;

use glam::DVec2;

use crate::dem::crop::crop;
use crate::dem::formats::height_encoding::HeightEncoding;
use crate::dem::formats::raw::{RawLayout, RawLayoutError};
use crate::dem::largest_rectangle::{largest_rectangle, outside};
use crate::dem::mosaic::Tiles;
use crate::dem::raster::Raster;
use crate::dem::read::{self, DemHints};
use crate::dem::undeclared::{NodataSign, undeclared_nodata};
use crate::dem::void_counts::VoidCounts;
use crate::dem::voids;
use crate::dem::warp;
use crate::dem::warp::metric_crs::{metric_crs, off_scale};
use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::description::finding_code::FindingCode;
use crate::description::words::HeightEncodingWord;
use crate::geom::crs::Crs;
use crate::geom::rect::Rect;
use crate::message::suggest::quoted;
use crate::scene::assets::Assets;
use crate::scene::overridden_crs::OverriddenCrs;
use crate::scene::scene_findings::SceneFindings;
use crate::terrain::lattice::Lattice;

/// The raster as read and the lattice made of it.
pub struct LoadedGround {
    /// The raster as read; tiles joined, voids filled where the scene file says so.
    pub source: Arc<Raster>,
    /// The heights in the scene's system, before earthworks.
    pub lattice: Lattice,
    /// The scene's system.
    pub crs: Crs,
    /// The system that the scene file or its elevation states in meters: the scene's but where its lengths are not true.
    pub stated_crs: Crs,
    /// A note where the two differ; it is among `findings`.
    pub scale_note: Option<String>,
    /// What was found, for the user.
    pub findings: SceneFindings,
}

/// Reads the document's elevation files and brings them to a metric system.
///
/// # Errors
/// A file cannot be read, several are not tiles of one raster, or they cannot be brought to the scene's
/// system.
pub fn load(document: &Document, assets: &Assets) -> Result<LoadedGround, Diagnostic> {
    let dem = &document.terrain.dem;
    let (mut findings, span) = (SceneFindings::new(document), dem.span().unwrap_or_default());
    let mut source = joined(document, assets, &mut findings)?;
    for found in undeclared_nodata(&source) {
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
        Some(true) => findings.add(FindingCode::VoidsFilled, span.clone(), voids::fill(&mut source).note()),
        // The source stays as it is read: the ground alone is without holes.
        None if VoidCounts::of(&source).voids > 0 => {
            let mut ground = source.clone();
            findings.add(FindingCode::VoidsFilled, span.clone(), voids::fill(&mut ground).note());
            filled = Some(ground);
        }
        None | Some(false) => {}
    }
    let metric = metric(document, filled.as_ref().unwrap_or(&source), &mut findings)?;
    let lattice = Lattice::from_raster(&metric).map_err(|error| document.error(dem, error))?;
    let crs = metric.crs.clone().or(document.crs.clone()).unwrap_or_else(Crs::local);
    let off = off_scale(&source, document.crs.as_ref()).map_err(|error| document.error(dem, error))?;
    let scale_note = off.as_ref().map(ToString::to_string);
    if let Some(note) = &scale_note {
        findings.add(FindingCode::LengthsNotTrue, span, note.as_str());
    }
    let stated_crs = off.map_or_else(|| crs.clone(), |off| off.stated);
    Ok(LoadedGround { source: Arc::new(source), lattice, crs, stated_crs, scale_note, findings })
}

/// The part of the elevation that the scene is made of, in a metric system.
fn metric<'a>(
    document: &Document,
    source: &'a Raster,
    findings: &mut SceneFindings,
) -> Result<Cow<'a, Raster>, Diagnostic> {
    /// Samples beside the extent that warping reads.
    const BESIDE: u32 = 4;
    let dem = &document.terrain.dem;
    let failed = |error| document.error(dem, error);
    let Some(extent) = &document.terrain.extent else {
        let metric = warp::to_metric(source, document.crs.as_ref()).map_err(failed)?;
        return Ok(match warp::resamples(source, document.crs.as_ref()).map_err(failed)? {
            true => straightened(metric, source, document, findings),
            false => metric,
        });
    };
    let crs = metric_crs(source, document.crs.as_ref()).map_err(failed)?;
    let scene = crs.clone().unwrap_or_else(Crs::local);
    let off = off_scale(source, document.crs.as_ref()).map_err(failed)?;
    let stated = off.map_or_else(|| scene.clone(), |off| off.stated);
    let given = document.points_crs.as_ref().unwrap_or(&stated);
    let own = source.crs.as_ref().unwrap_or(&stated);
    let misplaced = |error| document.error(extent, error);
    let corners: Result<Vec<DVec2>, _> =
        extent.iter().map(|&at| given.transform(&scene, DVec2::from(at))).collect();
    let rect = Rect::around(corners.map_err(misplaced)?);
    let in_source: Result<Vec<DVec2>, _> = rect.grid_points().map(|at| scene.transform(own, at)).collect();
    let part = crop(source, &Rect::around(in_source.map_err(misplaced)?), BESIDE);
    let warped = |part: Raster| Ok(warp::to_metric(&part, crs.as_ref()).map_err(failed)?.into_owned());
    let part = part.map(warped).transpose()?;
    part.and_then(|part| crop(&part, &rect, 0)).map(Cow::Owned).ok_or_else(|| {
        let message = "the extent holds less than two samples a side of the elevation model";
        document
            .error(extent, message)
            .with_help("name points on the model, or remove `extent` to take all of it")
    })
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

/// The document's elevation files as one raster.
fn joined(document: &Document, assets: &Assets, findings: &mut SceneFindings) -> Result<Raster, Diagnostic> {
    let terrain = &document.terrain;
    let overridden = RefCell::new(None);
    let companions = |name: &str| assets.read(name).ok();
    let hints = DemHints {
        height_scale: terrain.height_scale,
        height_offset: Some(terrain.height_offset),
        nodata: terrain.nodata,
        height_encoding: terrain.height_encoding.map(|encoding| match encoding {
            HeightEncodingWord::TerrainRgb => HeightEncoding::TerrainRgb,
            HeightEncodingWord::Terrarium => HeightEncoding::Terrarium,
        }),
        raw: raw_layout(document)?,
        // What the file states is compared with it below.
        vertical_datum: None,
        cell: terrain.cell,
        crs: terrain.crs.clone(),
        overridden: &|own| drop(overridden.replace(Some(own.clone()))),
        companions: &companions,
    };
    let (dem, mut tiles) = (&terrain.dem, Tiles::default());
    for name in dem.iter() {
        let mut tile = match assets.elevation(name).map_err(|error| document.error(dem, error))? {
            Some(elevation) => elevation.clone(),
            None => {
                let bytes = assets.read(name).map_err(|error| document.error(dem, error))?;
                read::read(name, &bytes, &hints).map_err(|error| document.error(dem, error))?
            }
        };
        if let (Some(stated), Some(own)) = (&terrain.crs, overridden.take()) {
            let systems = OverriddenCrs { file: name, own: &own, stated };
            let found = systems.finding(tile.center(), document, dem.span().unwrap_or_default());
            found.into_iter().for_each(|finding| findings.push(finding));
        }
        if let Some(stated) = &terrain.vertical_datum {
            find_other_datum(name, &tile, stated, document, findings);
            tile.vertical_datum = Some(stated.clone());
        }
        tiles.push(name, tile).map_err(|error| document.error(dem, error))?;
    }
    let mosaic = tiles.join().map_err(|error| document.error(dem, error))?;
    if mosaic.without_datum > 0 {
        let message = format!(
            "{} of {} tiles state no vertical datum, beside others that do: they are taken to be the same",
            mosaic.without_datum, mosaic.tiles
        );
        findings.add(FindingCode::VerticalDatumsMixed, dem.span().unwrap_or_default(), message);
    }
    if 2 * mosaic.in_feet > mosaic.overlaps {
        let message = format!(
            "of {} samples that tiles share, {} have the ratio of feet to meters: some tiles are in feet, and are read as meters",
            mosaic.overlaps, mosaic.in_feet
        );
        let help =
            "convert those tiles, for example with: gdal_calc.py -A IN --calc=\"A*0.3048\" --outfile=OUT";
        findings.add_with_help(FindingCode::HeightsInFeet, dem.span().unwrap_or_default(), message, help);
    }
    if dem.len() > 1 {
        findings.add(FindingCode::TilesJoined, dem.span().unwrap_or_default(), mosaic.note());
    }
    Ok(mosaic.raster)
}

/// Finds that a file states another vertical datum than the scene, which is believed.
fn find_other_datum(
    name: &str,
    tile: &Raster,
    stated: &str,
    document: &Document,
    findings: &mut SceneFindings,
) {
    if let Some(own) = tile.vertical_datum.as_deref().filter(|own| !own.eq_ignore_ascii_case(stated)) {
        let message = format!("'{}' counts heights from {own}, and the scene says {stated}", quoted(name));
        let span = document.terrain.dem.span().unwrap_or_default();
        findings.add(FindingCode::VerticalDatumsMixed, span, message);
    }
}

fn raw_layout(document: &Document) -> Result<Option<RawLayout>, Diagnostic> {
    let Some(stated) = &document.terrain.raw else { return Ok(None) };
    stated.parse().map(Some).map_err(|_: RawLayoutError| {
        let message = "this does not say how a RAW file is laid out";
        document.error(stated, message).with_help(RawLayoutError::REMEDY)
    })
}
