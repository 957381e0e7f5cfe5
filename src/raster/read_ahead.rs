//! Windows of a raster one after the other: the next is read while one is worked on.

use crate::error::DemErrorKind;
use crate::windows::{RasterWindow, Windows};

/// Calls `each` with the result of `read` for each of `windows`, in order, and reads the next window meanwhile, on
/// another thread where there is one. Memory: two windows.
///
/// # Errors
/// The first of `read`; `each` has been called with all windows before it.
pub fn read_ahead<W: Windows + Send + ?Sized, T: Send>(
    source: &mut W,
    mut windows: impl Iterator<Item = RasterWindow>,
    read: impl Fn(&mut W, RasterWindow) -> Result<T, DemErrorKind> + Sync,
    mut each: impl FnMut(RasterWindow, T) + Send,
) -> Result<(), DemErrorKind> {
    let read = |source: &mut W, window| read(source, window).map(|held| (window, held));
    let mut now = windows.next().map(|first| read(source, first)).transpose()?;
    while let Some((window, held)) = now {
        let next = windows.next();
        let (ahead, ()) =
            rayon::join(|| next.map(|next| read(source, next)).transpose(), || each(window, held));
        now = ahead?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::small;

    #[test]
    fn windows_come_in_order_and_the_first_error_ends_them() {
        let mut raster = small(4, 9, (0..36u8).map(f32::from).collect());
        let bands = RasterWindow::all(raster.size()).bands(8);
        let mut seen = Vec::new();
        let read = |source: &mut _, window: RasterWindow| match window.row {
            6 => Err(DemErrorKind::Changed),
            _ => Windows::samples(source, window),
        };
        let outcome =
            read_ahead(&mut raster, bands, read, |window, held| seen.push((window.row, held.get(0))));
        assert!(matches!(outcome, Err(DemErrorKind::Changed)));
        assert_eq!(seen, [(0, 0.0), (2, 8.0), (4, 16.0)]);
    }
}
