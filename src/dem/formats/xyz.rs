//! Grids as text, a point a line (`.xyz`, `.csv`, `.txt`): `x y z`, as GDAL's XYZ driver reads them.
//!
//! Two passes: the first finds the bounds and the steps between neighboring lines, the small ones of which are the
//! cell, since lines run along rows or columns; the second sets every point on its node. Points in any order and nodes
//! without a point (no data) are taken; points off the nodes are scattered and must be interpolated instead. A line that is no
//! point is left out and told.

use glam::{DVec2, DVec3, U64Vec2};

use crate::dem_file::DemFile;
use crate::dem_format::{DemFormat, FormatWriter, Recognition, any_size};
use crate::formats::xyz_write::write;
use crate::point_text::{PointLine, PointText};
use crate::wrong_lines::WrongLines;
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{Raster, Samples, north_up_nodes};

pub(super) static FORMAT: DemFormat = DemFormat {
    name: "XYZ grid",
    extensions: &["xyz"],
    shared_extensions: &["csv", "txt", "tsv"],
    recognition: Recognition::Extension,
    reader: read,
    windows: None,
    most_bytes: any_size,
    writer: Some(FormatWriter { extensions: &["xyz"], write }),
    windows_writer: None,
};

/// How far from its node a point may lie, in cells: rounded decimals of degrees are a few thousandths off.
const OFF_NODE: f64 = 0.01;

/// One node in this many must have a point: scattered points at whole meters lie on nodes as well, but on few of
/// them; a catchment cut from a grid fills a third of its rectangle.
const SPARSEST: u64 = 5;

/// The steps that the cell is found from: many rows' worth.
const MOST_STEPS: usize = 1 << 16;

fn read(file: &DemFile) -> Result<Raster, DemErrorKind> {
    let text = std::str::from_utf8(file.bytes)
        .map_err(|error| FORMAT.broken(format!("byte {} is not UTF-8 text", error.valid_up_to())))?;
    let text = PointText::new(text);
    let mut wrong = WrongLines::default();
    let lattice = XyzLattice::find(&text, &mut wrong)?;
    let XyzGrid { values, are_whole, low, high, without_height } = XyzGrid::fill(&text, &lattice)?;
    let left_out = format!("{without_height} of its points have no height, and there is no data");
    let north_west = DVec2::new(lattice.min.x, lattice.max.y);
    Ok(Raster {
        driver: "XYZ",
        data_type: match (are_whole, low, high) {
            (true, 0.0.., ..=255.0) => "Byte",
            (true, -32_768.0.., ..=32_767.0) => "Int16",
            (true, ..) => "Int32",
            _ => "Float32",
        },
        crs: file.crs()?,
        notes: wrong.note().into_iter().chain((without_height > 0).then_some(left_out)).collect(),
        ..Raster::new(lattice.columns as u32, Samples::F32(values))
            .placed(north_up_nodes(north_west, lattice.cell))
    })
}

/// The points of a text; `wrong` is called with the lines that are none.
fn points<'a>(
    text: &'a PointText<'_>,
    mut wrong: impl FnMut(&PointLine<'_>) + 'a,
) -> impl Iterator<Item = DVec3> + 'a {
    let columns = [0, 1, 2].map(|index| text.columns[index].unwrap_or(index));
    text.lines().filter_map(move |line| {
        let point = line.point(columns);
        if point.is_none() {
            wrong(&line);
        }
        point
    })
}

/// The smallest steps between neighboring lines along one axis, but for 0.
#[derive(Default)]
struct Steps(Vec<f64>);

impl Steps {
    fn add(&mut self, step: f64) {
        if step > 0.0 && self.0.len() < MOST_STEPS {
            self.0.push(step);
        }
    }

    /// The step that a tenth of all are shorter than; 0 where there is none. Steps are whole multiples of the cell,
    /// longer ones where rows end and nodes are left out; the very shortest may be a slip of the last decimal.
    fn small(mut self) -> f64 {
        self.0.sort_by(f64::total_cmp);
        self.0.get(self.0.len() / 10).copied().unwrap_or(0.0)
    }
}

struct XyzLattice {
    columns: u64,
    rows: u64,
    min: DVec2,
    max: DVec2,
    cell: DVec2,
}

