//! The numbers of a page: sections of bytes, each packed by deflate, one after the other.
//!
//! Deflate finds no repetition in floating-point numbers as they are. So each 32-bit number is first written as its
//! difference from the number `stride` before it, as integers that wrap round, and then all lowest bytes come before all
//! second ones, and so on: neighbors differ little, and their high bytes hardly ever. No bit is lost.

use std::collections::BTreeMap;
use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde_json::{Value, json};

/// How hard deflate looks for repetition: a page is written once and opened often.
const LEVEL: u32 = 8;

/// The sections of a page so far.
#[derive(Debug, Default)]
pub struct PageSections {
    bytes: Vec<u8>,
    /// Where the section with these packed bytes is: equal ones, such as the places of all parts of a model, are there once.
    places: BTreeMap<Vec<u8>, usize>,
}

impl PageSections {
    /// All sections.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Adds bytes that are packed already, such as a picture; returns where they are, for the page's description.
    pub fn add_packed(&mut self, bytes: &[u8]) -> Value {
        let at = self.add_once(bytes.to_vec());
        json!({"at": at, "length": bytes.len()})
    }

    /// Adds bytes, each as its difference from the one `stride` before it.
    pub fn add_bytes(&mut self, bytes: &[u8], stride: usize) -> Value {
        let before = |index: usize| index.checked_sub(stride).map_or(0, |before| bytes[before]);
        let differences: Vec<u8> =
            bytes.iter().enumerate().map(|(index, &byte)| byte.wrapping_sub(before(index))).collect();
        self.add_deflated(&differences, "bytes", stride, bytes.len())
    }

    /// Adds numbers of 32 bits, each as its difference from the one `stride` before it.
    pub fn add_words(&mut self, words: &[u32], stride: usize) -> Value {
        let before = |index: usize| index.checked_sub(stride).map_or(0, |before| words[before]);
        let mut planes = vec![0u8; words.len() * 4];
        for (index, &word) in words.iter().enumerate() {
            let difference = word.wrapping_sub(before(index)).to_le_bytes();
            for (plane, byte) in difference.into_iter().enumerate() {
                planes[plane * words.len() + index] = byte;
            }
        }
        self.add_deflated(&planes, "words", stride, words.len())
    }

    /// [`Self::add_words`] of the bits of floating-point numbers.
    pub fn add_floats(&mut self, floats: &[f32], stride: usize) -> Value {
        self.add_words(bytemuck::cast_slice(floats), stride)
    }

    fn add_deflated(&mut self, bytes: &[u8], kind: &str, stride: usize, count: usize) -> Value {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(LEVEL));
        let packed =
            encoder.write_all(bytes).and_then(|()| encoder.finish()).expect("memory takes all bytes");
        let length = packed.len();
        let at = self.add_once(packed);
        json!({"at": at, "length": length, "kind": kind, "stride": stride, "count": count})
    }

    fn add_once(&mut self, packed: Vec<u8>) -> usize {
        let next = self.bytes.len();
        *self.places.entry(packed).or_insert_with_key(|packed| {
            self.bytes.extend_from_slice(packed);
            next
        })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::io::Read;

    /// What the page's script makes of a section of words.
    pub(in crate::page) fn words(sections: &PageSections, section: &Value) -> Vec<u32> {
        let number = |key: &str| section[key].as_u64().expect("a number") as usize;
        let packed = &sections.bytes()[number("at")..][..number("length")];
        let mut planes = Vec::new();
        flate2::read::ZlibDecoder::new(packed).read_to_end(&mut planes).expect("sound");
        let (count, stride) = (number("count"), number("stride"));
        let mut words: Vec<u32> = Vec::with_capacity(count);
        for index in 0..count {
            let byte = |plane: usize| planes[plane * count + index];
            let before = index.checked_sub(stride).map_or(0, |before| words[before]);
            words.push(u32::from_le_bytes([byte(0), byte(1), byte(2), byte(3)]).wrapping_add(before));
        }
        words
    }

    #[test]
    fn numbers_come_back_bit_by_bit_and_smooth_ones_are_small() {
        let mut sections = PageSections::default();
        let smooth: Vec<f32> = (0..30_000).map(|index| 500.0 + (index as f32 * 1e-3).sin()).collect();
        let odd = [f32::NAN, -0.0, f32::MIN, 1e-40, 7.5];
        let (first, second) = (sections.add_floats(&smooth, 1), sections.add_floats(&odd, 2));
        let bits = |floats: &[f32]| floats.iter().map(|float| float.to_bits()).collect::<Vec<_>>();
        assert_eq!(words(&sections, &first), bits(&smooth));
        assert_eq!(words(&sections, &second), bits(&odd));
        assert!(first["length"].as_u64().expect("a number") < 45_000, "{first}");
    }
}
