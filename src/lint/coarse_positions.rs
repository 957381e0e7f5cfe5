//! Grid references whose squares are larger than what stands there allows.
//!
//! A grid reference of few digits names a square, and its middle is taken: four digits are a square of 1 km, so that a model
//! may stand 700 m from where it is meant. Each kind of table has the side that does no harm to it. Positions in numbers or
//! degrees have no side and are taken as exact.

use std::ops::Range;

use crate::context::LintContext;
use crate::sink::FindingSink;
use sandtable_description::document::Document;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::stated::Stated;
use sandtable_description::table_sources::table_sources;
use sandtable_geom::position::Position;

/// The largest square of something with a place of its own on the ground: a model, a line, an observer, an eye. Six digits
/// name squares of 100 m, in which a house may be on the other side of a hill.
const GROUND_SIDE_M: f64 = 10.0;

/// The largest square of a sign for something: a symbol, a label, a graphic. Staffs report units by six digits.
const SIGN_SIDE_M: f64 = 100.0;

/// Positions of a key, with the largest square that they may name.
struct KeyPositions<'a> {
    /// What lies there.
    noun: &'static str,
    positions: &'a [Position],
    span: Range<usize>,
    most_m: f64,
}

impl<'a> KeyPositions<'a> {
    fn one(noun: &'static str, at: &'a Stated<Position>, most_m: f64) -> Self {
        let span = at.span().unwrap_or_default();
        Self { noun, positions: std::slice::from_ref(&**at), span, most_m }
    }

    fn many(noun: &'static str, points: &'a Stated<Vec<Position>>, most_m: f64) -> Self {
        Self { noun, positions: points, span: points.span().unwrap_or_default(), most_m }
    }

    /// What is told of grid references that are too coarse; `None` where none is.
    fn message(&self) -> Option<String> {
        let sides_m = self.positions.iter().filter_map(Position::side_m);
        let coarse: Vec<f64> = sides_m.filter(|side_m| *side_m > self.most_m).collect();
        let side_m = coarse.iter().copied().max_by(f64::total_cmp)?;
        let (noun, side, most) = (self.noun, length(side_m), length(self.most_m));
        let off = length(side_m * std::f64::consts::FRAC_1_SQRT_2);
        Some(match (coarse.len(), self.positions.len()) {
            (1, 1) => format!(
                "the grid reference of {noun} names a square of {side}, whose middle is taken; the place may be {off} from there, \
                 where squares of {most} would do"
            ),
            (count, all) => format!(
                "of the {all} positions of {noun}, grid references of squares of up to {side}: {count}; their middles are taken, \
                 and the places may be {off} from there, where squares of {most} would do"
            ),
        })
    }
}

/// Finds grid references whose squares are too large for what lies in their middles.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    for (span, message) in coarse_positions(context.document) {
        let help = "write more digits: 16SGF50001800 names 10 m, 16SGF5000018000 names 1 m";
        sink.add(context.finding(FindingCode::CoarsePosition, span, message).with_help(help));
    }
}

