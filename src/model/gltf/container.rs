//! From bytes to a document whose every index points at something.

use ::gltf::json::mesh::Semantic;
use ::gltf::json::validation::{Checked, Error, Validate};
use ::gltf::json::{Path, Root};
use serde_json::{Value, json};

use crate::model::error::ModelError;

/// Extensions that change where data is or what it means, and are read.
const READ: [&str; 3] = ["KHR_texture_transform", "KHR_materials_unlit", "KHR_mesh_quantization"];
/// Extensions with this start only refine how a material looks; it is drawn without.
const REFINES: &str = "KHR_materials_";

/// The document and, for GLB, its binary chunk.
///
/// # Errors
/// [`ModelError::Gltf`] with what does not hold.
pub(super) fn open(bytes: &[u8]) -> Result<(Root, Option<&[u8]>), ModelError> {
    let (json, binary) = if bytes.starts_with(b"glTF") { split(bytes)? } else { (bytes, None) };
    let json = json.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(json);
    let fail = |error: serde_json::Error| ModelError::gltf("the JSON", error.to_string());
    let mut document: Value = serde_json::from_slice(json).map_err(fail)?;
    complete(&mut document);
    let mut root: Root = serde_json::from_value(document).map_err(fail)?;
    check_version(&root.asset.version)?;
    check_extensions(&root)?;
    root.extensions_required.clear();
    check_positions(&root)?;
    check_indices(&root)?;
    Ok((root, binary))
}

/// The JSON and binary chunks of a GLB file.
fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), ModelError> {
    const JSON: u32 = u32::from_le_bytes(*b"JSON");
    const BINARY: u32 = u32::from_le_bytes(*b"BIN\0");
    let fail = |reason: String| ModelError::gltf("the GLB header", reason);
    let word = |at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk::<4>()?));
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(fail(format!("the file ends after {} of 12 bytes", bytes.len())));
    };
    if version != 2 {
        return Err(fail(format!("version {version} is stated; export it as glTF 2.0")));
    }
    let length = length as usize;
    if length > bytes.len() || length < 12 {
        return Err(fail(format!(
            "{length} bytes are stated and {} there; the file is cut off",
            bytes.len()
        )));
    }
    let (mut json, mut binary) = (None, None);
    let mut at = 12;
    while at + 8 <= length {
        let (Some(size), Some(kind)) = (word(at), word(at + 4)) else { break };
        let end = (at + 8).checked_add(size as usize).filter(|&end| end <= length);
        let body = end.map(|end| &bytes[at + 8..end]).ok_or_else(|| {
            let left = length - at - 8;
            ModelError::gltf(
                "a GLB chunk",
                format!("{size} bytes are stated and {left} left; the file is cut off"),
            )
        })?;
        match kind {
            JSON if json.is_none() => json = Some(body),
            BINARY if binary.is_none() => binary = Some(body),
            _ => {}
        }
        at += 8 + body.len();
    }
    json.map(|json| (json, binary)).ok_or_else(|| fail("no JSON chunk follows it".into()))
}

/// Adds what the format lets out and `gltf-json` 1.4.1 insists on: nodes of scenes, and the image of a
/// texture that has one only by an extension. Takes out `extras`, of which it refuses all but objects.
fn complete(document: &mut Value) {
    drop_extras(document);
    for scene in list_in(document, "scenes") {
        if let Some(scene) = scene.as_object_mut() {
            scene.entry("nodes").or_insert_with(|| json!([]));
        }
    }
    let images = list_in(document, "images").len();
    let mut lacking = false;
    for texture in list_in(document, "textures") {
        if let Some(texture) = texture.as_object_mut().filter(|texture| !texture.contains_key("source")) {
            texture.insert("source".into(), json!(images));
            lacking = true;
        }
    }
    if lacking && let Some(document) = document.as_object_mut() {
        let images = document.entry("images").or_insert_with(|| json!([]));
        if let Some(images) = images.as_array_mut() {
            images.push(json!({ "name": "an image in a format that is not supported" }));
        }
    }
}

fn list_in<'a>(document: &'a mut Value, field: &str) -> &'a mut [Value] {
    document.get_mut(field).and_then(Value::as_array_mut).map_or(&mut [], Vec::as_mut_slice)
}

/// Recursion ends: `serde_json` lets values nest no deeper than 128 levels.
fn drop_extras(value: &mut Value) {
    match value {
        Value::Array(values) => values.iter_mut().for_each(drop_extras),
        Value::Object(fields) => {
            fields.remove("extras");
            fields.values_mut().for_each(drop_extras);
        }
        _ => {}
    }
}

