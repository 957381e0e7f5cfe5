//! Bytes of buffers and images: the GLB chunk, data URIs, companions, and the views into them.

use std::collections::BTreeMap;
use std::sync::Arc;

use ::gltf::Document;
use ::gltf::buffer::{Source, View};
use percent_encoding::percent_decode_str;

use crate::Companions;
use crate::error::{GltfDataError, ModelError};

/// The buffers of a document. A buffer that nothing reads may be missing.
pub(super) struct GltfBuffers {
    buffers: Vec<Result<Arc<[u8]>, Arc<GltfDataError>>>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct BufferView<'a> {
    pub bytes: &'a [u8],
    /// Bytes between the starts of elements, where stated.
    pub stride: Option<usize>,
}

impl GltfBuffers {
    /// All buffers, each companion loaded once.
    pub(super) fn load(document: &Document, binary: Option<&[u8]>, companions: &dyn Companions) -> Self {
        let mut by_uri: BTreeMap<&str, Result<Arc<[u8]>, Arc<GltfDataError>>> = BTreeMap::new();
        let mut buffers = Vec::new();
        for buffer in document.buffers() {
            let bytes = match (buffer.source(), binary) {
                (Source::Uri(uri), _) => {
                    let load = || load_uri(uri, companions).map(Arc::from).map_err(Arc::new);
                    by_uri.entry(uri).or_insert_with(load).clone()
                }
                (Source::Bin, Some(binary)) if buffer.index() == 0 => Ok(binary.into()),
                (Source::Bin, _) => Err(Arc::new(GltfDataError::NoSource)),
            };
            buffers.push(bytes.and_then(|bytes| {
                let (stated, actual) = (buffer.length() as u64, bytes.len());
                let is_short = (actual as u64) < stated;
                if is_short { Err(Arc::new(GltfDataError::TooShort { stated, actual })) } else { Ok(bytes) }
            }));
        }
        Self { buffers }
    }

    pub(super) fn view(&self, view: &View<'_>) -> Result<BufferView<'_>, ModelError> {
        let index = view.buffer().index();
        let buffer = self.buffers[index].as_ref();
        let buffer = buffer.map_err(|source| ModelError::GltfBuffer { index, source: Arc::clone(source) })?;
        let end = view.offset().checked_add(view.length());
        let bytes = end.and_then(|end| buffer.get(view.offset()..end)).ok_or_else(|| {
            let place = format!("bufferViews[{}]", view.index());
            ModelError::gltf(place, "it reaches past the end of its buffer")
        })?;
        Ok(BufferView { bytes, stride: view.stride() })
    }
}

fn load_uri(uri: &str, companions: &dyn Companions) -> Result<Vec<u8>, GltfDataError> {
    if uri.starts_with("data:") {
        return decode_data_uri(uri);
    }
    let bytes = companions.load(&file_name(uri)?);
    bytes.map_err(|source| GltfDataError::Companion { uri: uri.into(), source })
}

/// The bytes in a data URI (RFC 2397).
pub(super) fn decode_data_uri(uri: &str) -> Result<Vec<u8>, GltfDataError> {
    let (kind, body) = uri.split_once(',').ok_or(GltfDataError::NoComma)?;
    if kind.ends_with(";base64") { base64(body) } else { Ok(percent_decode_str(body).collect()) }
}

pub(super) fn file_name(uri: &str) -> Result<String, GltfDataError> {
    let is_scheme =
        |text: &str| text.chars().all(|each| each.is_ascii_alphanumeric() || "+-.".contains(each));
    if uri.split_once(':').is_some_and(|(scheme, _)| is_scheme(scheme)) {
        return Err(GltfDataError::NotRelative(uri.into()));
    }
    let name = percent_decode_str(uri).decode_utf8();
    name.map(Into::into).map_err(|_| GltfDataError::NotUtf8(uri.into()))
}

/// Base64 (RFC 4648), either alphabet, padding optional.
fn base64(text: &str) -> Result<Vec<u8>, GltfDataError> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3 + 3);
    let (mut bits, mut held) = (0u32, 0);
    for byte in text.trim_end_matches('=').bytes() {
        let digit = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            b'\r' | b'\n' | b' ' => continue,
            _ => return Err(GltfDataError::NotBase64(char::from(byte))),
        };
        bits = bits << 6 | u32::from(digit);
        held += 6;
        if held >= 8 {
            held -= 8;
            out.push((bits >> held) as u8);
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_every_length() {
        for (text, bytes) in [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg", "foob")] {
            assert_eq!(base64(text).expect(text), bytes.as_bytes());
        }
        assert!(base64("Zm*v").is_err());
    }

    #[test]
    fn only_relative_uris_are_files() {
        assert_eq!(file_name("my%20wall.png").expect("relative"), "my wall.png");
        assert_eq!(file_name("100%.png").expect("relative"), "100%.png");
        assert!(file_name("https://example.org/a.bin").is_err() && file_name("file:///etc/passwd").is_err());
    }
}
