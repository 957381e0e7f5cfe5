//! Buffers that many small lists share: a list is stored in one write and draws need not change buffers' memory.
//!
//! ```text
//!   block 0  ▓▓▓▓░░▓▓▓▓▓▓▓░░░░     ▓ in use   ░ free: first fit, neighbors are joined
//!   block 1  ▓▓▓░░░░░░░░░░░░░░
//! ```
//!
//! Blocks never grow, so that nothing stored is ever copied; a block in which nothing is left is given back.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::adapter::Gpu;
use crate::buffer_writes::BufferWrites;
use crate::error::GpuError;

/// Bytes in a block: larger ones waste more where little is stored, smaller ones are changed more often while drawing.
const BLOCK_BYTES: u64 = 16 << 20;

/// What writes and bindings are aligned to.
const ALIGNMENT: u64 = 4;

/// A list in an arena.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredRange {
    pub(super) block: usize,
    pub(super) bytes: Range<u64>,
}

impl StoredRange {
    /// The number of its block.
    pub fn block(&self) -> usize {
        self.block
    }

    /// Its first byte in the block.
    pub fn start(&self) -> u64 {
        self.bytes.start
    }
}

#[derive(Debug)]
pub struct Arena {
    label: &'static str,
    usage: wgpu::BufferUsages,
    blocks: Vec<Option<ArenaBlock>>,
}

#[derive(Debug)]
struct ArenaBlock {
    buffer: wgpu::Buffer,
    free: FreeRanges,
}

/// The free ranges of a block: their ends by their starts.
#[derive(Debug)]
struct FreeRanges {
    by_start: BTreeMap<u64, u64>,
    size: u64,
}

impl Arena {
    pub fn new(label: &'static str, usage: wgpu::BufferUsages) -> Self {
        Self { label, usage: usage | wgpu::BufferUsages::COPY_DST, blocks: Vec::new() }
    }

    /// Stores bytes until they are released; those up to the next multiple of four are zero.
    pub fn store(&mut self, writes: &mut BufferWrites<'_>, contents: &[u8]) -> Result<StoredRange, GpuError> {
        let size = (contents.len() as u64).next_multiple_of(ALIGNMENT);
        let known = self.blocks.iter_mut().enumerate().find_map(|(index, block)| {
            let bytes = block.as_mut()?.free.take(size)?;
            Some(StoredRange { block: index, bytes })
        });
        let range = match known {
            Some(range) => range,
            None => self.in_new_block(writes.gpu, size)?,
        };
        if let Some(Some(block)) = self.blocks.get(range.block) {
            writes.write(&block.buffer, range.bytes.start, contents);
        }
        Ok(range)
    }

    pub fn release(&mut self, range: StoredRange) {
        let Some(slot) = self.blocks.get_mut(range.block) else { return };
        let Some(block) = slot else { return };
        block.free.give_back(range.bytes);
        if block.free.is_all() {
            *slot = None;
        }
    }

    /// The stored bytes, to be bound; `None` for a range of another arena.
    pub fn slice(&self, range: &StoredRange) -> Option<wgpu::BufferSlice<'_>> {
        let block = self.blocks.get(range.block)?.as_ref()?;
        Some(block.buffer.slice(range.bytes.clone()))
    }

    /// The whole block of what is stored, to be bound; `None` for a range of another arena.
    pub fn block(&self, range: &StoredRange) -> Option<wgpu::BufferSlice<'_>> {
        Some(self.blocks.get(range.block)?.as_ref()?.buffer.slice(..))
    }

    /// The size of all blocks in bytes.
    pub fn size(&self) -> u64 {
        self.blocks.iter().flatten().map(|block| block.free.size).sum()
    }

    fn in_new_block(&mut self, gpu: &Gpu, size: u64) -> Result<StoredRange, GpuError> {
        let block_size = size.max(BLOCK_BYTES.min(gpu.limits.max_buffer_size));
        let label = self.label;
        gpu.check_size(|| label.into(), block_size)?;
        gpu.check_total(label, self.size() + block_size)?;
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: block_size,
            usage: self.usage,
            mapped_at_creation: false,
        });
        let mut free = FreeRanges::new(block_size);
        let bytes = free.take(size).unwrap_or(0..size);
        let block = Some(ArenaBlock { buffer, free });
        let index = self.blocks.iter().position(Option::is_none).unwrap_or(self.blocks.len());
        match self.blocks.get_mut(index) {
            Some(slot) => *slot = block,
            None => self.blocks.push(block),
        }
        Ok(StoredRange { block: index, bytes })
    }
}

impl FreeRanges {
    fn new(size: u64) -> Self {
        Self { by_start: BTreeMap::from([(0, size)]), size }
    }

    /// The first free range of `size` bytes.
    fn take(&mut self, size: u64) -> Option<Range<u64>> {
        let (&start, &end) = self.by_start.iter().find(|(start, end)| *end - *start >= size)?;
        self.by_start.remove(&start);
        if start + size < end {
            self.by_start.insert(start + size, end);
        }
        Some(start..start + size)
    }

    fn give_back(&mut self, range: Range<u64>) {
        let Range { mut start, mut end } = range;
        if start == end {
            return;
        }
        if let Some((&before, &before_end)) = self.by_start.range(..start).next_back()
            && before_end == start
        {
            start = before;
        }
        if let Some(after_end) = self.by_start.remove(&end) {
            end = after_end;
        }
        self.by_start.insert(start, end);
    }

    fn is_all(&self) -> bool {
        self.by_start.get(&0) == Some(&self.size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_given_back_joins_its_neighbors_and_is_taken_again() {
        let mut free = FreeRanges::new(100);
        let taken: Vec<_> = [40, 20, 40].into_iter().filter_map(|size| free.take(size)).collect();
        assert_eq!(taken, [0..40, 40..60, 60..100]);
        assert_eq!(free.take(1), None);
        free.give_back(0..40);
        free.give_back(60..100);
        assert_eq!(free.take(60), None, "the middle is in use");
        free.give_back(40..60);
        assert!(free.is_all());
        assert_eq!(free.take(100), Some(0..100));
    }

    #[test]
    fn ranges_in_use_never_overlap_whatever_the_order() {
        let mut free = FreeRanges::new(4096);
        let mut used: Vec<Range<u64>> = Vec::new();
        let mut state = 7u32;
        for _ in 0..2000 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let size = u64::from(state >> 24) * 4 + 4;
            if state & 4 == 0
                && let Some(range) = free.take(size)
            {
                assert!(used.iter().all(|other| range.end <= other.start || other.end <= range.start));
                used.push(range);
            } else if !used.is_empty() {
                free.give_back(used.swap_remove((state >> 8) as usize % used.len()));
            }
        }
        used.into_iter().for_each(|range| free.give_back(range));
        assert!(free.is_all());
    }
}
