//! The elevation files of a scene, as one raster: all of it, or the part that the scene's extent needs.
//!
//! ```text
//! files without an extent, or small ──► read whole, tiles joined
//! large files with an extent        ──► opened by their headers ──► the system of the ground ──► the window around the extent
//! files too large for the memory, or
//! for what pictures show of them    ──► opened by their headers ──► means of squares of samples
//! ```

use std::cell::RefCell;

use glam::DVec2;

use crate::assets::{AssetError, Assets};
use crate::decoded_whole::{decoded_whole, may_be_large};
use crate::given_tile::given_tile;
use crate::overridden_crs::OverriddenCrs;
use crate::planned_pictures::ElevationNeed;
use crate::reduced_elevation::{ReducedElevation, reduced_as_needed};
use crate::scene_findings::SceneFindings;
use sandtable_base::limits::{COMPANION_BYTES, PICTURED_SAMPLES, RASTER_SAMPLES};
use sandtable_base::message::choice::Choice;
use sandtable_base::message::suggest::quoted;
use sandtable_dem::formats::height_encoding::HeightEncoding;
use sandtable_dem::formats::raw_layout::{RawLayout, RawLayoutError};
use sandtable_dem::hints::{DemHints, DemOptions};
use sandtable_dem::read;
use sandtable_dem::vrt::{self, VrtTiles};
use sandtable_dem::vrt_source::VrtSource;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::elevation_file::ElevationFile;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::words::HeightEncodingWord;
use sandtable_geom::crs::Crs;
use sandtable_geom::length_unit::length_of_name;
use sandtable_geom::position::Position;
use sandtable_geom::rect::Rect;
use sandtable_raster::crop::{crop_window, part};
use sandtable_raster::error::{DemError, DemErrorKind};
use sandtable_raster::mosaic::{MosaicError, Tiles};
use sandtable_raster::mosaic_windows::MosaicWindows;
use sandtable_raster::raised::RaisedWindows;
use sandtable_raster::raster::Raster;
use sandtable_raster::reduced_windows::ReducedWindows;
use sandtable_raster::unstated_unit;
use sandtable_raster::warp::metric_crs::{OffScale, metric_crs, off_scale};
use sandtable_raster::warp::metric_windows::MetricSystem;
use sandtable_raster::windows::{
    MOST_KEPT_SAMPLES, RasterWindow, WINDOW_CACHE_BYTES, Windows, window_samples,
};
use sandtable_remote::address::is_address;

/// Samples beside an extent that are read of large files, so that voids on its border are known to end.
const MARGIN: u32 = 512;

/// Samples beside an extent that warping reads.
pub(super) const BESIDE: u32 = 4;

/// Elevation as it is read.
pub(super) struct ReadElevation {
    /// What is held, as a raster.
    pub held: Raster,
    /// The whole raster without its samples.
    whole: Raster,
    /// What is held of it.
    window: RasterWindow,
    /// Why the ground is made in another system than the stated one, if it is.
    pub off_scale: Option<OffScale>,
    /// The part of the whole that the scene is made of; `None` where that is all.
    pub extent: Option<StatedExtent>,
    /// As [`ReducedElevation::nests_step`].
    pub nests_step: Option<u32>,
    /// The raster of all samples, where those that are held are means of them.
    pub all_samples: Option<Box<dyn Windows + Send>>,
}

/// An extent in two systems.
#[derive(Clone)]
pub(super) struct StatedExtent {
    /// The system of the ground; `None` where the elevation names none.
    pub crs: Option<Crs>,
    /// In the system of the ground.
    pub ground: Rect,
    /// In that of the elevation files: the rectangle around the former.
    pub source: Rect,
}

