//! Kinds about movement across the land.

use crate::kind::{AnalysisFamily, AnalysisKind, AnalysisReach, AnalysisYield, LandPart};
use crate::parameter::{AnalysisParameter, ParameterDefault, ParameterForm};

/// For whom the ground is judged.
const VEHICLE: AnalysisParameter = AnalysisParameter::plain(
    "vehicle",
    ParameterForm::Vehicle,
    ParameterDefault::Value("tracked"),
    "The vehicle: one of the scene's, or `foot`, `wheeled`, `tracked` or `truck`.",
);

/// The two rules for people on foot.
const METHOD: AnalysisParameter = AnalysisParameter::word(
    "method",
    &["tobler", "langmuir"],
    "tobler",
    "How slopes slow people on foot: Tobler's function, or Naismith's rule as Langmuir has it. Vehicles have their limits.",
);

/// The layers on which the going depends.
const GOING_LAYERS: &[LandPart] =
    &[LandPart::Cover, LandPart::Roads, LandPart::Water, LandPart::Woods, LandPart::Crossings];

/// What the going does not know.
const NO_SOIL: &str = "No soil and no weather: trafficability follows from slope, cover, trees and water alone, with this \
     program's defaults for covers.";

/// What water does where its depth is unknown.
const UNKNOWN_DEPTH: &str = "Water of unknown depth counts as not fordable; ditches of the ground are crossed by `gap_m` where \
     posts lie closer than half of it, up to eight posts from rim to rim, and by their slopes elsewhere; posts are no finer \
     than the model, so that smaller obstacles are missed.";

/// What is wrong with times across the triangles of a lattice.
const TRIANGLES: &str = "Ways lead from post to post and across the triangles between posts, from a few points of their sides: on \
     planes times 32 posts away are up to 0.7 % too long where the ground is alike in all directions (1.8 % nearer, 0.5 % from \
     96 posts on), up to 2.4 % for vehicles on slopes that they go freely and 9 % on steeper ones; for people on foot by Tobler's \
     function up to 2 % where the ground rises 10 %, 5 % where it rises 20 %, 8 % where it rises 40 % and 13 % where it rises \
     70 %, by Langmuir's rule up to 4, 9 and 22 % where it rises 20, 40 and 70 %. Between posts times lie between \
     theirs, so that on rough ground they may be too short: a `route` takes on real ground the time at its end within 1 % on \
     average.";

/// What is wrong with ways on a lattice.
const METRICATION: &str = "Routes are traced back through the times of the kind `time`, across the triangles between posts, and \
     their points are moved along the sides to where they take the least. On real ground they take what `time` says at their \
     end within 1 % on average, nine of ten within 5 % (8 % near the limits of a vehicle), and never longer than from post to \
     post by sixteen steps. On level ground they are up to 0.2 % too long. Heights on a side lie on the line between its ends. \
     Where `time` reaches a post past a side too steep to go along, the route goes along it at the slowest that the vehicle \
     may. Lengths are those on the map.";

/// What is known of slopes across the way.
const WAY_SLOPES: &str = "Vehicles are slowed by slopes up, down and across; on roads and bridges a grade counts at most as the \
     steepest that the vehicle goes freely, since models of the ground show the slope across which a road was cut.";

/// What ground counts as part of a corridor.
const THROUGH: AnalysisParameter = AnalysisParameter::word(
    "through",
    &["unrestricted", "restricted"],
    "unrestricted",
    "The ground that counts in a width: `unrestricted` alone, or `restricted` ground too.",
);

/// What is wrong with widths.
const WIDTHS: &str = "Ground beyond the model counts as free, so that widths near its border may be too great; widths are good to \
     a cell, and what is narrower than one is missed.";

/// Where avenues begin.
const FROM_LINE: AnalysisParameter = AnalysisParameter::plain(
    "from_line",
    ParameterForm::Line,
    ParameterDefault::Required,
    "The line where they begin.",
);