/// The places and messages of grid references that are too coarse, by key.
fn coarse_positions(document: &Document) -> Vec<(Range<usize>, String)> {
    let tables = table_sources(document);
    let mut all = Vec::new();
    for table in &tables {
        let most_m = if is_sign(table.noun) { SIGN_SIDE_M } else { GROUND_SIDE_M };
        all.extend(table.source.points.iter().map(|points| KeyPositions::many(table.noun, points, most_m)));
    }
    for table in &document.viewsheds {
        all.extend(table.observers.iter().map(|at| KeyPositions::one("an observer", at, GROUND_SIDE_M)));
    }
    for table in &document.sights {
        all.push(KeyPositions::one("an observer", &table.observer, GROUND_SIDE_M));
        all.extend(table.targets.iter().map(|at| KeyPositions::one("a target", at, GROUND_SIDE_M)));
    }
    for table in &document.flights {
        all.extend(
            table.source.points.iter().map(|points| KeyPositions::many("a flight", points, SIGN_SIDE_M)),
        );
    }
    let models = document.models.iter().filter_map(|table| table.at.as_ref());
    all.extend(models.map(|at| KeyPositions::one("a model", at, GROUND_SIDE_M)));
    let eyes = document.cameras.iter().filter_map(|table| table.eye.as_ref());
    all.extend(eyes.map(|eye| KeyPositions::one("an eye", eye, GROUND_SIDE_M)));
    all.extend(document.ranges.iter().map(|table| KeyPositions::one("a range", &table.at, SIGN_SIDE_M)));
    let labels = document.labels.iter().filter_map(|table| table.at.as_ref());
    all.extend(labels.map(|at| KeyPositions::one("a label", at, SIGN_SIDE_M)));
    let symbols = document.symbols.iter().filter_map(|table| table.at.as_ref());
    all.extend(symbols.map(|at| KeyPositions::one("a symbol", at, SIGN_SIDE_M)));
    let found = all.iter().filter_map(|key| Some((key.span.clone(), key.message()?)));
    let mut found: Vec<_> = found.collect();
    found.sort_by_key(|(span, _)| span.start);
    found
}

/// Whether a table's features are drawn over the ground and are not themselves the ground or a thing on it.
fn is_sign(noun: &str) -> bool {
    ["graphics", "labels", "symbols", "overlays"].contains(&noun)
}

fn length(meters: f64) -> String {
    match meters {
        1000.0.. if meters % 1000.0 == 0.0 => format!("{} km", meters / 1000.0),
        1000.0.. => format!("{:.1} km", meters / 1000.0),
        _ => format!("{meters:.0} m"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_description::parse::parse;

    fn found(tables: &str) -> Vec<(String, String)> {
        let text = format!("[terrain]\ndem = \"a.tif\"\n{tables}");
        let document = parse("a.toml", &text).unwrap_or_else(|error| panic!("{error:?}"));
        let found = coarse_positions(&document);
        found.into_iter().map(|(span, message)| (text[span].to_owned(), message)).collect()
    }

    #[test]
    fn a_square_of_a_kilometer_is_too_coarse_for_a_symbol_and_one_of_100_m_is_not() {
        let symbol = |at: &str| format!("[[symbol]]\nsidc = \"10031000151211000000\"\nat = \"{at}\"\n");
        let coarse = found(&symbol("16S GF 50 18"));
        assert_eq!(coarse.len(), 1, "{coarse:?}");
        assert_eq!(coarse[0].0, "\"16S GF 50 18\"");
        let expected = "the grid reference of a symbol names a square of 1 km, whose middle is taken; the place may be 707 m \
                        from there, where squares of 100 m would do";
        assert_eq!(coarse[0].1, expected);
        for fine in ["16SGF500180", "16SGF5000018000", "16N 750050 4018050", "36.277N 84.215W"] {
            assert_eq!(found(&symbol(fine)), [], "{fine}");
        }
    }

    #[test]
    fn what_stands_on_the_ground_needs_squares_of_10_m() {
        let model = |at: &str| format!("[[model]]\nfile = \"a.obj\"\nat = \"{at}\"\n");
        assert_eq!(found(&model("16SGF50001800")), []);
        let coarse = found(&model("16SGF500180"));
        assert!(
            coarse[0].1.contains("a model names a square of 100 m") && coarse[0].1.contains("71 m"),
            "{coarse:?}"
        );
    }

    #[test]
    fn of_a_list_the_coarse_ones_are_counted() {
        let road = "[[road]]\nwidth = 6\npoints = [\"16SGF500180\", [750100, 4018000], \"16SGF5118\"]\n";
        let coarse = found(road);
        assert_eq!(coarse.len(), 1, "{coarse:?}");
        assert!(
            coarse[0].1.contains("of the 3 positions of roads, grid references of squares of up to 1 km: 2;")
        );
        let sight = "[[sight]]\nobserver = \"16SGF5118\"\ntargets = [\"16SGF5000018000\"]\n";
        assert!(found(sight)[0].1.contains("an observer names a square of 1 km"));
    }
}