impl ReadElevation {
    /// Reads the document's elevation files. One that is larger than a raster in memory, or than what pictures show of it, is
    /// reduced, where that is enough and the document states no extent.
    ///
    /// # Errors
    /// They cannot be read, are not of one raster, or have no place in a system in meters; the extent has none on them.
    pub fn new(
        document: &Document,
        assets: &Assets,
        need: ElevationNeed<'_>,
        findings: &mut SceneFindings,
    ) -> Result<Self, Diagnostic> {
        let (mut nests_step, mut all_samples) = (None, None);
        let held = match TileList::of(document, assets)? {
            None => replaced(document, assets, findings)?,
            Some(list) => {
                let mut of_windows = findings.clone();
                let windows = list.windows(document, assets, need, &mut of_windows)?;
                let reduced = match windows {
                    Some(windows) if document.terrain.extent.is_some() => {
                        *findings = of_windows;
                        return Self::around_extent(document, windows, need);
                    }
                    Some(windows) => reduced_as_needed(document, windows, need, &mut of_windows)?,
                    None => None,
                };
                match reduced {
                    Some(ReducedElevation { raster, nests_step: step, whole }) => {
                        (*findings, nests_step, all_samples) = (of_windows, step, Some(whole));
                        raster
                    }
                    None => list.joined(document, assets, findings)?,
                }
            }
        };
        let (whole, window) = (held.without_samples(), RasterWindow::all(held.size()));
        let failed = |error| document.error(&document.terrain.dem, error);
        let off_scale = off_scale(&held, document.crs.as_ref()).map_err(failed)?;
        let extent = match document.terrain.extent.is_some() {
            true => {
                let crs = metric_crs(&held, document.crs.as_ref()).map_err(failed)?;
                stated_extent(document, &whole, crs, off_scale.as_ref())?
            }
            false => None,
        };
        Ok(Self { held, whole, window, off_scale, extent, nests_step, all_samples })
    }

    /// Reads what the extent needs, and [`MARGIN`]; of a nested ground its means, and [`BESIDE`].
    fn around_extent(
        document: &Document,
        windows: Box<dyn Windows + Send>,
        need: ElevationNeed<'_>,
    ) -> Result<Self, Diagnostic> {
        let terrain = &document.terrain;
        let (mut windows, margin): (Box<dyn Windows + Send>, u32) = match need {
            ElevationNeed::Nested { step: 1 } => (windows, BESIDE),
            ElevationNeed::Nested { step } => (Box::new(ReducedWindows::new(windows, step)), BESIDE),
            ElevationNeed::All | ElevationNeed::AllThatFit | ElevationNeed::Pictures(_) => (windows, MARGIN),
        };
        let whole = windows.metadata().without_samples();
        let MetricSystem { crs, off_scale } = MetricSystem::of(&mut windows, document.crs.as_ref())
            .map_err(|error| document.error(&terrain.dem, error))?;
        let extent = stated_extent(document, &whole, crs, off_scale.as_ref())?;
        let window = |margin: u32| {
            let window = extent.as_ref().and_then(|extent| crop_window(&whole, &extent.source, margin));
            window.ok_or_else(|| nothing_within(document))
        };
        let is_small = |window: &RasterWindow| window.samples() as u64 <= RASTER_SAMPLES.get();
        // The margin is given up where there is no room for it.
        let window = Some(window(margin)?).filter(is_small).map_or_else(|| window(BESIDE), Ok)?;
        if !is_small(&window) {
            let message = format!(
                "the extent holds {} x {} samples of the elevation model, more than the {RASTER_SAMPLES} of a scene; name a \
                 smaller one, or {RASTER_SAMPLES:#}",
                window.width, window.height
            );
            return Err(document
                .error_at(terrain.extent.as_ref().and_then(|it| it.span()).unwrap_or_default(), message));
        }
        let samples = windows.samples(window).map_err(|error| document.error(&terrain.dem, error))?;
        let held = part(&whole, window, samples);
        Ok(Self { held, whole, window, off_scale, extent, nests_step: None, all_samples: None })
    }

    /// The part of the raster with its samples in `rect`, in its own system, and `margin` more on each side, from `held` or one
    /// like it with other samples.
    pub fn part(&self, held: &Raster, rect: &Rect, margin: u32) -> Option<Raster> {
        let window = crop_window(&self.whole, rect, margin)?;
        Some(part(&self.whole, window, window_samples(held, self.window, window)))
    }
}

/// The error where an extent does not lie on the elevation.
pub(super) fn nothing_within(document: &Document) -> Diagnostic {
    let message = "the extent holds less than two samples a side of the elevation model";
    let span = document.terrain.extent.as_ref().and_then(|extent| extent.span()).unwrap_or_default();
    document
        .error_at(span, message)
        .with_help("name points on the model, or remove `extent` to take all of it")
}

