//! Features along lines: fences, walls, hedges, power lines, trenches, obstacle belts and boundaries.
//!
//! Two passes, as for buildings: trenches are dug before the roads come, everything is set where the ground is finished.
//! What stands is only planned here; [`sandtable_structure::draped_solid`] sets it on the displayed ground for every picture.

use glam::DVec2;

use crate::attributes::Attributes;
use crate::builder::SceneBuilder;
use crate::crossed_shapes::CrossedShapes;
use crate::feature::FeatureKind;
use crate::feature_meshes::FeatureSolid;
use crate::meant_number::Meaning;
use crate::near::{self, Clipped};
use crate::report::TrenchRow;
use crate::scene_findings::FeatureTable;
use crate::sources::Sources;
use crate::tag_notes::NumberLimits;
use crate::vertical_scale::DrawnGround;
use sandtable_base::limits::LINE_PIECES;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::features::FenceTable;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::scalar::Scalar;
use sandtable_description::stated::Stated;
use sandtable_description::words::FenceKind;
use sandtable_draw::list::FeatureId;
use sandtable_earthworks::alignment::Alignment;
use sandtable_earthworks::brush::Trench;
use sandtable_geom::polyline::Polyline;
use sandtable_geom::rect::Rect;
use sandtable_ribbon::plan::PlanMesh;
use sandtable_ribbon::stroke::{StrokeOptions, StrokePath, stroke};
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_structure::bands::{BandSize, bare_m, hedge, parapets, rails, wall};
use sandtable_structure::draped_solid::DrapedSolid;
use sandtable_structure::fence::{Posts, spans, stands};
use sandtable_structure::obstacle::{self, Obstacles};
use sandtable_structure::power::{PowerLine, clear};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_terrain::volumes::Volumes;

/// A line is dug where its trench is at least as many cells wide; on coarser ground it would be a row of pits.
const LEAST_CELLS: f64 = 3.0;

/// A trench's bottom as a share of its width.
const BOTTOM: f64 = 0.55;

/// A line of fences, wires or the like.
pub struct FenceLine {
    kind: FenceKind,
    /// Its parts on the elevation model, with its width.
    parts: Vec<Alignment>,
    width_m: f64,
    height_m: f64,
    spacing_m: f64,
    sag: f64,
    feature: FeatureId,
}

/// A line that stops what moves across it.
#[derive(Clone, Debug, PartialEq)]
pub struct Barrier {
    /// World X and Y, two positions or more.
    pub line: Vec<DVec2>,
    /// What it is.
    pub kind: BarrierKind,
}

/// What stops what moves across a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BarrierKind {
    /// A wall or a belt of obstacles of this height in meters.
    Step(f64),
    /// A trench of this width in meters.
    Gap(f64),
}

/// The lines that stop vehicles: walls, belts of obstacles and trenches. Fences and hedges are driven through.
pub fn barriers(lines: &[FenceLine]) -> Vec<Barrier> {
    let of_line = |line: &FenceLine| {
        let kind = match line.kind {
            FenceKind::Wall | FenceKind::Obstacles => BarrierKind::Step(line.height_m),
            FenceKind::Trench => BarrierKind::Gap(line.width_m),
            _ => return Vec::new(),
        };
        line.parts.iter().map(|part| Barrier { line: part.line.points().to_vec(), kind }).collect()
    };
    lines.iter().flat_map(of_line).collect()
}

/// The default sizes of a kind.
struct Sizes {
    height_m: f64,
    width_m: f64,
    spacing_m: f64,
}

fn default_sizes(kind: FenceKind) -> Sizes {
    let (height_m, width_m, spacing_m) = match kind {
        FenceKind::Fence => (1.2, 0.12, 3.0),
        FenceKind::Wall => (2.0, 0.4, 4.0),
        FenceKind::Hedge => (1.8, 1.2, 1.2),
        FenceKind::PowerLine => (30.0, 10.0, 300.0),
        FenceKind::Trench => (1.5, 1.5, 1.5),
        FenceKind::Obstacles => (1.2, 9.0, 3.0),
        FenceKind::Boundary => (1.0, 2.0, 18.0),
    };
    Sizes { height_m, width_m, spacing_m }
}

