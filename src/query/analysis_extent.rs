//! The argument `extent` of an analysis as users write it.

use glam::DVec2;

use sandtable_analysis::extent::LandExtent;
use sandtable_geom::crs::Crs;

use crate::positions::position_list;

/// Positions along each side of a rectangle that is brought to another system, where its sides are curved.
const SIDE_STEPS: u32 = 16;

/// The extent that a text states. Numbers are coordinates of `crs`; the extent of a rectangle in another system than the
/// land's is the smallest one of the land around it.
///
/// # Errors
/// What is wrong with the text, and what to write.
pub(crate) fn parse(text: &str, crs: &Crs, land_crs: &Crs) -> Result<LandExtent, String> {
    if let Some([x0, y0, x1, y1]) = four_numbers(text) {
        return rectangle([DVec2::new(x0, y0), DVec2::new(x1, y1)], crs, land_crs);
    }
    let (mut numbers, mut on_land) = (Vec::new(), Vec::new());
    for position in position_list(text)? {
        let written = position.written(crs).map_err(|error| error.to_string())?;
        numbers.extend((!written.is_brought).then_some(written.at));
        on_land.push(crs.transform(land_crs, written.at).map_err(|error| error.to_string())?);
    }
    match (&on_land[..], &numbers[..]) {
        ([_], _) => {
            Err("states one position; write x0,y0,x1,y1, two positions at opposite corners, or an area \
                 of three positions or more"
                .into())
        }
        ([_, _], &[first, last]) => rectangle([first, last], crs, land_crs),
        (&[first, last], _) => rectangle([first, last], land_crs, land_crs),
        _ => Ok(LandExtent::area(on_land)),
    }
}

fn rectangle([a, b]: [DVec2; 2], crs: &Crs, land_crs: &Crs) -> Result<LandExtent, String> {
    let (low, high) = (a.min(b), a.max(b));
    if crs == land_crs {
        return Ok(LandExtent::rectangle([low, high]));
    }
    let sides = (0..=SIDE_STEPS).flat_map(|step| {
        let at = low + (high - low) * (f64::from(step) / f64::from(SIDE_STEPS));
        [(at.x, low.y), (at.x, high.y), (low.x, at.y), (high.x, at.y)].map(DVec2::from)
    });
    let outline: Result<Vec<DVec2>, _> = sides.map(|at| crs.transform(land_crs, at)).collect();
    Ok(LandExtent::rectangle(outline.map_err(|error| error.to_string())?))
}