/// The extent that the document states, if any. `crs` is the system of the ground.
fn stated_extent(
    document: &Document,
    whole: &Raster,
    crs: Option<Crs>,
    off_scale: Option<&OffScale>,
) -> Result<Option<StatedExtent>, Diagnostic> {
    let Some(extent) = &document.terrain.extent else { return Ok(None) };
    let scene = crs.clone().unwrap_or_else(Crs::local);
    let stated = off_scale.map_or_else(|| scene.clone(), |off| off.stated.clone());
    let given = document.points_crs.as_ref().unwrap_or(&stated);
    let own = whole.crs.as_ref().unwrap_or(&stated);
    let misplaced = |error| document.error(extent, error);
    let in_scene = |at: &Position| match at.numbers() {
        Some(numbers) => given.transform(&scene, numbers),
        None => at.in_system(&scene),
    };
    let corners: Result<Vec<DVec2>, _> = extent.iter().map(in_scene).collect();
    let ground = Rect::around(corners.map_err(misplaced)?);
    let in_source: Result<Vec<DVec2>, _> = ground.grid_points().map(|at| scene.transform(own, at)).collect();
    let source = Rect::around(in_source.map_err(misplaced)?);
    Ok(Some(StatedExtent { crs, ground, source }))
}

/// The elevation files that a document names: those that it lists, those in a folder, and those that a virtual raster lists.
struct TileList {
    files: Vec<TileFile>,
    vrts: Vec<VrtTiles>,
    stated: DemOptions,
}

/// An elevation file of a document.
#[derive(Clone)]
struct TileFile {
    name: String,
    /// How the virtual raster takes it that lists it, where one does.
    source: Option<VrtSource>,
    /// What is added to its heights.
    offset_m: f64,
}

impl TileFile {
    /// A file that no virtual raster lists.
    fn alone(name: String, offset_m: f64) -> Self {
        Self { name, source: None, offset_m }
    }

    /// What is stated of the file, by the document and by the virtual raster.
    fn options(&self, stated: &DemOptions) -> DemOptions {
        let nodata = stated.nodata.or(self.source.as_ref().and_then(|source| source.nodata));
        DemOptions { nodata, ..stated.clone() }
    }
}

impl TileList {
    /// The files of the document; `None` where other elevation takes their place.
    fn of(document: &Document, assets: &Assets) -> Result<Option<Self>, Diagnostic> {
        let dem = &document.terrain.dem;
        let mut list = Self { files: Vec::new(), vrts: Vec::new(), stated: stated(document)? };
        for ElevationFile { file: name, offset } in dem.iter() {
            let offset_m = *offset;
            if assets.elevation(name).map_err(|error| document.error(dem, error))?.is_some() {
                return Ok(None);
            }
            if assets.given().raster(name).is_some() {
                list.files.push(TileFile::alone(name.clone(), offset_m));
                continue;
            }
            if let Some(files) = assets.folder(name).map_err(|error| document.error(dem, error))? {
                let before = list.files.len();
                let tiles = files.into_iter().filter(|file| read::is_tile_name(file));
                list.files.extend(tiles.map(|file| TileFile::alone(file, offset_m)));
                if list.files.len() == before {
                    return Err(
                        document.error(dem, format!("'{}' is a folder without elevation", quoted(name)))
                    );
                }
                continue;
            }
            if !vrt::is_vrt(name) {
                list.files.push(TileFile::alone(name.clone(), offset_m));
                continue;
            }
            let bytes = assets.read(name).map_err(|error| document.error(dem, error))?;
            let mut vrt = VrtTiles::read(&bytes).map_err(|error| document.error(dem, error))?;
            if is_address(name) {
                vrt.check_beside().map_err(|error| document.error(dem, error))?;
            }
            let slashed = name.replace('\\', "/");
            let folder = slashed.rsplit_once('/').map_or(String::new(), |(folder, _)| format!("{folder}/"));
            vrt.state_nodata(list.stated.nodata);
            list.files.extend(vrt.sources.iter().map(|source| {
                let folder = if source.file.starts_with('/') { "" } else { &folder };
                TileFile { name: format!("{folder}{}", source.file), source: Some(source.clone()), offset_m }
            }));
            list.vrts.push(vrt);
        }
        Ok(Some(list))
    }

