//! The lists of all patches shown in few calls of the device.
//!
//! ```text
//!   patch 1   ground   road, river │ glass
//!   patch 2   ground   river       │ glass         │ where another pipeline or texture is needed
//!   patch 3   ground   road        │
//!             1 call   1 call        1 call
//! ```
//!
//! Where lists lie in the same blocks of their arenas and are drawn alike, one call draws all of them: it reads from a buffer
//! which vertices and indices each patch has. An adapter that cannot read it so takes a call for each list.

use std::ops::Range;

use bytemuck::cast_slice;
use wgpu::wgt::DrawIndexedIndirectArgs;

use crate::buffer_writes::BufferWrites;
use crate::error::GpuError;
use crate::live::LiveStatistics;
use crate::live::arena::{Arena, StoredRange};
use crate::memory::Loader;
use crate::passes::ScenePass;

/// Indices of a patch that are drawn alike.
#[derive(Clone, Debug)]
pub struct PatchCall {
    pub vertices: StoredRange,
    pub indices: StoredRange,
    /// Which of the stored indices.
    pub drawn: Range<u32>,
}

/// The arenas that calls read, and the sizes of what these hold.
#[derive(Clone, Copy, Debug)]
pub struct CallSource<'a> {
    pub vertices: &'a Arena,
    pub indices: &'a Arena,
    /// Bytes of a vertex. Lists of vertices lie one behind the other, or where some were: whole vertices from the first of
    /// their block on.
    pub vertex_bytes: u64,
    pub format: wgpu::IndexFormat,
}

/// Calls in the order in which they are drawn; `K` is what those of one call have in common.
#[derive(Debug)]
pub struct PatchCalls<K> {
    calls: Vec<PatchCall>,
    runs: Vec<CallRun<K>>,
    /// What the device reads of each call; `None` where it does not.
    arguments: Option<wgpu::Buffer>,
}

/// Calls that are drawn alike and whose lists lie in the same blocks.
#[derive(Clone, Debug, PartialEq, Eq)]
struct CallRun<K> {
    key: K,
    calls: Range<usize>,
}

impl PatchCall {
    /// The blocks of its lists.
    pub fn blocks(&self) -> [usize; 2] {
        [self.vertices.block(), self.indices.block()]
    }

    fn arguments(&self, source: &CallSource<'_>) -> DrawIndexedIndirectArgs {
        DrawIndexedIndirectArgs {
            index_count: self.drawn.len() as u32,
            instance_count: 1,
            first_index: (self.indices.start() / source.format.byte_size() as u64) as u32 + self.drawn.start,
            base_vertex: (self.vertices.start() / source.vertex_bytes) as i32,
            first_instance: 0,
        }
    }
}

impl<K: Copy + PartialEq> PatchCalls<K> {
    /// Sends what the device reads of `calls` to `kept`, or to a larger buffer that takes its place.
    pub fn new(
        writes: &mut BufferWrites<'_>,
        source: &CallSource<'_>,
        calls: impl IntoIterator<Item = (K, PatchCall)>,
        kept: &mut Option<wgpu::Buffer>,
    ) -> Result<Self, GpuError> {
        let (keys, calls): (Vec<K>, Vec<PatchCall>) = calls.into_iter().unzip();
        let mut runs: Vec<CallRun<K>> = Vec::new();
        for (index, (&key, call)) in keys.iter().zip(&calls).enumerate() {
            match runs.last_mut() {
                Some(run) if run.key == key && calls[run.calls.start].blocks() == call.blocks() => {
                    run.calls.end = index + 1;
                }
                _ => runs.push(CallRun { key, calls: index..index + 1 }),
            }
        }
        if !writes.gpu.draws_indirectly || calls.is_empty() {
            return Ok(Self { calls, runs, arguments: None });
        }
        let arguments: Vec<_> = calls.iter().map(|call| call.arguments(source)).collect();
        let bytes: &[u8] = cast_slice(&arguments);
        let buffer = match kept.take().filter(|kept| kept.size() >= bytes.len() as u64) {
            Some(kept) => kept,
            None => {
                let usage = wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST;
                let size = bytes.len().next_power_of_two() as u64;
                Loader::new(writes.gpu).buffer(|| "the calls of patches".into(), usage, size)?
            }
        };
        writes.write(&buffer, 0, bytes);
        *kept = Some(buffer.clone());
        Ok(Self { calls, runs, arguments: Some(buffer) })
    }

    /// How many calls of single lists there are.
    pub fn count(&self) -> usize {
        self.calls.len()
    }

    /// Draws the lists of `source` with what `set` sets for their keys; those for which it returns false are left out.
    pub fn draw(
        &self,
        pass: &mut ScenePass<'_, '_>,
        source: &CallSource<'_>,
        set: impl Fn(&mut ScenePass<'_, '_>, K) -> bool,
    ) -> LiveStatistics {
        let mut drawn = LiveStatistics::default();
        for run in &self.runs {
            if !set(pass, run.key) {
                continue;
            }
            let calls = &self.calls[run.calls.clone()];
            drawn.triangles += calls.iter().map(|call| call.drawn.len() as u64 / 3).sum::<u64>();
            drawn.calls += self.arguments.as_ref().map_or(calls.len(), |_| 1) as u32;
            if let Some(arguments) = &self.arguments {
                let blocks =
                    source.vertices.block(&calls[0].vertices).zip(source.indices.block(&calls[0].indices));
                let Some((vertices, indices)) = blocks else { continue };
                pass.pass.set_vertex_buffer(0, vertices);
                pass.pass.set_index_buffer(indices, source.format);
                let offset = run.calls.start * size_of::<DrawIndexedIndirectArgs>();
                pass.pass.multi_draw_indexed_indirect(arguments, offset as u64, calls.len() as u32);
                continue;
            }
            for call in calls {
                let slices = source.vertices.slice(&call.vertices).zip(source.indices.slice(&call.indices));
                let Some((vertices, indices)) = slices else { continue };
                pass.pass.set_vertex_buffer(0, vertices);
                pass.pass.set_index_buffer(indices, source.format);
                pass.pass.draw_indexed(call.drawn.clone(), 0, 0..1);
            }
        }
        drawn
    }
}
