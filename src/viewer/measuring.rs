//! Measuring by clicks: a line with its profile, an area, a line of sight, what is seen from a place.

use glam::DVec2;

use sandtable_base::message::numbers::fixed;
use sandtable_query::viewshed::ViewshedSummary;
use sandtable_terrain::profile::ProfileStation;
use sandtable_terrain::sight::line::{Sight, SightEnd};
use sandtable_terrain::sight::viewshed::ViewshedOptions;
use sandtable_walk::measure::MeasurableGround;

/// The height of observers and targets over ground, in meters.
const EYE_M: f64 = 1.7;

/// The kind of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeasureKind {
    /// A line: its length, climbs, profile.
    Line,
    /// The ground in an outline.
    Area,
    /// Whether one place is seen from another.
    Sight,
    /// How much is seen from a place.
    Viewshed,
}

impl MeasureKind {
    /// All of them, as the panel names them.
    pub const ALL: [(&'static str, Self); 4] =
        [("Line", Self::Line), ("Area", Self::Area), ("Sight", Self::Sight), ("Viewshed", Self::Viewshed)];

    fn most_points(self) -> usize {
        match self {
            Self::Line | Self::Area => usize::MAX,
            Self::Sight => 2,
            Self::Viewshed => 1,
        }
    }

    fn least_points(self) -> usize {
        match self {
            Self::Line | Self::Sight => 2,
            Self::Area => 3,
            Self::Viewshed => 1,
        }
    }
}

/// A measurement in progress or done. Places are map coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Measuring {
    /// What is measured.
    pub kind: MeasureKind,
    /// The places clicked at.
    pub points: Vec<DVec2>,
    /// What it came to, a fact a line; empty before there are places enough.
    pub facts: Vec<String>,
    /// The ground along a line.
    pub profile: Vec<ProfileStation>,
    is_done: bool,
}

impl Measuring {
    /// A measurement without places.
    pub fn new(kind: MeasureKind) -> Self {
        Self { kind, points: Vec::new(), facts: Vec::new(), profile: Vec::new(), is_done: false }
    }

    /// Adds a place; starts again after a finished measurement. What it comes to is still to be measured.
    pub fn click(&mut self, at: DVec2) {
        if self.is_done || self.points.len() >= self.kind.most_points() {
            *self = Self::new(self.kind);
        }
        if self.points.last() != Some(&at) {
            self.points.push(at);
        }
        self.is_done = self.points.len() >= self.kind.most_points();
    }

    /// Ends a line or an outline.
    pub fn finish(&mut self) {
        self.is_done = true;
    }

    /// Takes the last place back, and goes on; `false` where there is none. What it comes to is still to be measured.
    pub fn take_back(&mut self) -> bool {
        self.is_done = false;
        self.points.pop().is_some()
    }

    /// Whether there are places enough to measure.
    pub fn has_enough(&self) -> bool {
        self.points.len() >= self.kind.least_points()
    }

    /// Measures: after a click, and after the ground changed.
    pub fn measure(&mut self, ground: &impl MeasurableGround) {
        self.facts.clear();
        self.profile.clear();
        if !self.has_enough() {
            return;
        }
        self.facts = match self.kind {
            MeasureKind::Line => self.line(ground),
            MeasureKind::Area => area(&self.points, ground),
            MeasureKind::Sight => sight(self.points[0], self.points[1], ground),
            MeasureKind::Viewshed => vec!["looking around …".to_owned()],
        };
    }

