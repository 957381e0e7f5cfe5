//! An example of each kind of analysis: on a file of the repository, with what its picture shows.
//!
//! A kind without an example fails the test that writes the pages: whoever adds a kind adds its row.

use sandtable_catalog::kind::AnalysisKind;

/// An example of a kind.
pub struct Example {
    /// The kind.
    pub kind: &'static str,
    /// What is analyzed.
    pub land: ExampleLand,
    /// The arguments, as the command line takes them.
    pub arguments: &'static [(&'static str, &'static str)],
    /// What the picture shows: the map coordinates of its middle, and `n` of its scale 1:n.
    pub shows: [f64; 3],
    /// What is seen on it, a sentence or two.
    pub caption: &'static str,
}

/// What an example analyzes.
#[derive(Clone, Copy)]
pub enum ExampleLand {
    /// Elevation alone.
    Elevation,
    /// A scene with woods, water and roads.
    Caryville,
    /// A scene whose roads move earth.
    Earthworks,
}

impl ExampleLand {
    /// The file that a command names, from the top of the repository.
    pub fn file(self) -> &'static str {
        match self {
            Self::Elevation => "assets/jacksboro/dem.tif",
            Self::Caryville => "scenes/obstacles.toml",
            Self::Earthworks => "scenes/earthworks.toml",
        }
    }

    /// The tables of a scene in the folder of scenes that has this land and no analysis.
    pub fn tables(self) -> &'static str {
        match self {
            Self::Elevation => {
                "[terrain]\ndem = \"../assets/jacksboro/dem.tif\"\n[style]\npreset = \"military\"\n"
            }
            Self::Caryville => "include = \"common/caryville.toml\"\n",
            Self::Earthworks => "include = \"earthworks.toml\"\n[style]\npreset = \"military\"\n",
        }
    }
}

/// The example of a kind.
pub fn example(kind: &AnalysisKind) -> &'static Example {
    EXAMPLES.iter().find(|example| example.kind == kind.name).unwrap_or_else(|| {
        panic!("{} has no example: add a row to tests/scenes/analysis_pages/examples.rs", kind.name)
    })
}

/// The valley at Caryville between two ridges.
const VALLEY: [f64; 3] = [750_500.0, 4_019_700.0, 58_000.0];
/// Its north, where it is wide.
const MEADOWS: [f64; 3] = [750_500.0, 4_020_800.0, 58_000.0];
/// The ridges and the valley from farther away.
const RIDGES: [f64; 3] = [748_000.0, 4_019_000.0, 95_000.0];