/// The document's lines, and the ground dug where they are trenches and its cells are fine enough.
///
/// # Errors
/// A source cannot be had, or more is to stand than a scene may hold.
pub fn lay_out(
    document: &Document,
    sources: &Sources<'_>,
    lattice: &mut Lattice,
    collected: &mut SceneBuilder,
) -> Result<Vec<FenceLine>, Diagnostic> {
    let (mut lines, mut pieces, mut undug) = (Vec::new(), 0.0, 0);
    let extent = lattice.extent();
    for fence in &document.fences {
        let stated = fence.name.as_deref();
        let named = FeatureTable { kind: FeatureKind::Fence, name: stated, source: &fence.source };
        let found = sources.lines(&fence.source)?;
        let mut crossed = CrossedShapes::default();
        for (attributes, line) in near::lines(found, &extent, 0.0, &named, &mut collected.findings) {
            let name = attributes.name(stated);
            let feature = collected.add(FeatureKind::Fence, name.clone(), attributes.origin(&fence.source));
            crossed.add_line(line.points(), || name.clone());
            let line = fence_line(fence, &attributes, line.clip(&extent), feature, collected);
            pieces += line.pieces();
            if pieces > LINE_PIECES.get() as f64 {
                return Err(too_many(document, fence, line.kind));
            }
            if line.kind == FenceKind::Trench {
                undug += usize::from(!dig(&line, &name, lattice, collected));
            }
            lines.push(line);
        }
        crossed.report(
            ("line", "it stands through itself"),
            fence.source.span(),
            sources.frame,
            &mut collected.findings,
        );
    }
    if undug > 0 {
        let trenches = if undug == 1 { "trench" } else { "trenches" };
        let message = format!(
            "{undug} {trenches} drawn on the ground, not dug: the elevation model's posts are too far apart"
        );
        collected.findings.add(FindingCode::TooFine, 0..0, message);
    }
    Ok(lines)
}

fn too_many(document: &Document, fence: &FenceTable, kind: FenceKind) -> Diagnostic {
    let what = match kind {
        FenceKind::PowerLine => "pylons",
        FenceKind::Obstacles => "obstacles",
        FenceKind::Boundary => "dashes",
        FenceKind::Hedge | FenceKind::Trench | FenceKind::Wall => "lengths of it",
        FenceKind::Fence => "posts",
    };
    let message = format!("with the {what} along this, more than {LINE_PIECES} pieces stand along lines");
    let place = fence.spacing.as_ref().and_then(Stated::span).unwrap_or_else(|| fence.source.span());
    let help = format!("give it a wider `spacing`, choose fewer lines by `where`, or {LINE_PIECES:#}");
    document.error_at(place, message).with_help(help)
}

fn fence_line(
    fence: &FenceTable,
    attributes: &Attributes,
    parts: Vec<Polyline>,
    feature: FeatureId,
    collected: &mut SceneBuilder,
) -> FenceLine {
    let kind = attributes.value(fence.kind.as_ref()).unwrap_or_else(|| tagged_kind(fence, attributes));
    let sizes = default_sizes(kind);
    let limits = NumberLimits::above_zero(1000.0);
    let tagged = fence
        .height
        .is_none()
        .then(|| collected.tag_notes.number(attributes, &["height"], Meaning::Length, limits));
    let tagged = tagged.flatten();
    let mut size = |key, default: f64| attributes.number_or(key, default, &mut collected.default_counts);
    let height_m = size(fence.height.as_ref(), tagged.unwrap_or(sizes.height_m));
    let width_m = size(fence.width.as_ref(), sizes.width_m);
    FenceLine {
        kind,
        parts: parts.into_iter().map(|part| Alignment::on_ground(part, width_m)).collect(),
        width_m,
        height_m,
        spacing_m: size(fence.spacing.as_deref(), sizes.spacing_m),
        sag: fence.sag,
        feature,
    }
}

/// What a line is that the scene file says nothing of, by its properties as OpenStreetMap has them.
fn tagged_kind(fence: &FenceTable, attributes: &Attributes) -> FenceKind {
    let text = |name: &str| match attributes.get(name) {
        Some(Scalar::Text(text)) => text,
        _ => String::new(),
    };
    if fence.kind.is_some() {
        return FenceKind::default();
    }
    match (text("barrier").as_str(), text("power").as_str(), text("boundary").as_str()) {
        ("wall" | "city_wall" | "retaining_wall", _, _) => FenceKind::Wall,
        ("hedge", _, _) => FenceKind::Hedge,
        ("", "line" | "minor_line", _) => FenceKind::PowerLine,
        ("", "", boundary) if !boundary.is_empty() => FenceKind::Boundary,
        _ => FenceKind::default(),
    }
}

impl FenceLine {
    /// The lengths of its legs.
    fn lengths_m(&self) -> impl Iterator<Item = f64> + '_ {
        self.parts.iter().flat_map(|part| part.line.legs()).map(|[from, to]| from.distance(to))
    }

    /// How many pieces stand along it, before any is made.
    fn pieces(&self) -> f64 {
        let along: f64 = self.lengths_m().map(|length_m| f64::from(spans(length_m, self.spacing_m))).sum();
        match self.kind {
            FenceKind::Obstacles => along * f64::from(obstacle::rows(self.width_m, self.spacing_m)),
            // A pylon has as many triangles as twenty posts, and its wires as many again.
            FenceKind::PowerLine => along * 40.0,
            FenceKind::Boundary => along * 2.0,
            _ => along,
        }
    }
}