    /// The files as one raster on disk, where their formats allow that, and they are large: for the part
    /// within an extent, or to be reduced. What is wrong with a file is left to be told by who reads it whole.
    fn windows(
        &self,
        document: &Document,
        assets: &Assets,
        need: ElevationNeed<'_>,
        findings: &mut SceneFindings,
    ) -> Result<Option<Box<dyn Windows + Send>>, Diagnostic> {
        let dem = &document.terrain.dem;
        let most_kept = match (&document.terrain.extent, need) {
            (_, ElevationNeed::Nested { .. }) => 0,
            (Some(_), _) => MOST_KEPT_SAMPLES.min(RASTER_SAMPLES.get()),
            (None, ElevationNeed::Pictures(_)) => PICTURED_SAMPLES.get().min(RASTER_SAMPLES.get()),
            (None, ElevationNeed::AllThatFit) => RASTER_SAMPLES.get(),
            (None, ElevationNeed::All) => return Ok(None),
        };
        let (files, stated) = (self.files.clone(), self.stated.clone());
        let mut tiles = Vec::new();
        for file in &files {
            // What the file states is compared with what the scene does.
            let own = DemOptions { vertical_datum: None, ..stated.clone() };
            let overridden = RefCell::new(None);
            let note = |own: &Crs| drop(overridden.replace(Some(own.clone())));
            let windows = match open_windows(file, assets, &own, &note) {
                Ok(Some(windows)) => windows,
                // It would be the same again, and a server may take half a minute for it.
                Err(TileError::Asset(error @ AssetError::Remote { .. })) => {
                    return Err(document.error(dem, error));
                }
                Ok(None) | Err(_) => return Ok(None),
            };
            tiles.push((windows.metadata().without_samples(), overridden.into_inner()));
        }
        let samples =
            tiles.iter().map(|(tile, _)| u64::from(tile.width) * u64::from(tile.height)).sum::<u64>();
        if samples <= most_kept {
            return Ok(None);
        }
        let mut headers = Vec::new();
        for (file, (mut tile, overridden)) in files.iter().zip(tiles) {
            tile.vertical_datum = tile.vertical_datum.filter(|_| self.keeps_datum(file));
            check_tile(&file.name, &mut tile, overridden, document, findings);
            headers.push((file.name.clone(), tile));
        }
        let stating = headers.iter().filter(|(_, tile)| tile.vertical_datum.is_some()).count();
        let (count, is_alone, assets) = (headers.len(), self.vrts.is_empty(), assets.clone());
        let open = move |tile: usize| match open_windows(&files[tile], &assets, &stated, &|_| ()) {
            Ok(Some(windows)) => Ok(windows),
            Err(TileError::Dem(error)) => Err(error.kind),
            Err(TileError::Asset(error @ AssetError::Remote { .. })) => {
                Err(DemErrorKind::Unread(error.into()))
            }
            Ok(None) | Err(TileError::Asset(_)) => Err(DemErrorKind::Changed),
        };
        if count == 1 && is_alone {
            return open(0).map(Some).map_err(|error| document.error(dem, error));
        }
        if stating > 0 {
            find_missing_datums(count - stating, count, document, findings);
        }
        let message = format!("{count} tiles joined by their headers; what they share is not compared");
        findings.add(FindingCode::TilesJoined, dem.span().unwrap_or_default(), message);
        let mosaic = match MosaicWindows::new(headers, Box::new(open)) {
            // They are resampled when they are read whole.
            Err(MosaicError::Cells { .. } | MosaicError::Misaligned { .. })
                if document.terrain.cell.is_some() && is_alone =>
            {
                return Ok(None);
            }
            mosaic => Box::new(mosaic.map_err(|error| document.error(dem, error))?),
        };
        match self.frame() {
            Some(vrt) => vrt.filled_windows(mosaic).map(Some).map_err(|error| document.error(dem, error)),
            None => Ok(Some(mosaic)),
        }
    }