/// The examples, in the order of the kinds.
pub const EXAMPLES: &[Example] = &[
    Example {
        kind: "slope",
        land: ExampleLand::Elevation,
        arguments: &[],
        shows: RIDGES,
        caption: "The flanks of the ridges are too steep for vehicles; the valley between them is nearly level.",
    },
    Example {
        kind: "aspect",
        land: ExampleLand::Elevation,
        arguments: &[],
        shows: RIDGES,
        caption: "Each flank has the tint of the direction toward which it falls.",
    },
    Example {
        kind: "hillshade",
        land: ExampleLand::Elevation,
        arguments: &[("light", "multidirectional")],
        shows: RIDGES,
        caption: "Light from four sides shows ridges whatever their direction.",
    },
    Example {
        kind: "curvature",
        land: ExampleLand::Elevation,
        arguments: &[("direction", "profile")],
        shows: RIDGES,
        caption: "Crests are convex, the feet of slopes concave.",
    },
    Example {
        kind: "ruggedness",
        land: ExampleLand::Elevation,
        arguments: &[("measure", "tpi"), ("radius", "5")],
        shows: RIDGES,
        caption: "The topographic position index over eleven posts: ridges stand above the ground around them, valleys below.",
    },
    Example {
        kind: "geomorphons",
        land: ExampleLand::Elevation,
        arguments: &[("radius", "10"), ("flatness", "2")],
        shows: RIDGES,
        caption: "Ridges, spurs, slopes, hollows and valleys.",
    },
    Example {
        kind: "contours",
        land: ExampleLand::Elevation,
        arguments: &[("interval", "50")],
        shows: VALLEY,
        caption: "Every fifth line is an index line with its height.",
    },
    Example {
        kind: "elevation-bands",
        land: ExampleLand::Elevation,
        arguments: &[("interval", "100")],
        shows: RIDGES,
        caption: "Bands of 100 m.",
    },
    Example {
        kind: "peaks",
        land: ExampleLand::Elevation,
        arguments: &[("prominence", "40")],
        shows: RIDGES,
        caption: "Summits that rise at least 40 m above the pass to higher ground, with their heights.",
    },
    Example {
        kind: "passes",
        land: ExampleLand::Elevation,
        arguments: &[("depth", "60")],
        shows: RIDGES,
        caption: "The lowest points on the ways along ridges from summit to summit.",
    },
    Example {
        kind: "form-lines",
        land: ExampleLand::Elevation,
        arguments: &[],
        shows: RIDGES,
        caption: "Ridge lines climb from passes to summits, valley lines lead down.",
    },
    Example {
        kind: "obstacles",
        land: ExampleLand::Caryville,
        arguments: &[("vehicle", "tracked")],
        shows: VALLEY,
        caption: "Woods and slopes restrict tracked vehicles, steep ground and deep water stop them.",
    },
    Example {
        kind: "speed",
        land: ExampleLand::Caryville,
        arguments: &[("vehicle", "truck")],
        shows: VALLEY,
        caption: "Trucks are fast on roads, slow on meadows and have no speed in the woods.",
    },
    Example {
        kind: "time",
        land: ExampleLand::Caryville,
        arguments: &[("from", "749400,4020700"), ("vehicle", "foot"), ("classes_min", "15,30,45,60,90")],
        shows: VALLEY,
        caption: "How far a patrol on foot comes from Caryville in an hour and a half.",
    },
    Example {
        kind: "route",
        land: ExampleLand::Caryville,
        arguments: &[
            ("from", "749400,4020700"),
            ("via", "752000,4021800"),
            ("to", "753300,4019800"),
            ("vehicle", "truck"),
            ("start_h", "6.5"),
        ],
        shows: VALLEY,
        caption: "The quickest way of a convoy from Caryville to a meadow in the east through a way-point.",
    },
    Example {
        kind: "corridors",
        land: ExampleLand::Caryville,
        arguments: &[("widths_m", "300,600,1500"), ("vehicle", "tracked")],
        shows: VALLEY,
        caption: "The widest unrestricted ground lies in the valley; woods part it.",
    },
    Example {
        kind: "avenues",
        land: ExampleLand::Caryville,
        arguments: &[
            ("from_line", "749500,4022700;753500,4022700"),
            ("to_line", "751800,4016900;754700,4016900"),
            ("vehicle", "tracked"),
        ],
        shows: VALLEY,
        caption: "Three avenues from north to south, each apart from those before it.",
    },
    Example {
        kind: "chokes",
        land: ExampleLand::Caryville,
        arguments: &[
            ("from_line", "749500,4022700;753500,4022700"),
            ("to_line", "751800,4016900;754700,4016900"),
            ("vehicle", "tracked"),
        ],
        shows: VALLEY,
        caption: "The narrowest places on these avenues, with their widths.",
    },
    Example {
        kind: "viewsheds",
        land: ExampleLand::Caryville,
        arguments: &[("posts", "748230,4018450;754280,4018320;751500,4021900"), ("observer_height", "4")],
        shows: VALLEY,
        caption: "How many of three posts see the ground; what none sees is dead ground.",
    },
    Example {
        kind: "intervisibility",
        land: ExampleLand::Caryville,
        arguments: &[
            ("posts", "747700,4021500;748230,4018450;750600,4019500;752600,4021700;754280,4018320"),
            ("height", "10"),
        ],
        shows: VALLEY,
        caption: "Antennas of 10 m: full lines join those that see each other, broken ones those that do not.",
    },
    Example {
        kind: "best-posts",
        land: ExampleLand::Caryville,
        arguments: &[
            ("area", "746400,4016900;749400,4016900;750400,4022700;746400,4022700"),
            ("count", "3"),
            ("range", "6000"),
            ("observer_height", "4"),
        ],
        shows: VALLEY,
        caption: "Three posts on the western heights that together see most of the valley.",
    },
    Example {
        kind: "fields-of-fire",
        land: ExampleLand::Caryville,
        arguments: &[
            ("weapons", "749000,4019200;750900,4018200"),
            ("max_range", "3000"),
            ("min_range", "100"),
            ("direction", "75"),
            ("arc", "110"),
        ],
        shows: VALLEY,
        caption: "What two weapons hit within their sectors, from 100 m to 3 km.",
    },
    Example {
        kind: "masking",
        land: ExampleLand::Caryville,
        arguments: &[("radars", "752800,4019900"), ("radar_height", "15")],
        shows: VALLEY,
        caption: "How high above the ground an aircraft flies at most without being seen by a radar in the valley.",
    },
    Example {
        kind: "exposure",
        land: ExampleLand::Caryville,
        arguments: &[
            ("route", "749400,4020700;750600,4019000;752000,4018300;754000,4017800"),
            ("posts", "748230,4018450;754280,4018320"),
        ],
        shows: VALLEY,
        caption: "Stretches of a patrol's route in sight of two posts are full, those out of sight are broken.",
    },
    Example {
        kind: "landing-zones",
        land: ExampleLand::Caryville,
        arguments: &[("size", "5"), ("count", "8")],
        shows: [752_650.0, 4_021_750.0, 30_000.0],
        caption: "Level meadows are suited for touchdown points of 100 m; the best lie apart.",
    },
    Example {
        kind: "drop-zones",
        land: ExampleLand::Caryville,
        arguments: &[("jumpers", "12"), ("heading", "90"), ("count", "2")],
        shows: MEADOWS,
        caption: "Two zones for a pass of twelve jumpers, from west to east.",
    },
    Example {
        kind: "sites",
        land: ExampleLand::Caryville,
        arguments: &[
            ("size_m", "150"),
            ("road_m", "400"),
            ("water_m", "1500"),
            ("hidden_from", "748230,4018450"),
            ("count", "3"),
            ("separation_m", "800"),
        ],
        shows: MEADOWS,
        caption: "Places for a camp near roads and water that a post on the western ridge does not see.",
    },
    Example {
        kind: "fill",
        land: ExampleLand::Elevation,
        arguments: &[],
        shows: RIDGES,
        caption: "Depressions of the model, which water fills before it runs off.",
    },
    Example {
        kind: "flow",
        land: ExampleLand::Elevation,
        arguments: &[],
        shows: RIDGES,
        caption: "The area that drains through each post, by powers of ten.",
    },
    Example {
        kind: "streams",
        land: ExampleLand::Elevation,
        arguments: &[("area_m2", "400000")],
        shows: RIDGES,
        caption: "Streams that drain 0.4 km² and more, the wider the higher their order.",
    },
    Example {
        kind: "basins",
        land: ExampleLand::Elevation,
        arguments: &[("area_m2", "20000000")],
        shows: [747_500.0, 4_021_000.0, 160_000.0],
        caption: "The basins of outlets through which 20 km² and more drain off the land.",
    },
    Example {
        kind: "drainage-height",
        land: ExampleLand::Elevation,
        arguments: &[],
        shows: RIDGES,
        caption: "Ground that lies low over its stream floods first.",
    },
    Example {
        kind: "flood",
        land: ExampleLand::Caryville,
        arguments: &[("level_m", "320"), ("from", "749950,4021200")],
        shows: VALLEY,
        caption: "What the lake floods when it rises to 320 m.",
    },
    Example {
        kind: "dam-break",
        land: ExampleLand::Elevation,
        arguments: &[("dam", "36.256N 84.273W; 36.272N 84.273W"), ("level_m", "500"), ("way_km", "8")],
        shows: [743_400.0, 4_015_500.0, 55_000.0],
        caption: "A dam in a mountain valley: the water that it holds in the east, and the depths below it where it fails.",
    },
    Example {
        kind: "cut-fill",
        land: ExampleLand::Earthworks,
        arguments: &[("against", "source")],
        shows: [430.0, 215.0, 4_000.0],
        caption: "The cutting of a road through a ridge, and its embankments.",
    },
    Example {
        kind: "haul",
        land: ExampleLand::Earthworks,
        arguments: &[("against", "source"), ("block_m", "80")],
        shows: [480.0, 285.0, 5_600.0],
        caption: "Arrows lead from cuttings to the embankments that their earth fills.",
    },
    Example {
        kind: "berms",
        land: ExampleLand::Caryville,
        arguments: &[("line", "751500,4021300;751960,4021300"), ("level_m", "323")],
        shows: [751_740.0, 4_021_300.0, 4_000.0],
        caption: "A dam of earth across a stream, wide where it is high; its table has a row for every ten meters.",
    },
];
