//! The scene file's table `[[earthwork]]`: ground that is dug, leveled and filled.
//!
//! ```toml
//! [[earthwork]]
//! kind = "crater"
//! points = [[500120, 4649080]]
//! radius = 12
//!
//! [[earthwork]]
//! kind = "level"
//! points = [[500300, 4649100], [500360, 4649100], [500360, 4649150]]
//! ```

use crate::bounds::Bounds::{self, Above, Within};
use crate::declaration::{KeyDeclaration, Presence};
use crate::feature_source::FeatureSource;
use crate::feature_value::FeatureValue;
use crate::key;
use crate::reader::TableReader;
use crate::stated::Stated;
use crate::table::Table;
use crate::table_key;
use crate::words::EarthworkKind;
use sandtable_base::message::choice::Choice;

/// Radii, widths, depths and heights of earthworks.
const SIZE: Bounds = Above(0.0, 10_000.0);
/// Heights of rims, which may be none.
const RIM: Bounds = Within(0.0, 10_000.0);
/// Meters out for each meter of height of a batter; fill does not stand upright.
const FILL_BATTER: Bounds = Above(0.0, 20.0);
/// The same of a cutting, whose sides may be walls.
const CUT_BATTER: Bounds = Within(0.0, 20.0);

table! {
    /// `[[earthwork]]`: ground dug, leveled or filled, in the order of the file, after all else that shapes the ground but
    /// the pads of models. Water stays as it is; roads follow.
    struct EarthworkTable {
        /// Name for messages and the report.
        name: Option<String> = key::text(), otherwise "the property `name`";
        /// The shape.
        kind: Stated<EarthworkKind> = key::word::<EarthworkKind>(), required;
        /// Centers of craters; centerlines of trenches, tracks and banks, where one point makes a mound; outlines of level
        /// ground.
        source: FeatureSource = table_key::source::<1>(), inline;
        /// Of a crater: from its center to the crest of its rim.
        radius: Option<FeatureValue<f64>> = key::feature_number(SIZE, "m"), otherwise "10";
        /// Of a crater, a trench or a track: from the old ground down to the bottom.
        depth: Option<FeatureValue<f64>> = key::feature_number(SIZE, "m"),
            otherwise "0.32 of a crater's radius, as simple craters have it (Pike 1977); 1.5 for a trench, 0.15 for a track";
        /// Of a crater: from the old ground up to the crest.
        rim: Option<FeatureValue<f64>> = key::feature_number(RIM, "m"), otherwise "0.07 of the radius";
        /// Of a trench its width at the old ground, of a track the distance of its ruts, of a bank the width of its crown.
        width: Option<FeatureValue<f64>> = key::feature_number(SIZE, "m"), otherwise "1.5 for a trench, 2 for a track, 4 for a bank";
        /// Of a trench: its width at the bottom, less than `width`.
        bottom: Option<FeatureValue<f64>> = key::feature_number(SIZE, "m"), otherwise "0.55 of `width`";
        /// Of a track: width of a rut.
        rut: Option<FeatureValue<f64>> = key::feature_number(SIZE, "m"), otherwise "0.5";
        /// Of a bank: height of its crown above the ground under each of its points.
        height: Option<FeatureValue<f64>> = key::feature_number(SIZE, "m"), otherwise "3", unless ["level"];
        /// Elevation of level ground, or of the crown of a bank.
        level: Option<FeatureValue<f64>> = key::feature_number(Bounds::ELEVATION, "m"),
            otherwise "the mean of the ground in the outline; of a bank by `height`", unless ["height"];
        /// Of level ground: meters out for each meter up on a cutting's batter.
        cut_slope: f64 = key::number(CUT_BATTER, "m/m"), default 1;
        /// Of level ground and banks: meters out for each meter down on the batter.
        fill_slope: f64 = key::number(FILL_BATTER, "m/m"), default 1.5;
    }
    check(reader) {
        if let Some(kind) = &kind {
            let kind: &Stated<EarthworkKind> = kind;
            check_points(reader, **kind, source.as_ref());
            check_keys(reader, **kind);
        }
        reader.exclude("height", "level");
    }
}

