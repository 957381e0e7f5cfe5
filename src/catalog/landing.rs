//! Kinds about landing and sites.

use crate::kind::{AnalysisFamily, AnalysisKind, AnalysisReach, AnalysisYield, LandPart};
use crate::parameter::{
    AnalysisParameter,
    ParameterDefault::{Otherwise, Value},
    ParameterForm,
};

/// The kinds.
pub(crate) const KINDS: &[AnalysisKind] = &[LANDING_ZONES, DROP_ZONES, SITES];

const LANDING_ZONES: AnalysisKind = AnalysisKind {
    name: "landing-zones",
    family: AnalysisFamily::Landing,
    title: "Helicopter landing zones",
    summary: "Where a helicopter can land: 0 unsuited, 1 with caution, 2 suited, with the best sites.",
    parameters: &[
        AnalysisParameter::word(
            "size",
            &["1", "2", "3", "4", "5", "6", "7"],
            "3",
            "The size of the touchdown point: 25, 35, 50, 80, 100, 125 or 150 m across.",
        ),
        AnalysisParameter::number(
            "free_slope",
            (0.0, 45.0),
            "°",
            Value("7"),
            "The greatest slope without caution.",
        ),
        AnalysisParameter::number(
            "greatest_slope",
            (0.0, 45.0),
            "°",
            Value("15"),
            "The greatest slope at all.",
        ),
        AnalysisParameter::number(
            "obstacle_ratio",
            (1.0, 100.0),
            "",
            Value("10"),
            "How many meters from the disk an approach or departure needs for each meter of an obstacle's height.",
        ),
        AnalysisParameter::number(
            "approach_m",
            (0.0, 10000.0),
            "m",
            Value("500"),
            "How far from the disk approach and departure must be clear.",
        ),
        AnalysisParameter::number("count", (0.0, 100.0), "", Value("3"), "The greatest number of sites."),
        AnalysisParameter::number(
            "separation_m",
            (0.0, 100_000.0),
            "m",
            Value("50"),
            "The least distance between the edges of two sites.",
        ),
    ],
    yields: AnalysisYield::Both,
    reach: AnalysisReach::Whole,
    layers: &[LandPart::Cover, LandPart::Water, LandPart::Obstacles],
    source: "FM 3-21.38, chapter 4",
    limits: &[
        "Approach and departure are opposite, straight, and in the directions of the eight neighbors of a post alone.",
        "Ground beyond the land and without data counts as clear of obstacles on approach and departure.",
        "Forests in which a scene places no trees count as 15 m high, orchards as 4 m.",
        "The table's points count disks beside each other on suited ground, each with a clear way of its own; up to 20 are counted. \
         Wind may turn the way in into the way out.",
        "Wires and obstacles between posts are unknown, as are wind, dust and the bearing strength of soil.",
    ],
};

const DROP_ZONES: AnalysisKind = AnalysisKind {
    name: "drop-zones",
    family: AnalysisFamily::Landing,
    title: "Drop zones",
    summary: "Where parachutists can be dropped: 0 unsuited, 1 with caution, 2 suited as the center of a zone of the length that they need.",
    parameters: &[
        AnalysisParameter::number(
            "jumpers",
            (1.0, 1000.0),
            "",
            Value("12"),
            "The jumpers of one pass, from whom the length follows where it is not stated.",
        ),
        AnalysisParameter::number(
            "speed_kn",
            (10.0, 300.0),
            "kn",
            Value("130"),
            "The aircraft's speed over the ground.",
        ),
        AnalysisParameter::number(
            "interval_s",
            (0.1, 60.0),
            "s",
            Value("1"),
            "Seconds from one jumper to the next.",
        ),
        AnalysisParameter::number(
            "buffer_m",
            (0.0, 5000.0),
            "m",
            Value("100"),
            "The ground left free at each end.",
        ),
        AnalysisParameter::number(
            "length_m",
            (10.0, 50_000.0),
            "m",
            Otherwise("that of the jumpers, at least 275"),
            "The length along the heading.",
        ),
        AnalysisParameter::number("width_m", (10.0, 50_000.0), "m", Value("275"), "The width across it."),
        AnalysisParameter::number(
            "heading",
            (0.0, 360.0),
            "°",
            Otherwise("the best of every ten degrees"),
            "The heading of the aircraft, clockwise from north.",
        ),
        AnalysisParameter::number(
            "free_slope",
            (0.0, 45.0),
            "°",
            Value("6"),
            "The greatest slope without caution.",
        ),
        AnalysisParameter::number(
            "greatest_slope",
            (0.0, 45.0),
            "°",
            Value("17"),
            "The greatest slope at all.",
        ),
        AnalysisParameter::number("count", (0.0, 100.0), "", Value("3"), "The greatest number of zones."),
        AnalysisParameter::number(
            "separation_m",
            (0.0, 100_000.0),
            "m",
            Value("100"),
            "The least distance between two zones along their length.",
        ),
    ],
    yields: AnalysisYield::Both,
    reach: AnalysisReach::Whole,
    layers: &[LandPart::Cover, LandPart::Water, LandPart::Woods, LandPart::Obstacles],
    source: "D = R · T with 200 m of buffers and at least 275 m, after FM 3-21.38 and TC 3-21.220 for drops that the ground \
             releases; all numbers are defaults, which the unit's own rules overrule",
    limits: &[
        "Slopes, covers and widths are this program's defaults, not a manual's; sizes for drops that the aircraft computes and \
         for loads differ.",
        "Wind, its drift and the scatter of jumpers are unknown, as are wires and obstacles between posts.",
        "Water, woods and masts beside a zone count nothing, nor does the way of the aircraft to it.",
    ],
};

