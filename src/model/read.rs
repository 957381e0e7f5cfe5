//! Reads a model file of any format. The format follows from the content, else from the extension.

use std::collections::BTreeSet;

use crate::error::ModelError;
use crate::{Companions, Model};
use crate::{gltf, obj, three_ds};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ModelFormat {
    ThreeDs,
    Obj,
    Gltf,
}

/// The model in `bytes`. `name` is the file's name, for its extension and for messages; `companions` loads the files
/// that the model names.
///
/// # Errors
/// [`ModelError`]. A missing or broken texture is not an error but one of [`Model::notes`].
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
        model.notes.push("the model has nothing to draw".into());
    }
    shorten(&mut model.notes);
    Ok(model)
}

/// Drops repeated notes, and all after the first few.
fn shorten(notes: &mut Vec<String>) {
    /// As many as a user reads. Arbitrary.
    const MAX_NOTES: usize = 40;
    let mut known = BTreeSet::new();
    notes.retain(|note| known.insert(note.clone()));
    if notes.len() > MAX_NOTES {
        let more = notes.len() - MAX_NOTES;
        notes.truncate(MAX_NOTES);
        notes.push(format!("and {more} more"));
    }
}

/// The format by its content, else by its extension.
fn format_of(name: &str, bytes: &[u8]) -> Option<ModelFormat> {
    /// The id of the outermost chunk of a 3DS file, `0x4D4D`.
    const MAIN_CHUNK: &[u8] = b"MM";
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes).trim_ascii_start();
    if bytes.starts_with(MAIN_CHUNK) {
        return Some(ModelFormat::ThreeDs);
    }
    if bytes.starts_with(b"glTF") || text.starts_with(b"{") {
        return Some(ModelFormat::Gltf);
    }
    match name.rsplit_once('.')?.1.to_ascii_lowercase().as_str() {
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
    use crate::error::CompanionError;

    struct NoCompanions;

    impl Companions for NoCompanions {
        fn load(&self, name: &str) -> Result<Vec<u8>, CompanionError> {
            Err(format!("there is no {name}").into())
        }
    }

    #[test]
    fn the_content_outweighs_the_extension() {
        assert_eq!(format_of("house.obj", b"MM\x06\0\0\0"), Some(ModelFormat::ThreeDs));
        assert_eq!(format_of("house.3ds", b"\xEF\xBB\xBF \n{}"), Some(ModelFormat::Gltf));
        assert_eq!(format_of("HOUSE.OBJ", b"v 0 0 0"), Some(ModelFormat::Obj));
    }

    #[test]
    fn an_unknown_format_is_refused_with_the_formats_that_are_read() {
        let error = read("house.fbx", b"Kaydara", &NoCompanions).map(|_| ()).expect_err("not a model");
        let text = error.to_string();
        assert!(
            text.contains("house.fbx") && text.contains("4B 61 79 64") && text.contains(".glb"),
            "{text}"
        );
    }

    #[test]
    fn an_empty_file_is_refused() {
        assert!(matches!(read("a.obj", b"", &NoCompanions), Err(ModelError::Empty { .. })));
    }
}
