//! Rewrites an OBJ text to one that `tobj` 4.0.5 reads right, and keeps beside it what `tobj` has no words for.
//!
//! Faces come after all vertices, since they may name a later one, and have three corners or more. Their indices are
//! absolute and in range, so that `tobj` cannot miscount; each corner has all three, the first texture coordinate and the
//! first normal standing for missing ones, because `tobj` mixes up corners that have them and corners that have not. Every
//! vertex has a color, because `tobj` gives the colors that are there to the first vertices. Numbers are plain. Smoothing
//! groups and materials are kept in the order of the faces, which `tobj` keeps too.

use std::fmt::Write;
use std::io::Read;
use std::path::Path;

use crate::error::ModelError;
use sandtable_base::limits::MODEL_TRIANGLES;
use sandtable_mesh::numbering::Numbering;

use super::text::{logical_lines, number, split_keyword};

/// Stands before names in what `tobj` reads: it has none that are empty.
pub(super) const NAME_MARK: char = '=';

/// The name in the file of what `tobj` read with a mark.
pub(super) fn unmarked(name: &str) -> &str {
    name.strip_prefix(NAME_MARK).unwrap_or_default()
}

/// The file as `tobj` reads it, with what it does not read.
#[derive(Debug, Default)]
pub(super) struct ObjFile {
    /// Objects and groups with faces of three or more corners, in order: Y up, V upward, one index for all that a corner
    /// has, a color for each vertex. A missing texture coordinate is NaN, a missing normal zero; marked names. One
    /// without faces where there are none.
    pub objects: Vec<tobj::Model>,
    /// The faces of each object that has any.
    pub faces: Vec<Vec<ObjFace>>,
    /// Names of materials in the order of their first use.
    pub materials: Vec<String>,
    /// The arguments of each `mtllib`.
    pub libraries: Vec<String>,
    pub has_smoothing: bool,
    /// The number of `v` lines.
    pub vertices: usize,
    /// The number of faces of one or two corners, which no object has.
    pub short_faces: usize,
    pub points_and_lines: usize,
}

/// What `tobj` does not tell about a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObjFace {
    /// Index into [`ObjFile::materials`]; `None` before the first `usemtl`.
    pub material: Option<u32>,
    /// The smoothing group; 0 is off.
    pub smoothing: u32,
    /// Whether all corners have a normal; otherwise none has.
    pub has_normals: bool,
}

/// The file in `text`.
///
/// # Errors
/// [`ModelError::Obj`] for the first line that is wrong, otherwise for the first face with a vertex that no line defines;
/// [`ModelError::TooLarge`].
pub(super) fn read(text: &str) -> Result<ObjFile, ModelError> {
    let mut sound = SoundText {
        uvs_and_normals: "vt NaN NaN\nvn 0 0 0\n".into(),
        name: Some(String::new()),
        text,
        ..SoundText::default()
    };
    for (line, statement) in logical_lines(text) {
        sound.line = line;
        sound.statement(&statement)?;
        if sound.corner_count > MODEL_TRIANGLES.count() {
            return Err(ModelError::TooLarge { what: "corners of faces", limit: &MODEL_TRIANGLES });
        }
    }
    sound.finish()
}

/// The numbers of positions, texture coordinates and normals that `text` defines.
fn totals(text: &str) -> [usize; 3] {
    ["v", "vt", "vn"].map(|keyword| {
        logical_lines(text).filter(|(_, line)| line.split_whitespace().next() == Some(keyword)).count()
    })
}

/// The rewritten text so far.
#[derive(Default)]
struct SoundText<'a> {
    text: &'a str,
    /// Lines `v`.
    positions: String,
    /// Lines `vt` and `vn`, first those of corners without them.
    uvs_and_normals: String,
    /// Lines `o` and `f`; an `o` before the first face of each object.
    faces: String,
    file: ObjFile,
    line: usize,
    /// The numbers of positions, texture coordinates and normals up to this line.
    counts: [usize; 3],
    /// The same in the file, counted when a face first names what no line so far defines.
    totals: Option<[usize; 3]>,
    corner_count: usize,
    /// The object's name where none of its faces is written yet.
    name: Option<String>,
    material_numbers: Numbering<String>,
    material: Option<u32>,
    smoothing: u32,
    /// The first face with a vertex that no line defines.
    undefined: Option<ModelError>,
}