const SITES: AnalysisKind = AnalysisKind {
    name: "sites",
    family: AnalysisFamily::Landing,
    title: "Sites for camps and gun positions",
    summary: "Where a camp or a gun position can be: 0 unsuited, 1 with caution, 2 suited, with the best sites and their table.",
    parameters: &[
        AnalysisParameter::number("size_m", (1.0, 5000.0), "m", Value("60"), "How far across a site is."),
        AnalysisParameter::number(
            "free_slope",
            (0.0, 45.0),
            "°",
            Value("3"),
            "The greatest slope without caution.",
        ),
        AnalysisParameter::number(
            "greatest_slope",
            (0.0, 45.0),
            "°",
            Value("7"),
            "The greatest slope at all.",
        ),
        AnalysisParameter::plain(
            "area",
            ParameterForm::Area,
            Otherwise("the whole land"),
            "The area in which centers of sites lie.",
        ),
        AnalysisParameter::word(
            "cover",
            &["any", "open", "concealed"],
            "any",
            "What grows on a site: `open` wants ground without trees and houses, `concealed` trees or scrub over all of it.",
        ),
        AnalysisParameter::number(
            "water_m",
            (0.0, 1_000_000.0),
            "m",
            Otherwise("any distance"),
            "The greatest distance from its center to water.",
        ),
        AnalysisParameter::number(
            "dry_m",
            (0.0, 10_000.0),
            "m",
            Value("20"),
            "The least distance from any part of it to water.",
        ),
        AnalysisParameter::number(
            "road_m",
            (0.0, 1_000_000.0),
            "m",
            Otherwise("any distance"),
            "The greatest distance from its center to a road or track; a site never holds one.",
        ),
        AnalysisParameter::plain(
            "hidden_from",
            ParameterForm::Points { least: 1 },
            Otherwise("nobody"),
            "Posts of the enemy that must not see any part of a site.",
        ),
        AnalysisParameter::number(
            "observer_height",
            (0.0, 100_000.0),
            "m",
            Value("2"),
            "The height of those posts' eyes above the ground.",
        ),
        AnalysisParameter::number(
            "hidden_height",
            (0.0, 1000.0),
            "m",
            Value("3"),
            "The height above the ground up to which a site must be hidden.",
        ),
        AnalysisParameter::number(
            "range",
            (1.0, 10_000_000.0),
            "m",
            Otherwise("as far as the land reaches"),
            "How far those posts see, in plan.",
        ),
        AnalysisParameter::numbers(
            "enemy_deg",
            (0.0, 360.0),
            "°",
            Otherwise("none"),
            "Directions of the enemy, clockwise from north, toward which the ground must mask a site.",
        ),
        AnalysisParameter::number(
            "least_mask",
            (0.0, 89.0),
            "°",
            Value("1"),
            "How high at least the ground rises over each post of a site toward the enemy.",
        ),
        AnalysisParameter::number(
            "greatest_mask",
            (0.0, 89.0),
            "°",
            Value("15"),
            "How high at most, so that guns clear the crest.",
        ),
        AnalysisParameter::number("count", (0.0, 100.0), "", Value("3"), "The greatest number of sites."),
        AnalysisParameter::number(
            "separation_m",
            (0.0, 100_000.0),
            "m",
            Value("100"),
            "The least distance between the edges of two sites.",
        ),
    ],
    yields: AnalysisYield::Both,
    reach: AnalysisReach::Whole,
    layers: &[LandPart::Cover, LandPart::Roads, LandPart::Water, LandPart::Woods, LandPart::Obstacles],
    source: "Factors after FM 5-33 (terrain analysis) and FM 6-50 (position areas of guns); all numbers are this program's \
             defaults, not a manual's",
    limits: &[
        "The score is the mean of what is left of the limits of slope, water and roads: it ranks sites of one class, no more.",
        "No soil, no drainage and no weather; whether water is fit to drink and a road bears its traffic is unknown.",
        "A mask is that of bare ground on a flat Earth, along the chain of posts nearest to the direction; ground beyond the \
         model masks nothing.",
        "A crest that a gun clears says nothing of its range, charge and fuze.",
        "Trees and buildings hide a site from the posts of `hidden_from`, and mask nothing.",
    ],
};
