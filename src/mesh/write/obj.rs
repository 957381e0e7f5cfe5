//! Wavefront OBJ: a line a vertex, a line a face, indices from 1 over the whole file.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};

use glam::{Vec2, Vec3};

use crate::sink::VertexId;
use crate::source::MeshSource;
use crate::write::remarks::Remarks;

/// Writes `mesh` as one object, each coordinate in the fewest digits that keep its value.
///
/// # Errors
/// `out` cannot be written, or the mesh cannot be made.
pub fn write(mesh: &mut impl MeshSource, remarks: &Remarks, out: &mut impl Write) -> io::Result<()> {
    ObjWriter::new(out, remarks, None)?;
    writeln!(out, "o terrain")?;
    mesh.each_vertex(&mut |Vec3 { x, y, z }| writeln!(out, "v {x} {y} {z}"))?;
    mesh.each_triangle(&mut |corners| {
        let [a, b, c] = corners.map(|id| id.index() + 1);
        writeln!(out, "f {a} {b} {c}")
    })
}

/// One object of a file. All attributes but the positions may be empty; the others have one value a vertex.
#[derive(Clone, Debug, Default)]
pub struct ObjObject<'a> {
    /// The name; a number is added where it repeats.
    pub name: String,
    /// The material, as the library calls it.
    pub material: Option<String>,
    /// Positions in world space.
    pub positions: Cow<'a, [Vec3]>,
    /// sRGB colors in 0..=1.
    pub colors: Vec<Vec3>,
    /// Unit normals.
    pub normals: Vec<Vec3>,
    /// Texture coordinates; V runs upward.
    pub uvs: Vec<Vec2>,
    /// Triples of indices into `positions`.
    pub triangles: Cow<'a, [[VertexId; 3]]>,
}

/// Writes an OBJ file object by object.
pub struct ObjWriter<'w, W> {
    out: &'w mut W,
    /// Lines written of each kind: the base of the next object's indices.
    positions: usize,
    uvs: usize,
    normals: usize,
    names: BTreeMap<String, usize>,
}

impl<'w, W: Write> ObjWriter<'w, W> {
    /// Writes the remarks and names the material library.
    ///
    /// # Errors
    /// `out` cannot be written.
    pub fn new(out: &'w mut W, remarks: &Remarks, library: Option<&str>) -> io::Result<Self> {
        for line in &remarks.lines {
            writeln!(out, "# {line}")?;
        }
        if let Some(library) = library {
            writeln!(out, "mtllib {library}")?;
        }
        Ok(Self { out, positions: 0, uvs: 0, normals: 0, names: BTreeMap::new() })
    }

    /// Writes an object.
    ///
    /// # Errors
    /// The output cannot be written.
    pub fn object(&mut self, object: &ObjObject<'_>) -> io::Result<()> {
        let name = self.unique_name(&object.name);
        writeln!(self.out, "o {name}")?;
        for (index, Vec3 { x, y, z }) in object.positions.iter().enumerate() {
            write!(self.out, "v {x} {y} {z}")?;
            if let Some(Vec3 { x: red, y: green, z: blue }) = object.colors.get(index) {
                write!(self.out, " {red} {green} {blue}")?;
            }
            writeln!(self.out)?;
        }
        for Vec3 { x, y, z } in &object.normals {
            writeln!(self.out, "vn {x} {y} {z}")?;
        }
        for Vec2 { x, y } in &object.uvs {
            writeln!(self.out, "vt {x} {y}")?;
        }
        if let Some(material) = &object.material {
            writeln!(self.out, "usemtl {material}")?;
        }
        for corners in object.triangles.iter() {
            write!(self.out, "f")?;
            for id in corners {
                self.corner(object, id.index() + 1)?;
            }
            writeln!(self.out)?;
        }
        self.positions += object.positions.len();
        self.uvs += object.uvs.len();
        self.normals += object.normals.len();
        Ok(())
    }

    /// A face corner: the `index`-th vertex of the object, from 1.
    fn corner(&mut self, object: &ObjObject<'_>, index: usize) -> io::Result<()> {
        write!(self.out, " {}", self.positions + index)?;
        match (object.uvs.is_empty(), object.normals.is_empty()) {
            (true, true) => Ok(()),
            (false, true) => write!(self.out, "/{}", self.uvs + index),
            (true, false) => write!(self.out, "//{}", self.normals + index),
            (false, false) => write!(self.out, "/{}/{}", self.uvs + index, self.normals + index),
        }
    }

    /// A name that no object has had.
    fn unique_name(&mut self, name: &str) -> String {
        let name = if name.is_empty() { "unnamed".to_owned() } else { word(name) };
        let count = self.names.entry(name.clone()).or_default();
        *count += 1;
        if *count == 1 { name } else { format!("{name}.{count}") }
    }
}

/// `name` as one word: characters other than letters, digits, `-` and `.` become `_`.
pub fn word(name: &str) -> String {
    name.chars().map(|at| if at.is_alphanumeric() || "-.".contains(at) { at } else { '_' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write::samples::{remarks, square};

    #[test]
    fn a_reader_gets_back_what_was_written() {
        let mut text = Vec::new();
        write(&mut &square(), &remarks(), &mut text).expect("memory");
        let text = String::from_utf8(text).expect("UTF-8");
        assert!(text.starts_with("# a?v 9 9 9\n# zwölf\no terrain\nv 0 0 -1.5\n"), "{text}");
        let numbers = |kind: &str| -> Vec<f32> {
            let lines = text.lines().filter(|line| line.starts_with(kind));
            lines
                .flat_map(|line| line.split(' ').skip(1).map(|word| word.parse().expect("a number")))
                .collect()
        };
        let expected: Vec<f32> = square().positions.iter().flat_map(|at| at.to_array()).collect();
        assert_eq!(numbers("v "), expected);
        assert_eq!(numbers("f "), [1.0, 2.0, 3.0, 1.0, 3.0, 4.0]);
    }

    #[test]
    fn objects_of_one_name_are_told_apart_and_count_on() {
        let square = square();
        let object = ObjObject {
            name: "a b".into(),
            positions: Cow::Borrowed(&square.positions),
            uvs: vec![Vec2::ZERO; 4],
            normals: vec![Vec3::Z; 4],
            triangles: Cow::Borrowed(&square.triangles[..1]),
            ..ObjObject::default()
        };
        let plain = ObjObject { uvs: Vec::new(), ..object.clone() };
        let mut text = Vec::new();
        let mut writer = ObjWriter::new(&mut text, &Remarks::default(), Some("a.mtl")).expect("memory");
        [&object, &plain, &object].into_iter().try_for_each(|each| writer.object(each)).expect("memory");
        let text = String::from_utf8(text).expect("UTF-8");
        let lines =
            |kind: &str| -> Vec<&str> { text.lines().filter(|line| line.starts_with(kind)).collect() };
        assert_eq!(lines("o "), ["o a_b", "o a_b.2", "o a_b.3"]);
        assert_eq!(lines("f "), ["f 1/1/1 2/2/2 3/3/3", "f 5//5 6//6 7//7", "f 9/5/9 10/6/10 11/7/11"]);
    }
}
