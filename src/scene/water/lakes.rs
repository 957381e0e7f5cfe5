//! Lakes: level water, the ground under it leveled and the shore blended.

use glam::DVec2;

use crate::attributes::{Attributes, count_default};
use crate::builder::SceneBuilder;
use crate::feature::{FeatureKind, described};
use crate::feature_origin::FeatureOrigin;
use crate::near::Clipped;
use crate::report::LakeRow;
use crate::sources::{Sourced, Sources};
use crate::symbols::LineSymbol;
use crate::water::lake_level::{FAR_OFF_HELP, LakeSurface, far_off_m, far_off_message};
use sandtable_base::limits::GROUND_POSTS;
use sandtable_base::message::choice::Choice;
use sandtable_base::message::numbers::fixed;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::features::LakeTable;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::words::LevelRule;
use sandtable_draw::list::FeatureId;
use sandtable_earthworks::shore::{self, Flooded, LakeBasin};
use sandtable_geom::polygon;
use sandtable_ribbon::area;
use sandtable_ribbon::plan::PlanMesh;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_terrain::densify;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_vector::feature::Polygon;

/// Meters in one repeat of the water's texture: fine enough not to be seen as a pattern.
const LAKE_TEXTURE_M: f64 = 400.0;

/// Adds the document's lakes to `collected` and levels the ground under them. Lakes off the ground and those
/// without an area are left out, with a note. Every level is measured before any ground is moved.
///
/// The lattice may get more posts; its origin, its extent and all heights beside the shores stay as they are.
///
/// # Errors
/// A source cannot be had, or a level cannot be found.
pub fn lay(
    document: &Document,
    sources: &Sources<'_>,
    lattice: &mut Lattice,
    collected: &mut SceneBuilder,
) -> Result<(), Diagnostic> {
    let lakes = measure(document, sources, lattice, collected)?;
    make_denser(lattice, &lakes, collected);
    let basins: Vec<LakeBasin<'_>> = lakes.iter().map(Lake::basin).collect();
    let flooded = shore::flood(lattice, &basins);
    for (lake, flooded) in lakes.into_iter().zip(flooded) {
        let feature = lake.report(&flooded, lattice, collected);
        let outlines = std::iter::once(&lake.shape.exterior).chain(&lake.shape.holes);
        collected.symbols.extend(outlines.filter_map(|outline| LineSymbol::of_shore(outline, feature)));
        collected.lay(lake.plan, RibbonSurface::Lake, feature);
    }
    Ok(())
}

/// The document's lakes with their levels, in the order of its tables.
fn measure(
    document: &Document,
    sources: &Sources<'_>,
    lattice: &Lattice,
    collected: &mut SceneBuilder,
) -> Result<Vec<Lake>, Diagnostic> {
    let (mut lakes, extent) = (Vec::new(), lattice.extent());
    for table in &document.lakes {
        for Sourced { attributes, shape, .. } in sources.polygons(&table.source)? {
            let name = attributes.name(table.name.as_deref());
            let bounds = polygon::bounds(&shape.exterior);
            if !bounds.meets(&extent) {
                let message = format!("{} lies off the elevation model", described("lake", &name));
                collected.findings.add(FindingCode::LeftOut, table.source.span(), message);
                continue;
            }
            let mut plan = Clipped { plan: PlanMesh::default(), extent: &extent };
            area::fill(&shape.exterior, &shape.holes, LAKE_TEXTURE_M, &mut plan);
            if plan.plan.triangles.is_empty() {
                let message = format!("lake '{name}' left out: its shore encloses no area");
                collected.findings.add(FindingCode::EmptyShape, table.source.span(), message);
                continue;
            }
            let shore = Shore::of(lattice, &shape);
            let level = level_of(document, table, &attributes, &shore, collected)?;
            let origin = attributes.origin(&table.source);
            lakes.push(Lake { name, origin, plan: plan.plan, shape, shore, level });
        }
    }
    Ok(lakes)
}