fn check_version(version: &str) -> Result<(), ModelError> {
    if version.starts_with("2.") {
        return Ok(());
    }
    Err(ModelError::gltf("asset.version", format!("'{version}' is stated; export it as glTF 2.0")))
}

/// The extensions that a document uses and could do without, and that are not read.
pub(super) fn unread_extensions(root: &Root) -> impl Iterator<Item = &String> {
    root.extensions_used.iter().filter(lacks)
}

fn lacks(name: &&String) -> bool {
    !READ.contains(&name.as_str()) && !name.starts_with(REFINES)
}

fn check_extensions(root: &Root) -> Result<(), ModelError> {
    match root.extensions_required.iter().find(lacks) {
        Some(name) => Err(ModelError::gltf(
            "extensionsRequired",
            format!("{name} is needed and not supported; export the model without it"),
        )),
        None => Ok(()),
    }
}

/// What `gltf-json` 1.4.1 panics on when it is not so: POSITION names an accessor that is there.
fn check_positions(root: &Root) -> Result<(), ModelError> {
    for (mesh, primitive) in root
        .meshes
        .iter()
        .enumerate()
        .flat_map(|(mesh, one)| one.primitives.iter().map(move |each| (mesh, each)))
    {
        let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
        if let Some(index) = positions.filter(|index| index.value() >= root.accessors.len()) {
            let (index, count) = (index.value(), root.accessors.len());
            let reason = format!("POSITION names accessor {index} of {count}");
            return Err(ModelError::gltf(format!("meshes[{mesh}]"), reason));
        }
    }
    Ok(())
}

/// Indices out of range and values that are none of those allowed. What else the crate reports — missing
/// bounds of positions, attributes of the author's own — is no reason to refuse a file.
fn check_indices(root: &Root) -> Result<(), ModelError> {
    let mut first = None;
    root.validate(root, Path::new, &mut |path, error| {
        let path = path();
        let own_attribute = error == Error::Invalid && path.as_str().contains(".attributes");
        if first.is_none() && matches!(error, Error::IndexOutOfBounds | Error::Invalid) && !own_attribute {
            first = Some((path, error));
        }
    });
    match first {
        Some((path, Error::IndexOutOfBounds)) => {
            Err(ModelError::gltf(path.as_str(), "the index names something that is not there"))
        }
        Some((path, _)) => Err(ModelError::gltf(path.as_str(), "the value is none of those allowed")),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glb(parts: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut body = Vec::new();
        for (kind, data) in parts {
            body.extend((data.len() as u32).to_le_bytes());
            body.extend(*kind);
            body.extend(*data);
        }
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend((body.len() as u32 + 12).to_le_bytes());
        file.extend(body);
        file
    }

    const LEAST: &[u8] = br#"{"asset":{"version":"2.0"}}"#;

    #[test]
    fn a_glb_is_split_into_its_chunks() {
        let file = glb(&[(b"JSON", LEAST), (b"BIN\0", &[7, 8])]);
        assert_eq!(open(&file).map(|(_, binary)| binary).expect("a sound file"), Some(&[7, 8][..]));
    }

    #[test]
    fn every_cut_of_a_glb_is_refused() {
        let file = glb(&[(b"JSON", LEAST), (b"BIN\0", &[7, 8])]);
        assert!((4..file.len()).all(|end| open(&file[..end]).is_err()));
        let mut forged = file.clone();
        forged[8..12].copy_from_slice(&[3, 0, 0, 0]);
        assert!(open(&forged).is_err());
    }

    #[test]
    fn a_position_that_names_no_accessor_is_refused() {
        let json =
            br#"{"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":4}}]}]}"#;
        assert!(open(json).expect_err("forged").to_string().contains("accessor 4 of 0"));
    }

    #[test]
    fn what_the_format_lets_out_may_be_let_out() {
        let json = br#"{"asset":{"version":"2.0"},"scenes":[{}],"textures":[{"extras":3}],"extras":[1]}"#;
        let (root, _) = open(json).expect("a sound file");
        assert_eq!((root.scenes[0].nodes.len(), root.images.len()), (0, 1));
        for odd in [&b"[]"[..], b"3", br#"{"scenes":3}"#, br#"{"images":{},"textures":[{}]}"#] {
            assert!(open(odd).is_err());
        }
    }

    #[test]
    fn what_a_file_cannot_do_without_is_named() {
        let json = br#"{"asset":{"version":"2.0"},"extensionsRequired":["KHR_draco_mesh_compression"]}"#;
        assert!(open(json).expect_err("unsupported").to_string().contains("KHR_draco_mesh_compression"));
        assert!(open(br#"{"asset":{"version":"1.0"}}"#).is_err());
    }
}
