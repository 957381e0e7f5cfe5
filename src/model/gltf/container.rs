//! Parses the bytes of a file to a document whose indices are all in range.

use ::gltf::Document;
use ::gltf::json::validation::{Checked, Error, Validate};
use ::gltf::json::{Path, Root};
use ::gltf::mesh::Semantic;
use serde_json::{Map, Value, json};

use crate::error::ModelError;

/// Supported extensions that change the place or the meaning of data.
const SUPPORTED: [&str; 4] =
    ["KHR_texture_transform", "KHR_materials_unlit", "KHR_mesh_quantization", "EXT_texture_webp"];
/// The start of extensions that refine how a material looks; it is drawn without them.
const REFINEMENTS: &str = "KHR_materials_";

pub(super) struct GltfFile<'a> {
    pub document: Document,
    /// The binary chunk of a GLB file.
    pub binary: Option<&'a [u8]>,
}

impl<'a> GltfFile<'a> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, ModelError> {
        let (json, binary) = if bytes.starts_with(b"glTF") { split(bytes)? } else { (bytes, None) };
        let json = json.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(json);
        let mut document: Value = serde_json::from_slice(json).map_err(ModelError::GltfJson)?;
        complete(&mut document);
        let root: Root = serde_json::from_value(document).map_err(ModelError::GltfJson)?;
        check_version(&root.asset.version)?;
        check_extensions(&root)?;
        check_positions(&root)?;
        check_indices(&root)?;
        Ok(Self { document: Document::from_json_without_validation(root), binary })
    }
}

fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), ModelError> {
    const JSON: usize = u32::from_le_bytes(*b"JSON") as usize;
    const BINARY: usize = u32::from_le_bytes(*b"BIN\0") as usize;
    let fail = |reason: String| ModelError::gltf("the GLB chunks", reason);
    let word = |at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk::<4>()?) as usize);
    let (version, length) = (word(4).unwrap_or(0), word(8).unwrap_or(0));
    if version != 2 && bytes.len() >= 12 {
        return Err(fail(format!("the file has version {version}; export it as glTF 2.0")));
    }
    let file = bytes.get(..length).filter(|file| file.len() >= 12).ok_or_else(|| {
        fail(format!("the file has {} of {length} bytes; copy or export it again", bytes.len()))
    })?;
    let (mut json, mut binary, mut rest) = (None, None, &file[12..]);
    while let Some((header, body)) = rest.split_first_chunk::<8>() {
        let at = file.len() - rest.len();
        let (Some(size), Some(kind)) = (word(at), word(at + 4)) else { break };
        let chunk = body.get(..size).ok_or_else(|| {
            let left = body.len();
            fail(format!("a chunk has {left} of {size} bytes; copy or export the file again"))
        })?;
        match kind {
            JSON if json.is_none() => json = Some(chunk),
            BINARY if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        rest = &rest[header.len() + size..];
    }
    let json = json.ok_or_else(|| fail("there is no JSON chunk; export the file again".into()))?;
    Ok((json, binary))
}

/// Adds an optional field that `gltf-json` 1.4.1 requires: nodes of scenes. Removes `extras`, of which it accepts only
/// objects. Moves to where it looks for them the images and the colors that extensions name.
fn complete(document: &mut Value) {
    remove_extras(document);
    each_object(document, "textures", take_webp_source);
    each_object(document, "materials", take_diffuse);
    for scene in document.get_mut("scenes").and_then(Value::as_array_mut).into_iter().flatten() {
        if let Some(scene) = scene.as_object_mut() {
            scene.entry("nodes").or_insert_with(|| json!([]));
        }
    }
}

fn each_object(document: &mut Value, list: &str, change: fn(&mut Map<String, Value>)) {
    let values = document.get_mut(list).and_then(Value::as_array_mut).into_iter().flatten();
    values.filter_map(Value::as_object_mut).for_each(change);
}

/// The WebP image of a texture counts, not the one for readers that know none.
fn take_webp_source(texture: &mut Map<String, Value>) {
    let source =
        texture.get("extensions").and_then(|all| all.get("EXT_texture_webp")?.get("source")).cloned();
    if let Some(source) = source {
        texture.insert("source".into(), source);
    }
}

/// The diffuse color and texture of the older way to describe materials, where the file has them in no other.
fn take_diffuse(material: &mut Map<String, Value>) {
    const OLDER: &str = "KHR_materials_pbrSpecularGlossiness";
    let Some(older) = material.get("extensions").and_then(|all| all.get(OLDER)).cloned() else { return };
    let newer = material.entry("pbrMetallicRoughness").or_insert_with(|| json!({}));
    let Some(newer) = newer.as_object_mut() else { return };
    if newer.contains_key("baseColorTexture") {
        return;
    }
    for (key, older_key) in [("baseColorFactor", "diffuseFactor"), ("baseColorTexture", "diffuseTexture")] {
        if let Some(value) = older.get(older_key) {
            newer.insert(key.into(), value.clone());
        }
    }
}

/// Recursion ends: `serde_json` lets values nest no deeper than 128 levels.
fn remove_extras(value: &mut Value) {
    match value {
        Value::Array(values) => values.iter_mut().for_each(remove_extras),
        Value::Object(fields) => {
            fields.remove("extras");
            fields.values_mut().for_each(remove_extras);
        }
        _ => {}
    }
}

fn check_version(version: &str) -> Result<(), ModelError> {
    if version.starts_with("2.") {
        return Ok(());
    }
    Err(ModelError::gltf("asset.version", format!("it is '{version}'; export the model as glTF 2.0")))
}

/// Whether an extension is neither read nor can be left out.
pub(super) fn is_unsupported(name: &str) -> bool {
    !SUPPORTED.contains(&name) && !name.starts_with(REFINEMENTS)
}

