//! Kinds about landing and sites.

use crate::kind::{AnalysisFamily, AnalysisKind, AnalysisReach, AnalysisYield, LandPart};
use crate::parameter::{
    AnalysisParameter,
    ParameterDefault::{Otherwise, Value},
    ParameterForm,
};

/// The kinds.
pub(crate) const KINDS: &[AnalysisKind] = &[LANDING_ZONES, SITES];

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
        "Wires and obstacles between posts are unknown, as are wind, dust and the bearing strength of soil.",
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
    ],
};