/// Digs a trench; `false` where the ground's cells are too coarse for it. What is shaped for something else stays.
fn dig(line: &FenceLine, name: &str, lattice: &mut Lattice, collected: &mut SceneBuilder) -> bool {
    if lattice.cell().max_element() * LEAST_CELLS > line.width_m {
        return false;
    }
    let mut volumes = Volumes::default();
    let area_m2 = lattice.cell_m2();
    for part in &line.parts {
        let trench = Trench {
            line: part.line.points().to_vec(),
            bottom_m: line.width_m * BOTTOM,
            top_m: line.width_m,
            depth_m: line.height_m,
        };
        for change in trench.apply(lattice).pieces {
            let changed: Vec<_> = change.changed(lattice).collect();
            for (post, before) in changed {
                let dug = lattice.height(post);
                if lattice.is_pinned(post) {
                    lattice.pin(post, before);
                } else {
                    volumes.cut_m3 += f64::from(before - dug) * area_m2;
                    lattice.pin(post, dug);
                }
            }
        }
    }
    let row = TrenchRow { name: name.to_owned(), length: line.lengths_m().sum(), cut: volumes.cut_m3 };
    collected.report.trenches.push(row);
    true
}

/// Builds the lines on the ground as it is now: boundaries and the floors of trenches as ribbons, the rest upright.
pub fn set(lines: &[FenceLine], ground: DrawnGround<'_>, collected: &mut SceneBuilder) {
    let mut added = 0;
    let extent = ground.lattice.extent();
    for line in lines {
        for part in &line.parts {
            match line.kind {
                FenceKind::Boundary => {
                    collected.lay(dashes(part, line, &extent), RibbonSurface::Boundary, line.feature);
                }
                FenceKind::Trench => {
                    let bare = Alignment::on_ground(part.line.clone(), bare_m(line.width_m));
                    let mut floor = Clipped { plan: PlanMesh::default(), extent: &extent };
                    ribbon(&bare, RibbonSurface::Trench, &mut floor);
                    collected.lay(floor.plan, RibbonSurface::Trench, line.feature);
                }
                _ => {}
            }
            let uprights = uprights(part, line, &ground, &mut added);
            let feature = line.feature;
            collected.uprights.extend(uprights.into_iter().map(|upright| FeatureSolid { upright, feature }));
        }
    }
    if added > 0 {
        let pylons = if added == 1 { "pylon" } else { "pylons" };
        let message = format!("{added} {pylons} added to keep wires off the ground");
        collected.findings.add(FindingCode::PylonsAdded, 0..0, message);
    }
}

/// The uprights along one part of a line; `added` counts the pylons that keep wires off the ground.
fn uprights(
    part: &Alignment,
    line: &FenceLine,
    ground: &dyn TriangleSurface,
    added: &mut usize,
) -> Vec<DrapedSolid> {
    let FenceLine { height_m, width_m, spacing_m, sag, .. } = *line;
    let size = BandSize { height_m, every_m: spacing_m };
    match line.kind {
        FenceKind::Fence => {
            let posts = Posts { stands: stands(&part.line, spacing_m), width_m, height_m };
            let [low, high] = rails(part, height_m);
            vec![DrapedSolid::Posts(posts), DrapedSolid::Band(low), DrapedSolid::Band(high)]
        }
        FenceKind::Wall => vec![DrapedSolid::Band(wall(part, size))],
        FenceKind::Hedge => vec![DrapedSolid::Band(hedge(part, size))],
        FenceKind::PowerLine => {
            let (pylons, more) = clear(&stands(&part.line, spacing_m), height_m, ground);
            *added += more;
            vec![DrapedSolid::PowerLine(PowerLine { pylons, height_m, width_m, sag })]
        }
        FenceKind::Trench => parapets(part, size).map(DrapedSolid::Band).to_vec(),
        FenceKind::Obstacles => {
            let stands = obstacle::belt(part, spacing_m);
            vec![DrapedSolid::Obstacles(Obstacles { stands, height_m })]
        }
        FenceKind::Boundary => Vec::new(),
    }
}

fn ribbon(alignment: &Alignment, surface: RibbonSurface, sink: &mut Clipped<'_>) {
    let options = StrokeOptions::of(surface, alignment.width.widest_m());
    stroke(&StrokePath::alone(alignment), &options, sink);
}

/// A boundary's dashes and dots: in each spacing a dash of a half, and a dot as long as the line is wide.
fn dashes(part: &Alignment, line: &FenceLine, extent: &Rect) -> PlanMesh {
    let mut all = Clipped { plan: PlanMesh::default(), extent };
    let length_m = part.line.length();
    let count = spans(length_m, line.spacing_m);
    let period_m = length_m / f64::from(count);
    let dot_m = line.width_m.min(period_m / 6.0);
    for index in 0..count {
        let start_m = f64::from(index) * period_m;
        let dash = (start_m, start_m + period_m / 2.0);
        let dot = (start_m + period_m * 0.75 - dot_m / 2.0, start_m + period_m * 0.75 + dot_m / 2.0);
        for (from, to) in [dash, dot] {
            if let Some(piece) = part.line.slice(from, to, 0.0) {
                ribbon(&Alignment::on_ground(piece, line.width_m), RibbonSurface::Boundary, &mut all);
            }
        }
    }
    all.plan
}
