//! The numbers of a page: sections of bytes, each packed by deflate, one after the other.
//!
//! Deflate finds no repetition in floating-point numbers as they are. So each 32-bit number is first written as its
//! difference from the number `stride` before it, as integers that wrap round, and then all lowest bytes come before all
//! second ones, and so on: neighbors differ little, and their high bytes hardly ever. No bit is lost.

use std::collections::BTreeMap;
use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;
use serde_json::{Value, json};

use sandtable_terrain::stop_flag::StopFlag;

/// How hard deflate looks for repetition. Level 8 takes five times as long and saves two bytes of a hundred, and whoever sits before a
/// notebook waits for it; level 4 is three times as quick and adds four.
const LEVEL: u32 = 6;

/// Bytes that wait to be packed, at most: enough for every thread, and few beside a scene.
const MOST_WAITING_BYTES: usize = 64 << 20;

/// The sections of a page so far. The page's description names a section by its number, and has the table of where they are.
#[derive(Debug, Default)]
pub struct PageSections {
    waiting: Vec<PageSection>,
    waiting_bytes: usize,
    packed: PackedSections,
}

/// The bytes of all sections, and where each section is.
#[derive(Debug, Default)]
pub struct PackedSections {
    /// One section after the other.
    pub bytes: Vec<u8>,
    /// The first byte and the length of each section, by its number.
    pub places: Vec<[usize; 2]>,
    /// Where the section with these bytes is: equal ones, such as the places of all parts of a model, are there once.
    known: BTreeMap<Vec<u8>, usize>,
}

/// A section that waits.
#[derive(Debug)]
enum PageSection {
    Packed(Vec<u8>),
    Deflatable(Vec<u8>),
}

impl PageSections {
    /// Adds bytes that are packed already, such as a picture; returns the number of the section.
    pub fn add_packed(&mut self, bytes: &[u8]) -> usize {
        self.add(PageSection::Packed(bytes.to_vec()))
    }

    /// Adds bytes, each as its difference from the one `stride` before it; returns the section for the page's description.
    pub fn add_bytes(&mut self, bytes: &[u8], stride: usize) -> Value {
        let before = |index: usize| index.checked_sub(stride).map_or(0, |before| bytes[before]);
        let differences =
            bytes.iter().enumerate().map(|(index, &byte)| byte.wrapping_sub(before(index))).collect();
        let section = self.add(PageSection::Deflatable(differences));
        json!({"section": section, "stride": stride, "count": bytes.len()})
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
        let section = self.add(PageSection::Deflatable(planes));
        json!({"section": section, "stride": stride, "count": words.len()})
    }

    /// [`Self::add_words`] of the bits of floating-point numbers.
    pub fn add_floats(&mut self, floats: &[f32], stride: usize) -> Value {
        self.add_words(bytemuck::cast_slice(floats), stride)
    }

    /// All sections, packed. `watch` says how much of what waited is.
    pub fn finish(mut self, watch: &StopFlag) -> PackedSections {
        watch.stretch(0.0..1.0, self.waiting_bytes);
        self.pack(watch);
        self.packed
    }

    fn add(&mut self, section: PageSection) -> usize {
        self.waiting_bytes += section.bytes().len();
        self.waiting.push(section);
        let number = self.packed.places.len() + self.waiting.len() - 1;
        if self.waiting_bytes > MOST_WAITING_BYTES {
            self.pack(&StopFlag::default());
        }
        number
    }

    /// Packs what waits, on all threads.
    fn pack(&mut self, watch: &StopFlag) {
        let packed = |section: PageSection| {
            let bytes = section.bytes().len();
            let packed = section.packed();
            watch.did(bytes);
            packed
        };
        let packed: Vec<Vec<u8>> = std::mem::take(&mut self.waiting).into_par_iter().map(packed).collect();
        self.waiting_bytes = 0;
        for section in packed {
            self.packed.add(section);
        }
    }
}

impl PageSection {
    fn bytes(&self) -> &[u8] {
        let (Self::Packed(bytes) | Self::Deflatable(bytes)) = self;
        bytes
    }

    fn packed(self) -> Vec<u8> {
        match self {
            Self::Packed(bytes) => bytes,
            Self::Deflatable(bytes) => {
                let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(LEVEL));
                encoder.write_all(&bytes).and_then(|()| encoder.finish()).expect("memory takes all bytes")
            }
        }
    }
}

impl PackedSections {
    fn add(&mut self, section: Vec<u8>) {
        let (next, length) = (self.bytes.len(), section.len());
        let at = *self.known.entry(section).or_insert_with_key(|section| {
            self.bytes.extend_from_slice(section);
            next
        });
        self.places.push([at, length]);
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::io::Read;

    /// What the page's script makes of a section of words.
    pub(in crate::page) fn words(sections: &PackedSections, section: &Value) -> Vec<u32> {
        let number = |key: &str| section[key].as_u64().expect("a number") as usize;
        let [at, length] = sections.places[number("section")];
        let packed = &sections.bytes[at..][..length];
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
        let [first, second, again] = [(&smooth[..], 1), (&odd, 2), (&smooth, 1)]
            .map(|(floats, stride)| sections.add_floats(floats, stride));
        let sections = sections.finish(&StopFlag::default());
        let bits = |floats: &[f32]| floats.iter().map(|float| float.to_bits()).collect::<Vec<_>>();
        assert_eq!(words(&sections, &first), bits(&smooth));
        assert_eq!(words(&sections, &second), bits(&odd));
        assert!(sections.bytes.len() < 45_000, "{}", sections.bytes.len());
        assert_eq!(words(&sections, &again), bits(&smooth));
        assert_eq!(sections.places[0], sections.places[2], "equal sections are there once");
    }
}