    /// The files as one raster in memory.
    fn joined(
        &self,
        document: &Document,
        assets: &Assets,
        findings: &mut SceneFindings,
    ) -> Result<Raster, Diagnostic> {
        let dem = &document.terrain.dem;
        let failed = |error| document.error(dem, error);
        let overridden = RefCell::new(None);
        let companions = assets.companions(COMPANION_BYTES.get());
        let note = |own: &Crs| drop(overridden.replace(Some(own.clone())));
        // What the file states is compared with what the scene does.
        let own = DemOptions { vertical_datum: None, ..self.stated.clone() };
        let mut tiles = Tiles::default();
        for file in &self.files {
            let name = &file.name;
            let options = file.options(&own);
            let hints = DemHints { options, overridden: &note, companions: &|name| companions.get(name) };
            let tile = match assets.given().raster(name) {
                Some(raster) => Ok(given_tile(name, raster, &hints, document)?),
                None => match decoded(file, assets, &own, &note) {
                    Some(tile) => Ok(tile),
                    None => {
                        let bytes = assets.read(name).map_err(|error| document.error(dem, error))?;
                        read::read(name, &bytes, &hints)
                    }
                },
            };
            companions.check().map_err(|error| document.error(dem, error))?;
            let mut tile = tile.map_err(|error| document.error(dem, error))?;
            if let Some(source) = &file.source {
                tile = source.taken_from(tile).map_err(|error| document.error(dem, error))?;
            }
            tile = tile.raised(file.offset_m);
            tile.vertical_datum = tile.vertical_datum.filter(|_| self.keeps_datum(file));
            check_tile(name, &mut tile, overridden.take(), document, findings);
            tiles.push(name, tile).map_err(failed)?;
        }
        // A virtual raster states its own grid.
        let cell = document.terrain.cell.filter(|_| self.vrts.is_empty());
        let mut mosaic = tiles.join_in_cells(cell).map_err(failed)?;
        if let Some(vrt) = self.frame() {
            mosaic.raster = vrt.filled(mosaic.raster).map_err(|error| document.error(dem, error))?;
        }
        find_missing_datums(mosaic.without_datum, mosaic.tiles, document, findings);
        if 2 * mosaic.in_feet > mosaic.overlaps {
            let message = format!(
                "of {} samples that tiles share, {} have the ratio of feet to meters: some tiles are in feet, and are read as meters",
                mosaic.overlaps, mosaic.in_feet
            );
            let help =
                "convert those tiles, for example with: gdal_calc.py -A IN --calc=\"A*0.3048\" --outfile=OUT";
            findings.add_with_help(FindingCode::HeightsInFeet, dem.span().unwrap_or_default(), message, help);
        }
        if mosaic.tiles > 1 {
            findings.add(FindingCode::TilesJoined, dem.span().unwrap_or_default(), mosaic.note());
        }
        Ok(mosaic.raster)
    }

    /// Whether the vertical datum that a file states is still that of its heights: an offset brings a tile to the datum of
    /// the others.
    fn keeps_datum(&self, file: &TileFile) -> bool {
        file.offset_m == 0.0 || self.files.len() < 2
    }

    /// The virtual raster that states the frame of all tiles: several are joined to another raster than each states.
    fn frame(&self) -> Option<&VrtTiles> {
        let [vrt] = &self.vrts[..] else { return None };
        (self.files.len() == vrt.sources.len()).then_some(vrt)
    }
}

