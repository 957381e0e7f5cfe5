//! One elevation file while it is read: its name, its bytes, and what is stated of it, in the file, beside it or by the caller.

use glam::{DAffine2, DVec2};

use crate::companion::world_file;
use crate::file_name::{file_name, split_extension};
use crate::hints::DemHints;
use sandtable_geom::crs::Crs;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::georef;
use sandtable_raster::raster::{Raster, north_up};
use sandtable_raster::vertical;

/// An elevation file while it is read: its name, bytes and hints.
pub(crate) struct DemFile<'a> {
    /// The name as given, for the extension and the companions.
    pub name: &'a str,
    /// The content.
    pub bytes: &'a [u8],
    pub hints: &'a DemHints<'a>,
}

impl DemFile<'_> {
    /// The extension in lower case, without the dot; empty where there is none.
    pub fn extension(&self) -> String {
        split_extension(self.name).1.to_ascii_lowercase()
    }

    pub fn stem(&self) -> &str {
        split_extension(file_name(self.name)).0
    }

    /// The bytes of the companion with another extension, in lower or in upper case.
    pub fn companion(&self, extension: &str) -> Option<Vec<u8>> {
        let base = split_extension(self.name).0;
        let read = |extension: &str| (self.hints.companions)(&format!("{base}.{extension}"));
        read(extension).or_else(|| read(&extension.to_ascii_uppercase()))
    }

    /// The content of the `.hdr` beside the file: `a.hdr` for `a.bil`, or `a.img.hdr` for `a.img`.
    pub fn header(&self) -> Option<Vec<u8>> {
        self.companion("hdr").or_else(|| (self.hints.companions)(&format!("{}.hdr", self.name)))
    }

    /// The coordinate system of the hints, else of a `.prj` companion; `None` where there is neither.
    pub fn crs(&self) -> Result<Option<Crs>, DemErrorKind> {
        self.crs_or(|| Ok(None))
    }

    /// The coordinate system of the hints, else the one that the file states, else that of a `.prj` companion.
    pub fn crs_or(
        &self,
        stated: impl FnOnce() -> Result<Option<Crs>, DemErrorKind>,
    ) -> Result<Option<Crs>, DemErrorKind> {
        let Some(crs) = &self.hints.options.crs else { return self.own_crs(stated) };
        // What the file states may be unreadable: another is stated for that.
        if let Ok(Some(own)) = self.own_crs(stated) {
            (self.hints.overridden)(&own);
        }
        Ok(Some(crs.clone()))
    }

    fn own_crs(
        &self,
        stated: impl FnOnce() -> Result<Option<Crs>, DemErrorKind>,
    ) -> Result<Option<Crs>, DemErrorKind> {
        if let Some(crs) = stated()? {
            return Ok(Some(crs));
        }
        let Some(bytes) = self.companion("prj") else { return Ok(None) };
        Ok(Some(Crs::parse(&String::from_utf8_lossy(&bytes))?))
    }

    /// `raster` at the place that the file states; else at that of a world file with one of `extensions` beside it, or with
    /// the hinted cell and its south-west sample at (0, 0), or else with samples 1 apart and without a georeference.
    pub fn placed(
        &self,
        raster: Raster,
        stated: Option<DAffine2>,
        extensions: &[&str],
    ) -> Result<Raster, DemErrorKind> {
        if let Some(map_from_grid) = stated {
            return Ok(raster.placed(georef::checked(map_from_grid)?));
        }
        if let Some(text) = extensions.iter().find_map(|extension| self.companion(extension)) {
            return Ok(raster.placed(world_file(&String::from_utf8_lossy(&text))?));
        }
        let cell = self.cell()?;
        let size = DVec2::splat(cell.unwrap_or(1.0));
        let corner = DVec2::new(-0.5, f64::from(raster.height) - 0.5) * size;
        Ok(Raster { georeferenced: cell.is_some(), ..raster.placed(north_up(corner, size)) })
    }

    /// `raster`, of which the samples may be absent, with the unit of elevations that the caller states; else with the file's own;
    /// and where that states none, with the one of the vertical part of a `.prj` beside it. A note says where the caller's
    /// is another than the file's.
    pub fn with_unit(&self, raster: Raster) -> Result<Raster, DemErrorKind> {
        let options = &self.hints.options;
        let is_sound = |unit_m: f64| unit_m.is_finite() && unit_m > 0.0;
        let stated =
            checked("vertical_unit", options.vertical_unit, is_sound, "a positive number of meters")?;
        if options.height_scale.is_some() || options.height_encoding.is_some() {
            return Ok(raster);
        }
        let states_own = raster.states_z_unit || raster.meters_per_z != 1.0;
        let own_m = if states_own {
            Some(raster.meters_per_z)
        } else {
            self.companion("prj").and_then(vertical_unit)
        };
        let Some(meters_per_z) = stated.or(own_m) else { return Ok(raster) };
        let mut notes = raster.notes;
        if let Some(own_m) = own_m.filter(|own_m| *own_m != meters_per_z) {
            notes.push(format!(
                "the unit of its elevations is {own_m} m by the file, and {meters_per_z} m is stated in its place"
            ));
        }
        Ok(Raster { meters_per_z, states_z_unit: true, notes, ..raster })
    }

    /// The hinted meters per value, checked.
    pub fn height_scale(&self) -> Result<Option<f64>, DemErrorKind> {
        let is_sound = |scale: f64| scale.is_finite() && scale != 0.0;
        checked("height_scale", self.hints.options.height_scale, is_sound, "a finite number other than 0")
    }

    /// The hinted height of value 0, checked; 0 where there is none.
    pub fn height_offset(&self) -> Result<f64, DemErrorKind> {
        let offset =
            checked("height_offset", self.hints.options.height_offset, f64::is_finite, "a finite number");
        Ok(offset?.unwrap_or(0.0))
    }

    /// The hinted distance between samples, checked.
    pub fn cell(&self) -> Result<Option<f64>, DemErrorKind> {
        let is_sound = |cell: f64| cell.is_finite() && cell > 0.0;
        checked("cell", self.hints.options.cell, is_sound, "a positive number of meters")
    }
}

/// Meters in the unit of the vertical part of a `.prj`; `None` without one.
fn vertical_unit(prj: Vec<u8>) -> Option<f64> {
    vertical::unit_of_wkt(&String::from_utf8_lossy(&prj))
}

fn checked(
    what: &'static str,
    hint: Option<f64>,
    is_sound: impl Fn(f64) -> bool,
    wanted: &'static str,
) -> Result<Option<f64>, DemErrorKind> {
    match hint.filter(|&value| !is_sound(value)) {
        Some(value) => Err(DemErrorKind::Hint { what, value, wanted }),
        None => Ok(hint),
    }
}
