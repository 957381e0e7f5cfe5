//! Areas: land cover on the ground, with lines along the outlines.
//!
//! Areas lie below everything else on the ground, and a later one over an earlier. Textures are laid out in world meters,
//! so that areas side by side make one pattern. Natural covers fade along their outlines, as they grow;
//! what has a border, or is built, ends there, and so do the patches of a raster of land cover, which adjoin each other.

use glam::DVec2;

use crate::builder::SceneBuilder;
use crate::crossed_shapes::CrossedShapes;
use crate::feature::FeatureKind;
use crate::near::Clipped;
use crate::scene_findings::FeatureTable;
use crate::sources::{Sourced, Sources};
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::features::AreaTable;
use sandtable_description::words::{Border, Cover};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;
use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;
use sandtable_geom::region::{self, PolygonRings};
use sandtable_ribbon::area;
use sandtable_ribbon::border::{Dashes, border, edge};
use sandtable_ribbon::plan::PlanMesh;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_ribbon::texture::cover::{EDGE_M, border_color, cover_length_m, is_natural};
use sandtable_vector::feature::Polygon;

/// Adds the document's areas to `collected`. Those off the ground and those without an area are left out, and those for
/// which an expression gives no cover; notes say how many.
///
/// # Errors
/// A source cannot be had.
pub fn lay(
    document: &Document,
    sources: &Sources<'_>,
    extent: &Rect,
    collected: &mut SceneBuilder,
) -> Result<(), Diagnostic> {
    for table in &document.areas {
        let (mut bare, mut off, mut empty) = (0, 0, 0);
        let mut crossed = CrossedShapes::default();
        let polygons = sources.polygons(&table.source)?;
        let outline = match sources.is_class_raster(&table.source) {
            true => AreaOutline::Shared,
            false => AreaOutline::Own,
        };
        for Sourced { attributes, shape, crossings } in polygons {
            let Some(cover) = attributes.value(Some(&table.cover)) else {
                bare += 1;
                continue;
            };
            let Some(patch) = AreaPatch::of((table, outline), cover, (&shape, crossings), extent) else {
                let is_empty = crossings == 0 && polygon::doubled_area(&shape.exterior).abs() < LEAST_M2;
                *if is_empty { &mut empty } else { &mut off } += 1;
                continue;
            };
            let name = attributes.name(table.name.as_deref());
            crossed.add_polygon(&shape, crossings, || name.clone());
            let feature = collected.add(FeatureKind::Area, name, attributes.origin(&table.source));
            patch.lay(feature, collected);
        }
        let outcome = "what an odd number of its turns runs around is covered";
        crossed.report(("area", outcome), table.source.span(), sources.frame, &mut collected.findings);
        let named =
            FeatureTable { kind: FeatureKind::Area, name: table.name.as_deref(), source: &table.source };
        if outline == AreaOutline::Own {
            collected.findings.left_out(off, &named, "off the elevation model");
        }
        collected.findings.without_extent(empty, &named, "their outlines enclose no area");
        collected.findings.left_out(bare, &named, "their properties name no cover");
    }
    Ok(())
}

/// An outline around less encloses nothing, square meters.
const LEAST_M2: f64 = 1e-6;

/// The polygons that the rings of a polygon with so many crossings enclose; they cross nothing.
fn without_crossings(shape: &Polygon, crossings: usize) -> Vec<PolygonRings> {
    match crossings {
        0 => vec![shape.rings().cloned().collect()],
        _ => region::even_odd(shape.rings().map(Vec::as_slice)),
    }
}

/// Whether what is beside an area is known.
#[derive(Clone, Copy, PartialEq, Eq)]
enum AreaOutline {
    /// Natural covers fade toward bare ground.
    Own,
    /// Its neighbors begin where it ends: ground would show between covers that fade.
    Shared,
}

/// One area, ready to be laid.
struct AreaPatch {
    fill: PlanMesh,
    line: PlanMesh,
    /// Where the cover fades.
    edge: PlanMesh,
    cover: Cover,
    tint: Srgba,
}

