//! The frame of a virtual raster around its tiles: what none of them covers is no data.

use glam::{DAffine2, DVec2};

use crate::vrt_fault::{PLACE, unsupported};
use sandtable_base::limits::{RASTER_SAMPLES, WINDOWED_SAMPLES};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{Raster, Samples};
use sandtable_raster::windows::{RasterWindow, Windows};

/// Where a virtual raster lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct VrtFrame {
    pub size: (u32, u32),
    /// `None` where it states no place: then it lies where its tiles do.
    pub map_from_grid: Option<DAffine2>,
}

impl VrtFrame {
    /// Where the joined tiles lie in the frame; `None` where they fill it.
    ///
    /// # Errors
    /// They reach beyond it, or lie between its samples.
    fn place_of(&self, joined: &Raster) -> Result<Option<RasterWindow>, DemErrorKind> {
        let (width, height) = joined.size();
        let Some(stated) = self.map_from_grid else {
            return if self.size == (width, height) { Ok(None) } else { Err(self.other_size(joined)) };
        };
        let whole = joined.without_samples().placed(stated);
        let corner = |at: DVec2| whole.grid_from_map(joined.map_from_grid.transform_point2(at));
        let (first, size) = (corner(DVec2::ZERO), DVec2::new(f64::from(width), f64::from(height)));
        let at = first.round();
        let off = [(first, at), (corner(size), at + size)].map(|(found, wanted)| (found - wanted).length());
        // What is not a number lies off.
        if !off.into_iter().all(|off| off < PLACE) {
            return Err(unsupported("another place than its tiles".to_owned()));
        }
        let end = at + size;
        let all = DVec2::new(f64::from(self.size.0), f64::from(self.size.1));
        if at.cmplt(DVec2::ZERO).any() || end.cmpgt(all).any() {
            return Err(self.other_size(joined));
        }
        let window = RasterWindow { column: at.x as u32, row: at.y as u32, width, height };
        Ok((window != RasterWindow::all(self.size)).then_some(window))
    }

    fn other_size(&self, joined: &Raster) -> DemErrorKind {
        let ((width, height), (columns, rows)) = (self.size, joined.size());
        unsupported(format!("{width} x {height} samples of tiles that span {columns} x {rows}"))
    }

    /// The frame with the joined tiles in it.
    ///
    /// # Errors
    /// They reach beyond it, or lie between its samples; it has more samples than a raster.
    pub fn filled(&self, joined: Raster) -> Result<Raster, DemErrorKind> {
        if self.place_of(&joined)?.is_none() {
            return Ok(joined);
        }
        let (width, height) = self.size;
        if u64::from(width) * u64::from(height) > RASTER_SAMPLES.get() {
            return Err(unsupported(format!(
                "{width} x {height} samples, more than the {RASTER_SAMPLES} of a raster"
            )));
        }
        let mut windows = self.filled_windows(Box::new(joined))?;
        let samples = windows.samples(RasterWindow::all(self.size))?;
        Ok(Raster { samples, ..windows.metadata().without_samples() })
    }

    /// The frame with the joined tiles in it, of tiles that are read in windows.
    ///
    /// # Errors
    /// They reach beyond it, or lie between its samples; it has more samples than are read in windows.
    pub fn filled_windows(
        &self,
        joined: Box<dyn Windows + Send>,
    ) -> Result<Box<dyn Windows + Send>, DemErrorKind> {
        let Some(place) = self.place_of(joined.metadata())? else { return Ok(joined) };
        let (width, height) = self.size;
        if u64::from(width) * u64::from(height) > WINDOWED_SAMPLES.get() {
            return Err(unsupported(format!(
                "{width} x {height} samples, more than the {WINDOWED_SAMPLES} of a file"
            )));
        }
        let mut header = Raster { width, height, ..joined.metadata().without_samples() };
        let first = DVec2::new(f64::from(place.column), f64::from(place.row));
        header.map_from_grid.translation = header.map_from_grid.transform_point2(-first);
        Ok(Box::new(FramedWindows { joined, place, header }))
    }
}

/// Joined tiles in a frame.
struct FramedWindows {
    joined: Box<dyn Windows + Send>,
    place: RasterWindow,
    header: Raster,
}

impl Windows for FramedWindows {
    fn metadata(&self) -> &Raster {
        &self.header
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        window.assert_within(self.size());
        let mut all = Samples::absent(window.samples(), self.header.samples.is_wide());
        if let Some(shared) = self.place.intersection(window) {
            let RasterWindow { column, row, .. } = self.place;
            let own = RasterWindow { column: shared.column - column, row: shared.row - row, ..shared };
            let found = self.joined.samples(own)?;
            for (from, to) in shared.shared_rows(window) {
                all.copy_from(to, &found, from);
            }
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::small_raster::small;

    #[test]
    fn what_tiles_leave_of_the_frame_is_no_data() {
        let tile = small(2, 2, vec![1.0, 2.0, 3.0, 4.0]);
        let corner = |column: f64, row: f64| tile.map_from_grid.transform_point2(DVec2::new(column, row));
        let mut map_from_grid = tile.map_from_grid;
        map_from_grid.translation = corner(-1.0, -2.0);
        let frame = VrtFrame { size: (4, 5), map_from_grid: Some(map_from_grid) };
        let filled = frame.filled(tile.clone()).expect("inside");
        assert_eq!((filled.size(), filled.map_from_grid), ((4, 5), map_from_grid));
        assert_eq!([filled.at(1, 2), filled.at(2, 3)], [1.0, 4.0]);
        assert_eq!(filled.samples.valid().count(), 4);
        let small_frame = VrtFrame { size: (2, 5), ..frame };
        assert!(small_frame.filled(tile.clone()).is_err(), "the tile reaches beyond");
        map_from_grid.translation = corner(-1.5, -2.0);
        let between = VrtFrame { map_from_grid: Some(map_from_grid), ..frame };
        assert!(between.filled(tile.clone()).is_err(), "the tile lies between samples");
        let anywhere = VrtFrame { size: (2, 2), map_from_grid: None };
        assert_eq!(anywhere.filled(tile.clone()).expect("all of it").samples, tile.samples);
    }
}
