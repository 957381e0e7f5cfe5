//! 3MF: solids for printers, in millimeters (3MF Core Specification 1.3).

use std::fmt::Write;
use std::io;

use glam::Vec3;

use crate::trimesh::TriMesh;
use crate::write::remarks::Remarks;
use sandtable_base::archive;
use sandtable_base::message::xml::escaped;

/// A solid and its place on the printer's bed.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedSolid {
    /// Its name in the printer's program.
    pub name: String,
    /// In millimeters, closed.
    pub mesh: TriMesh,
    /// Where its origin is, in millimeters.
    pub at_mm: Vec3,
}

const CONTENT_TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"#;

const RELATIONSHIPS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"#;

/// The bytes of a 3MF file with `solids`; its description is `remarks`.
///
/// # Errors
/// The file would be larger than a zip archive holds.
pub fn bytes(solids: &[PlacedSolid], remarks: &Remarks) -> io::Result<Vec<u8>> {
    let model = model(solids, remarks);
    archive::zip(&[
        ("[Content_Types].xml", CONTENT_TYPES.as_bytes()),
        ("_rels/.rels", RELATIONSHIPS.as_bytes()),
        ("3D/3dmodel.model", model.as_bytes()),
    ])
}

fn model(solids: &[PlacedSolid], remarks: &Remarks) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n",
    );
    let description = escaped(&remarks.lines.join("; "));
    let (mut objects, mut build) = (String::new(), String::new());
    for (number, solid) in (1..).zip(solids) {
        add_object(&mut objects, number, solid);
        let [x, y, z] = solid.at_mm.to_array();
        // Writing to a string cannot fail.
        let _ = writeln!(build, "<item objectid=\"{number}\" transform=\"1 0 0 0 1 0 0 0 1 {x} {y} {z}\"/>");
    }
    let _ = writeln!(text, "<metadata name=\"Description\">{description}</metadata>");
    let _ = write!(text, "<resources>\n{objects}</resources>\n<build>\n{build}</build>\n</model>\n");
    text
}

fn add_object(text: &mut String, number: u32, solid: &PlacedSolid) {
    let name = escaped(&solid.name);
    let _ = writeln!(text, "<object id=\"{number}\" type=\"model\" name=\"{name}\"><mesh><vertices>");
    for at in &solid.mesh.positions {
        let _ = writeln!(text, "<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>", at.x, at.y, at.z);
    }
    text.push_str("</vertices><triangles>\n");
    for [a, b, c] in &solid.mesh.triangles {
        let _ = writeln!(text, "<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>", a.0, b.0, c.0);
    }
    text.push_str("</triangles></mesh></object>\n");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write::samples::{remarks, square};
    use sandtable_base::archive::ZipReader;

    #[test]
    fn the_package_names_its_parts_and_holds_every_vertex_and_triangle() {
        let solid =
            PlacedSolid { name: "a <b> & \"c\"".into(), mesh: square(), at_mm: Vec3::new(1.5, 0.0, 0.0) };
        let bytes = bytes(&[solid.clone(), solid], &remarks()).expect("memory");
        let zip = ZipReader::open(&bytes).expect("intact");
        let model =
            String::from_utf8(zip.read("3D/3dmodel.model", 1 << 20).expect("there").to_vec()).expect("text");
        assert!(
            model.contains("unit=\"millimeter\"")
                && model.contains("name=\"a &lt;b&gt; &amp; &quot;c&quot;\"")
        );
        assert_eq!((model.matches("<vertex ").count(), model.matches("<triangle ").count()), (8, 4));
        assert_eq!(model.matches("transform=\"1 0 0 0 1 0 0 0 1 1.5 0 0\"").count(), 2);
        assert_eq!(zip.names().count(), 3);
    }
}
