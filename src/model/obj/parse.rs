//! Parses an OBJ text to statements with absolute indices in range.

use std::ops::Range;

use glam::{Vec2, Vec3};

use crate::error::ModelError;
use sandtable_base::limits::MODEL_TRIANGLES;
use sandtable_draw::color::Srgba;
use sandtable_mesh::numbering::Numbering;

use super::text::{logical_lines, number, split_keyword};

/// A file as stored, but Z up.
#[derive(Debug, Default)]
pub(super) struct ObjFile {
    pub positions: Vec<Vec3>,
    /// One for each position; white where the file has none.
    pub colors: Vec<Srgba>,
    /// V upward.
    pub uvs: Vec<Vec2>,
    pub normals: Vec<Vec3>,
    pub corners: Vec<ObjCorner>,
    /// Objects and groups, in order; some have no faces.
    pub objects: Vec<FaceGroup>,
    /// Names of materials in the order of their first use.
    pub materials: Vec<String>,
    /// The arguments of each `mtllib`.
    pub libraries: Vec<String>,
    pub has_smoothing: bool,
    pub points_and_lines: usize,
}

#[derive(Debug, Default)]
pub(super) struct FaceGroup {
    /// Empty for faces before the first name.
    pub name: String,
    pub faces: Vec<ObjFace>,
}

/// A face of one or more corners.
#[derive(Clone, Debug)]
pub(super) struct ObjFace {
    /// The face's part of [`ObjFile::corners`].
    pub corners: Range<usize>,
    /// Index into [`ObjFile::materials`]; `None` before the first `usemtl`.
    pub material: Option<u32>,
    /// The smoothing group; 0 is off.
    pub smoothing: u32,
    line: usize,
}

/// A corner of a face, as indices from 0. Either all corners of a face have texture coordinates or none; likewise
/// normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ObjCorner {
    pub position: usize,
    pub uv: Option<usize>,
    pub normal: Option<usize>,
}

pub(super) fn parse(text: &str) -> Result<ObjFile, ModelError> {
    let mut parser = ObjParser::default();
    parser.file.objects.push(FaceGroup::default());
    for (line, statement) in logical_lines(text) {
        parser.line = line;
        parser.statement(&statement)?;
        if parser.file.corners.len() > MODEL_TRIANGLES.count() {
            return Err(ModelError::TooLarge { what: "corners of faces", limit: &MODEL_TRIANGLES });
        }
    }
    parser.file.check_indices()?;
    Ok(parser.file)
}

#[derive(Default)]
struct ObjParser {
    file: ObjFile,
    line: usize,
    material_numbers: Numbering<String>,
    material: Option<u32>,
    smoothing: u32,
}

impl ObjParser {
    fn error(&self, reason: String) -> ModelError {
        ModelError::Obj { line: self.line, reason }
    }