/// Four finite numbers with commas between.
fn four_numbers(text: &str) -> Option<[f64; 4]> {
    let numbers: Vec<f64> =
        text.split(',').map(|number| number.trim().parse().ok()).collect::<Option<_>>()?;
    numbers.try_into().ok().filter(|numbers: &[f64; 4]| numbers.iter().all(|number| number.is_finite()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::{AnalyzeError, Analyzed, WrittenArgument, analyze, bare_land};
    use crate::dataset::Dataset;
    use crate::windowed_elevation::WindowedElevation;
    use sandtable_analysis::extent::ground_part;
    use sandtable_analysis::land::Land;
    use sandtable_raster::raster::{Raster, Samples, north_up_nodes};
    use sandtable_terrain::lattice::{Lattice, Post};
    use sandtable_terrain::stop_flag::StopFlag;
    use std::sync::Arc;

    const COLUMNS: u32 = 60;
    const ROWS: u32 = 50;

    /// Rough ground with a hole, posts 10 m apart, its south-west post at 500000,4000000.
    fn rough() -> Raster {
        let height = |at: u32| match (at % COLUMNS, at / COLUMNS) {
            (31, 22) => f32::NAN,
            (column, row) => ((column * 31 + row * 17 + column * row) % 23) as f32 * 0.7,
        };
        let north_west = DVec2::new(500_000.0, 4_000_000.0 + f64::from(ROWS - 1) * 10.0);
        Raster::new(COLUMNS, Samples::F32((0..COLUMNS * ROWS).map(height).collect()))
            .placed(north_up_nodes(north_west, DVec2::splat(10.0)))
    }

    fn kept() -> Dataset {
        Dataset::from_raster("rough", Arc::new(rough()))
    }

    fn on_disk() -> Dataset {
        Dataset::from_windows("rough", WindowedElevation::new(Box::new(rough())))
    }

    fn analyzed(dataset: &Dataset, kind: &str, arguments: &[(&str, &str)]) -> Result<Analyzed, AnalyzeError> {
        let kind = sandtable_catalog::kind(kind).expect("a kind");
        let written = |&(name, text): &(&str, &str)| WrittenArgument { name: name.into(), text: text.into() };
        let written: Vec<WrittenArgument> = arguments.iter().map(written).collect();
        let land = bare_land(dataset, (kind, &written), &dataset.crs())?;
        analyze(dataset, land, (kind, &written), &dataset.crs(), &StopFlag::default())
    }

    fn value_bits(analyzed: &Analyzed, post: Post) -> u32 {
        let raster = analyzed.outcome.raster.as_ref().expect("a raster");
        raster.values.value(analyzed.ground.index(post)).to_bits()
    }

    fn refusal(extent: &str) -> String {
        let refused = analyzed(&kept(), "slope", &[("extent", extent)]).err().expect("refused");
        refused.to_string()
    }

    /// Posts 20 to 40 eastward and 15 to 30 northward.
    const PART: &str = "500200,4000150,500400,4000300";

    #[test]
    fn within_an_extent_a_kind_has_the_bits_of_the_whole_kept_or_on_disk() {
        for kind in ["slope", "curvature", "ruggedness", "geomorphons", "obstacles", "speed"] {
            let whole = analyzed(&kept(), kind, &[]).expect(kind);
            for dataset in [kept(), on_disk()] {
                let part = analyzed(&dataset, kind, &[("extent", PART)]).expect(kind);
                assert_eq!((part.ground.columns(), part.ground.rows()), (21, 16), "{kind}");
                for post in part.ground.posts() {
                    let in_whole = post.offset(20, 15);
                    assert_eq!(part.ground.map_position(post), whole.ground.map_position(in_whole));
                    assert_eq!(value_bits(&part, post), value_bits(&whole, in_whole), "{kind} {post:?}");
                }
            }
        }
    }

    #[test]
    fn without_an_extent_all_of_the_land_on_disk_is_analyzed() {
        let found = analyzed(&on_disk(), "slope", &[]).expect("an outcome");
        assert_eq!((found.ground.columns(), found.ground.rows()), (COLUMNS, ROWS));
    }

    #[test]
    fn figures_are_those_of_the_extent_and_not_of_the_ground_around_it() {
        let part = analyzed(&kept(), "obstacles", &[("extent", PART)]).expect("an outcome");
        let figure = |index: usize| part.outcome.figures[index].value;
        let raster = part.outcome.raster.as_ref().expect("a raster");
        let of_code = |code: f32| {
            (0..raster.values.len()).filter(|&index| raster.values.value(index) == code).count() as f64
        };
        for (figure_at, code) in [(0, 0.0), (2, 1.0), (4, 2.0)] {
            assert!((figure(figure_at) - of_code(code) * 1e-4).abs() < 1e-12, "{code}");
        }
        assert!(of_code(0.0) + of_code(1.0) + of_code(2.0) > 300.0);
    }

    #[test]
    fn in_an_area_values_outside_its_ring_are_no_data() {
        let triangle = "500200,4000150; 500400,4000150; 500200,4000350";
        let part = analyzed(&kept(), "slope", &[("extent", triangle)]).expect("an outcome");
        let valid = |post| !f32::from_bits(value_bits(&part, post)).is_nan();
        assert!(valid(Post { column: 1, row: 1 }) && valid(Post { column: 9, row: 9 }));
        assert!(!valid(Post { column: 11, row: 11 }) && !valid(Post { column: 20, row: 20 }));
    }

    #[test]
    fn for_a_kind_that_reaches_everywhere_the_land_ends_at_the_extent() {
        let whole = analyzed(&kept(), "contours", &[("interval", "5")]).expect("an outcome");
        let part =
            analyzed(&on_disk(), "contours", &[("interval", "5"), ("extent", PART)]).expect("an outcome");
        assert!(!part.outcome.features.is_empty());
        assert!(part.outcome.features.len() < whole.outcome.features.len());
        assert_eq!(part.ground.map_extent().min, DVec2::new(500_200.0, 4_000_150.0));
        assert_eq!(part.ground.map_extent().max, DVec2::new(500_400.0, 4_000_300.0));
    }

    #[test]
    fn an_extent_off_the_land_or_between_posts_is_refused_by_its_name() {
        let off = refusal("0,0,10,10");
        assert!(
            off.starts_with("`extent` ") && off.contains("from 500000,4000000 to 500590,4000490"),
            "{off}"
        );
        assert!(refusal("500001,4000001,500009,4000009").contains("fewer than two posts a side"));
        assert!(refusal("500200,4000150").contains("one position"));
        assert!(refusal("here").starts_with("`extent`: "));
        assert!(refusal("500200,4000150,NaN,4000300").starts_with("`extent`: "));
    }

    #[test]
    fn an_extent_beyond_the_land_is_cut_there_with_a_note() {
        let found = analyzed(&kept(), "slope", &[("extent", "499000,4000000,500100,4000100")]).expect("part");
        assert_eq!((found.ground.columns(), found.ground.rows()), (11, 11));
        assert!(found.outcome.notes.iter().any(|note| note.contains("beyond the land")));
        let at_border = analyzed(&kept(), "slope", &[("extent", "500000,4000000,500100,4000100")]);
        assert!(at_border.expect("part").outcome.notes.is_empty());
    }

    proptest::proptest! {
        #[test]
        fn no_text_breaks_an_extent(text in "[-0-9.,;e ]{0,40}|\\PC{0,30}") {
            let ground = Lattice::from_raster(&rough()).expect("north up");
            if let Ok(extent) = parse(&text, &Crs::local(), &Crs::local())
                && let Ok(posts) = extent.posts(&ground)
            {
                assert!(posts.last.column < COLUMNS && posts.last.row < ROWS);
                let part = ground_part(&Arc::new(ground), posts);
                let _ = part.map(|part| extent.masked(Land::bare(part, Crs::local())));
            }
        }

        #[test]
        fn corners_of_any_size_give_posts_of_the_land_or_a_reason(
            corners in proptest::array::uniform4(-1e3_f64..1e3), scale in -3_i32..300,
        ) {
            let ground = Lattice::from_raster(&rough()).expect("north up");
            let of = |index: usize| ground.origin()[index % 2] + corners[index] * 10_f64.powi(scale);
            let text = format!("{},{},{},{}", of(0), of(1), of(2), of(3));
            if let Ok(extent) = parse(&text, &Crs::local(), &Crs::local()) {
                match extent.posts(&ground) {
                    Ok(posts) => assert!(posts.last.column < COLUMNS && posts.last.row < ROWS),
                    Err(reason) => assert!(!reason.is_empty()),
                }
            }
        }
    }

    #[test]
    fn grid_references_and_degrees_state_an_extent_of_land_in_meters() {
        let zone = Crs::from_epsg(32616).expect("known");
        let by_grid = parse("16S GF 50000 18000; 16S GF 51000 18500", &zone, &zone).expect("sound");
        assert_eq!(by_grid.bounds().size(), DVec2::new(1000.0, 500.0));
        let degrees = parse("-84.2,36.3,-84.1,36.35", &Crs::wgs84(), &zone).expect("sound");
        for corner in [[-84.2, 36.3], [-84.1, 36.35], [-84.2, 36.35], [-84.1, 36.3]] {
            let on_land = Crs::wgs84().transform(&zone, DVec2::from(corner)).expect("in the zone");
            assert!(degrees.bounds().grown(1e-6).contains(on_land), "{corner:?}");
        }
    }
}
