//! Grids written as text, a point a line (`.xyz`, `.csv`, `.txt`): `x y z`, as GDAL's XYZ driver reads them.
//!
//! Read twice: first the bounds and the steps between neighboring lines, the small ones of which are the cell, since
//! lines run along rows or columns; then every point is set on its node. Points in any order, and nodes without a point (no
//! data), are taken; points off the nodes are not: they are scattered, and want interpolating.
//!
//! Numbers stand apart by blanks, tabs, semicolons or commas; a first line of names says which are x, y and z, and
//! lines that start with `#` are passed over.

use glam::DVec2;

use crate::dem::error::{DemErrorKind, MOST_SAMPLES};
use crate::dem::formats::ascii::number;
use crate::dem::raster::{Raster, Samples, north_up};
use crate::dem::read::DemFile;

const FORMAT: &str = "XYZ grid";

/// The extensions that such grids have.
pub(crate) const EXTENSIONS: [&str; 4] = ["xyz", "csv", "txt", "tsv"];

/// How far from its node a point may lie, in cells: rounded decimals of degrees are a few thousandths off.
const OFF_NODE: f64 = 0.01;

/// At least one node in so many must have a point. Scattered points at whole meters stand on nodes as well, but on
/// few of them; a catchment cut from a grid fills a third of its rectangle.
const SPARSEST: u64 = 5;

/// Steps that are looked at for the cell: many rows' worth.
const MOST_STEPS: usize = 1 << 16;

/// The remedy for points that are no grid.
const SCATTERED: &str = "make a grid of them with: sandtable dem grid POINTS OUT.tif --cell METERS";

/// Reads a grid; its coordinate system comes from a `.prj` companion.
pub(crate) fn read(source: &DemFile) -> Result<Raster, DemErrorKind> {
    let text = std::str::from_utf8(source.bytes).map_err(|error| {
        DemErrorKind::broken(FORMAT, format!("byte {} is not UTF-8 text", error.valid_up_to()))
    })?;
    let text = XyzLines::new(text);
    let survey = XyzSurvey::of(&text)?;
    let lattice = survey.lattice()?;
    let XyzGrid { values, whole, low, high } = place(&text, &lattice)?;
    let corner = DVec2::new(lattice.min.x, lattice.max.y) + DVec2::new(-0.5, 0.5) * lattice.cell;
    Ok(Raster {
        driver: "XYZ",
        data_type: match (whole, low, high) {
            (true, 0.0.., ..=255.0) => "Byte",
            (true, -32_768.0.., ..=32_767.0) => "Int16",
            (true, ..) => "Int32",
            _ => "Float32",
        },
        width: lattice.columns as u32,
        height: lattice.rows as u32,
        samples: Samples::F32(values),
        meters_per_z: 1.0,
        map_from_grid: north_up(corner, lattice.cell),
        georeferenced: true,
        crs: source.crs_beside()?,
        nodata: None,
        vertical_datum: None,
    })
}

/// A text of points.
struct XyzLines<'a> {
    text: &'a str,
    /// Lines before the first point.
    skip: usize,
    /// Which of a line's numbers are x, y and z.
    columns: [usize; 3],
}

impl<'a> XyzLines<'a> {
    fn new(text: &'a str) -> Self {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let (mut skip, mut columns) = (0, [0, 1, 2]);
        let first = text.lines().enumerate().find(|(_, line)| is_content(line));
        if let Some((index, line)) =
            first.filter(|(_, line)| words(line).any(|word| number(word.as_bytes()).is_none()))
        {
            skip = index + 1;
            let names: Vec<String> =
                words(line).map(|name| name.trim_matches('"').to_ascii_lowercase()).collect();
            let named = |known: &[&str]| names.iter().position(|name| known.contains(&name.as_str()));
            columns = [
                named(&["x", "lon", "long", "longitude", "east", "easting"]).unwrap_or(0),
                named(&["y", "lat", "latitude", "north", "northing"]).unwrap_or(1),
                named(&["z", "alt", "altitude", "height", "elevation", "elev"]).unwrap_or(2),
            ];
        }
        Self { text, skip, columns }
    }

