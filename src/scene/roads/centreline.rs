//! The document's roads as centrelines, each with what it is to become.

use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::description::features::{Road, Scalar};
use crate::description::words;
use crate::draw::list::FeatureId;
use crate::geom::polyline::Polyline;
use crate::geom::rect::Rect;
use crate::ribbon::stroke::StrokeOptions;
use crate::ribbon::texture::{Surface, texture_length_m};
use crate::scene::attributes::Attributes;
use crate::scene::collected::Collected;
use crate::scene::kind::FeatureKind;
use crate::scene::near;
use crate::scene::sources::Sources;

/// How far from the ground a centreline may run whose road still reaches it, in metres.
const REACH_M: f64 = 1000.0;

/// What carries a stretch of road.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carried {
    /// The ground.
    Ground,
    /// A bridge over it.
    Bridge,
    /// A tunnel under it.
    Tunnel,
}

/// A road, or a stretch of one that is carried by one thing.
#[derive(Clone, Debug)]
pub struct Centreline {
    /// The centreline in world coordinates.
    pub line: Polyline,
    /// The road's elevation in metres at each vertex of `line`, where it has one of its own: on the ground it conforms
    /// to, on a bridge, in a tunnel. `None` where it lies on the ground as it is.
    pub levels_m: Option<Vec<f64>>,
    /// Its carriageway's width and joints.
    pub options: StrokeOptions,
    /// What it is paved with.
    pub surface: Surface,
    /// What carries it.
    pub carried: Carried,
    /// What passes over what: roads of different levels do not meet.
    pub level: i32,
    /// The feature it is.
    pub feature: FeatureId,
    /// Which of the document's roads it is from.
    pub table: usize,
    /// What its file says of it.
    pub attributes: Attributes,
}

/// The centrelines of the document's roads that come near the ground.
///
/// # Errors
/// A source cannot be had.
pub fn collect(
    document: &Document,
    sources: &Sources<'_>,
    extent: &Rect,
    collected: &mut Collected,
) -> Result<Vec<Centreline>, Diagnostic> {
    let mut all = Vec::new();
    for (table, road) in document.roads.iter().enumerate() {
        let lines = sources.lines(&road.source)?;
        let given = road.name.as_deref();
        for (attributes, line) in near::lines(lines, (extent, REACH_M), (FeatureKind::Road, given), collected)
        {
            let surface = match attributes.word(road.surface.as_ref()).unwrap_or_default() {
                words::Surface::Asphalt => Surface::Asphalt,
                words::Surface::Gravel => Surface::Gravel,
                words::Surface::Track => Surface::Track,
            };
            let stated = ("[[road]] width", road.width.as_ref());
            let width_m = attributes.number_or(stated, 6.0, &mut collected.defaulted);
            let options = StrokeOptions {
                width_m,
                texture_length_m: texture_length_m(surface, width_m),
                ..StrokeOptions::default()
            };
            let carried = carried(road, &attributes);
            let level = level(road, &attributes, carried);
            let feature = collected.add(FeatureKind::Road, attributes.name(given));
            all.push(Centreline {
                line,
                levels_m: None,
                options,
                surface,
                carried,
                level,
                feature,
                table,
                attributes,
            });
        }
    }
    Ok(all)
}

/// What carries a road, by the expressions stated for it, else by its properties as OpenStreetMap has them.
pub(in crate::scene) fn carried(road: &Road, attributes: &Attributes) -> Carried {
    let tagged = |property: &str| match attributes.get(property) {
        None => false,
        Some(Scalar::Bool(value)) => value,
        Some(Scalar::Number(value)) => value != 0.0,
        Some(Scalar::Text(text)) => !matches!(text.as_str(), "" | "no" | "false" | "0"),
    };
    let holds = |stated: &Option<toml::Spanned<_>>, property| match stated {
        Some(expression) => attributes.holds(expression.get_ref()),
        None => tagged(property),
    };
    match (holds(&road.tunnel, "tunnel"), holds(&road.bridge, "bridge")) {
        (true, _) => Carried::Tunnel,
        (false, true) => Carried::Bridge,
        (false, false) => Carried::Ground,
    }
}

fn level(road: &Road, attributes: &Attributes, carried: Carried) -> i32 {
    let tagged = || attributes.get("layer").as_ref().and_then(crate::description::expression::as_number);
    let by_kind = match carried {
        Carried::Ground => 0.0,
        Carried::Bridge => 1.0,
        Carried::Tunnel => -1.0,
    };
    let level = attributes.number(road.level.as_ref()).or_else(tagged).unwrap_or(by_kind);
    level.round().clamp(-20.0, 20.0) as i32
}
