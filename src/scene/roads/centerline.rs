//! The document's roads as centerlines, each with what it is to become.

use glam::DVec2;

use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::description::features::RoadTable;
use crate::description::words::{self, Markings};
use crate::draw::list::FeatureId;
use crate::geom::polyline::{Polyline, kept};
use crate::geom::rect::Rect;
use crate::ribbon::stroke::{StrokeOptions, Widths};
use crate::ribbon::texture::{RibbonSurface, texture_length_m};
use crate::scene::FeatureKind;
use crate::scene::attributes::Attributes;
use crate::scene::builder::SceneBuilder;
use crate::scene::near;
use crate::scene::sources::Sources;

/// How far from the ground a centerline may run whose road still reaches it, in meters.
const REACH_M: f64 = 1000.0;

/// What carries a stretch of road.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    /// The ground.
    Ground,
    /// A bridge over it.
    Bridge,
    /// A tunnel under it.
    Tunnel,
}

/// A road, or a stretch of one that is carried by one thing.
#[derive(Clone, Debug)]
pub struct Centerline {
    /// The centerline in world coordinates.
    pub line: Polyline,
    /// The road's elevation in meters at each vertex of `line`, where it has one of its own: on the ground it conforms
    /// to, on a bridge, in a tunnel. `None` where it lies on the ground as it is.
    pub levels_m: Option<Vec<f64>>,
    /// Its carriageway's width and joints; the width is the mean one where it changes along the line.
    pub options: StrokeOptions,
    /// Its carriageway's width in meters at each vertex of `line`, where it changes; `None` where it does not.
    pub widths_m: Option<Vec<f64>>,
    /// How wide the unpaved strip on either side is, in meters; 0 where there is none.
    pub shoulder_m: f64,
    /// What it is paved with.
    pub surface: RibbonSurface,
    /// What carries it.
    pub carried: Support,
    /// What passes over what: roads of different levels do not meet.
    pub level: i32,
    /// The feature it is.
    pub feature: FeatureId,
    /// Which of the document's roads it is from.
    pub table: usize,
    /// What its file says of it.
    pub attributes: Attributes,
}

/// The centerlines of the document's roads that come near the ground.
///
/// # Errors
/// A source cannot be had.
pub fn collect(
    document: &Document,
    sources: &Sources<'_>,
    extent: &Rect,
    collected: &mut SceneBuilder,
) -> Result<Vec<Centerline>, Diagnostic> {
    let mut all = Vec::new();
    for (table, road) in document.roads.iter().enumerate() {
        let lines = sources.lines(&road.source)?;
        let widths_m = lines.first().and_then(|line| widths_m(road, &line.shape));
        let given = (FeatureKind::Road, road.name.as_deref());
        for (attributes, line) in near::lines(lines, (extent, REACH_M), given, collected) {
            let mut centerline = centerline((table, road), attributes, line, collected);
            if let Some(widths_m) = &widths_m {
                centerline.vary(widths_m);
            }
            all.push(centerline);
        }
    }
    Ok(all)
}

impl Centerline {
    /// How wide its carriageway is along its line; the mean width where there are not as many widths as vertices.
    pub fn widths(&self) -> Widths<'_> {
        match &self.widths_m {
            Some(widths_m) if widths_m.len() == self.line.points().len() => Widths::PerVertex(widths_m),
            _ => Widths::Constant(self.options.width_m),
        }
    }

    /// The widths at the vertices of `part`, the part of its line that begins at station `from_m`; `None` where the
    /// width does not change.
    pub fn widths_along(&self, part: &Polyline, from_m: f64) -> Option<Vec<f64>> {
        let widths_m = self.widths_m.as_ref()?;
        let stations = self.line.stations();
        let width_m = |station: f64| {
            let after = stations.partition_point(|&reached| reached < station).clamp(1, stations.len() - 1);
            let way = (station - stations[after - 1]) / (stations[after] - stations[after - 1]);
            widths_m[after - 1] + (widths_m[after] - widths_m[after - 1]) * way.clamp(0.0, 1.0)
        };
        Some(part.stations().iter().map(|&station| width_m(from_m + station)).collect())
    }

    /// Gives it a width at each vertex.
    fn vary(&mut self, widths_m: &[f64]) {
        self.options.width_m = widths_m.iter().sum::<f64>() / widths_m.len() as f64;
        self.options.texture_length_m = texture_length_m(self.surface, self.options.width_m);
        self.widths_m = Some(widths_m.to_vec());
    }
}

/// One road line with all that its table says of it.
fn centerline(
    (table, road): (usize, &RoadTable),
    attributes: Attributes,
    line: Polyline,
    collected: &mut SceneBuilder,
) -> Centerline {
    let surface = surface(road, &attributes);
    let width_m = attributes.number(&road.width, &mut collected.default_counts);
    let shoulder_m = attributes.number(&road.shoulder, &mut collected.default_counts);
    let options = StrokeOptions {
        width_m,
        join: road.join,
        miter_limit: road.miter_limit,
        texture_length_m: texture_length_m(surface, width_m),
    };
    let carried = carried(road, &attributes);
    Centerline {
        line,
        levels_m: None,
        options,
        widths_m: None,
        shoulder_m,
        surface,
        carried,
        level: level(road, &attributes, carried),
        feature: collected.add(FeatureKind::Road, attributes.name(road.name.as_deref())),
        table,
        attributes,
    }
}

