//! Coordinate systems that the scene states in place of those that files state.

use std::ops::Range;

use glam::DVec2;

use sandtable_base::message::suggest::quoted;
use sandtable_description::document::Document;
use sandtable_description::finding::Finding;
use sandtable_description::finding_code::FindingCode;
use sandtable_geom::crs::Crs;
use sandtable_geom::geodesic::Geodesic;

/// Two realizations of one datum are nearer to each other than this, meters.
const LEAST_M: f64 = 1.0;

/// A system that a file states, and the one that the scene states in its place.
pub struct OverriddenCrs<'a> {
    /// The name of the file.
    pub file: &'a str,
    /// Its own system.
    pub own: &'a Crs,
    /// The system that the scene states, which takes precedence.
    pub stated: &'a Crs,
}

impl OverriddenCrs<'_> {
    /// The finding at the bytes `span` of the scene file, where the systems put the coordinates `at` of the file a meter or
    /// more from each other, or the shift between their datums is not known; `None` where they do not, or one of them puts
    /// these nowhere on Earth.
    pub fn finding(&self, at: DVec2, document: &Document, span: Range<usize>) -> Option<Finding> {
        let effect = match Geodesic::between_systems(self.own, self.stated, at).map(|line| line.length_m()) {
            Some(apart_m) if apart_m >= LEAST_M => format!("which puts it {apart_m:.0} m elsewhere"),
            None if self.own.datum_shift_to(self.stated).is_err() => {
                "and the shift between their datums is not known here".to_owned()
            }
            Some(_) | None => return None,
        };
        let message = format!(
            "'{}' states {}, and the scene says {} in its place, {effect}",
            quoted(self.file),
            self.own.name(),
            self.stated.name()
        );
        let finding = Finding::new(FindingCode::CrsOverridden, message).at(&document.source, span);
        let help = "leave `crs` out, unless the file is known to state the wrong system";
        Some(finding.with_help(help))
    }
}