/// The keys that only some kinds have, each with these kinds.
const KEYS_OF_KINDS: [(&str, &[EarthworkKind]); 10] = {
    use EarthworkKind::{Crater, Level, Raise, Track, Trench};
    [
        ("radius", &[Crater]),
        ("depth", &[Crater, Trench, Track]),
        ("rim", &[Crater]),
        ("width", &[Trench, Track, Raise]),
        ("bottom", &[Trench]),
        ("rut", &[Track]),
        ("height", &[Raise]),
        ("level", &[Level, Raise]),
        ("cut_slope", &[Level]),
        ("fill_slope", &[Level, Raise]),
    ]
};

/// Reports keys that the kind does not have.
fn check_keys(reader: &mut TableReader<'_, '_>, kind: EarthworkKind) {
    for (key, kinds) in KEYS_OF_KINDS.into_iter().filter(|(_, kinds)| !kinds.contains(&kind)) {
        let words: Vec<&str> = kinds.iter().map(|kind| kind.word()).collect();
        let help = format!("remove it; `kind = \"{}\"` has it", words.join("\" or \""));
        reader.without_effect(&[key], &format!("on an earthwork of kind `{}`", kind.word()), &help);
    }
}

/// Reports inline points that are too few for the kind.
fn check_points(reader: &mut TableReader<'_, '_>, kind: EarthworkKind, source: Option<&FeatureSource>) {
    let least = match kind {
        EarthworkKind::Crater | EarthworkKind::Raise => 1,
        EarthworkKind::Trench | EarthworkKind::Track => 2,
        EarthworkKind::Level => 3,
    };
    let Some(points) = source.and_then(|source| source.points.as_ref()) else { return };
    let is_closed = least > 2 && points.len() > 1 && points.first() == points.last();
    let count = points.len() - usize::from(is_closed);
    if count < least {
        let message =
            format!("`points` has {count} of the {least} points that `kind = \"{}\"` needs", kind.word());
        let help = format!("write at least {least} points as [[x1, y1], [x2, y2], ...]");
        reader.error(points.span().unwrap_or_default(), message, help);
    }
}

#[cfg(test)]
mod tests {
    use crate::document::Document;
    use crate::parse::parse;

    fn read(table: &str) -> Result<Document, String> {
        let text = format!("[terrain]\ndem = \"a.tif\"\n[[earthwork]]\n{table}\n");
        parse("scene.toml", &text).map_err(|errors| errors.to_string())
    }

    #[test]
    fn every_kind_needs_its_points_and_nothing_else() {
        for (kind, least) in [("crater", 1), ("raise", 1), ("trench", 2), ("track", 2), ("level", 3)] {
            for count in 1..=3 {
                let points: Vec<String> = (0..count).map(|at| format!("[{at}, {}]", at * at)).collect();
                let found = read(&format!("kind = \"{kind}\"\npoints = [{}]", points.join(", ")));
                assert_eq!(found.is_ok(), count >= least, "{kind} of {count}: {:?}", found.err());
            }
        }
        let closed = read("kind = \"level\"\npoints = [[0, 0], [1, 0], [0, 0]]").expect_err("too few");
        assert!(closed.contains("has 2 of the 3 points that `kind = \"level\"` needs"), "{closed}");
    }

    #[test]
    fn keys_of_another_kind_are_refused() {
        let wrong = read("kind = \"trench\"\npoints = [[0, 0], [1, 0]]\nradius = 3").expect_err("wrong");
        assert!(wrong.contains("`radius` has no effect on an earthwork of kind `trench`"), "{wrong}");
        assert!(wrong.contains("`kind = \"crater\"` has it"), "{wrong}");
        let both = read("kind = \"raise\"\npoints = [[0, 0]]\nheight = 3\nlevel = 100").expect_err("wrong");
        assert!(both.contains("both `level` and `height`"), "{both}");
        let sound = read("kind = \"raise\"\npoints = [[0, 0]]\nlevel = 100\nfill_slope = 2").expect("sound");
        assert_eq!(sound.earthworks[0].fill_slope, 2.0);
    }
}
