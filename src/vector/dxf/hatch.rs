//! Boundaries of hatches: rings of lines with bulges, or of edges one after the other.

use glam::{DVec2, DVec3};

use crate::dxf::curves::{Spline, arc, ellipse, sweep_deg};
use crate::dxf::entity::bent;
use crate::dxf::groups::DxfGroup;

/// Reads groups in order.
struct HatchGroups<'a, 'b> {
    groups: &'a [DxfGroup<'b>],
    at: usize,
}

impl HatchGroups<'_, '_> {
    /// The number of the next group where it has a code; else the reader stays.
    fn next(&mut self, code: i32) -> Option<f64> {
        let group = self.groups.get(self.at).filter(|group| group.code == code)?;
        self.at += 1;
        group.number()
    }

    fn point(&mut self, code: i32) -> Option<DVec2> {
        Some(DVec2::new(self.next(code)?, self.next(code + 10)?))
    }

    /// Goes on to the next group with a code.
    fn seek(&mut self, code: i32) -> bool {
        let found = self.groups[self.at.min(self.groups.len())..].iter().position(|group| group.code == code);
        self.at = found.map_or(self.groups.len(), |offset| self.at + offset);
        found.is_some()
    }
}

/// The rings of all boundaries that can be read.
pub(super) fn rings(groups: &[DxfGroup<'_>]) -> Vec<Vec<DVec3>> {
    let mut reader = HatchGroups { groups, at: 0 };
    let mut rings = Vec::new();
    if !reader.seek(91) {
        return rings;
    }
    reader.at += 1;
    while reader.seek(92) {
        let flags = reader.next(92).unwrap_or(0.0) as i64;
        let ring = if flags & 2 != 0 { polyline(&mut reader) } else { edges(&mut reader) };
        rings.extend(ring.filter(|ring| ring.len() >= 3));
    }
    rings
}

fn polyline(reader: &mut HatchGroups<'_, '_>) -> Option<Vec<DVec3>> {
    let has_bulges = reader.next(72)? != 0.0;
    reader.next(73);
    let count = reader.next(93)?;
    let mut vertices = Vec::new();
    while (vertices.len() as f64) < count {
        let Some(at) = reader.point(10) else { break };
        let bulge = if has_bulges { reader.next(42).unwrap_or(0.0) } else { 0.0 };
        vertices.push((at.extend(0.0), bulge));
    }
    bent(&vertices, true)
}

fn edges(reader: &mut HatchGroups<'_, '_>) -> Option<Vec<DVec3>> {
    let count = reader.next(93)?;
    let mut ring: Vec<DVec3> = Vec::new();
    let mut read = 0.0;
    while read < count {
        let Some(kind) = reader.next(72) else { break };
        ring.extend(edge(reader, kind as i64)?);
        read += 1.0;
    }
    ring.dedup_by(|next, last| next.distance(*last) < 1e-9 * (1.0 + last.length()));
    Some(ring)
}

fn edge(reader: &mut HatchGroups<'_, '_>, kind: i64) -> Option<Vec<DVec3>> {
    Some(match kind {
        1 => vec![reader.point(10)?.extend(0.0), reader.point(11)?.extend(0.0)],
        2 => {
            let (center, radius) = (reader.point(10)?, reader.next(40)?);
            let (from, to) = (reader.next(50)?, reader.next(51)?);
            let is_left = reader.next(73)? != 0.0;
            // Clockwise arcs have their angles mirrored.
            let (from, sweep) = match is_left {
                true => (from, sweep_deg(from, to)),
                false => (-from, -sweep_deg(from, to)),
            };
            arc(center.extend(0.0), radius, from.to_radians(), sweep).collect()
        }
        3 => {
            let (center, major) = (reader.point(10)?, reader.point(11)?);
            let minor = major.perp() * reader.next(40)?;
            let (from, to) = (reader.next(50)?.to_radians(), reader.next(51)?.to_radians());
            let is_left = reader.next(73)? != 0.0;
            let minor = if is_left { minor } else { -minor };
            ellipse(center.extend(0.0), major.extend(0.0), minor.extend(0.0), from, to)
        }
        4 => {
            let mut spline =
                Spline { degree: usize::try_from(reader.next(94)? as i64).ok()?, ..Spline::default() };
            let is_rational = reader.next(73)? != 0.0;
            reader.next(74);
            let (knots, control) = (reader.next(95)?, reader.next(96)?);
            while (spline.knots.len() as f64) < knots {
                spline.knots.push(reader.next(40)?);
            }
            while (spline.control.len() as f64) < control {
                spline.control.push(reader.point(10)?.extend(0.0));
                if is_rational {
                    spline.weights.push(reader.next(42)?);
                }
            }
            // Since 2010 the points that it was drawn through follow, which say no more.
            if let Some(fit) =
                reader.groups.get(reader.at).filter(|group| group.code == 97).and_then(DxfGroup::number)
            {
                let is_followed = reader.groups.get(reader.at + 1).is_some_and(|group| group.code == 11);
                if is_followed || fit == 0.0 {
                    reader.at += 1;
                    while reader.point(11).is_some() {}
                    for code in [12, 13] {
                        let _ = reader.point(code);
                    }
                }
            }
            spline.vertices()
        }
        _ => return None,
    })
}