impl SoundText<'_> {
    fn error(&self, reason: String) -> ModelError {
        ModelError::Obj { line: self.line, reason }
    }

    fn statement(&mut self, line: &str) -> Result<(), ModelError> {
        let (keyword, rest) = split_keyword(line);
        match keyword {
            "v" => self.position(rest)?,
            "vt" => self.texture_coordinate(rest)?,
            "vn" => {
                let words = self.coordinates(rest, "normal")?;
                push_numbers(&mut self.uvs_and_normals, "vn", &words[..3]);
                self.counts[2] += 1;
            }
            "f" | "fo" => self.face(rest)?,
            "p" | "l" => self.file.points_and_lines += 1,
            "o" | "g" => self.name = Some(rest.split_whitespace().collect::<Vec<_>>().join(" ")),
            "s" => {
                self.file.has_smoothing = true;
                self.smoothing = rest.split_whitespace().next().map_or(0, |group| group.parse().unwrap_or(0));
            }
            "usemtl" => {
                let number = self.material_numbers.number(rest.to_owned());
                self.material = Some(number.index);
                if number.is_new {
                    self.file.materials.push(rest.into());
                }
            }
            "mtllib" => self.file.libraries.push(rest.into()),
            _ => {}
        }
        Ok(())
    }

    /// `x y z`, `x y z w` where all are divided by w, or `x y z red green blue`; always written with a color.
    fn position(&mut self, rest: &str) -> Result<(), ModelError> {
        let words = self.coordinates(rest, "vertex")?;
        let color = words.get(3..6).unwrap_or(&["1"; 3]);
        let w = if words.len() == 4 { number(words[3]) } else { 1.0 };
        if w == 0.0 || w == 1.0 {
            push_numbers(&mut self.positions, "v", words[..3].iter().chain(color));
        } else {
            let [x, y, z] = [0, 1, 2].map(|axis| number(words[axis]) / w);
            let _ = writeln!(self.positions, "v {x:e} {y:e} {z:e} 1 1 1");
        }
        self.counts[0] += 1;
        Ok(())
    }

    /// The words of a line, three at least.
    fn coordinates<'b>(&self, rest: &'b str, what: &str) -> Result<Vec<&'b str>, ModelError> {
        let words: Vec<&str> = without_comment(rest).take(8).collect();
        if words.len() < 3 {
            return Err(self.error(format!("a {what} has {} of 3 coordinates", words.len())));
        }
        Ok(words)
    }

    fn texture_coordinate(&mut self, rest: &str) -> Result<(), ModelError> {
        let mut words = without_comment(rest);
        let Some(u) = words.next() else {
            return Err(self.error("a texture coordinate has no number".into()));
        };
        push_numbers(&mut self.uvs_and_normals, "vt", &[u, words.next().unwrap_or("0")]);
        self.counts[1] += 1;
        Ok(())
    }

    /// Texture coordinates and normals that not all corners of a face have, or that no line defines, are dropped: common
    /// exporters name them without writing them.
    fn face(&mut self, rest: &str) -> Result<(), ModelError> {
        let corners = without_comment(rest).map(|word| self.corner(word)).collect::<Result<Vec<_>, _>>()?;
        self.corner_count += corners.len();
        let is_ahead = |corner: &[usize; 3]| {
            corner.iter().zip(self.counts).any(|(&index, count)| index >= count && index != usize::MAX)
        };
        if self.totals.is_none() && corners.iter().any(is_ahead) {
            self.totals = Some(totals(self.text));
        }
        let totals = self.totals.unwrap_or(self.counts);
        if let Some(&[position, ..]) = corners.iter().find(|corner| corner[0] >= totals[0]) {
            let (number, defined) = (position.saturating_add(1), totals[0]);
            let error = self.error(format!("a face names vertex {number}, but only {defined} are defined"));
            self.undefined.get_or_insert(error);
        } else if corners.len() >= 3 {
            self.write_face(&corners, totals);
        } else {
            self.file.short_faces += usize::from(!corners.is_empty());
        }
        Ok(())
    }

    fn write_face(&mut self, corners: &[[usize; 3]], totals: [usize; 3]) {
        if let Some(name) = self.name.take() {
            let _ = writeln!(self.faces, "o {NAME_MARK}{name}");
            self.file.faces.push(Vec::new());
        }
        let [_, has_uvs, has_normals] =
            [0, 1, 2].map(|place| corners.iter().all(|corner| corner[place] < totals[place]));
        self.faces.push('f');
        for corner in corners {
            // The first texture coordinate and the first normal stand for missing ones.
            let uv = if has_uvs { corner[1] + 2 } else { 1 };
            let normal = if has_normals { corner[2] + 2 } else { 1 };
            for (separator, index) in [(' ', corner[0] + 1), ('/', uv), ('/', normal)] {
                self.faces.push(separator);
                self.faces.push_str(&index.to_string());
            }
        }
        self.faces.push('\n');
        if let Some(faces) = self.file.faces.last_mut() {
            faces.push(ObjFace { material: self.material, smoothing: self.smoothing, has_normals });
        }
    }

    /// The indices from 0 in `position/uv/normal`; the largest of all where there is none. Negative ones count back from
    /// the last line so far.
    fn corner(&self, word: &str) -> Result<[usize; 3], ModelError> {
        let mut indices = [usize::MAX; 3];
        for (place, text) in word.split('/').enumerate() {
            let (Some(slot), Some(&count)) = (indices.get_mut(place), self.counts.get(place)) else {
                return Err(self.error(format!("the face corner '{word}' has more than three indices")));
            };
            if text.is_empty() && place > 0 {
                continue;
            }
            let number: i64 = text
                .parse()
                .map_err(|_| self.error(format!("'{text}' in the face corner '{word}' is not an index")))?;
            let index = if number < 0 { number.checked_add(count as i64) } else { number.checked_sub(1) };
            *slot = index.and_then(|index| usize::try_from(index).ok()).unwrap_or(usize::MAX);
        }
        if indices[0] == usize::MAX {
            let defined = self.counts[0];
            let reason = format!("the face corner '{word}' names no vertex; {defined} are defined so far");
            return Err(self.error(reason));
        }
        Ok(indices)
    }

    /// Has `tobj` read the text.
    fn finish(self) -> Result<ObjFile, ModelError> {
        if let Some(error) = self.undefined {
            return Err(error);
        }
        let vertices = self.positions.as_bytes().chain(self.uvs_and_normals.as_bytes());
        let options = tobj::LoadOptions { single_index: true, ..tobj::LoadOptions::default() };
        let no_library = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
        let (objects, _) =
            tobj::load_obj_buf(&mut vertices.chain(self.faces.as_bytes()), &options, no_library)
                .map_err(|error| ModelError::Obj { line: self.line, reason: error.to_string() })?;
        Ok(ObjFile { objects, vertices: self.counts[0], ..self.file })
    }
}

