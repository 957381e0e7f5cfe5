//! Any model file to a [`Model`]: by content first, by extension where the content says nothing.

use crate::model::error::ModelError;
use crate::model::{Companions, Model};
use crate::model::{gltf, obj, three_ds};

/// The formats that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ModelFormat {
    ThreeDs,
    Obj,
    Gltf,
}

/// The model in `bytes`. `name` is the file's name, used for its extension and in messages; the files the
/// model names are asked of `companions`.
///
/// # Errors
/// [`ModelError`]. A missing or broken texture is no error but one of [`Model::notes`].
pub fn read(name: &str, bytes: &[u8], companions: &dyn Companions) -> Result<Model, ModelError> {
    if bytes.is_empty() {
        return Err(ModelError::Empty { name: name.into() });
    }
    let mut model = match format_of(name, bytes) {
        Some(ModelFormat::ThreeDs) => three_ds::read(bytes, companions),
        Some(ModelFormat::Obj) => obj::read(bytes, companions),
        Some(ModelFormat::Gltf) => gltf::read(bytes, companions),
        None => Err(ModelError::Unknown { name: name.into(), start: start_of(bytes) }),
    }?;
    if model.parts.is_empty() {
        model.notes.push("there is nothing to draw in it".into());
    }
    shorten(&mut model.notes);
    Ok(model)
}

/// Drops repeated notes, and all past the first few.
fn shorten(notes: &mut Vec<String>) {
    /// As many as someone reads; arbitrary.
    const MOST: usize = 40;
    let mut known = std::collections::BTreeSet::new();
    notes.retain(|note| known.insert(note.clone()));
    if notes.len() > MOST {
        let more = notes.len() - MOST;
        notes.truncate(MOST);
        notes.push(format!("and {more} more"));
    }
}

fn format_of(name: &str, bytes: &[u8]) -> Option<ModelFormat> {
    by_content(bytes).or_else(|| by_extension(name))
}

fn by_content(bytes: &[u8]) -> Option<ModelFormat> {
    /// The chunk that holds a whole 3DS file, `0x4D4D`, little-endian.
    const MAIN_CHUNK: &[u8] = b"MM";
    if bytes.starts_with(b"glTF") {
        return Some(ModelFormat::Gltf);
    }
    if bytes.starts_with(MAIN_CHUNK) {
        return Some(ModelFormat::ThreeDs);
    }
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    (text.trim_ascii_start().first() == Some(&b'{')).then_some(ModelFormat::Gltf)
}

fn by_extension(name: &str) -> Option<ModelFormat> {
    let (_, extension) = name.rsplit_once('.')?;
    match extension.to_ascii_lowercase().as_str() {
        "3ds" => Some(ModelFormat::ThreeDs),
        "obj" => Some(ModelFormat::Obj),
        "gltf" | "glb" => Some(ModelFormat::Gltf),
        _ => None,
    }
}

fn start_of(bytes: &[u8]) -> String {
    let start: Vec<String> = bytes.iter().take(4).map(|byte| format!("{byte:02X}")).collect();
    start.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Nothing;

    impl Companions for Nothing {
        fn load(&self, name: &str) -> Result<Vec<u8>, String> {
            Err(format!("there is no {name}"))
        }
    }

    #[test]
    fn content_counts_for_more_than_the_extension() {
        assert_eq!(format_of("house.obj", b"MM\x06\0\0\0"), Some(ModelFormat::ThreeDs));
        assert_eq!(format_of("house.3ds", b"\xEF\xBB\xBF \n{}"), Some(ModelFormat::Gltf));
        assert_eq!(format_of("HOUSE.OBJ", b"v 0 0 0"), Some(ModelFormat::Obj));
    }

    #[test]
    fn what_cannot_be_read_is_told_what_can() {
        let error = read("house.fbx", b"Kaydara", &Nothing).map(|_| ()).expect_err("not a model");
        let text = error.to_string();
        assert!(
            text.contains("house.fbx") && text.contains("4B 61 79 64") && text.contains(".glb"),
            "{text}"
        );
    }

    #[test]
    fn an_empty_file_is_refused() {
        assert!(matches!(read("a.obj", b"", &Nothing), Err(ModelError::Empty { .. })));
    }
}
