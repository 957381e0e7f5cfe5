//! An OBJ text, checked statement by statement and rewritten to the plain subset that `tobj` reads safely.
//!
//! All indices are made absolute and tested against what the file has defined so far; points, lines,
//! curves and comments are left out. What `tobj` has no place for — materials, smoothing, which corners
//! have what — is kept beside it, one [`ObjFace`] for each face in order.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::model::error::ModelError;
use crate::model::part::MAX_TRIANGLES;

use super::text::logical_lines;

/// What the rewritten text does not say about a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ObjFace {
    /// Position in [`Plain::materials`]; `None` before the first `usemtl`.
    pub material: Option<u32>,
    /// The smoothing group; 0 is off.
    pub smoothing: u32,
    /// Whether all its corners have texture coordinates.
    pub has_uvs: bool,
    /// Whether all its corners have normals.
    pub has_normals: bool,
}

/// A checked file.
#[derive(Clone, Debug, Default)]
pub(super) struct Plain {
    /// The rewritten text: `v`, `vt`, `vn`, `o` and `f` of three or more corners.
    pub text: String,
    /// A record for each `f` in `text`.
    pub faces: Vec<ObjFace>,
    /// Names of materials in the order of their first use.
    pub materials: Vec<String>,
    /// What stands after each `mtllib`.
    pub libraries: Vec<String>,
    /// How many positions there are.
    pub vertices: usize,
    /// How many `f` statements with corners there are, those that cannot be drawn included.
    pub stated_faces: usize,
    /// Whether a smoothing group is ever named.
    pub says_smoothing: bool,
    /// How many point and line statements were left out.
    pub points_and_lines: usize,
}

/// Checks and rewrites `text`.
///
/// # Errors
/// [`ModelError::Obj`] with the line.
pub(super) fn check(text: &str) -> Result<Plain, ModelError> {
    let mut reader = ObjReader { totals: totals(text), ..ObjReader::default() };
    for (number, line) in logical_lines(text) {
        reader.statement(&line).map_err(|reason| ModelError::obj(number, reason))?;
        if reader.corners > MAX_TRIANGLES {
            return Err(ModelError::TooLarge { what: "corners of faces", limit: MAX_TRIANGLES });
        }
    }
    Ok(reader.finish())
}

/// How many positions, texture coordinates and normals the whole file defines: an index counted from the
/// start may name what comes later.
fn totals(text: &str) -> [usize; 3] {
    let mut totals = [0; 3];
    for (_, line) in logical_lines(text) {
        let place = match line.split_whitespace().next() {
            Some("v") => 0,
            Some("vt") => 1,
            Some("vn") => 2,
            _ => continue,
        };
        totals[place] += 1;
    }
    totals
}

#[derive(Default)]
struct ObjReader {
    totals: [usize; 3],
    positions: String,
    colors: Vec<Option<[f32; 3]>>,
    points: Vec<[f32; 3]>,
    uvs: usize,
    normals: usize,
    attributes: String,
    bodies: String,
    material: Option<u32>,
    known_materials: BTreeMap<String, u32>,
    smoothing: u32,
    corners: usize,
    plain: Plain,
}