    /// The points with the number of their line, from 1.
    fn points(&self) -> impl Iterator<Item = Result<(DVec2, f64), DemErrorKind>> {
        let lines = self.text.lines().enumerate().skip(self.skip).filter(|(_, line)| is_content(line));
        lines.map(|(index, line)| {
            let wrong = || {
                let shown: String = line.chars().take(40).collect();
                DemErrorKind::broken(FORMAT, format!("line {} is '{shown}', not x, y and z", index + 1))
            };
            let [x, y, z] =
                self.columns.map(|column| words(line).nth(column).and_then(|word| number(word.as_bytes())));
            let (Some(x), Some(y), Some(z)) = (x, y, z) else { return Err(wrong()) };
            let at = DVec2::new(x, y);
            if at.is_finite() { Ok((at, z)) } else { Err(wrong()) }
        })
    }
}

fn is_content(line: &str) -> bool {
    let line = line.trim();
    !line.is_empty() && !line.starts_with('#')
}

/// The parts of a line: between semicolons, or blanks, or else commas, which elsewhere may be decimal.
fn words(line: &str) -> impl Iterator<Item = &str> {
    let by_semicolons = line.contains(';');
    let by_blanks = !by_semicolons && line.split_ascii_whitespace().nth(2).is_some();
    let is_between = move |letter: char| match (by_semicolons, by_blanks) {
        (true, _) => letter == ';',
        (_, true) => letter.is_ascii_whitespace(),
        _ => letter == ',',
    };
    let strip = move |word: &'_ str| if by_blanks { word.trim_end_matches(',').len() } else { word.len() };
    line.split(is_between)
        .map(move |word| word[..strip(word)].trim())
        .filter(move |word| !by_blanks || !word.is_empty())
}

/// What the first reading tells.
struct XyzSurvey {
    points: u64,
    min: DVec2,
    max: DVec2,
    step: DVec2,
}

impl XyzSurvey {
    fn of(text: &XyzLines) -> Result<Self, DemErrorKind> {
        let (mut points, mut min, mut max) = (0u64, DVec2::INFINITY, DVec2::NEG_INFINITY);
        let mut before: Option<DVec2> = None;
        let mut steps: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
        for point in text.points() {
            let (at, _) = point?;
            points += 1;
            (min, max) = (min.min(at), max.max(at));
            let step = before.map_or(DVec2::ZERO, |before| (at - before).abs());
            for (steps, step) in steps.iter_mut().zip(step.to_array()) {
                if step > 0.0 && steps.len() < MOST_STEPS {
                    steps.push(step);
                }
            }
            before = Some(at);
        }
        let [x, y] = steps.map(small_step);
        Ok(Self { points, min, max, step: DVec2::new(x, y) })
    }

    fn lattice(&self) -> Result<XyzLattice, DemErrorKind> {
        if self.points == 0 {
            return Err(DemErrorKind::broken(FORMAT, "it holds no point"));
        }
        if self.step.min_element() == 0.0 {
            return Err(scattered("all of its points stand in one line".into()));
        }
        let sides = ((self.max - self.min) / self.step).round();
        let nodes = (sides.x + 1.0) * (sides.y + 1.0);
        let (columns, rows) = (sides.x as u64 + 1, sides.y as u64 + 1);
        if nodes > MOST_SAMPLES as f64 || nodes > (self.points.saturating_mul(SPARSEST)) as f64 {
            let step = self.step;
            let reason =
                format!("{} points on {columns} x {rows} nodes, {} by {} apart", self.points, step.x, step.y);
            return Err(scattered(reason));
        }
        let cell = (self.max - self.min) / sides;
        Ok(XyzLattice { columns, rows, min: self.min, max: self.max, cell })
    }
}

/// The step that a tenth of all are shorter than; 0 where there is none. Steps are whole multiples of the cell, longer
/// ones where rows end and where nodes are left out; the very shortest may be a slip of the last decimal.
fn small_step(mut steps: Vec<f64>) -> f64 {
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 10).copied().unwrap_or(0.0)
}

fn scattered(found: String) -> DemErrorKind {
    DemErrorKind::Georeference { reason: format!("its points are no grid: {found}"), remedy: SCATTERED }
}

struct XyzLattice {
    columns: u64,
    rows: u64,
    min: DVec2,
    max: DVec2,
    cell: DVec2,
}

/// What the second reading gives.
struct XyzGrid {
    values: Vec<f32>,
    whole: bool,
    low: f64,
    high: f64,
}