impl AreaPatch {
    /// The patch of a polygon with so many crossings; `None` where nothing of it lies on the ground.
    ///
    /// Where it is several polygons, each has the line and the edge along its own outline, cut to itself: what does not
    /// depend on the others need not be held against them.
    fn of(
        (table, outline): (&AreaTable, AreaOutline),
        cover: Cover,
        (shape, crossings): (&Polygon, usize),
        extent: &Rect,
    ) -> Option<Self> {
        if !Rect::around(shape.exterior.iter().copied()).meets(extent) {
            return None;
        }
        let tint = table.color.map_or(Srgba::WHITE, |color| Srgba(color.0));
        let [fill, line, edge] = [(); 3].map(|()| PlanMesh::default());
        let mut patch = Self { fill, line, edge, cover, tint };
        let parts = without_crossings(shape, crossings);
        let corners: usize = parts.iter().flatten().map(Vec::len).sum();
        for part in &parts {
            patch.add((table, outline), part, corners, extent);
        }
        (!patch.fill.triangles.is_empty()).then_some(patch)
    }

    /// Adds one of its polygons, which have so many `corners` in all.
    fn add(
        &mut self,
        (table, outline): (&AreaTable, AreaOutline),
        rings: &[Vec<DVec2>],
        corners: usize,
        extent: &Rect,
    ) {
        let (cover, width_m) = (self.cover, table.border_width);
        let mut fill = Clipped { plan: PlanMesh::default(), extent };
        area::fill(&rings[0], &rings[1..], texture_m(cover, width_m), &mut fill);
        let rings: Vec<&[DVec2]> = rings.iter().map(Vec::as_slice).collect();
        let fades = outline == AreaOutline::Own && is_natural(cover);
        if fades && border_of(table, cover) == Border::None && corners <= MOST_FADED {
            let faded_m = EDGE_M.min(fill.plan.area_m2().sqrt() * FADED);
            self.edge.append(&edge(&rings, &fill.plan, faded_m, cover_length_m(cover)));
        }
        let dashes = match border_of(table, cover) {
            Border::None => None,
            Border::Solid => Some(Dashes::Unbroken),
            Border::Dashed => Some(Dashes::Dashed),
        };
        if let Some(dashes) = dashes {
            self.line.append(&border(&rings, &fill.plan, width_m, dashes));
        }
        self.fill.append(&fill.plan);
    }

    /// Lays the area, and its border over it.
    fn lay(self, feature: FeatureId, collected: &mut SceneBuilder) {
        collected.lay_tinted(self.fill, (RibbonSurface::Cover(self.cover), self.tint), feature);
        if !self.edge.triangles.is_empty() {
            collected.lay_tinted(self.edge, (RibbonSurface::CoverEdge(self.cover), self.tint), feature);
        }
        if !self.line.triangles.is_empty() {
            let color = multiplied(border_color(self.cover), self.tint);
            collected.lay_tinted(self.line, (RibbonSurface::Border, color), feature);
        }
    }
}

/// The width of a border in meters at which hatching has its own size: the default of `border_width`.
const HATCHED_BORDER_M: f64 = 4.0;

/// Meters in one repeat of a cover's texture; hatching is as wide as the border wants it.
fn texture_m(cover: Cover, border_width_m: f64) -> f64 {
    match cover {
        Cover::Restricted => cover_length_m(cover) * border_width_m / HATCHED_BORDER_M,
        _ => cover_length_m(cover),
    }
}

/// The corners of an outline above which it is not faded: a cover of a whole country is not seen from near.
const MOST_FADED: usize = 4000;

/// Of small areas the part of the side of the square of their size that fades: more would leave nothing of them.
const FADED: f64 = 1.0 / 8.0;

/// The stated border, or the cover's own.
fn border_of(table: &AreaTable, cover: Cover) -> Border {
    let own = if cover == Cover::Restricted { Border::Solid } else { Border::None };
    table.border.unwrap_or(own)
}

fn multiplied(color: Srgba, tint: Srgba) -> Srgba {
    let product = |(a, b): (u8, u8)| ((u16::from(a) * u16::from(b) + 127) / 255) as u8;
    Srgba(std::array::from_fn(|channel| product((color.0[channel], tint.0[channel]))))
}
