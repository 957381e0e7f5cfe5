//! Bytes: buffers from the GLB chunk, data URIs or companions, and the views into them.

use std::collections::BTreeMap;
use std::rc::Rc;

use ::gltf::json::Root;

use crate::model::Companions;
use crate::model::error::ModelError;

/// The buffers of a document, or why one cannot be had: a buffer that nothing reads may be missing.
pub(super) struct GltfBuffers {
    buffers: Vec<Result<Rc<[u8]>, String>>,
}

/// A part of a buffer with the distance between its elements, where it states one.
#[derive(Clone, Copy, Debug)]
pub(super) struct BufferView<'a> {
    pub bytes: &'a [u8],
    pub stride: Option<usize>,
}

impl GltfBuffers {
    /// All buffers, each companion loaded once.
    pub(super) fn load(root: &Root, binary: Option<&[u8]>, companions: &dyn Companions) -> Self {
        let mut by_uri: BTreeMap<&str, Result<Rc<[u8]>, String>> = BTreeMap::new();
        let mut buffers = Vec::new();
        for (index, buffer) in root.buffers.iter().enumerate() {
            let bytes = match (&buffer.uri, binary) {
                (Some(uri), _) => {
                    by_uri.entry(uri).or_insert_with(|| resolve(uri, companions).map(Rc::from)).clone()
                }
                (None, Some(binary)) if index == 0 => Ok(binary.into()),
                (None, _) => Err("it has no uri, and the file no binary chunk for it".into()),
            };
            buffers.push(bytes.and_then(|bytes| {
                let (stated, there) = (buffer.byte_length.0, bytes.len());
                let enough = there as u64 >= stated;
                if enough { Ok(bytes) } else { Err(format!("{stated} bytes are stated and {there} there")) }
            }));
        }
        Self { buffers }
    }

    /// The bytes of buffer view `index`.
    ///
    /// # Errors
    /// [`ModelError::Gltf`] where its buffer cannot be had or it reaches past it.
    pub(super) fn view(&self, root: &Root, index: usize) -> Result<BufferView<'_>, ModelError> {
        let fail = |reason: &str| ModelError::gltf(format!("bufferViews[{index}]"), reason);
        let view = root.buffer_views.get(index).ok_or_else(|| fail("it is not there"))?;
        let place = view.buffer.value();
        let buffer = self.buffers.get(place).ok_or_else(|| fail("its buffer is not there"))?;
        let buffer =
            buffer.as_ref().map_err(|reason| ModelError::gltf(format!("buffers[{place}]"), reason))?;
        let start = usize::try_from(view.byte_offset.unwrap_or_default().0).ok();
        let length = usize::try_from(view.byte_length.0).ok();
        let bytes = start
            .zip(length)
            .and_then(|(start, length)| buffer.get(start..start.checked_add(length)?))
            .ok_or_else(|| fail("it reaches past the end of its buffer"))?;
        Ok(BufferView { bytes, stride: view.byte_stride.map(|stride| stride.0) })
    }
}

/// The bytes a URI stands for.
///
/// # Errors
/// A sentence.
fn resolve(uri: &str, companions: &dyn Companions) -> Result<Vec<u8>, String> {
    if uri.starts_with("data:") {
        return bytes_of(uri);
    }
    companions.load(&file_name(uri)?).map_err(|reason| format!("its file '{uri}' cannot be had: {reason}"))
}

/// The bytes in a data URI (RFC 2397).
///
/// # Errors
/// A sentence.
pub(super) fn bytes_of(uri: &str) -> Result<Vec<u8>, String> {
    let (kind, body) = uri.split_once(',').ok_or("its data URI has no comma")?;
    if kind.ends_with(";base64") { base64(body) } else { Ok(unescape(body)) }
}

/// The relative file name that a URI stands for.
///
/// # Errors
/// Where the URI is not relative.
pub(super) fn file_name(uri: &str) -> Result<String, String> {
    let scheme = uri.split_once(':').map(|(scheme, _)| scheme);
    if scheme
        .is_some_and(|scheme| scheme.chars().all(|each| each.is_ascii_alphanumeric() || "+-.".contains(each)))
    {
        return Err(format!("'{uri}' is no file beside the model"));
    }
    String::from_utf8(unescape(uri)).map_err(|_| format!("'{uri}' is no UTF-8"))
}

/// `%20` and its like to bytes (RFC 3986).
fn unescape(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let code = || u8::from_str_radix(std::str::from_utf8(bytes.get(at + 1..at + 3)?).ok()?, 16).ok();
        match (bytes[at], code()) {
            (b'%', Some(byte)) => {
                out.push(byte);
                at += 3;
            }
            (byte, _) => {
                out.push(byte);
                at += 1;
            }
        }
    }
    out
}

/// Base64 (RFC 4648), either alphabet, padding optional.
fn base64(text: &str) -> Result<Vec<u8>, String> {
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
            _ => return Err(format!("its data URI holds '{}', which is no base64", char::from(byte))),
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
            assert_eq!(base64(text), Ok(bytes.into()));
        }
        assert!(base64("Zm*v").is_err());
    }

    #[test]
    fn only_relative_uris_are_files() {
        assert_eq!(file_name("my%20wall.png"), Ok("my wall.png".into()));
        assert_eq!(file_name("100%.png"), Ok("100%.png".into()));
        assert!(file_name("https://example.org/a.bin").is_err() && file_name("file:///etc/passwd").is_err());
    }
}
