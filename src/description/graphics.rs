//! The scene file's tables of tactical graphics and of sight.

use crate::bounds::Bounds::{self, Above, Within};
use crate::declaration::{KeyDeclaration, Presence};
use crate::feature_source::FeatureSource;
use crate::key;
use crate::reader::TableReader;
use crate::stated::Stated;
use crate::table::Table;
use crate::table_key;
use crate::words::{GraphicOrder, GraphicSide, GraphicStatus, RangeExtent, ViewshedTint};
use sandtable_geom::crs::Crs;
use sandtable_geom::position::Position;

/// Distances from a place.
const REACH: Bounds = Above(0.0, 1e7);
/// Heights of eyes and targets above the ground.
const ABOVE: Bounds = Within(0.0, 1e5);

table! {
    /// `[[graphic]]`: a tactical graphic.
    struct GraphicTable {
        /// Name for messages and the feature list.
        name: Option<String> = key::text(), otherwise "the property `name`";
        /// What it is: one of the words of `scenes/SYMBOLS.md`, such as `phase_line`, or six digits of symbol
        /// set 25, or eight that begin with the set.
        kind: Option<Stated<String>> = key::filled_text(), otherwise "by `sidc`; with `file` the property `kind`";
        /// Symbol identification code of symbol set 25, 45 or 46, 20 or 30 digits: its kind, side, status and echelon.
        sidc: Option<Stated<String>> = key::filled_text(), otherwise "by `kind`; with `file` the property `sidc`";
        /// Its points, in the order of its draw rule (`scenes/SYMBOLS.md` says what each is); of a file's feature those of its
        /// shape.
        source: FeatureSource = table_key::source::<1>(), inline;
        /// Width of a corridor, a lane or a rectangle; of an axis of advance the width of its head, instead of a last point, and
        /// its points lead from its start to its tip.
        width: Option<f64> = key::number(Above(0.0, 1e6), "m"), otherwise "by its points; with `file` the property `width`";
        /// Of axes and arrows: whether their points lead from the tip or to it.
        order: Option<GraphicOrder> = key::word::<GraphicOrder>(), otherwise "`drawn` for an axis with `width`, else `standard`";
        /// Whose it is; decides its color.
        side: Option<GraphicSide> = key::word::<GraphicSide>(), otherwise "by `sidc`, else `friend`";
        /// Whether it is there or planned; decides its dashes.
        status: Option<GraphicStatus> = key::word::<GraphicStatus>(), otherwise "by `sidc`, else `present`";
        /// Field T: its name or number.
        designation: Option<String> = key::text(), otherwise "with `file` the property `designation` or `unique_designation`";
        /// Field T1: a second name, such as that of the unit on the right of a boundary.
        designation_2: Option<String> = key::text(), otherwise "with `file` the property `designation_2`";
        /// Field B: a word such as `brigade`, or a mark such as `X`.
        echelon: Option<String> = key::text(), otherwise "by `sidc`; with `file` the property `echelon`";
        /// Field AS: the country of a boundary's units.
        country: Option<String> = key::text(), otherwise "with `file` the property `country`";
        /// Field N: the mark of the enemy, `ENY`.
        hostile: Option<String> = key::text(), otherwise "`ENY` on areas of the hostile side; with `file` the property `hostile`";
        /// Field H: further text.
        further: Option<String> = key::text(), otherwise "with `file` the property `further`";
        /// Field V: type of equipment, such as the vehicles of a convoy.
        equipment as "type": Option<String> = key::text(), otherwise "with `file` the property `type`";
        /// Field C: how many, or how strong an event was.
        quantity: Option<String> = key::text(), otherwise "with `file` the property `quantity`";
        /// Field Y: where it is, in words.
        location: Option<String> = key::text(), otherwise "with `file` the property `location`";
        /// Field Q: the direction in which an event moves, as an arrow.
        direction: Option<f64> = key::number(Bounds::DIRECTION, "°"), otherwise "no arrow; with `file` the property `direction`";
        /// Field AP: number of a target.
        target: Option<String> = key::text(), otherwise "with `file` the property `target`";
        /// Field W: the time from which it holds.
        from: Option<String> = key::text(), otherwise "with `file` the property `from`";
        /// Field W1: the time until which it holds.
        until: Option<String> = key::text(), otherwise "with `file` the property `until`";
        /// Field X of airspace: lowest and highest elevation; a corridor is an upright ribbon between them.
        elevations: Option<[f64; 2]> = key::number_range(Bounds::ELEVATION, "m"), otherwise "on the ground";
        /// Field AM: radius of a circle, the rising ranges of a fan, or the half axes of an ellipse, and length and width of a
        /// rectangle, the one along its azimuth first.
        distances: Option<Stated<Vec<f64>>> = key::numbers(REACH, "m"), otherwise "none; with `file` the property `distances`";
        /// Field AN: of a sector, the left and the right azimuth of each range; of an ellipse or rectangle that of its first
        /// distance.
        azimuths: Option<Stated<Vec<f64>>> = key::numbers(Bounds::DIRECTION, "°"), otherwise "none; with `file` the property `azimuths`";
    }
    check(reader) {
        reader.exclude("sidc", "kind");
        if reader.key_span("file").is_none() {
            reader.need_either("kind", "sidc", "add `kind = \"phase_line\"` or another word of scenes/SYMBOLS.md");
        }
    }

    /// `[[viewshed]]`: what observers see, as a tint of the ground.
    struct ViewshedTable {
        /// Name for the legend.
        name: Option<String> = key::text(), otherwise "none";
        /// Where the observers are; ground is in sight where one of them sees it.
        observers: Stated<Vec<Stated<Position>>> = key::places(1), required;
        /// Coordinate system of `observers`.
        crs: Option<Crs> = key::crs(), otherwise "the scene's `points_crs`";
        /// Height of their eyes above the ground.
        observer_height: f64 = key::number(ABOVE, "m"), default 2;
        /// Height above the ground of what is looked for.
        target_height: f64 = key::number(ABOVE, "m"), default 0;
        /// How far they look. All samples of the elevation model within it are read, however large the model is.
        range: Option<f64> = key::number(REACH, "m"), otherwise "as far as the ground reaches";
        /// Directions in which they look, from the first clockwise to the second.
        azimuths: Option<[f64; 2]> = key::directions(Bounds::DIRECTION, "°"), otherwise "all around";
        /// Which ground is tinted.
        tint: ViewshedTint = key::word::<ViewshedTint>(), default "both";
    }

    /// `[[sight]]`: lines of sight from an observer, in green as far as the ground is seen and in red where it is hidden.
    struct SightTable {
        /// Name for the legend.
        name: Option<String> = key::text(), otherwise "none";
        /// Where the observer is.
        observer: Stated<Position> = key::point(), required;
        /// Where the lines lead.
        targets: Stated<Vec<Stated<Position>>> = key::places(1), required;
        /// Coordinate system of `observer` and `targets`.
        crs: Option<Crs> = key::crs(), otherwise "the scene's `points_crs`";
        /// Height of the observer's eyes above the ground.
        observer_height: f64 = key::number(ABOVE, "m"), default 2;
        /// Height above the ground of what is looked for at each target; decides the ring around it.
        target_height: f64 = key::number(ABOVE, "m"), default 0;
    }

    /// `[[range]]`: rings, sectors and fans of a weapon, a sensor or an observer.
    struct RangeTable {
        /// Name on the picture and in the legend.
        name: Option<String> = key::text(), otherwise "none";
        /// Where it is.
        at: Stated<Position> = key::point(), required;
        /// Coordinate system of `at`.
        crs: Option<Crs> = key::crs(), otherwise "the scene's `points_crs`";
        /// Rising distances, each with a ring.
        distances: Stated<Vec<f64>> = key::numbers(REACH, "m"), required;
        /// The sector, from the first azimuth clockwise to the second.
        azimuths: Option<[f64; 2]> = key::directions(Bounds::DIRECTION, "°"), otherwise "all around";
        /// Whose it is; decides its color.
        side: GraphicSide = key::word::<GraphicSide>(), default "friend";
        /// Whether the ground within it is filled, all of it or what is in sight.
        fill: RangeExtent = key::word::<RangeExtent>(), default "none";
        /// With `fill = "seen"`: height of the eyes, the barrel or the antenna above the ground.
        height: f64 = key::number(ABOVE, "m"), default 2;
        /// With `fill = "seen"`: height above the ground of what is looked for.
        target_height: f64 = key::number(ABOVE, "m"), default 0;
    }
}
