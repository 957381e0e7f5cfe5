//! Volumes of earth moved.

/// Earth moved, in cubic meters, each post standing for one cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Volumes {
    /// Taken away.
    pub cut_m3: f64,
    /// Put on.
    pub fill_m3: f64,
}
