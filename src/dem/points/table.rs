//! Points as text (`.xyz`, `.csv`, `.txt`): a point a line, with or without a header that names the columns.
//!
//! A point without a height (an empty field, NaN, or a word such as `null`) and a line that is no point are left out and told; a
//! file with as many wrong lines as points is refused with the first of them.

use crate::point_text::PointText;
use crate::points::cloud::{PointCloud, PointHints};
use crate::points::error::PointsError;
use crate::wrong_lines::WrongLines;
use sandtable_base::limits::GRID_POINTS;
use sandtable_base::message::numbers::counted;

/// Reads a table of points.
///
/// # Errors
/// [`PointsError`] for a file with as many lines that are no points as points, a header without x, y or z, and a file without
/// points.
pub fn read(bytes: &[u8], hints: &PointHints) -> Result<PointCloud, PointsError> {
    let text = std::str::from_utf8(bytes).map_err(|error| PointsError::NotText(error.valid_up_to()))?;
    let text = PointText::new(text);
    let columns = match (text.columns, text.header) {
        ([Some(x), Some(y), Some(z)], _) => [x, y, z],
        (_, header) => {
            let (line, found) = header.map_or((1, String::new()), |header| (header.number, header.quote()));
            return Err(PointsError::Columns { line, found });
        }
    };
    let mut points = Vec::new();
    let mut without_height = 0usize;
    let mut wrong = WrongLines::default();
    for line in text.lines() {
        match line.point(columns) {
            Some(point) if point.z.is_nan() => without_height += 1,
            Some(point) if point.z.is_finite() => points.push(point),
            _ => wrong.add(&line),
        }
        if points.len() as u64 > GRID_POINTS.get() {
            return Err(PointsError::TooMany(points.len() as u64));
        }
    }
    if let Some((line, found)) = wrong.refused(points.len() + without_height) {
        return Err(PointsError::Line { line, found });
    }
    if points.is_empty() {
        return Err(PointsError::Empty(without_height));
    }
    let left_out = format!(
        "{} left out",
        counted(without_height, "point without a height was", "points without a height were")
    );
    let notes = wrong.note().into_iter().chain((without_height > 0).then_some(left_out)).collect();
    Ok(PointCloud { crs: hints.crs.cloned(), notes, ..PointCloud::new(points) })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn points(text: &str) -> Result<Vec<DVec3>, String> {
        read(text.as_bytes(), &PointHints::default())
            .map(|cloud| cloud.points)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn points_come_with_or_without_a_header_in_any_columns_and_separators() {
        let expected = vec![DVec3::new(1.5, 2.0, 7.0), DVec3::new(-3.0, 4e3, 8.25)];
        for text in [
            "1.5,2,7\n-3,4e3,8.25\n",
            "\u{feff}x,y,z\r\n1.5,2,7\r\n\r\n-3,4e3,8.25",
            "id;lat;lon;elevation\n7;2;1,5;7\n8;4e3;-3;8,25",
            "# surveyed\n1.5  2\t7\n// more\n -3 4e3 8.25",
            "\"z\",\"x\",\"y\"\n7,1.5,2\n8.25,-3,4000",
        ] {
            assert_eq!(points(text), Ok(expected.clone()), "{text}");
        }
    }

    #[test]
    fn as_many_lines_that_are_no_points_as_points_are_refused_with_the_number_of_the_first() {
        for (text, wanted) in [
            ("x,y,z\n1,2,3\n3,north,1\n", "line 3: found '3,north,1'"),
            ("1 2 3\n4 5\n", "line 2: found '4 5'"),
            ("1,2,3\ninf,2,3", "line 2"),
            ("x,y,depth\n1,2,3", "line 1: the header 'x,y,depth'"),
            ("", "no points"),
            ("x y z\n", "no points"),
        ] {
            let refused = points(text).expect_err(text);
            assert!(refused.contains(wanted), "{refused}");
        }
        assert!(read(b"1 2 3\n\xff\xfe", &PointHints::default()).is_err());
    }

    #[test]
    fn a_line_that_is_no_point_among_others_is_left_out_and_told() {
        let text = b"x,y,z\n1,2,3\n3,north,1\n4,5,6\n7,8,inf\n7,8,9\n";
        let cloud = read(text, &PointHints::default()).expect("three points");
        assert_eq!(cloud.points.len(), 3);
        let told = "left out: 2 lines that are no points: line 3 is '3,north,1', line 5 is '7,8,inf'";
        assert_eq!(cloud.notes, [told]);
    }

    #[test]
    fn points_without_a_height_are_left_out_and_counted() {
        let text = b"x,y,z\n1,2,3\n4,5,\n6,7,nan\n8,9,null\n";
        let cloud = read(text, &PointHints::default()).expect("one point");
        assert_eq!(cloud.points.len(), 1);
        assert_eq!(cloud.notes, ["3 points without a height were left out"]);
    }
}