/// A lake that no ground is moved for yet.
struct Lake {
    name: String,
    origin: FeatureOrigin,
    shape: Polygon,
    plan: PlanMesh,
    shore: Shore,
    level: LakeLevel,
}

/// The rule of a level that the scene states.
const GIVEN: &str = "given";

/// A lake's level with the rule it was found by.
struct LakeLevel {
    level_m: f64,
    rule: &'static str,
}

impl Lake {
    fn reach_m(&self) -> f64 {
        shore::reach_m(area_m2(&self.shape))
    }

    fn basin(&self) -> LakeBasin<'_> {
        LakeBasin {
            exterior: &self.shape.exterior,
            holes: &self.shape.holes,
            level_m: self.level.level_m as f32,
            reach_m: self.reach_m(),
        }
    }

    /// Reports what the lake took and returns its feature.
    fn report(&self, flooded: &Flooded, lattice: &Lattice, collected: &mut SceneBuilder) -> FeatureId {
        let (level_m, volumes) = (self.level.level_m, flooded.volumes);
        let span = self.origin.span.clone();
        let message = format!(
            "{} lies level at {} m: {} m³ cut, {} m³ filled",
            described("lake", &self.name),
            fixed(level_m, 1),
            fixed(volumes.cut_m3, 0),
            fixed(volumes.fill_m3, 0)
        );
        collected.findings.add(FindingCode::LakeLevel, span.clone(), message);
        if let (Some(lowest_m), Some(highest_m)) = (self.shore.lowest_m(), self.shore.highest_m())
            && let Some(off_m) = far_off_m(level_m, [lowest_m, highest_m])
        {
            let lake = described("lake", &self.name);
            let message = far_off_message(&lake, level_m, [lowest_m, highest_m], off_m);
            collected.findings.add_with_help(
                FindingCode::LakeLevelWrong,
                span.clone(),
                message,
                FAR_OFF_HELP,
            );
        }
        if let Some(lower_m) = flooded.lower_level_m {
            let message = format!(
                "{} shares cells with a lake at {} m, and the lower level holds there",
                described("lake", &self.name),
                fixed(lower_m, 1)
            );
            collected.findings.add(FindingCode::LakesShareCells, span.clone(), message);
        }
        // A part of a meter is less than the note tells.
        if shore::bed_reach_m(lattice).round() > self.reach_m().round() {
            let mut message = format!(
                "{} lies on posts {:.3} m apart, and the ground is level up to {:.0} m from its shore; a model of a \
                 smaller area could have more posts",
                described("lake", &self.name),
                lattice.cell().max_element(),
                shore::bed_reach_m(lattice)
            );
            if densify::doublings_for(lattice, shore::spacing_m(self.reach_m())) > 0 {
                message.push_str(&format!(", or {GROUND_POSTS:#}"));
            }
            collected.findings.add(FindingCode::TooFine, span, message);
        }
        collected.report.lakes.push(LakeRow {
            name: self.name.clone(),
            level: level_m,
            rule: self.level.rule,
            lowest_shore: self.shore.lowest_m(),
            median_shore: self.shore.median_m(),
            highest_shore: self.shore.highest_m(),
            area: area_m2(&self.shape),
            cut: volumes.cut_m3,
            fill: volumes.fill_m3,
        });
        collected.lakes.push(LakeSurface {
            outline: self.shape.exterior.clone(),
            level_m,
            is_stated: self.level.rule == GIVEN,
        });
        collected.add(FeatureKind::Lake, self.name.clone(), self.origin.clone())
    }
}

