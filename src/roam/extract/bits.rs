//! The first two passes of extraction: one bit a vertex, and the vertices' numbers, which are counts of bits.

use crate::layout::PatchLayout;

/// Columns and rows of the blocks that are skipped where their center is not active: sixteen errors are one cache line, and a
/// quarter of a word of bits.
const BLOCK: usize = 16;

/// The active vertices as bits, row by row, and the number of active vertices before each word.
#[derive(Clone, Debug, Default)]
pub struct ActiveBits {
    pub words: Vec<u64>,
    pub before: Vec<u32>,
    /// The numbers of active vertices with even coordinates; stale for other vertices.
    pub even_numbers: Vec<u32>,
    pub even_width: usize,
    /// Words in a row.
    pub width: usize,
    pub columns: usize,
    pub rows: usize,
    pub patch: usize,
}

impl ActiveBits {
    pub fn set(&mut self, layout: &PatchLayout, errors: &[f32], tolerance_m: f32) {
        (self.columns, self.rows) = (layout.columns(), layout.rows());
        self.patch = layout.patch() as usize;
        self.width = self.columns.div_ceil(64);
        self.words.clear();
        self.words.resize(self.width * self.rows, 0);
        if self.patch < BLOCK {
            for (from, to) in errors.chunks_exact(self.columns).zip(self.words.chunks_exact_mut(self.width)) {
                for (word, from) in to.iter_mut().zip(from.chunks(64)) {
                    *word = above(from, tolerance_m);
                }
            }
        } else {
            self.set_by_blocks(errors, tolerance_m);
        }
        for y in (0..self.rows).step_by(self.patch) {
            for x in (0..self.columns).step_by(self.patch) {
                self.words[y * self.width + x / 64] |= 1 << (x % 64);
            }
        }
    }

    /// Inside a block, all vertices descend from its center; on its sides, from that of the block beyond as well;
    /// its corners, of other vertices, are always tested.
    fn set_by_blocks(&mut self, errors: &[f32], tolerance_m: f32) {
        let (columns, width) = (self.columns, self.width);
        let blocks = (columns - 1) / BLOCK;
        let mut south = vec![false; blocks];
        let mut here = vec![false; blocks];
        for first in (0..self.rows).step_by(BLOCK) {
            std::mem::swap(&mut south, &mut here);
            match errors.chunks_exact(columns).nth(first + BLOCK / 2) {
                Some(centers) => {
                    let centers = centers[BLOCK / 2..].iter().step_by(BLOCK);
                    here.iter_mut().zip(centers).for_each(|(here, &error)| *here = error > tolerance_m);
                }
                None => here.fill(false),
            }
            for block in 0..=blocks {
                let x = block * BLOCK;
                let is = |active: &[bool], block: usize| active.get(block).is_some_and(|&active| active);
                let (own, west) = (is(&here, block), is(&here, block.wrapping_sub(1)));
                let words = self.words[first * width + x / 64..].iter_mut().step_by(width);
                let mut rows = words.zip(errors[first * columns + x..].chunks(columns)).take(BLOCK);
                if let Some((word, from)) = rows.next() {
                    let wide = own || is(&south, block);
                    *word |= above_block(from, if wide { BLOCK } else { 1 }, tolerance_m) << (x % 64);
                }
                if own {
                    rows.for_each(|(word, from)| *word |= above_block(from, BLOCK, tolerance_m) << (x % 64));
                } else if west {
                    rows.for_each(|(word, from)| *word |= u64::from(from[0] > tolerance_m) << (x % 64));
                }
            }
        }
    }

    /// Numbers the vertices and lists them.
    pub fn number(&mut self, vertices: &mut Vec<u32>) {
        self.before.clear();
        let mut count = 0;
        self.before.extend(self.words.iter().map(|word| {
            let before = count;
            count += word.count_ones();
            before
        }));
        self.even_width = self.columns / 2 + 1;
        self.even_numbers.resize(self.even_width * (self.rows / 2 + 1), 0);
        vertices.clear();
        vertices.reserve(count as usize);
        for (row, words) in self.words.chunks_exact(self.width).enumerate() {
            let even_row = row / 2 * self.even_width;
            for (place, &word) in words.iter().enumerate().filter(|(_, word)| **word != 0) {
                let mut number = vertices.len() as u32;
                let first = (row * self.columns + place * 64) as u32;
                vertices.extend(places(word).map(|bit| first + bit));
                if row % 2 == 0 {
                    let numbers = &mut self.even_numbers[even_row + place * 32..];
                    for bit in places(word) {
                        // An odd place has the even ones beside it active, and writes once more what is there.
                        numbers[bit as usize / 2] = number - (bit & 1);
                        number += 1;
                    }
                }
            }
        }
    }

    /// Room for all triangles and for those that are written and not kept.
    pub fn most_triangles(layout: &PatchLayout, vertices: &[u32]) -> usize {
        2 * layout.patch_count() + 2 * vertices.len() + 4
    }

    pub fn get(&self, x: usize, y: usize) -> bool {
        self.words[y * self.width + x / 64] >> (x % 64) & 1 == 1
    }

    /// The number of an active vertex.
    pub fn rank(&self, x: usize, y: usize) -> u32 {
        let word = y * self.width + x / 64;
        self.before[word] + (self.words[word] & ((1 << (x % 64)) - 1)).count_ones()
    }
}

/// The places of a word's bits, from the lowest.
pub fn places(mut word: u64) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let place = (word != 0).then(|| word.trailing_zeros());
        word &= word.wrapping_sub(1);
        place
    })
}

/// One bit for each of up to 64 errors.
fn above(errors: &[f32], tolerance_m: f32) -> u64 {
    let mut bytes = [0u8; 64];
    for (byte, &error) in bytes.iter_mut().zip(errors) {
        *byte = u8::from(error > tolerance_m);
    }
    let eights = bytes.as_chunks::<8>().0.iter().enumerate();
    eights.fold(0, |word, (place, eight)| word | gather(eight) << (8 * place))
}

/// The same for the first `count` errors, 16 or 1.
fn above_block(errors: &[f32], count: usize, tolerance_m: f32) -> u64 {
    let Some(errors) = errors.first_chunk::<BLOCK>().filter(|_| count == BLOCK) else {
        return u64::from(errors[0] > tolerance_m);
    };
    let mut bytes = [0u8; BLOCK];
    for (byte, &error) in bytes.iter_mut().zip(errors) {
        *byte = u8::from(error > tolerance_m);
    }
    bytes.as_chunks::<8>().0.iter().rev().fold(0, |word, eight| word << 8 | gather(eight))
}

/// Eight bytes of 0 or 1 to eight bits: every byte is moved to its place in the top byte, and nothing else is.
fn gather(eight: &[u8; 8]) -> u64 {
    u64::from_le_bytes(*eight).wrapping_mul(0x0102_0408_1020_4080) >> 56
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixty_four_errors_are_sixty_four_bits() {
        for place in 0..64 {
            let mut errors = [1.0f32; 64];
            errors[place] = 1.5;
            assert_eq!(above(&errors, 1.0), 1 << place);
            assert_eq!(above(&errors[..place], 1.0), 0);
        }
        assert_eq!(above(&[f32::INFINITY; 64], 1.0), u64::MAX);
    }
}