impl ObjReader {
    fn statement(&mut self, line: &str) -> Result<(), String> {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        match keyword {
            "v" => self.position(rest),
            "vt" => self.texture_coordinate(rest),
            "vn" => self.normal(rest),
            "f" | "fo" => self.face(rest),
            "p" | "l" => {
                self.plain.points_and_lines += 1;
                Ok(())
            }
            "o" | "g" => {
                let name: Vec<&str> = rest.split_whitespace().collect();
                put(&mut self.bodies, format_args!("o {}\n", name.join(" ")));
                Ok(())
            }
            "s" => {
                self.plain.says_smoothing = true;
                self.smoothing = rest.split_whitespace().next().map_or(0, |group| group.parse().unwrap_or(0));
                Ok(())
            }
            "usemtl" => {
                self.use_material(rest);
                Ok(())
            }
            "mtllib" => {
                self.plain.libraries.push(rest.into());
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// `x y z`, `x y z w` with all divided by w, or `x y z red green blue`.
    fn position(&mut self, rest: &str) -> Result<(), String> {
        let values = numbers(rest);
        let [x, y, z] =
            three(&values).ok_or_else(|| format!("a vertex has {} of 3 coordinates", values.len()))?;
        let w = if values.len() == 4 && values[3] != 0.0 { values[3] } else { 1.0 };
        self.points.push([x / w, y / w, z / w]);
        self.colors.push(values.get(3..6).and_then(three));
        Ok(())
    }

    fn texture_coordinate(&mut self, rest: &str) -> Result<(), String> {
        let values = numbers(rest);
        let u = values.first().copied().ok_or("a texture coordinate has no number")?;
        let v = values.get(1).copied().unwrap_or(0.0);
        self.uvs += 1;
        put(&mut self.attributes, format_args!("vt {u} {v}\n"));
        Ok(())
    }

    fn normal(&mut self, rest: &str) -> Result<(), String> {
        let values = numbers(rest);
        let [x, y, z] =
            three(&values).ok_or_else(|| format!("a normal has {} of 3 components", values.len()))?;
        self.normals += 1;
        put(&mut self.attributes, format_args!("vn {x} {y} {z}\n"));
        Ok(())
    }

    fn face(&mut self, rest: &str) -> Result<(), String> {
        let words = rest.split_whitespace().take_while(|word| !word.starts_with('#'));
        let corners = words.map(|word| self.corner(word)).collect::<Result<Vec<_>, _>>()?;
        self.plain.stated_faces += usize::from(!corners.is_empty());
        if corners.len() < 3 {
            return Ok(());
        }
        self.corners += corners.len();
        let has_uvs = corners.iter().all(|corner| corner[1].is_some());
        let has_normals = corners.iter().all(|corner| corner[2].is_some());
        self.plain.faces.push(ObjFace {
            material: self.material,
            smoothing: self.smoothing,
            has_uvs,
            has_normals,
        });
        self.bodies.push('f');
        for [position, uv, normal] in corners {
            put(&mut self.bodies, format_args!(" {}/", position.unwrap_or(1)));
            if let (true, Some(uv)) = (has_uvs, uv) {
                put(&mut self.bodies, format_args!("{uv}"));
            }
            if let (true, Some(normal)) = (has_normals, normal) {
                put(&mut self.bodies, format_args!("/{normal}"));
            }
        }
        self.bodies.push('\n');
        Ok(())
    }

    /// `position/uv/normal` with absolute indices from 1. Texture coordinates and normals that are not
    /// there are as if not named: common exporters name them without writing them.
    fn corner(&self, word: &str) -> Result<[Option<usize>; 3], String> {
        let counts = [self.points.len(), self.uvs, self.normals];
        let mut indices = [None; 3];
        for (place, text) in word.split('/').enumerate() {
            let (Some(slot), Some(&count)) = (indices.get_mut(place), counts.get(place)) else {
                return Err(format!("the face corner '{word}' has more than three indices"));
            };
            if text.is_empty() && place > 0 {
                continue;
            }
            let number: i64 =
                text.parse().map_err(|_| format!("'{text}' in the face corner '{word}' is no index"))?;
            let index = if number < 0 { count as i64 + 1 + number } else { number };
            *slot = usize::try_from(index).ok().filter(|index| (1..=self.totals[place]).contains(index));
            if place == 0 && slot.is_none() {
                let total = self.totals[0];
                return Err(format!(
                    "a face names vertex {number}, and {count} of {total} are defined so far"
                ));
            }
        }
        Ok(indices)
    }

    fn use_material(&mut self, name: &str) {
        let next = self.plain.materials.len() as u32;
        let id = *self.known_materials.entry(name.into()).or_insert(next);
        if id == next {
            self.plain.materials.push(name.into());
        }
        self.material = Some(id);
    }

    fn finish(mut self) -> Plain {
        let colored = self.colors.iter().any(Option::is_some);
        for (point, color) in self.points.iter().zip(&self.colors) {
            let [x, y, z] = point;
            put(&mut self.positions, format_args!("v {x} {y} {z}"));
            if colored {
                let [red, green, blue] = color.unwrap_or([1.0; 3]);
                put(&mut self.positions, format_args!(" {red} {green} {blue}"));
            }
            self.positions.push('\n');
        }
        self.plain.vertices = self.points.len();
        self.plain.text = self.positions + &self.attributes + &self.bodies;
        self.plain
    }
}

fn put(text: &mut String, what: std::fmt::Arguments<'_>) {
    text.write_fmt(what).expect("writing to a text cannot fail");
}

fn three(values: impl AsRef<[f32]>) -> Option<[f32; 3]> {
    values.as_ref().first_chunk::<3>().copied()
}

fn numbers(rest: &str) -> Vec<f32> {
    rest.split_whitespace().take_while(|word| !word.starts_with('#')).take(8).map(number).collect()
}

/// The number a word begins with: exporters write `1.#IND` and worse. NaN where there is none.
pub(super) fn number(word: &str) -> f32 {
    if let Ok(value) = word.parse() {
        return value;
    }
    let bytes = word.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let mut end = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    end += digits(end);
    if bytes.get(end) == Some(&b'.') {
        end += 1 + digits(end + 1);
    }
    word.get(..end).and_then(|start| start.parse().ok()).unwrap_or(f32::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_become_absolute() {
        let plain =
            check("v 0 0 0\nv 1 0 0\nvt 0 0\nv 0 1 0\nf -3/-1 -2/1 3/1 # last").expect("a sound file");
        assert!(plain.text.ends_with("f 1/1 2/1 3/1\n"), "{}", plain.text);
        assert_eq!((plain.vertices, plain.stated_faces), (3, 1));
        assert!(plain.faces[0].has_uvs && !plain.faces[0].has_normals);
    }

    #[test]
    fn forged_indices_are_refused_with_their_line() {
        for index in
            ["0", "4", "-4", "9223372036854775807", "-9223372036854775808", "99999999999999999999", "x", "/1"]
        {
            let error = check(&format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {index}")).expect_err(index);
            assert!(matches!(error, ModelError::Obj { line: 4, .. }), "{error}");
        }
        assert!(check("f 1/").is_err() && check("v 0 0").is_err());
    }

    #[test]
    fn odd_numbers_are_read_as_far_as_they_go() {
        assert_eq!(numbers("+2. -.5 1e2 3.1+e2 -1.#IND 1E-2"), [2.0, -0.5, 100.0, 3.1, -1.0, 0.01]);
        assert!(number("x").is_nan() && number("").is_nan() && number("é").is_nan());
    }

    #[test]
    fn a_corner_without_texture_coordinates_takes_them_from_its_face() {
        let plain = check("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2//1 3/1/1").expect("sound");
        assert!(!plain.faces[0].has_uvs && plain.faces[0].has_normals);
        assert!(plain.text.ends_with("f 1//1 2//1 3//1\n"), "{}", plain.text);
    }

    #[test]
    fn one_colored_vertex_colors_all() {
        let plain = check("v 0 0 0 1 0.5 0\nv 2 4 6 2").expect("sound");
        assert_eq!(plain.text, "v 0 0 0 1 0.5 0\nv 1 2 3 1 1 1\n");
    }
}