    fn statement(&mut self, line: &str) -> Result<(), ModelError> {
        let (keyword, rest) = split_keyword(line);
        match keyword {
            "v" => self.position(rest)?,
            "vt" => self.texture_coordinate(rest)?,
            "vn" => {
                let normal = self.vector(&numbers(rest), "normal")?;
                self.file.normals.push(normal);
            }
            "f" | "fo" => self.face(rest)?,
            "p" | "l" => self.file.points_and_lines += 1,
            "o" | "g" => {
                let name = rest.split_whitespace().collect::<Vec<_>>().join(" ");
                self.file.objects.push(FaceGroup { name, faces: Vec::new() });
            }
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

    /// `x y z`, `x y z w` where all are divided by w, or `x y z red green blue`.
    fn position(&mut self, rest: &str) -> Result<(), ModelError> {
        let values = numbers(rest);
        let w = if values.len() == 4 && values[3] != 0.0 { values[3] } else { 1.0 };
        let position = self.vector(&values, "vertex")? / w;
        self.file.positions.push(position);
        let color =
            values.get(3..6).map(|channels| color_from_channels([channels[0], channels[1], channels[2]]));
        self.file.colors.push(color.unwrap_or(Srgba::WHITE));
        Ok(())
    }

    /// The first three values, Y up, as a vector, Z up.
    fn vector(&self, values: &[f32], what: &str) -> Result<Vec3, ModelError> {
        match values {
            &[x, y, z, ..] => Ok(Vec3::new(x, -z, y)),
            _ => Err(self.error(format!("a {what} has {} of 3 coordinates", values.len()))),
        }
    }

    fn texture_coordinate(&mut self, rest: &str) -> Result<(), ModelError> {
        let uv = match numbers(rest)[..] {
            [] => return Err(self.error("a texture coordinate has no number".into())),
            [u] => Vec2::new(u, 0.0),
            [u, v, ..] => Vec2::new(u, v),
        };
        self.file.uvs.push(uv);
        Ok(())
    }

    fn face(&mut self, rest: &str) -> Result<(), ModelError> {
        let first = self.file.corners.len();
        for word in without_comment(rest) {
            let corner = self.corner(word)?;
            self.file.corners.push(corner);
        }
        let corners = first..self.file.corners.len();
        if let Some(object) = self.file.objects.last_mut().filter(|_| !corners.is_empty()) {
            let Self { material, smoothing, line, .. } = *self;
            object.faces.push(ObjFace { corners, material, smoothing, line });
        }
        Ok(())
    }

    /// `position/uv/normal`; negative indices count back from the last line so far.
    fn corner(&self, word: &str) -> Result<ObjCorner, ModelError> {
        let counts = [self.file.positions.len(), self.file.uvs.len(), self.file.normals.len()];
        let mut indices = [None; 3];
        for (place, text) in word.split('/').enumerate() {
            let (Some(slot), Some(&count)) = (indices.get_mut(place), counts.get(place)) else {
                return Err(self.error(format!("the face corner '{word}' has more than three indices")));
            };
            if text.is_empty() && place > 0 {
                continue;
            }
            let number: i64 = text
                .parse()
                .map_err(|_| self.error(format!("'{text}' in the face corner '{word}' is not an index")))?;
            let index = if number < 0 { number.checked_add(count as i64) } else { number.checked_sub(1) };
            *slot = index.and_then(|index| usize::try_from(index).ok());
        }
        match indices {
            [Some(position), uv, normal] => Ok(ObjCorner { position, uv, normal }),
            _ => Err(self.error(format!(
                "the face corner '{word}' names no vertex; {} are defined so far",
                counts[0]
            ))),
        }
    }
}

impl ObjFile {
    /// Refuses faces with positions that no line defines. Texture coordinates and normals that no line defines are
    /// dropped: common exporters name them without writing them.
    fn check_indices(&mut self) -> Result<(), ModelError> {
        let (positions, uvs, normals) = (self.positions.len(), self.uvs.len(), self.normals.len());
        for face in self.objects.iter().flat_map(|object| &object.faces) {
            let corners = &mut self.corners[face.corners.clone()];
            if let Some(corner) = corners.iter().find(|corner| corner.position >= positions) {
                let number = corner.position.saturating_add(1);
                let reason = format!("a face names vertex {number}, but only {positions} are defined");
                return Err(ModelError::Obj { line: face.line, reason });
            }
            let is_below = |index: Option<usize>, count: usize| index.is_some_and(|index| index < count);
            let has_uvs = corners.iter().all(|corner| is_below(corner.uv, uvs));
            let has_normals = corners.iter().all(|corner| is_below(corner.normal, normals));
            for corner in corners {
                corner.uv = corner.uv.filter(|_| has_uvs);
                corner.normal = corner.normal.filter(|_| has_normals);
            }
        }
        Ok(())
    }
}

/// An sRGB color from channels in 0..=1; NaN is 0.
pub(super) fn color_from_channels(channels: [f32; 3]) -> Srgba {
    let [red, green, blue] = channels.map(|channel| (channel * 255.0 + 0.5) as u8);
    Srgba::opaque(red, green, blue)
}

fn without_comment(rest: &str) -> impl Iterator<Item = &str> {
    rest.split_whitespace().take_while(|word| !word.starts_with('#'))
}

fn numbers(rest: &str) -> Vec<f32> {
    without_comment(rest).take(8).map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_become_absolute() {
        let file = parse("v 0 0 0\nv 1 0 0\nvt 0 0\nv 0 1 0\nf -3/-1 -2/1 3/1 # last").expect("a sound file");
        let corner = |position| ObjCorner { position, uv: Some(0), normal: None };
        assert_eq!(file.corners, [0, 1, 2].map(corner));
        assert_eq!((file.positions.len(), file.objects[0].faces.len()), (3, 1));
    }

    #[test]
    fn an_index_may_name_a_later_vertex_and_a_missing_texture_coordinate_is_dropped() {
        let file = parse("f 1/9/1 2/9/1 3/9/1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1").expect("a sound file");
        let corner = |position| ObjCorner { position, uv: None, normal: Some(0) };
        assert_eq!(file.corners, [0, 1, 2].map(corner));
    }

    #[test]
    fn forged_indices_are_refused_with_their_line() {
        for index in
            ["0", "4", "-4", "9223372036854775807", "-9223372036854775808", "99999999999999999999", "x", "/1"]
        {
            let error = parse(&format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {index}")).expect_err(index);
            assert!(matches!(error, ModelError::Obj { line: 4, .. }), "{error}");
        }
        assert!(parse("f 1/").is_err() && parse("v 0 0").is_err());
    }

    #[test]
    fn a_corner_without_texture_coordinates_takes_them_from_its_face() {
        let file = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2//1 3/1/1").expect("sound");
        assert!(file.corners.iter().all(|corner| corner.uv.is_none() && corner.normal == Some(0)));
    }

    #[test]
    fn vertices_are_divided_by_w_and_white_where_they_have_no_color() {
        let file = parse("v 0 0 0 1 0.5 0\nv 2 4 6 2").expect("sound");
        assert_eq!(file.positions, [Vec3::ZERO, Vec3::new(1.0, -3.0, 2.0)]);
        assert_eq!(file.colors, [Srgba::opaque(255, 128, 0), Srgba::WHITE]);
    }
}
