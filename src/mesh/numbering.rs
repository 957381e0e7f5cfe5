//! Numbers for distinct keys, in the order in which they first occur: how equal vertices are welded.

use std::collections::HashMap;
use std::hash::Hash;

use glam::Vec3;

/// Numbers distinct keys 0, 1, 2, … in the order of their first use.
#[derive(Clone, Debug)]
pub struct Numbering<K> {
    numbers: HashMap<K, u32>,
}

impl<K> Default for Numbering<K> {
    fn default() -> Self {
        Self { numbers: HashMap::new() }
    }
}

impl<K: Eq + Hash> Numbering<K> {
    /// The number of `key`, and whether the key is new.
    pub fn number(&mut self, key: K) -> Numbered {
        let next = self.numbers.len() as u32;
        let index = *self.numbers.entry(key).or_insert(next);
        Numbered { index, is_new: index == next }
    }
}

/// The number of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Numbered {
    /// The number.
    pub index: u32,
    /// Whether the key occurred for the first time.
    pub is_new: bool,
}

/// The bits of a position: the key by which vertices are welded. −0 counts as 0.
pub fn weld_key(position: Vec3) -> [u32; 3] {
    (position + Vec3::ZERO).to_array().map(f32::to_bits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_keys_share_a_number_and_minus_zero_is_zero() {
        let mut numbering = Numbering::default();
        let [one, other] = [Vec3::new(0.0, 1.0, 2.0), Vec3::new(-0.0, 1.0, 2.0)];
        assert_eq!(numbering.number(weld_key(one)), Numbered { index: 0, is_new: true });
        assert_eq!(numbering.number(weld_key(Vec3::ONE)), Numbered { index: 1, is_new: true });
        assert_eq!(numbering.number(weld_key(other)), Numbered { index: 0, is_new: false });
    }
}
