//! 3D Studio files: chunks within chunks.

use std::collections::BTreeMap;

use super::shape::{Object, Paint, Shape};

/// The file of `shape`. Each of `nodes` places the object it names at a point of its own; objects that none
/// names stay where they are.
pub fn write(shape: &Shape, nodes: &[(&str, [f32; 3])]) -> Vec<u8> {
    let mut editor = chunk(0x3D3E, &3u32.to_le_bytes());
    for paint in &shape.paints {
        editor.extend(material(paint));
    }
    editor.extend(chunk(0x0100, &1f32.to_le_bytes()));
    for object in &shape.objects {
        editor.extend(mesh(object, &shape.paints));
    }
    let mut main = chunk(0x0002, &3u32.to_le_bytes());
    main.extend(chunk(0x3D3D, &editor));
    if !nodes.is_empty() {
        let nodes: Vec<u8> = (0..).zip(nodes).flat_map(|(id, &(object, at))| node(id, object, at)).collect();
        main.extend(chunk(0xB000, &nodes));
    }
    chunk(0x4D4D, &main)
}

fn chunk(id: u16, body: &[u8]) -> Vec<u8> {
    let length = (body.len() + 6) as u32;
    [&id.to_le_bytes(), &length.to_le_bytes()[..], body].concat()
}

fn text(text: &str) -> Vec<u8> {
    [text.as_bytes(), &[0]].concat()
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

fn material(paint: &Paint) -> Vec<u8> {
    let color = |id: u16, color: [u8; 3]| chunk(id, &chunk(0x0011, &color));
    let mut body = chunk(0xA000, &text(paint.name));
    body.extend(color(0xA010, paint.color.map(|channel| channel / 2)));
    body.extend(color(0xA020, paint.color));
    body.extend(color(0xA030, [20; 3]));
    if paint.two_sided {
        body.extend(chunk(0xA081, &[]));
    }
    chunk(0xAFFF, &body)
}

fn mesh(object: &Object, paints: &[Paint]) -> Vec<u8> {
    let mut places: BTreeMap<[u32; 3], u16> = BTreeMap::new();
    let mut vertices: Vec<f32> = Vec::new();
    let mut triangles: Vec<[u16; 3]> = Vec::new();
    let mut smoothing: Vec<u32> = Vec::new();
    let mut groups: Vec<Vec<u16>> = vec![Vec::new(); paints.len()];
    for face in &object.faces {
        let ids: Vec<u16> = face
            .corners
            .iter()
            .map(|&(at, _)| {
                let next = (vertices.len() / 3) as u16;
                let id = *places.entry(at.to_array().map(f32::to_bits)).or_insert(next);
                if id == next {
                    vertices.extend(at.to_array());
                }
                id
            })
            .collect();
        for corner in 2..ids.len() {
            groups[face.paint].push(triangles.len() as u16);
            triangles.push([ids[0], ids[corner - 1], ids[corner]]);
            smoothing.push(face.smoothing);
        }
    }
    let count =
        |count: usize| u16::try_from(count).expect("a mesh holds at most 65,535 of each").to_le_bytes();
    let mut faces = count(triangles.len()).to_vec();
    for ids in &triangles {
        faces.extend(ids.iter().flat_map(|id| id.to_le_bytes()));
        faces.extend(7u16.to_le_bytes());
    }
    for (paint, faces_of_it) in paints.iter().zip(&groups).filter(|(_, faces)| !faces.is_empty()) {
        let ids = faces_of_it.iter().flat_map(|id| id.to_le_bytes());
        let body: Vec<u8> = text(paint.name).into_iter().chain(count(faces_of_it.len())).chain(ids).collect();
        faces.extend(chunk(0x4130, &body));
    }
    faces.extend(chunk(0x4150, &smoothing.iter().flat_map(|mask| mask.to_le_bytes()).collect::<Vec<u8>>()));
    let mut body = chunk(0x4110, &[&count(vertices.len() / 3)[..], &floats(&vertices)].concat());
    body.extend(chunk(0x4120, &faces));
    body.extend(chunk(0x4160, &floats(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])));
    chunk(0x4000, &[text(object.name), chunk(0x4100, &body)].concat())
}

/// A node without a parent that stands still.
fn node(id: u16, object: &str, at: [f32; 3]) -> Vec<u8> {
    let track = |value: &[f32]| {
        let mut body = vec![0; 10];
        body.extend(1u32.to_le_bytes());
        body.extend([0; 6]);
        body.extend(floats(value));
        body
    };
    let mut body = chunk(0xB030, &id.to_le_bytes());
    body.extend(chunk(0xB010, &[&text(object)[..], &[0, 0, 0, 0, 0xFF, 0xFF]].concat()));
    body.extend(chunk(0xB011, &text(&format!("{object}{id}"))));
    body.extend(chunk(0xB013, &floats(&[0.0; 3])));
    body.extend(chunk(0xB020, &track(&at)));
    body.extend(chunk(0xB021, &track(&[0.0, 0.0, 0.0, 1.0])));
    body.extend(chunk(0xB022, &track(&[1.0; 3])));
    chunk(0xB002, &body)
}