/// Puts more posts between those there are, where a lake is small for the cells.
fn make_denser(lattice: &mut Lattice, lakes: &[Lake], collected: &mut SceneBuilder) {
    let reach_m = lakes.iter().map(Lake::reach_m).fold(f64::INFINITY, f64::min);
    if densify::bring_to(lattice, shore::spacing_m(reach_m)) > 0 {
        let spacing_m = lattice.cell().max_element();
        let message =
            format!("posts every {spacing_m:.3} m were put in for lakes; the ground stays as it was");
        collected.findings.add(FindingCode::PostsAdded, 0..0, message);
    }
}

/// The stated level, or that of the rule.
fn level_of(
    document: &Document,
    lake: &LakeTable,
    attributes: &Attributes,
    shore: &Shore,
    collected: &mut SceneBuilder,
) -> Result<LakeLevel, Diagnostic> {
    if let Some(level_m) = attributes.value(lake.level.as_ref()) {
        return Ok(LakeLevel { level_m, rule: GIVEN });
    }
    let rule = lake.level_rule;
    count_default(lake.level.as_ref(), "the lowest height along the shore", &mut collected.default_counts);
    shore.level_m(rule).map(|level_m| LakeLevel { level_m, rule: rule.word() }).ok_or_else(|| {
        let message = "no ground lies along this lake's shore to take its level from";
        document.error_at(lake.source.span(), message).with_help("state it: level = <meters>")
    })
}

struct Shore {
    /// Heights in meters, rising, each with the meters of shore that it represents.
    heights: Vec<(f64, f64)>,
}

impl Shore {
    /// The ground along the part of the shore that lies on the model, at every vertex and twice a cell.
    fn of(lattice: &Lattice, shape: &Polygon) -> Self {
        let step = lattice.cell().min_element() / 2.0;
        let extent = lattice.extent();
        let edges = polygon::edges(&shape.exterior).filter_map(|(from, to)| extent.clip_line(from, to));
        let samples = edges.flat_map(|(from, to)| {
            let length_m = from.distance(to);
            let count = (length_m / step).ceil().clamp(1.0, 1e6) as u32;
            (0..count).map(move |index| {
                (from.lerp(to, f64::from(index) / f64::from(count)), length_m / f64::from(count))
            })
        });
        let height = |(at, stands_for_m): (DVec2, f64)| {
            let answer = ground_height(lattice, Interpolation::Bilinear, at + lattice.origin());
            answer.height_m().map(|height_m| (height_m, stands_for_m))
        };
        let mut heights: Vec<(f64, f64)> = samples.filter_map(height).collect();
        heights.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self { heights }
    }

    /// `None` where no ground lies along the shore; so for all.
    fn lowest_m(&self) -> Option<f64> {
        self.heights.first().map(|first| first.0)
    }

    fn highest_m(&self) -> Option<f64> {
        self.heights.last().map(|last| last.0)
    }

    /// The height with as much shore below as above.
    fn median_m(&self) -> Option<f64> {
        let half: f64 = self.heights.iter().map(|height| height.1).sum::<f64>() / 2.0;
        let mut passed = 0.0;
        let middle = self.heights.iter().find(|height| {
            passed += height.1;
            passed >= half
        });
        middle.or(self.heights.last()).map(|height| height.0)
    }

    fn mean_m(&self) -> Option<f64> {
        let (sum, length) =
            self.heights.iter().fold((0.0, 0.0), |(sum, length), at| (sum + at.0 * at.1, length + at.1));
        if length > 0.0 { Some(sum / length) } else { self.lowest_m() }
    }

    fn level_m(&self, rule: LevelRule) -> Option<f64> {
        match rule {
            LevelRule::Lowest => self.lowest_m(),
            LevelRule::Median => self.median_m(),
            LevelRule::Mean => self.mean_m(),
        }
    }
}

/// The water's area in square meters, islands taken out, on the model or off.
fn area_m2(shape: &Polygon) -> f64 {
    let area = |ring: &[DVec2]| polygon::doubled_area(ring).abs() / 2.0;
    area(&shape.exterior) - shape.holes.iter().map(|hole| area(hole)).sum::<f64>()
}
