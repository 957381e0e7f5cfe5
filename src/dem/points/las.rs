//! LAS and LAZ: points of laser scanners.
//!
//! Uncompressed points are read here: of each record only x, y, z, the class and the flag "withheld" matter, and they
//! stand at fixed places. Compressed ones are unpacked by the `las` crate into the same records.
//!
//! A scanner's points are of all that it met. Without a choice of classes the ground's (class 2) are taken where there
//! are any; a file that nobody has classified gives all its points, roofs and treetops among them, and says so.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::dem::points::las_crs;
use crate::dem::points::las_header::{LasHeader, broken};
use crate::dem::points::{PointCloud, PointHints, PointsError, laz};

/// The class of the ground.
pub const GROUND: u8 = 2;

/// Whether the content is that of a LAS or LAZ file.
pub fn recognizes(bytes: &[u8]) -> bool {
    bytes.starts_with(b"LASF")
}

/// Reads a LAS or LAZ file.
///
/// # Errors
/// [`PointsError`]: a header that the file belies, a compression that is not read, a coordinate system that is not
/// understood (unless the hints state one), no point of the classes asked for.
pub fn read(bytes: &[u8], hints: &PointHints) -> Result<PointCloud, PointsError> {
    let header = LasHeader::read(bytes)?;
    let system = las_crs::read(&header.records(bytes), &header, hints.crs)?;
    let found = if header.compressed {
        let mut found = LasPoints::new(&header);
        laz::unpack(bytes, &header, &mut |records| found.take(records))?;
        found
    } else {
        let mut found = LasPoints::new(&header);
        found.take(&bytes[header.points_at..][..header.count as usize * header.record]);
        found
    };
    let mut notes = system.notes;
    let points = found.of_classes(hints.classes, &mut notes)?;
    Ok(PointCloud {
        points,
        breaklines: Vec::new(),
        crs: system.crs,
        meters_per_z: system.meters_per_z,
        vertical_datum: system.vertical_datum,
        notes,
    })
}

/// Points with their classes.
struct LasPoints<'a> {
    header: &'a LasHeader,
    points: Vec<DVec3>,
    classes: Vec<u8>,
    withheld: usize,
}

impl<'a> LasPoints<'a> {
    fn new(header: &'a LasHeader) -> Self {
        // A compressed file may promise more than it holds; what it does hold will grow the lists.
        let room = if header.compressed { 0 } else { header.count as usize };
        Self { header, points: Vec::with_capacity(room), classes: Vec::with_capacity(room), withheld: 0 }
    }

    fn take(&mut self, records: &[u8]) {
        let header = self.header;
        for record in records.chunks_exact(header.record) {
            // Withheld points are deleted ones that nobody has removed.
            let (class, withheld) = match header.is_extended() {
                false => (record[15] & 0x1f, record[15] & 0x80 != 0),
                true => (record[16], record[15] & 0x04 != 0),
            };
            if withheld {
                self.withheld += 1;
                continue;
            }
            let [x, y, z] = [0, 4, 8].map(|at| {
                let stored = [record[at], record[at + 1], record[at + 2], record[at + 3]];
                f64::from(i32::from_le_bytes(stored))
            });
            self.points.push(DVec3::new(x, y, z) * header.scale + header.offset);
            self.classes.push(class);
        }
    }

    /// The points of the classes asked for.
    fn of_classes(self, wanted: &[u8], notes: &mut Vec<String>) -> Result<Vec<DVec3>, PointsError> {
        if self.withheld > 0 {
            notes.push(format!("{} withheld points were left out", self.withheld));
        }
        let all = self.points.len();
        let has_ground = self.classes.contains(&GROUND);
        let wanted = match wanted {
            [] if has_ground => &[GROUND][..],
            [] => {
                notes.push(format!(
                    "no point is classified as ground: all {all} were taken, whatever they hit"
                ));
                return if all == 0 {
                    Err(PointsError::Empty { why: String::new() })
                } else {
                    Ok(self.points)
                };
            }
            wanted => wanted,
        };
        let taken: Vec<DVec3> = self
            .points
            .iter()
            .zip(&self.classes)
            .filter(|(_, class)| wanted.contains(class))
            .map(|(point, _)| *point)
            .collect();
        let named = wanted.iter().map(u8::to_string).collect::<Vec<_>>().join(", ");
        if taken.is_empty() {
            let why = format!(" of class {named}; it has {}", census(&self.classes));
            return Err(PointsError::Empty { why });
        }
        notes.push(format!("{} of {all} points were taken, of class {named}", taken.len()));
        Ok(taken)
    }
}

/// How many points there are of each class, in words.
fn census(classes: &[u8]) -> String {
    let mut counts: BTreeMap<u8, usize> = BTreeMap::new();
    for &class in classes {
        *counts.entry(class).or_default() += 1;
    }
    let words: Vec<String> =
        counts.iter().map(|(class, count)| format!("{count} of class {class}")).collect();
    if words.is_empty() { "none at all".into() } else { words.join(", ") }
}

/// Whether an uncompressed point's place can be had at all; the crate that unpacks wants at least one point.
pub(super) fn check_not_empty(header: &LasHeader) -> Result<(), PointsError> {
    if header.count > 0 { Ok(()) } else { Err(broken("it promises no points")) }
}
