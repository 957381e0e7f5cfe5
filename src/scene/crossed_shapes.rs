//! Outlines and lines of one table that cross themselves: where the first does, and how many others do.

use std::ops::Range;

use glam::DVec2;

use crate::feature::described;
use crate::scene_findings::SceneFindings;
use crate::world_frame::WorldFrame;
use sandtable_base::message::numbers::fixed;
use sandtable_description::finding::Finding;
use sandtable_description::finding_code::FindingCode;
use sandtable_geom::own_crossing::own_crossing;
use sandtable_vector::feature::Polygon;

/// The crossed shapes of one table.
#[derive(Debug, Default)]
pub struct CrossedShapes {
    /// The name of the first, which may be empty, and where it crosses itself, in world coordinates.
    first: Option<(String, DVec2)>,
    count: usize,
}

impl CrossedShapes {
    /// Looks at a polygon whose rings have so many crossings.
    pub fn add_polygon(&mut self, shape: &Polygon, crossings: usize, name: impl FnOnce() -> String) {
        if crossings > 0 {
            self.add(shape.rings().find_map(|ring| own_crossing(ring, true)).map(|found| found.at), name);
        }
    }

    /// Looks at a line.
    pub fn add_line(&mut self, points: &[DVec2], name: impl FnOnce() -> String) {
        self.add(own_crossing(points, false).map(|found| found.at), name);
    }

    fn add(&mut self, crossing: Option<DVec2>, name: impl FnOnce() -> String) {
        let Some(at) = crossing else { return };
        self.count += 1;
        self.first.get_or_insert_with(|| (name(), at));
    }

    /// Adds the finding about the table that `span` states, where one of its shapes, which are called `noun`, crosses
    /// itself; `outcome` says what becomes of it.
    pub fn report(
        self,
        (noun, outcome): (&str, &str),
        span: Range<usize>,
        frame: &WorldFrame<'_>,
        findings: &mut SceneFindings,
    ) {
        let Some((name, at)) = self.first else { return };
        let (what, at, others) = (described(noun, &name), at + frame.origin, self.count - 1);
        let more = if others > 0 { format!("; {others} more of this table do") } else { String::new() };
        let message =
            format!("{what} crosses itself at ({}, {}): {outcome}{more}", fixed(at.x, 0), fixed(at.y, 0));
        let finding = Finding::new(FindingCode::CrossesItself, message).at(&frame.document.source, span);
        let help = "mend the order of its points, for example with: ogr2ogr -makevalid out.geojson IN";
        findings.push(finding.with_help(help).and_more(others));
    }
}
