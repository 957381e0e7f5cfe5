//! Positions and lines as users name them: on the command line, in a CSV file, or as the line of a vector file.

use std::path::Path;
use std::str::FromStr;

use glam::DVec2;

use crate::app::dataset::Dataset;
use crate::app::failure::CliError;
use crate::app::files;
use crate::app::points::parse_points;
use crate::geom::crs::Crs;
use crate::vector::hints::VectorHints;
use crate::vector::read;

/// One or more `X,Y` with spaces between them, as written on the command line; all finite.
#[derive(Clone, Debug, PartialEq)]
pub struct PositionList(pub Vec<DVec2>);

/// `X,Y` or `X,Y,H`: a position and meters above the ground there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observer {
    /// The position.
    pub at: DVec2,
    /// Meters above the ground, where they are given.
    pub above_m: Option<f64>,
}

impl FromStr for PositionList {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let position = |text: &str| match numbers(text).as_deref() {
            Some(&[x, y]) => Some(DVec2::new(x, y)),
            _ => None,
        };
        let positions: Option<Vec<DVec2>> = text.split_whitespace().map(position).collect();
        match positions {
            Some(positions) if !positions.is_empty() => Ok(Self(positions)),
            _ => Err("write positions as X,Y, for example 731500,4017200".into()),
        }
    }
}

impl FromStr for Observer {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match numbers(text).as_deref() {
            Some(&[x, y]) => Ok(Self { at: DVec2::new(x, y), above_m: None }),
            Some(&[x, y, above_m]) => Ok(Self { at: DVec2::new(x, y), above_m: Some(above_m) }),
            _ => Err("write a position as X,Y or, with meters above the ground, X,Y,H".into()),
        }
    }
}

/// Finite numbers between commas.
fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split(',')
        .map(|number| number.trim().parse().ok().filter(|number: &f64| number.is_finite()))
        .collect()
}

/// A line and the system of its coordinates.
#[derive(Clone, Debug)]
pub struct InputLine {
    /// Its vertices, at least two.
    pub vertices: Vec<DVec2>,
    /// What they are coordinates of.
    pub crs: Crs,
}

/// The system that `--crs` names, if it is given.
///
/// # Errors
/// There is no such system.
pub fn stated_crs(text: Option<&str>) -> Result<Option<Crs>, CliError> {
    text.map(Crs::parse).transpose().map_err(|error| CliError::Usage(format!("--crs: {error}")))
}

/// A position in the ground's system.
///
/// # Errors
/// It cannot be expressed there; `name` is what the user calls it.
pub fn on_ground(name: &str, from: &Crs, ground: &Crs, at: DVec2) -> Result<DVec2, CliError> {
    from.transform(ground, at).map_err(|error| CliError::input(format!("{name} {},{}: {error}", at.x, at.y)))
}

/// The line in the file at `path` (`-` for standard input): the vertices of a CSV text in their order, or the first line
/// of a vector file. `stated` is the system of its coordinates, where the user says one; without it a vector file's is its
/// own, and that of a CSV text the dataset's.
///
/// # Errors
/// The file cannot be had or read, or holds no line.
pub fn read_way(path: &Path, stated: Option<Crs>, dataset: &Dataset) -> Result<InputLine, CliError> {
    let is_csv = path.extension().is_none_or(|extension| {
        ["csv", "txt", "xy", "xyz"].iter().any(|known| extension.eq_ignore_ascii_case(known))
    });
    if !is_csv {
        return vector_way(path, stated);
    }
    let text = files::read_text(path)?;
    let points = parse_points(&files::text_name(path), &text)?;
    let vertices: Vec<DVec2> = points.iter().map(|point| point.at).collect();
    if vertices.len() < 2 {
        let found = vertices.len();
        let name = files::text_name(path);
        return Err(CliError::input(format!("{name}: a line needs at least two positions, found {found}")));
    }
    Ok(InputLine { vertices, crs: stated.unwrap_or_else(|| dataset.crs()) })
}

fn vector_way(path: &Path, stated: Option<Crs>) -> Result<InputLine, CliError> {
    let wrong = |reason: String| CliError::input(format!("{}: {reason}", path.display()));
    let bytes = files::read(path)?;
    let beside = files::beside(path);
    let name = path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    let hints = VectorHints { crs: stated.as_ref(), layer: None, companions: &beside };
    let layer = read::read(&name, &bytes, &hints).map_err(|error| wrong(error.to_string()))?;
    let line = layer.features.iter().find_map(|feature| feature.lines().first().cloned());
    match line {
        Some(vertices) => Ok(InputLine { vertices, crs: layer.crs }),
        None => Err(wrong("it holds no line; a profile follows the first line of a vector file".into())),
    }
}

/// `x, y` as a reader wants them: degrees to a meter or so, meters to the meter.
pub fn spoken(crs: &Crs, at: DVec2) -> String {
    let decimals = if crs.is_geographic() { 5 } else { 0 };
    format!("{:.decimals$}, {:.decimals$}", at.x, at.y)
}

/// Checks that a picture could be written to `path`.
///
/// # Errors
/// The folder is not there, `path` is no file or `input` itself, or its name is that of another format than PNG.
pub fn check_picture_place(path: &Path, input: &Path) -> Result<(), CliError> {
    files::check_picture_place(path, input, "this is the input itself; name another with -o")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_two_finite_numbers_and_stands_may_have_a_height() {
        assert_eq!("1.5,-2e3".parse(), Ok(PositionList(vec![DVec2::new(1.5, -2e3)])));
        let two = vec![DVec2::new(-84.1, 36.2), DVec2::new(-84.0, 36.0)];
        assert_eq!("-84.1,36.2 -84,36".parse(), Ok(PositionList(two)));
        assert_eq!("1,2,30".parse(), Ok(Observer { at: DVec2::new(1.0, 2.0), above_m: Some(30.0) }));
        assert_eq!("1,2".parse(), Ok(Observer { at: DVec2::new(1.0, 2.0), above_m: None }));
        for wrong in ["", "1", "1,2,3,4", "a,b", "NaN,1", "1,inf", "1;2"] {
            assert!(wrong.parse::<PositionList>().is_err() && wrong.parse::<Observer>().is_err(), "{wrong}");
        }
    }
}