/// Where avenues end.
const TO_LINE: AnalysisParameter = AnalysisParameter::plain(
    "to_line",
    ParameterForm::Line,
    ParameterDefault::Required,
    "The line where they end.",
);

/// How many avenues.
const COUNT: AnalysisParameter = AnalysisParameter::number(
    "count",
    (1.0, 20.0),
    "",
    ParameterDefault::Value("3"),
    "The most routes; fewer where no further one differs.",
);

/// How far apart avenues are.
const APART: AnalysisParameter = AnalysisParameter::number(
    "apart_m",
    (0.0, 100_000.0),
    "m",
    ParameterDefault::Value("750"),
    "The distance from a route within which the next ones are slowed, and choke points count as one.",
);

/// How strongly a route keeps later ones away.
const PENALTY: AnalysisParameter = AnalysisParameter::number(
    "penalty",
    (1.0, 100.0),
    "",
    ParameterDefault::Value("3"),
    "How many times longer the ground near a route takes when the next one is looked for.",
);

/// The kinds.
pub(crate) const KINDS: &[AnalysisKind] = &[
    AnalysisKind {
        name: "obstacles",
        family: AnalysisFamily::Movement,
        title: "Modified combined obstacle overlay",
        summary: "Ground that is unrestricted (0), restricted (1) or severely restricted (2) for a vehicle, with the area of each.",
        parameters: &[VEHICLE],
        yields: AnalysisYield::Raster,
        reach: AnalysisReach::Posts(10),
        layers: GOING_LAYERS,
        source: "FM 34-130 (1994), appendix B; ATP 2-01.3",
        limits: &[
            NO_SOIL,
            UNKNOWN_DEPTH,
            "A slope counts by the lower of the vehicle's limits uphill and downhill, since an overlay has no direction.",
        ],
    },
    AnalysisKind {
        name: "speed",
        family: AnalysisFamily::Movement,
        title: "Speed",
        summary: "The speed of a vehicle at each post straight up its slope, 0 where it cannot go.",
        parameters: &[VEHICLE, METHOD],
        yields: AnalysisYield::Raster,
        reach: AnalysisReach::Posts(10),
        layers: GOING_LAYERS,
        source: "Tobler 1993; Naismith 1892 with Langmuir 1984; classes of movement after FM 34-130",
        limits: &[
            NO_SOIL,
            UNKNOWN_DEPTH,
            "Roads have the vehicle's speed on their surface whatever their grade.",
        ],
    },
    AnalysisKind {
        name: "time",
        family: AnalysisFamily::Movement,
        title: "Time to reach",
        summary: "The minutes that a vehicle takes to each post from the nearest in time of the places, roads and bridges included.",
        parameters: &[
            AnalysisParameter::plain(
                "from",
                ParameterForm::Points { least: 1 },
                ParameterDefault::Required,
                "The places where movement starts.",
            ),
            VEHICLE,
            METHOD,
            AnalysisParameter::number(
                "max_min",
                (0.1, 100_000.0),
                "min",
                ParameterDefault::Value("100000"),
                "What takes longer is not reached.",
            ),
            AnalysisParameter::numbers(
                "classes_min",
                (0.1, 100_000.0),
                "min",
                ParameterDefault::Value("15, 30, 60, 120, 240"),
                "The isochrones: where one class ends and the next begins.",
            ),
        ],
        yields: AnalysisYield::Both,
        reach: AnalysisReach::Whole,
        layers: GOING_LAYERS,
        source: "Dijkstra 1959 with the queue of Dial 1969; Tobler 1993; Naismith 1892 with Langmuir 1984; across \
                 triangles after Sethian and Vladimirsky 2003",
        limits: &[NO_SOIL, UNKNOWN_DEPTH, TRIANGLES, WAY_SLOPES],
    },
    AnalysisKind {
        name: "route",
        family: AnalysisFamily::Movement,
        title: "Route",
        summary: "The quickest route of a vehicle through places, with a march table by leg.",
        parameters: &[
            AnalysisParameter::plain(
                "from",
                ParameterForm::Points { least: 1 },
                ParameterDefault::Required,
                "Where it starts: the first position.",
            ),
            AnalysisParameter::plain(
                "to",
                ParameterForm::Points { least: 1 },
                ParameterDefault::Required,
                "Where it ends: the first position.",
            ),
            AnalysisParameter::plain(
                "via",
                ParameterForm::Points { least: 1 },
                ParameterDefault::Otherwise("it goes straight there"),
                "Places that it passes, in order.",
            ),
            VEHICLE,
            METHOD,
            AnalysisParameter::number(
                "start_h",
                (0.0, 24.0),
                "h",
                ParameterDefault::Value("0"),
                "The hour of the start, from which the table has the arrivals.",
            ),
        ],
        yields: AnalysisYield::Features,
        reach: AnalysisReach::Whole,
        layers: GOING_LAYERS,
        source: "Dijkstra 1959 with the queue of Dial 1969, toward its end as Hart, Nilsson and Raphael 1968; Tobler 1993; \
                 Naismith 1892 with Langmuir 1984; across triangles after Sethian and Vladimirsky 2003",
        limits: &[
            NO_SOIL,
            UNKNOWN_DEPTH,
            METRICATION,
            WAY_SLOPES,
            "The route is the quickest, not the least seen or the safest.",
        ],
    },
    AnalysisKind {
        name: "corridors",
        family: AnalysisFamily::Movement,
        title: "Mobility corridors",
        summary: "The widest corridor of unrestricted ground that holds each post, by the widths of echelons.",
        parameters: &[
            AnalysisParameter::numbers(
                "widths_m",
                (1.0, 1_000_000.0),
                "m",
                ParameterDefault::Value("1500, 3000, 6000"),
                "The widths: by default a battalion's, a brigade's and a division's.",
            ),
            VEHICLE,
            THROUGH,
        ],
        yields: AnalysisYield::Raster,
        reach: AnalysisReach::Whole,
        layers: GOING_LAYERS,
        source: "FM 34-130 (1994); ATP 2-01.3; distances by Felzenszwalb and Huttenlocher 2012",
        limits: &[NO_SOIL, UNKNOWN_DEPTH, WIDTHS],
    },
    AnalysisKind {
        name: "avenues",
        family: AnalysisFamily::Movement,
        title: "Avenues of approach",
        summary: "The best routes that differ from one line to another, with their times and their narrowest widths.",
        parameters: &[FROM_LINE, TO_LINE, VEHICLE, METHOD, COUNT, APART, PENALTY, THROUGH],
        yields: AnalysisYield::Features,
        reach: AnalysisReach::Whole,
        layers: GOING_LAYERS,
        source: "FM 34-130 (1994); ATP 2-01.3; routes by Dijkstra 1959 with a penalty near earlier ones",
        limits: &[
            NO_SOIL,
            UNKNOWN_DEPTH,
            METRICATION,
            WAY_SLOPES,
            WIDTHS,
            "Routes are the quickest one after the other, not the set of routes that is best together.",
        ],
    },
    AnalysisKind {
        name: "chokes",
        family: AnalysisFamily::Movement,
        title: "Choke points",
        summary: "The narrowest places on the best routes from one line to another.",
        parameters: &[
            FROM_LINE,
            TO_LINE,
            VEHICLE,
            METHOD,
            AnalysisParameter::number(
                "most",
                (1.0, 100.0),
                "",
                ParameterDefault::Value("10"),
                "The most places, the narrowest first.",
            ),
            COUNT,
            APART,
            PENALTY,
            THROUGH,
        ],
        yields: AnalysisYield::Features,
        reach: AnalysisReach::Whole,
        layers: GOING_LAYERS,
        source: "FM 34-130 (1994); ATP 2-01.3; distances by Felzenszwalb and Huttenlocher 2012",
        limits: &[
            NO_SOIL,
            UNKNOWN_DEPTH,
            METRICATION,
            WAY_SLOPES,
            WIDTHS,
            "A width of 0 is restricted ground on the route; on a road through such ground the width is the road's.",
        ],
    },
];
