//! Wavefront OBJ and MTL, Y up.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::shape::Shape;

/// The OBJ file of `shape`, which names the library `library`.
pub fn objects(shape: &Shape, library: &str) -> Vec<u8> {
    let mut text = format!("# meters, Y up, front toward +Z\nmtllib {library}\n");
    let (mut places, mut uvs) = (BTreeMap::new(), BTreeMap::new());
    let mut put = |arguments: std::fmt::Arguments<'_>| text.write_fmt(arguments).expect("memory takes all");
    for object in &shape.objects {
        put(format_args!("o {}\n", object.name));
        let mut paint = usize::MAX;
        let mut smoothing = u32::MAX;
        for face in &object.faces {
            if paint != face.paint {
                paint = face.paint;
                put(format_args!("usemtl {}\n", shape.paints[paint].name));
            }
            if smoothing != face.smoothing {
                smoothing = face.smoothing;
                put(format_args!("s {smoothing}\n"));
            }
            let textured = shape.paints[paint].texture.is_some();
            let mut corners = String::new();
            for &(at, uv) in &face.corners {
                // Tenths of millimeters; adding zero makes one of the two zeros.
                let place =
                    [at.x, at.z, -at.y].map(|value| format!("{:.4}", (value * 1e4).round() / 1e4 + 0.0));
                let next = places.len() + 1;
                let id = *places.entry(place.join(" ")).or_insert_with_key(|place| {
                    put(format_args!("v {place}\n"));
                    next
                });
                write!(corners, " {id}").expect("memory takes all");
                if textured {
                    let uv = [uv.x, uv.y].map(|value| format!("{:.4}", (value * 1e4).round() / 1e4 + 0.0));
                    let next = uvs.len() + 1;
                    let id = *uvs.entry(uv.join(" ")).or_insert_with_key(|uv| {
                        put(format_args!("vt {uv}\n"));
                        next
                    });
                    write!(corners, "/{id}").expect("memory takes all");
                }
            }
            put(format_args!("f{corners}\n"));
        }
    }
    text.into_bytes()
}

/// The MTL file of `shape`.
pub fn library(shape: &Shape) -> Vec<u8> {
    let mut text = String::new();
    for paint in &shape.paints {
        let [red, green, blue] = paint.color.map(|channel| f32::from(channel) / 255.0);
        let map = paint.texture.as_ref().map_or(String::new(), |(file, _)| format!("map_Kd {file}\n"));
        let name = paint.name;
        write!(text, "newmtl {name}\nKd {red:.4} {green:.4} {blue:.4}\nd 1\nillum 1\n{map}\n")
            .expect("memory takes all");
    }
    text.into_bytes()
}
