//! Buildings that are made of parts: Simple 3D Buildings (OpenStreetMap's `building:part`).
//!
//! A building's outline and its parts are features of one file. Where the parts cover the outline they are drawn in its
//! place, on the ground of the whole building; else the outline is drawn as well.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::attributes::Attributes;
use crate::sources::Sourced;
use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;
use sandtable_geom::rect_tree::RectTree;
use sandtable_geom::region;
use sandtable_vector::feature::Polygon;

/// The least share of an outline that its parts cover where they replace it: mappers draw borders twice and not alike.
const COVERED: f64 = 0.9;

/// A part's vertices that are looked for in an outline.
const WITNESSES: usize = 8;

/// How far these are drawn toward the part's middle, since parts share borders with their outline.
const DRAWN_IN: f64 = 0.02;

/// The most pairs of a vertex and a side of an outline that are looked at: a hundred times what cities take.
const MOST_STEPS: usize = 1 << 30;

/// The outlines of a table and their parts.
#[derive(Debug, Default)]
pub struct BuildingParts {
    /// The outline of each part that has one, both by their numbers among the polygons.
    outline_of: BTreeMap<usize, usize>,
    /// Whether parts replace an outline that has some.
    is_replaced: BTreeMap<usize, bool>,
}

impl BuildingParts {
    /// Finds the outlines and parts among the polygons of a table.
    pub fn find(polygons: &[Sourced<Polygon>]) -> Self {
        let (parts, outlines): (Vec<usize>, Vec<usize>) =
            (0..polygons.len()).partition(|&index| is_part(&polygons[index].attributes));
        let mut found = Self::default();
        if parts.is_empty() || outlines.is_empty() {
            return found;
        }
        let ring = |index: usize| &polygons[index].shape.exterior[..];
        let boxes: Vec<Rect> = outlines.iter().map(|&index| polygon::bounds(ring(index))).collect();
        let (tree, mut steps) = (RectTree::new(&boxes), 0);
        for &part in &parts {
            let witnesses = witnesses(ring(part));
            let middle = polygon::bounds(ring(part)).center();
            let around = tree.meeting_in_order(&Rect { min: middle, max: middle });
            let holding = around.into_iter().map(|number| outlines[number]).filter(|&outline| {
                steps += witnesses.len() * ring(outline).len();
                steps <= MOST_STEPS && is_within(&witnesses, ring(outline))
            });
            let smallest = holding.min_by(|&a, &b| area_m2(ring(a)).total_cmp(&area_m2(ring(b))));
            found.outline_of.extend(smallest.map(|outline| (part, outline)));
        }
        let mut parts_of: BTreeMap<usize, Vec<Vec<DVec2>>> = BTreeMap::new();
        for (&part, &outline) in &found.outline_of {
            parts_of.entry(outline).or_default().push(polygon::counter_clockwise(ring(part)));
        }
        for (outline, parts) in parts_of {
            let covered: f64 = region::union(parts.iter().map(Vec::as_slice))
                .iter()
                .flatten()
                .map(|ring| polygon::doubled_area(ring) / 2.0)
                .sum();
            found.is_replaced.insert(outline, covered.abs() >= COVERED * area_m2(ring(outline)));
        }
        found
    }

    /// The outline whose parts are drawn in its place, of which the polygon `index` is one.
    pub fn replaced_outline_of(&self, index: usize) -> Option<usize> {
        self.outline_of.get(&index).copied().filter(|&outline| self.is_replaced(outline))
    }

    /// Whether the parts of the polygon `index` are drawn in its place.
    pub fn is_replaced(&self, index: usize) -> bool {
        self.is_replaced.get(&index).copied().unwrap_or(false)
    }

    /// Whether the polygon `index` has parts that cover it in part and is drawn beside them.
    pub fn is_beside_parts(&self, index: usize) -> bool {
        self.is_replaced.get(&index).is_some_and(|is_replaced| !is_replaced)
    }
}

/// Whether a feature is a part of a building, and not one itself.
fn is_part(attributes: &Attributes) -> bool {
    attributes.affirm("building:part") && !attributes.affirm("building")
}

fn witnesses(ring: &[DVec2]) -> Vec<DVec2> {
    let middle = ring.iter().sum::<DVec2>() / ring.len().max(1) as f64;
    let step = ring.len().div_ceil(WITNESSES).max(1);
    ring.iter().step_by(step).map(|at| at.lerp(middle, DRAWN_IN)).collect()
}

/// Whether most of the witnesses lie in a ring.
fn is_within(witnesses: &[DVec2], ring: &[DVec2]) -> bool {
    let inside = witnesses.iter().filter(|&&at| polygon::contains([ring], at)).count();
    inside * 4 >= witnesses.len() * 3
}

fn area_m2(ring: &[DVec2]) -> f64 {
    polygon::doubled_area(ring).abs() / 2.0
}