/// An elevation file that has no windows.
#[derive(Debug, thiserror::Error)]
enum TileError {
    #[error(transparent)]
    Asset(#[from] AssetError),
    #[error(transparent)]
    Dem(#[from] DemError),
}

/// The windows of an elevation file; `None` where its format is read whole.
fn open_windows(
    file: &TileFile,
    assets: &Assets,
    stated: &DemOptions,
    overridden: &dyn Fn(&Crs),
) -> Result<Option<Box<dyn Windows + Send>>, TileError> {
    let TileFile { name, source, offset_m } = file;
    if assets.given().raster(name).is_some() {
        return Ok(None);
    }
    let (head, content) = assets.open_elevation(name, read::HEAD_BYTES)?;
    let companions = assets.companions(COMPANION_BYTES.get());
    let options = file.options(stated);
    let hints = DemHints { options, overridden, companions: &|name| companions.get(name) };
    let windows = read::open_windows(name, &head, content, &hints, WINDOW_CACHE_BYTES);
    companions.check()?;
    let windows = match (source, windows?) {
        (Some(source), Some(windows)) => {
            let failed = |kind| DemError { name: name.clone(), kind };
            Some(source.taken_windows(windows).map_err(failed)?)
        }
        (_, windows) => windows,
    };
    Ok(windows.map(|windows| raised(windows, *offset_m)))
}

/// A large file on disk, decoded from there block by block: its bytes are not held beside its samples. `None` for other files, and
/// for what cannot be read so, of which reading it whole tells why.
fn decoded(
    file: &TileFile,
    assets: &Assets,
    stated: &DemOptions,
    overridden: &dyn Fn(&Crs),
) -> Option<Raster> {
    let bytes =
        assets.bytes_on_disk(&file.name).filter(|bytes| may_be_large(*bytes) && file.source.is_none())?;
    let alone = TileFile::alone(file.name.clone(), 0.0);
    decoded_whole(open_windows(&alone, assets, stated, overridden).ok()??, bytes)
}

/// Windows with `meters` added to their heights.
fn raised(windows: Box<dyn Windows + Send>, meters: f64) -> Box<dyn Windows + Send> {
    if meters == 0.0 { windows } else { Box::new(RaisedWindows::new(windows, meters)) }
}

/// What the document states of its elevation files.
fn stated(document: &Document) -> Result<DemOptions, Diagnostic> {
    let terrain = &document.terrain;
    Ok(DemOptions {
        height_scale: terrain.height_scale,
        height_offset: Some(terrain.height_offset),
        nodata: terrain.nodata,
        height_encoding: terrain.height_encoding.map(|encoding| match encoding {
            HeightEncodingWord::TerrainRgb => HeightEncoding::TerrainRgb,
            HeightEncodingWord::Terrarium => HeightEncoding::Terrarium,
        }),
        raw: raw_layout(document)?,
        vertical_datum: terrain.vertical_datum.clone(),
        vertical_unit: vertical_unit(document)?,
        cell: terrain.cell,
        crs: terrain.crs.clone(),
        surface: terrain.surface.clone(),
    })
}

/// Meters in the unit that the document states of elevations.
fn vertical_unit(document: &Document) -> Result<Option<f64>, Diagnostic> {
    let terrain = &document.terrain;
    let Some(stated) = &terrain.vertical_unit else { return Ok(None) };
    let rival = [
        ("height_scale", terrain.height_scale.is_some()),
        ("height_encoding", terrain.height_encoding.is_some()),
    ];
    match rival.iter().find(|(_, is_stated)| *is_stated) {
        Some((rival, _)) => {
            let message =
                format!("`vertical_unit` has no effect beside `{rival}`, which gives heights in meters");
            let error = document.error(stated, message).with_code(FindingCode::NoEffect);
            Err(error.with_help("remove one of them"))
        }
        None => Ok(length_of_name(stated.word())),
    }
}

/// The elevation that takes the place of the document's files.
fn replaced(
    document: &Document,
    assets: &Assets,
    findings: &mut SceneFindings,
) -> Result<Raster, Diagnostic> {
    let (dem, mut found) = (&document.terrain.dem, None);
    for ElevationFile { file: name, offset } in dem.iter() {
        let elevation = assets.elevation(name).map_err(|error| document.error(dem, error))?;
        found = found.or(elevation.map(|elevation| (name, elevation.clone().raised(*offset))));
    }
    let (name, mut tile) = found.ok_or_else(|| document.error(dem, "no elevation is named"))?;
    check_tile(name, &mut tile, None, document, findings);
    Ok(tile)
}

/// Finds what a tile states otherwise than the scene, which is believed. `overridden` is its own system, where the scene
/// states one.
fn check_tile(
    name: &str,
    tile: &mut Raster,
    overridden: Option<Crs>,
    document: &Document,
    findings: &mut SceneFindings,
) {
    let (terrain, span) = (&document.terrain, document.terrain.dem.span().unwrap_or_default());
    if let (Some(stated), Some(own)) = (&terrain.crs, overridden) {
        let systems = OverriddenCrs { file: name, own: &own, stated };
        let found = systems.finding(tile.center(), document, span.clone());
        found.into_iter().for_each(|finding| findings.push(finding));
    }
    if let Some(note) = unstated_unit::note(tile).filter(|_| terrain.height_scale.is_none()) {
        let message = format!("the elevations of '{}': {note}", quoted(name));
        findings.add_with_help(FindingCode::HeightsInFeet, span.clone(), message, unstated_unit::REMEDY);
    }
    let Some(stated) = &terrain.vertical_datum else { return };
    if let Some(own) = tile.vertical_datum.as_deref().filter(|own| !own.eq_ignore_ascii_case(stated)) {
        let message = format!("'{}' counts heights from {own}, and the scene says {stated}", quoted(name));
        findings.add(FindingCode::VerticalDatumsMixed, span, message);
    }
    tile.vertical_datum = Some(stated.clone());
}

/// Finds that some tiles state no vertical datum where others do.
fn find_missing_datums(without: usize, tiles: usize, document: &Document, findings: &mut SceneFindings) {
    if without > 0 {
        let message = format!(
            "{without} of {tiles} tiles state no vertical datum, beside others that do: they are taken to be the same"
        );
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