impl XyzLattice {
    /// The lattice of the points of a text; lines that are none are added to `wrong`.
    fn find(text: &PointText<'_>, wrong: &mut WrongLines) -> Result<Self, DemErrorKind> {
        let (mut count, mut min, mut max) = (0u64, DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (mut x_steps, mut y_steps) = (Steps::default(), Steps::default());
        let mut before: Option<DVec2> = None;
        for point in points(text, |line| wrong.add(line)) {
            let at = point.truncate();
            count += 1;
            (min, max) = (min.min(at), max.max(at));
            let step = before.map_or(DVec2::ZERO, |before| (at - before).abs());
            x_steps.add(step.x);
            y_steps.add(step.y);
            before = Some(at);
        }
        let step = DVec2::new(x_steps.small(), y_steps.small());
        if let Some((line, found)) = wrong.refused(usize::try_from(count).unwrap_or(usize::MAX)) {
            return Err(FORMAT.broken(format!("line {line} is '{found}', not x, y and z")));
        }
        if count == 0 {
            return Err(FORMAT.broken("it holds no point"));
        }
        if step.min_element() == 0.0 {
            return Err(scattered("all of its points lie on one line".into()));
        }
        let sides = ((max - min) / step).round();
        let nodes = (sides.x + 1.0) * (sides.y + 1.0);
        // Far apart, their distance may be infinite and the number of nodes no number.
        if nodes.is_nan() || nodes > count.saturating_mul(SPARSEST) as f64 {
            let [columns, rows] = [sides.x + 1.0, sides.y + 1.0];
            let apart = format!("{} by {} apart", step.x, step.y);
            return Err(scattered(format!("{count} points on {columns} x {rows} nodes, {apart}")));
        }
        let (columns, rows) = (sides.x as u64 + 1, sides.y as u64 + 1);
        if columns.saturating_mul(rows) > RASTER_SAMPLES.get() {
            return Err(DemErrorKind::TooLarge { size: U64Vec2::new(columns, rows), most: &RASTER_SAMPLES });
        }
        Ok(Self { columns, rows, min, max, cell: (max - min) / sides })
    }
}

fn scattered(found: String) -> DemErrorKind {
    DemErrorKind::Georeference {
        reason: format!("its points are no grid: {found}"),
        remedy: "make a grid of them with: sandtable dem grid POINTS OUT.tif --cell METERS",
    }
}

struct XyzGrid {
    values: Vec<f32>,
    are_whole: bool,
    low: f64,
    high: f64,
    without_height: u64,
}

impl XyzGrid {
    fn fill(text: &PointText<'_>, lattice: &XyzLattice) -> Result<Self, DemErrorKind> {
        let (columns, rows) = (lattice.columns as usize, lattice.rows as usize);
        let values = vec![f32::NAN; columns * rows];
        let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut grid = Self { values, are_whole: true, low, high, without_height: 0 };
        for DVec3 { x, y, z } in points(text, |_| ()) {
            let at = DVec2::new(x - lattice.min.x, lattice.max.y - y) / lattice.cell;
            let node = at.round();
            if (at - node).abs().max_element() > OFF_NODE {
                return Err(scattered(format!("({x}, {y}) lies between the nodes of others")));
            }
            let index = (node.y as usize).min(rows - 1) * columns + (node.x as usize).min(columns - 1);
            let old = f64::from(grid.values[index]);
            if old.is_finite() && old != f64::from(z as f32) {
                return Err(scattered(format!("({x}, {y}) has the heights {old} and {z}")));
            }
            if z.is_finite() {
                grid.values[index] = z as f32;
                grid.are_whole &= z.fract() == 0.0;
                (grid.low, grid.high) = (grid.low.min(z), grid.high.max(z));
            } else {
                grid.without_height += 1;
            }
        }
        Ok(grid)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hints::DemHints;
    use crate::read::read;

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
        assert!(raster.notes.is_empty());
    }

    #[test]
    fn a_point_whose_height_is_a_word_for_none_is_no_data_and_is_told() {
        let raster = grid("0 10 1\n5 10 null\n0 0 NaN\n5 0 4\n").expect("a grid");
        assert!(raster.at(1, 0).is_nan() && raster.at(0, 1).is_nan() && raster.at(1, 1) == 4.0);
        assert!(raster.notes[0].starts_with("2 of its points have no height"), "{:?}", raster.notes);
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
    fn points_too_far_apart_for_any_number_of_nodes_are_refused() {
        // A line that lost its end, so that two numbers ran together; positions whose distance is no number.
        for text in [
            "440750 3751290 107\n440810 3751290 123\n440870 375121249879465922 2171\n-113.0 37.4 2131\n-113.1 37.4 1873",
            "0 0 1\n1e-300 0 2\n1e300 0 3\n0 1e-300 4\n0 1e300 5",
            "-1e308 0 1\n1e308 0 2\n-1e308 1e308 3\n1e308 -1e308 4",
        ] {
            let refused = grid(text).expect_err(text);
            assert!(refused.contains("nodes") && refused.contains("sandtable dem grid"), "{refused}");
        }
    }

    #[test]
    fn a_line_that_is_no_point_leaves_its_node_without_data_and_is_told() {
        let raster = grid("0 10 1\n5 10 2\n0 0\n5 0 4\n").expect("a grid");
        assert!(raster.at(0, 1).is_nan() && raster.at(1, 1) == 4.0);
        assert_eq!(raster.notes, ["left out: 1 line that is no point: line 3 is '0 0'"]);
    }

    #[test]
    fn what_is_no_text_of_points_is_refused_with_the_line() {
        assert!(grid("0 0 1\n5 0\n").expect_err("short").contains("line 2 is '5 0'"));
        assert!(grid("0 0 1\n5 0 deep\n").expect_err("a word").contains("line 2"));
        assert!(grid("# nothing\n").expect_err("empty").contains("no point"));
        assert!(read("a.xyz", &[0xff, 0xfe], &DemHints::default()).is_err());
    }
}