fn place(text: &XyzLines, lattice: &XyzLattice) -> Result<XyzGrid, DemErrorKind> {
    let (columns, rows) = (lattice.columns as usize, lattice.rows as usize);
    let mut placed = XyzGrid {
        values: vec![f32::NAN; columns * rows],
        whole: true,
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
    };
    for point in text.points() {
        let (at, height) = point?;
        let grid = DVec2::new(at.x - lattice.min.x, lattice.max.y - at.y) / lattice.cell;
        let node = grid.round();
        if (grid - node).abs().max_element() > OFF_NODE {
            return Err(scattered(format!("({}, {}) lies between nodes that others stand on", at.x, at.y)));
        }
        let index = (node.y as usize).min(rows - 1) * columns + (node.x as usize).min(columns - 1);
        let old = f64::from(placed.values[index]);
        if old.is_finite() && old != f64::from(height as f32) {
            return Err(scattered(format!("({}, {}) has the heights {old} and {height}", at.x, at.y)));
        }
        if height.is_finite() {
            placed.values[index] = height as f32;
            placed.whole &= height.fract() == 0.0;
            (placed.low, placed.high) = (placed.low.min(height), placed.high.max(height));
        }
    }
    Ok(placed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::read::{DemHints, read};

    fn grid(text: &str) -> Result<Raster, String> {
        read("a.xyz", text.as_bytes(), &DemHints::default()).map_err(|error| error.to_string())
    }

    #[test]
    fn rows_and_columns_in_any_order_make_the_same_grid() {
        let rows = grid("0 10 1\n5 10 2\n0 0 3\n5 0 4\n").expect("by rows");
        let columns = grid("x;y;z\n0;0;3\n0;10;1\n5;0;4\n5;10;2\n").expect("by columns");
        for raster in [rows, columns] {
            assert_eq!(raster.samples, Samples::F32(vec![1.0, 2.0, 3.0, 4.0]));
            assert_eq!(raster.geotransform(), [-2.5, 5.0, 0.0, 15.0, 0.0, -10.0]);
            assert_eq!(raster.data_type, "Byte");
        }
    }

    #[test]
    fn numbers_stand_apart_in_every_usual_way() {
        for text in [
            "# made by hand\n0,10,1.5\n5,10,2\n0,0,3\n5,0,4",
            "0, 10, 1.5\n5, 10, 2\n0, 0, 3\n5, 0, 4",
            "0\t10\t1,5\r\n5\t10\t2\r\n0\t0\t3\r\n5\t0\t4\r\n",
            "height,lat,lon\n1.5,10,0\n2,10,5\n3,0,0\n4,0,5",
        ] {
            let raster = grid(text).expect(text);
            assert_eq!(raster.samples, Samples::F32(vec![1.5, 2.0, 3.0, 4.0]), "{text}");
        }
    }

    #[test]
    fn a_node_without_a_point_is_no_data() {
        let raster = grid("0 10 1\n5 10 2\n10 10 3\n0 0 4\n10 0 -1").expect("a grid");
        assert!(raster.at(1, 1).is_nan() && raster.at(2, 1) == -1.0 && raster.data_type == "Int16");
    }

    #[test]
    fn scattered_points_are_refused_with_what_makes_a_grid_of_them() {
        for text in [
            "0 0 1\n3 1 2\n7 9 3\n2 6 4\n9 4 5",
            "0 0 1\n1 0 2\n2.3 0 3\n0 1 1\n1 1 2\n2 1 3",
            "0 0 1\n1 0 2\n0 1 1\n1 1 2\n0 0 7",
            "0 0 1\n0 1 2\n0 2 3",
            "1 2 3",
        ] {
            let refused = grid(text).expect_err(text);
            assert!(refused.contains("sandtable dem grid"), "{refused}");
        }
    }

    #[test]
    fn what_is_no_text_of_points_is_refused_with_the_line() {
        assert!(grid("0 0 1\n5 0\n").expect_err("short").contains("line 2 is '5 0'"));
        assert!(grid("0 0 1\n5 0 deep\n").expect_err("a word").contains("line 2"));
        assert!(grid("# nothing\n").expect_err("empty").contains("no point"));
        assert!(read("a.xyz", &[0xff, 0xfe], &DemHints::default()).is_err());
    }
}
