//! The ground of all patches shown in few calls of the device.
//!
//! Where lists lie in the same blocks of their arenas, one call draws all of them: it reads from a buffer which vertices and
//! indices each patch has. An adapter that cannot read it so takes a call for each patch.

use std::ops::Range;

use bytemuck::cast_slice;
use wgpu::wgt::DrawIndexedIndirectArgs;

use crate::adapter::Gpu;
use crate::error::GpuError;
use crate::live::LiveStatistics;
use crate::live::arena::{Arena, StoredRange};
use crate::memory::Loader;

/// Bytes of an index.
const INDEX_BYTES: u64 = size_of::<u16>() as u64;

/// Bytes of a vertex.
const VERTEX_BYTES: u64 = size_of::<[f32; 3]>() as u64;

/// The ground of a patch.
#[derive(Clone, Debug)]
pub struct GroundCall {
    pub vertices: StoredRange,
    pub indices: StoredRange,
    pub triangles: u32,
}

/// The ground of some patches, in the order in which it is drawn.
#[derive(Debug, Default)]
pub struct GroundCalls {
    calls: Vec<GroundCall>,
    /// Calls whose lists lie in the same blocks.
    runs: Vec<Range<usize>>,
    /// What the device reads of each call; `None` where it does not.
    arguments: Option<wgpu::Buffer>,
}

impl GroundCall {
    fn arguments(&self) -> DrawIndexedIndirectArgs {
        DrawIndexedIndirectArgs {
            index_count: self.triangles * 3,
            instance_count: 1,
            first_index: (self.indices.start() / INDEX_BYTES) as u32,
            // Lists of vertices lie one behind the other, or where some were: whole vertices from the block's first.
            base_vertex: (self.vertices.start() / VERTEX_BYTES) as i32,
            first_instance: 0,
        }
    }

    fn blocks(&self) -> [usize; 2] {
        [self.vertices.block(), self.indices.block()]
    }
}

impl GroundCalls {
    /// Sends what the device reads of `calls` to `kept`, or to a larger buffer that takes its place.
    pub fn new(gpu: &Gpu, calls: Vec<GroundCall>, kept: &mut Option<wgpu::Buffer>) -> Result<Self, GpuError> {
        let mut runs: Vec<Range<usize>> = Vec::new();
        for (index, call) in calls.iter().enumerate() {
            match runs.last_mut() {
                Some(run) if calls[run.start].blocks() == call.blocks() => run.end = index + 1,
                _ => runs.push(index..index + 1),
            }
        }
        if !gpu.draws_indirectly || calls.is_empty() {
            return Ok(Self { calls, runs, arguments: None });
        }
        let arguments: Vec<_> = calls.iter().map(GroundCall::arguments).collect();
        let bytes: &[u8] = cast_slice(&arguments);
        let buffer = match kept.take().filter(|kept| kept.size() >= bytes.len() as u64) {
            Some(kept) => kept,
            None => {
                let usage = wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST;
                let size = bytes.len().next_power_of_two() as u64;
                Loader::new(gpu).buffer(|| "the calls of the ground".into(), usage, size)?
            }
        };
        gpu.queue.write_buffer(&buffer, 0, bytes);
        *kept = Some(buffer.clone());
        Ok(Self { calls, runs, arguments: Some(buffer) })
    }

    /// Draws with the pipeline that is set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, vertices: &Arena, indices: &Arena) -> LiveStatistics {
        let mut drawn = LiveStatistics::default();
        for run in &self.runs {
            let calls = &self.calls[run.clone()];
            drawn.patches += run.len() as u32;
            drawn.triangles += calls.iter().map(|call| u64::from(call.triangles)).sum::<u64>();
            drawn.calls += self.arguments.as_ref().map_or(run.len(), |_| 1) as u32;
            if let Some(arguments) = &self.arguments {
                let blocks = vertices.block(&calls[0].vertices).zip(indices.block(&calls[0].indices));
                let Some((vertices, indices)) = blocks else { continue };
                pass.set_vertex_buffer(0, vertices);
                pass.set_index_buffer(indices, wgpu::IndexFormat::Uint16);
                let offset = run.start * size_of::<DrawIndexedIndirectArgs>();
                pass.multi_draw_indexed_indirect(arguments, offset as u64, run.len() as u32);
                continue;
            }
            for call in calls {
                let slices = vertices.slice(&call.vertices).zip(indices.slice(&call.indices));
                let Some((vertices, indices)) = slices else { continue };
                pass.set_vertex_buffer(0, vertices);
                pass.set_index_buffer(indices, wgpu::IndexFormat::Uint16);
                pass.draw_indexed(0..call.triangles * 3, 0, 0..1);
            }
        }
        drawn
    }
}