/// The widths stated for the points of an inline line, at the vertices that are left of it.
fn widths_m(road: &RoadTable, shape: &[DVec2]) -> Option<Vec<f64>> {
    let stated = road.widths.as_ref()?;
    let widths_m: Option<Vec<f64>> =
        kept(shape, near::MERGE_M).into_iter().map(|index| stated.get(index).copied()).collect();
    widths_m.filter(|widths_m| widths_m.len() >= 2)
}

/// What it is paved with and what is painted on it.
fn surface(road: &RoadTable, attributes: &Attributes) -> RibbonSurface {
    match attributes.value_or_default(&road.surface) {
        words::RoadSurface::Gravel => RibbonSurface::Gravel,
        words::RoadSurface::Track => RibbonSurface::Track,
        words::RoadSurface::Asphalt => match attributes.value_or_default(&road.markings) {
            Markings::Dashed => RibbonSurface::Asphalt,
            Markings::Solid => RibbonSurface::AsphaltSolid,
            Markings::Edges => RibbonSurface::AsphaltEdges,
            Markings::None => RibbonSurface::AsphaltPlain,
        },
    }
}

/// What carries a road, by the expressions stated for it, else by its properties as OpenStreetMap has them.
pub(in crate::scene) fn carried(road: &RoadTable, attributes: &Attributes) -> Support {
    let holds = |stated: &Option<_>, property| match stated {
        Some(expression) => attributes.holds(expression),
        None => attributes.affirm(property),
    };
    match (holds(&road.tunnel, "tunnel"), holds(&road.bridge, "bridge")) {
        (true, _) => Support::Tunnel,
        (false, true) => Support::Bridge,
        (false, false) => Support::Ground,
    }
}

fn level(road: &RoadTable, attributes: &Attributes, carried: Support) -> i32 {
    let tagged = || attributes.get("layer").and_then(|layer| layer.number());
    let by_kind = match carried {
        Support::Ground => 0.0,
        Support::Bridge => 1.0,
        Support::Tunnel => -1.0,
    };
    let level = attributes.value(road.level.as_ref()).or_else(tagged).unwrap_or(by_kind);
    level.round().clamp(-20.0, 20.0) as i32
}

#[cfg(test)]
pub(in crate::scene::roads) mod tests {
    use super::*;
    use crate::description::parse::parse;

    /// A road along these points, six meters wide, from the document's first table.
    pub fn road(points: &[(f64, f64)], carried: Support, level: i32) -> Centerline {
        let line = Polyline::new(points.iter().map(|&(x, y)| DVec2::new(x, y)), 0.0).expect("a line");
        Centerline {
            line,
            levels_m: None,
            options: StrokeOptions::default(),
            widths_m: None,
            shoulder_m: 0.0,
            surface: RibbonSurface::Asphalt,
            carried,
            level,
            feature: FeatureId(2),
            table: 0,
            attributes: Attributes::default(),
        }
    }

    fn line(points: &[(f64, f64)]) -> Polyline {
        Polyline::new(points.iter().map(|&(x, y)| DVec2::new(x, y)), 0.0).expect("a line")
    }

    /// The road of a scene file with these keys.
    fn table(keys: &str) -> RoadTable {
        let text = format!("[terrain]\ndem = \"a\"\n[[road]]\n{keys}\n");
        parse("road.toml", &text).expect("a valid scene").roads.remove(0)
    }

    #[test]
    fn a_part_of_a_road_is_as_wide_as_the_road_there() {
        let mut road = centerline(
            (0, &table("points = [[0, 0], [1, 1]]")),
            Attributes::default(),
            line(&[(0.0, 0.0), (10.0, 0.0), (30.0, 0.0)]),
            &mut SceneBuilder::default(),
        );
        let part = line(&[(5.0, 0.0), (10.0, 0.0), (20.0, 0.0)]);
        assert_eq!(road.widths_along(&part, 5.0), None);
        road.vary(&[4.0, 8.0, 4.0]);
        assert_eq!(road.widths_along(&part, 5.0), Some(vec![6.0, 8.0, 6.0]));
    }

    #[test]
    fn widths_stay_with_their_points_where_points_are_merged() {
        let road = table("points = [[0, 0], [0.001, 0], [9, 0]]\nwidths = [3, 4, 5]");
        let shape = [DVec2::ZERO, DVec2::X * 0.001, DVec2::X * 9.0];
        assert_eq!(widths_m(&road, &shape), Some(vec![3.0, 5.0]));
    }
}