    fn line(&mut self, ground: &impl MeasurableGround) -> Vec<String> {
        let measured = ground.measure_line(&self.points);
        let summary = measured.summary;
        self.profile = measured.stations;
        let mut facts = vec![
            format!("{} in plan", length_text(summary.length_m)),
            format!("{} over ground", length_text(summary.ground_length_m)),
            format!("up {:.1} m, down {:.1} m", summary.ascent_m, summary.descent_m),
        ];
        if let (Some(lowest), Some(highest)) = (summary.lowest, summary.highest) {
            facts.push(format!(
                "from {} to {} m high",
                fixed(lowest.height_m, 1),
                fixed(highest.height_m, 1)
            ));
        }
        if summary.covered_m < summary.length_m * 0.999 {
            facts.push("a part has no ground".to_owned());
        }
        facts
    }
}

fn area(ring: &[DVec2], ground: &impl MeasurableGround) -> Vec<String> {
    match ground.measure_area(ring) {
        Ok(measured) => {
            let mut facts =
                vec![area_text(measured.plan_m2), format!("{} round it", length_text(measured.perimeter_m))];
            if let Some(heights) = measured.zone.heights {
                let (min, mean, max) = (heights.min_m, heights.mean_m, heights.max_m);
                facts.push(format!(
                    "{} to {} m high, {} m on average",
                    fixed(min, 1),
                    fixed(max, 1),
                    fixed(mean, 1)
                ));
            }
            facts
        }
        Err(error) => vec![error.to_string()],
    }
}

fn sight(from: DVec2, to: DVec2, ground: &impl MeasurableGround) -> Vec<String> {
    let end = |at| SightEnd { at, above_m: EYE_M };
    let distance = length_text(from.distance(to));
    match ground.line_of_sight(end(from), end(to)) {
        Sight::Clear => vec![format!("in sight, {distance} away"), heights_note()],
        Sight::Blocked(blocker) => vec![
            format!("not in sight, {distance} away"),
            format!(
                "ground {} m high hides it, {} away",
                fixed(blocker.height_m, 1),
                length_text(blocker.distance_m)
            ),
            heights_note(),
        ],
        Sight::NoGround(_) => vec!["an end has no ground".to_owned()],
    }
}

fn heights_note() -> String {
    format!("both {EYE_M} m above ground")
}

/// The viewshed from an eye at a place.
pub fn viewshed_from(at: DVec2) -> ViewshedOptions {
    ViewshedOptions::new(SightEnd { at, above_m: EYE_M })
}

/// The figures of a viewshed; `None` for a place without ground.
pub fn seen_facts(seen: Option<&ViewshedSummary>) -> Vec<String> {
    match seen {
        Some(seen) => vec![
            format!("{} are seen", area_text(seen.visible_m2)),
            format!("{:.1} % of the scene, from {EYE_M} m above ground", seen.visible_share * 100.0),
        ],
        None => vec!["there is no ground here".to_owned()],
    }
}

/// A length in meters or kilometers.
pub fn length_text(length_m: f64) -> String {
    if length_m < 10_000.0 { format!("{length_m:.1} m") } else { format!("{:.2} km", length_m / 1e3) }
}

/// An area in square meters, hectares or square kilometers.
pub fn area_text(area_m2: f64) -> String {
    match area_m2 {
        ..1e4 => format!("{area_m2:.0} m²"),
        ..1e6 => format!("{:.2} ha", area_m2 / 1e4),
        _ => format!("{:.3} km²", area_m2 / 1e6),
    }
}

/// A volume in cubic meters, from a million on in millions.
pub fn volume_text(volume_m3: f64) -> String {
    match volume_m3 {
        ..1e6 => format!("{volume_m3:.0} m³"),
        _ => format!("{:.2} million m³", volume_m3 / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_editing::viewing::open_to_view;
    use sandtable_walk::Walk;
    use sandtable_walk::frame::WalkOptions;
    use std::path::Path;
    use std::sync::Arc;

    fn walk() -> Walk {
        let editor = open_to_view(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml")), &[])
            .expect("readable");
        Walk::new(Arc::new(editor.source().build(&|_| ()).expect("sound")), WalkOptions::default())
    }

    #[test]
    fn a_line_and_an_area_are_measured_as_soon_as_they_have_places_enough() {
        let (walk, corner) = (walk(), DVec2::new(749_000.0, 4_017_500.0));
        let mut line = Measuring::new(MeasureKind::Line);
        line.click(corner);
        line.measure(&walk);
        assert!(line.facts.is_empty());
        line.click(corner + DVec2::X * 300.0);
        line.measure(&walk);
        assert_eq!(line.facts[0], "300.0 m in plan");
        assert!(line.profile.len() > 5, "{:?}", line.profile);
        line.click(corner + DVec2::X * 900.0);
        assert!(line.take_back());
        line.measure(&walk);
        assert_eq!(line.facts[0], "300.0 m in plan", "the last place is taken back");
        line.finish();
        line.click(corner);
        line.measure(&walk);
        assert_eq!(line.points.len(), 1, "a new line");
        assert!(line.take_back() && !line.take_back());
        let mut area = Measuring::new(MeasureKind::Area);
        for offset in [DVec2::ZERO, DVec2::X * 200.0, DVec2::new(200.0, 100.0), DVec2::Y * 100.0] {
            area.click(corner + offset);
            area.measure(&walk);
        }
        assert_eq!(area.facts[..2], ["2.00 ha", "600.0 m round it"]);
    }

    #[test]
    fn sight_takes_two_places_and_a_viewshed_one() {
        let (walk, at) = (walk(), DVec2::new(749_000.0, 4_017_500.0));
        let mut sight = Measuring::new(MeasureKind::Sight);
        sight.click(at);
        sight.measure(&walk);
        sight.click(at + 20.0);
        sight.measure(&walk);
        assert!(sight.facts[0].contains("in sight, 28.3 m away"), "{:?}", sight.facts);
        sight.click(at);
        sight.measure(&walk);
        assert_eq!(sight.points.len(), 1);
        let mut viewshed = Measuring::new(MeasureKind::Viewshed);
        viewshed.click(at);
        viewshed.measure(&walk);
        assert_eq!(viewshed.facts, ["looking around …"]);
        let seen = walk.viewshed_task(viewshed_from(viewshed.points[0])).seen().expect("ground");
        viewshed.facts = seen_facts(Some(&seen.summary));
        assert!(viewshed.facts[0].ends_with("are seen"), "{:?}", viewshed.facts);
    }

    #[test]
    fn lengths_and_areas_are_told_in_units_of_their_size() {
        assert_eq!([length_text(12.34), length_text(12_345.0)], ["12.3 m", "12.35 km"].map(str::to_owned));
        assert_eq!(area_text(999.6), "1000 m²");
        assert_eq!(
            [volume_text(12.4), volume_text(13.5e6)],
            ["12 m³", "13.50 million m³"].map(str::to_owned)
        );
        assert_eq!([area_text(25_000.0), area_text(2.5e6)], ["2.50 ha", "2.500 km²"].map(str::to_owned));
    }
}