fn without_comment(rest: &str) -> impl Iterator<Item = &str> {
    rest.split_whitespace().take_while(|word| !word.starts_with('#'))
}

/// Writes a line of numbers: words that `tobj` reads as they are, others as the numbers that they begin with.
fn push_numbers<'a>(text: &mut String, keyword: &str, words: impl IntoIterator<Item = &'a &'a str>) {
    text.push_str(keyword);
    for &word in words {
        text.push(' ');
        if word.parse::<f32>().is_ok() {
            text.push_str(word);
        } else {
            let _ = write!(text, "{:e}", number(word));
        }
    }
    text.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The vertices of the corners of the first object's faces, in order.
    fn corners<const N: usize>(file: &ObjFile, values: fn(&tobj::Mesh) -> &[f32]) -> Vec<[f32; N]> {
        let mesh = &file.objects[0].mesh;
        let of = |&index: &u32| std::array::from_fn(|place| values(mesh)[index as usize * N + place]);
        mesh.indices.iter().map(of).collect()
    }

    const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

    #[test]
    fn indices_become_absolute() {
        let text = "v 0 0 0\nv 1 0 0\nvt 0.5 0\nv 0 1 0\nf -3/-1 -2/1 3/1 # last";
        let file = read(text).expect("a sound file");
        assert_eq!(corners(&file, |mesh| &mesh.positions), TRIANGLE);
        assert_eq!(corners(&file, |mesh| &mesh.texcoords), [[0.5, 0.0]; 3]);
        assert_eq!((file.vertices, file.faces[0].len(), file.faces[0][0].has_normals), (3, 1, false));
    }

    #[test]
    fn an_index_may_name_a_later_vertex_and_a_missing_texture_coordinate_is_dropped() {
        let file = read("f 1/9/1 2/9/1 3/9/1\no\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1").expect("a sound file");
        assert_eq!(corners(&file, |mesh| &mesh.positions), TRIANGLE);
        assert_eq!(corners(&file, |mesh| &mesh.normals), [[0.0, 0.0, 1.0]; 3]);
        assert!(file.objects[0].mesh.texcoords.iter().all(|value| value.is_nan()));
    }

    #[test]
    fn forged_indices_are_refused_with_their_line() {
        for index in
            ["0", "4", "-4", "9223372036854775807", "-9223372036854775808", "99999999999999999999", "x", "/1"]
        {
            let error = read(&format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {index}")).expect_err(index);
            assert!(matches!(error, ModelError::Obj { line: 4, .. }), "{error}");
        }
        assert!(read("f 1/").is_err() && read("v 0 0").is_err());
    }

    #[test]
    fn a_corner_without_texture_coordinates_takes_them_from_its_face() {
        let file = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2//1 3/1/1").expect("sound");
        assert!(file.objects[0].mesh.texcoords.iter().all(|value| value.is_nan()));
        assert_eq!(corners(&file, |mesh| &mesh.normals), [[0.0, 0.0, 1.0]; 3]);
        assert!(file.faces[0][0].has_normals);
    }

    #[test]
    fn vertices_are_divided_by_w_and_white_where_they_have_no_color() {
        let file = read("v 0 0 0 1 0.5 0\nv 2 4 6 2\nv 1 1 1 0\nf 1 2 3").expect("sound");
        assert_eq!(corners(&file, |mesh| &mesh.positions), [[0.0; 3], [1.0, 2.0, 3.0], [1.0; 3]]);
        assert_eq!(corners(&file, |mesh| &mesh.vertex_color), [[1.0, 0.5, 0.0], [1.0; 3], [1.0; 3]]);
    }
}
