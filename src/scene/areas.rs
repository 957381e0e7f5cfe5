//! Areas: what covers the ground, with the lines along their outlines.
//!
//! Areas lie below everything else on the ground, and a later one over an earlier. Textures are laid out in world meters,
//! aligned with north, so that areas side by side make one pattern. Natural covers fade along their outlines, as they grow;
//! what has a border, or is built, ends there.

use glam::DVec2;

use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::description::features::AreaTable;
use crate::description::finding_code::FindingCode;
use crate::description::words::{Border, Cover};
use crate::draw::color::Srgba;
use crate::draw::list::FeatureId;
use crate::geom::own_crossing::own_crossing;
use crate::geom::rect::Rect;
use crate::geom::region::{self, PolygonRings};
use crate::geom::self_crossing::count_crossings;
use crate::ribbon::area;
use crate::ribbon::border::{Dashes, border, edge};
use crate::ribbon::plan::PlanMesh;
use crate::ribbon::texture::RibbonSurface;
use crate::ribbon::texture::cover::{EDGE_M, border_color, cover_length_m, is_natural};
use crate::scene::FeatureKind;
use crate::scene::builder::{SceneBuilder, described};
use crate::scene::near::Clipped;
use crate::scene::scene_findings::FeatureTable;
use crate::scene::sources::{Sourced, Sources};
use crate::vector::feature::Polygon;

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
        let (mut bare, mut off) = (0, 0);
        let mut crossed: Option<(String, DVec2, usize)> = None;
        for Sourced { attributes, shape } in sources.polygons(&table.source)? {
            let Some(cover) = attributes.value(Some(&table.cover)) else {
                bare += 1;
                continue;
            };
            let Some(patch) = AreaPatch::of(table, cover, &shape, extent) else {
                off += 1;
                continue;
            };
            let name = attributes.name(table.name.as_deref());
            if patch.crosses_itself
                && let Some(crossing) = shape.rings().find_map(|ring| own_crossing(ring, true))
            {
                crossed.get_or_insert((name.clone(), crossing.at + sources.frame.origin, 0)).2 += 1;
            }
            let feature = collected.add(FeatureKind::Area, name, attributes.origin(&table.source));
            patch.lay(feature, collected);
        }
        if let Some((name, at, count)) = crossed {
            let others =
                if count > 1 { format!("; {} more of this table do", count - 1) } else { String::new() };
            let message = format!(
                "{} crosses itself at ({:.0}, {:.0}): what an odd number of its turns runs around is covered{others}",
                described("area", &name),
                at.x,
                at.y
            );
            collected.findings.add(FindingCode::CrossesItself, table.source.span(), message);
        }
        let named =
            FeatureTable { kind: FeatureKind::Area, name: table.name.as_deref(), source: &table.source };
        let why = "off the elevation model or without an area";
        collected.findings.left_out(off, &named, why);
        collected.findings.left_out(bare, &named, "their properties name no cover");
    }
    Ok(())
}

/// The polygons that a polygon's rings enclose, which cross nothing, and whether the rings do.
fn without_crossings(shape: &Polygon) -> (Vec<PolygonRings>, bool) {
    match count_crossings(shape.rings().map(Vec::as_slice), 0) {
        Some(_) => (vec![shape.rings().cloned().collect()], false),
        None => (region::even_odd(shape.rings().map(Vec::as_slice)), true),
    }
}

/// One area, ready to be laid.
struct AreaPatch {
    fill: PlanMesh,
    line: PlanMesh,
    /// Where the cover fades.
    edge: PlanMesh,
    cover: Cover,
    tint: Srgba,
    /// Whether its outline crossed itself.
    crosses_itself: bool,
}

impl AreaPatch {
    /// `None` where nothing of it lies on the ground.
    fn of(table: &AreaTable, cover: Cover, shape: &Polygon, extent: &Rect) -> Option<Self> {
        if !Rect::around(shape.exterior.iter().copied()).meets(extent) {
            return None;
        }
        let width_m = table.border_width;
        let mut fill = Clipped { plan: PlanMesh::default(), extent };
        let (parts, crosses_itself) = without_crossings(shape);
        for part in &parts {
            area::fill(&part[0], &part[1..], texture_m(cover, width_m), &mut fill);
        }
        let rings: Vec<&[DVec2]> = parts.iter().flatten().map(Vec::as_slice).collect();
        let edge = edge_of(table, cover, &rings, &fill.plan);
        let dashes = match border_of(table, cover) {
            Border::None => None,
            Border::Solid => Some(Dashes::Unbroken),
            Border::Dashed => Some(Dashes::Dashed),
        };
        let line = dashes.map(|dashes| border(&rings, &fill.plan, width_m, dashes)).unwrap_or_default();
        let tint = table.color.map_or(Srgba::WHITE, |color| Srgba(color.0));
        (!fill.plan.triangles.is_empty()).then_some(Self {
            fill: fill.plan,
            line,
            edge,
            cover,
            tint,
            crosses_itself,
        })
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

/// The strip in which natural cover fades, where no line is to be drawn along its outline.
fn edge_of(table: &AreaTable, cover: Cover, rings: &[&[DVec2]], fill: &PlanMesh) -> PlanMesh {
    let corners: usize = rings.iter().map(|ring| ring.len()).sum();
    if !is_natural(cover) || border_of(table, cover) != Border::None || corners > MOST_FADED {
        return PlanMesh::default();
    }
    edge(rings, fill, EDGE_M.min(fill.area_m2().sqrt() * FADED), cover_length_m(cover))
}

/// The stated border, or the cover's own.
fn border_of(table: &AreaTable, cover: Cover) -> Border {
    let own = if cover == Cover::Restricted { Border::Solid } else { Border::None };
    table.border.unwrap_or(own)
}

fn multiplied(color: Srgba, tint: Srgba) -> Srgba {
    let product = |(a, b): (u8, u8)| ((u16::from(a) * u16::from(b) + 127) / 255) as u8;
    Srgba(std::array::from_fn(|channel| product((color.0[channel], tint.0[channel]))))
}
