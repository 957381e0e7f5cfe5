//! LAS and LAZ: points of laser scanners.
//!
//! Of each record only x, y, z, the class and the flag "withheld" matter, and they lie at fixed places. Compressed
//! records are unpacked first (`laz`).
//!
//! A scanner's points are of everything that it met. Without a choice of classes the ground's (class 2) are taken where
//! there are any; a file without classification gives all its points, roofs and treetops among them, and notes so.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::points::cloud::{PointCloud, PointHints};
use crate::points::error::PointsError;
use crate::points::las_crs::LasCrs;
use crate::points::las_header::LasHeader;
use crate::points::laz;
use sandtable_base::bytes::ByteFields;

/// The class of the ground.
pub const GROUND: u8 = 2;

/// Reads a LAS or LAZ file.
///
/// # Errors
/// [`PointsError`]: a header that contradicts the file, a compression that is not read, a coordinate system that is not
/// understood (unless the hints state one), no point of the wanted classes.
pub fn read(bytes: &[u8], hints: &PointHints) -> Result<PointCloud, PointsError> {
    let header = LasHeader::read(bytes)?;
    let system = LasCrs::new(&header.records(bytes), &header, hints.crs)?;
    let mut points = LasPoints::new(&header);
    if header.is_compressed {
        laz::unpack(bytes, &header, |records| points.take(records))?;
    } else {
        points.take(&bytes[header.points_at..][..header.count as usize * header.point_bytes]);
    }
    let mut notes = system.notes;
    let points = points.select_classes(hints.classes, &mut notes)?;
    Ok(PointCloud {
        crs: system.crs,
        meters_per_z: system.meters_per_z,
        vertical_datum: system.vertical_datum,
        notes,
        ..PointCloud::new(points)
    })
}

struct LasPoints<'a> {
    header: &'a LasHeader,
    points: Vec<DVec3>,
    classes: Vec<u8>,
    withheld: usize,
}

impl<'a> LasPoints<'a> {
    fn new(header: &'a LasHeader) -> Self {
        // A compressed file may state more than it holds; the lists grow with what it does hold.
        let count = if header.is_compressed { 0 } else { header.count as usize };
        Self { header, points: Vec::with_capacity(count), classes: Vec::with_capacity(count), withheld: 0 }
    }

    fn take(&mut self, records: &[u8]) {
        let header = self.header;
        for record in records.chunks_exact(header.point_bytes) {
            // Withheld points are deleted ones that were not removed.
            let (class, is_withheld) = match header.is_extended() {
                false => (record[15] & 0x1f, record[15] & 0x80 != 0),
                true => (record[16], record[15] & 0x04 != 0),
            };
            if is_withheld {
                self.withheld += 1;
                continue;
            }
            let fields = ByteFields::little_endian(record);
            let stored = [0, 4, 8].map(|at| f64::from(fields.i32(at).unwrap_or_default()));
            self.points.push(DVec3::from(stored) * header.scale + header.offset);
            self.classes.push(class);
        }
    }

    fn select_classes(self, wanted: &[u8], notes: &mut Vec<String>) -> Result<Vec<DVec3>, PointsError> {
        if self.withheld > 0 {
            notes.push(format!("{} withheld points were left out", self.withheld));
        }
        let all = self.points.len();
        if wanted.is_empty() && !self.classes.contains(&GROUND) {
            notes.push(format!("no point is classified as ground: all {all} were taken, whatever they hit"));
            return if all > 0 { Ok(self.points) } else { Err(PointsError::Empty(0)) };
        }
        let wanted = if wanted.is_empty() { &[GROUND] } else { wanted };
        let with_classes = self.points.iter().zip(&self.classes);
        let taken: Vec<DVec3> =
            with_classes.filter(|(_, class)| wanted.contains(class)).map(|(point, _)| *point).collect();
        let names = wanted.iter().map(u8::to_string).collect::<Vec<_>>().join(", ");
        if taken.is_empty() {
            return Err(PointsError::NoClass { wanted: names, found: census(&self.classes) });
        }
        notes.push(format!("{} of {all} points were taken, of class {names}", taken.len()));
        Ok(taken)
    }
}

/// The number of points of each class, in words.
fn census(classes: &[u8]) -> String {
    let mut counts: BTreeMap<u8, usize> = BTreeMap::new();
    for &class in classes {
        *counts.entry(class).or_default() += 1;
    }
    let words: Vec<String> =
        counts.iter().map(|(class, count)| format!("{count} of class {class}")).collect();
    if words.is_empty() { "none at all".into() } else { words.join(", ") }
}