fn check_extensions(root: &Root) -> Result<(), ModelError> {
    match root.extensions_required.iter().find(|name| is_unsupported(name)) {
        Some(name) => {
            let reason = format!("{name} is required but not supported; export the model without it");
            Err(ModelError::gltf("extensionsRequired", reason))
        }
        None => Ok(()),
    }
}

/// Checks that POSITION is an accessor: `gltf-json` 1.4.1 panics where it is not.
fn check_positions(root: &Root) -> Result<(), ModelError> {
    for (mesh, primitives) in root.meshes.iter().map(|mesh| &mesh.primitives).enumerate() {
        let positions =
            primitives.iter().filter_map(|each| each.attributes.get(&Checked::Valid(Semantic::Positions)));
        let count = root.accessors.len();
        if let Some(index) = positions.map(|index| index.value()).find(|&index| index >= count) {
            let reason = format!("POSITION names accessor {index} of {count}");
            return Err(ModelError::gltf(format!("meshes[{mesh}]"), reason));
        }
    }
    Ok(())
}

/// Refuses indices out of range and unknown values. The rest that the crate reports, such as missing bounds of
/// positions and attributes of the author's own, does no harm.
fn check_indices(root: &Root) -> Result<(), ModelError> {
    let mut first = None;
    root.validate(root, Path::new, &mut |path, error| {
        let path = path();
        let is_own_attribute = error == Error::Invalid && path.as_str().contains(".attributes");
        let reason = match error {
            Error::IndexOutOfBounds => "the index is out of range",
            Error::Invalid if !is_own_attribute => "the value is not one of those allowed",
            _ => return,
        };
        first.get_or_insert((path, reason));
    });
    first.map_or(Ok(()), |(path, reason)| Err(ModelError::gltf(path.as_str(), reason)))
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

    fn error_of(json: &[u8]) -> String {
        GltfFile::open(json).map(|_| ()).expect_err("refused").to_string()
    }

    #[test]
    fn a_glb_is_split_into_its_chunks_and_others_are_ignored() {
        let file = glb(&[(b"JSON", LEAST), (b"BIN\0", &[7, 8])]);
        assert_eq!(GltfFile::open(&file).expect("a sound file").binary, Some(&[7, 8][..]));
        let file = glb(&[(b"JSON", LEAST), (b"what", &[1]), (b"BIN\0", &[7, 8])]);
        assert_eq!(GltfFile::open(&file).expect("a sound file").binary, Some(&[7, 8][..]));
    }

    #[test]
    fn every_cut_of_a_glb_is_refused() {
        let file = glb(&[(b"JSON", LEAST), (b"BIN\0", &[7, 8])]);
        assert!((4..file.len()).all(|end| GltfFile::open(&file[..end]).is_err()));
        let mut forged = file.clone();
        forged[8..12].copy_from_slice(&[3, 0, 0, 0]);
        assert!(GltfFile::open(&forged).is_err());
    }

    #[test]
    fn a_position_that_names_no_accessor_is_refused() {
        let json =
            br#"{"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":4}}]}]}"#;
        assert!(error_of(json).contains("accessor 4 of 0"));
    }

    #[test]
    fn what_the_format_leaves_out_may_be_left_out() {
        let json = br#"{"asset":{"version":"2.0"},"scenes":[{}],"textures":[{"extras":3}],"extras":[1]}"#;
        let GltfFile { document, .. } = GltfFile::open(json).expect("a sound file");
        assert_eq!(document.scenes().map(|scene| scene.nodes().count()).collect::<Vec<_>>(), [0]);
        assert!(document.textures().all(|texture| texture.source().is_none()));
        for odd in [&b"[]"[..], b"3", br#"{"scenes":3}"#, br#"{"images":{},"textures":[{}]}"#] {
            assert!(GltfFile::open(odd).is_err());
        }
    }

    #[test]
    fn images_and_colors_that_extensions_name_are_found() {
        let json = br#"{"asset":{"version":"2.0"},"extensionsRequired":["EXT_texture_webp"],
            "images":[{"uri":"a.png"},{"uri":"b.webp"}],
            "textures":[{"source":0,"extensions":{"EXT_texture_webp":{"source":1}}},
                {"extensions":{"EXT_texture_webp":{"source":1}}},{"source":0}],
            "materials":[{"extensions":{"KHR_materials_pbrSpecularGlossiness":
                {"diffuseFactor":[0.5,0,0,1],"diffuseTexture":{"index":2}}}}]}"#;
        let GltfFile { document, .. } = GltfFile::open(json).expect("a sound file");
        let sources = document.textures().map(|texture| texture.source().map(|image| image.index()));
        assert_eq!(sources.collect::<Vec<_>>(), [Some(1), Some(1), Some(0)]);
        let material = document.materials().next().expect("one").pbr_metallic_roughness();
        assert_eq!(material.base_color_factor(), [0.5, 0.0, 0.0, 1.0]);
        assert_eq!(material.base_color_texture().map(|info| info.texture().index()), Some(2));
        let out_of_range = br#"{"asset":{"version":"2.0"},
            "textures":[{"extensions":{"EXT_texture_webp":{"source":7}}}]}"#;
        assert!(GltfFile::open(out_of_range).is_err());
    }

    #[test]
    fn an_extension_that_a_file_requires_is_named() {
        let json = br#"{"asset":{"version":"2.0"},"extensionsRequired":["KHR_draco_mesh_compression"]}"#;
        assert!(error_of(json).contains("KHR_draco_mesh_compression"));
        assert!(GltfFile::open(br#"{"asset":{"version":"1.0"}}"#).is_err());
    }
}
