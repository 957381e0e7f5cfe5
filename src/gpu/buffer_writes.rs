//! Bytes that are sent to buffers: staged for the next frame, or by the queue.
//!
//! ```text
//!   staged       bytes ─► ring of mapped buffers ─► copies at the head of the frame's commands
//!   by the queue bytes ─► a buffer for each write ─► copies before all commands
//! ```
//!
//! A frame that moves writes some hundred short lists. The queue makes and maps a buffer for each, and frees it afterwards; of a
//! ring only places are taken. What is sent rarely, or by another thread, goes by the queue.

use wgpu::util::StagingBelt;

use crate::adapter::Gpu;

/// The bytes of a buffer of the ring: about what a frame that moves sends.
const CHUNK_BYTES: u64 = 1 << 20;

/// The bytes of a frame above which the ring's buffers are not kept for the next: a scene that is sent whole would keep as much
/// memory a second time.
const KEPT_BYTES: u64 = 8 << 20;

/// What multiples of bytes are copied.
const ALIGNMENT: u64 = wgpu::COPY_BUFFER_ALIGNMENT;

/// Writes for the frames of a renderer.
#[derive(Debug)]
pub struct StagingRing {
    belt: StagingBelt,
    copies: Vec<StagedCopy>,
}

/// Bytes in the ring and their place.
#[derive(Debug)]
struct StagedCopy {
    from: wgpu::Buffer,
    from_byte: u64,
    to: wgpu::Buffer,
    to_byte: u64,
    bytes: u64,
}

/// How bytes get to buffers of a device.
#[derive(Debug)]
pub struct BufferWrites<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// `None` for the queue.
    ring: Option<&'a mut StagingRing>,
}

impl StagingRing {
    /// A ring without memory yet.
    pub fn new(gpu: &Gpu) -> Self {
        Self { belt: StagingBelt::new(gpu.device.clone(), CHUNK_BYTES), copies: Vec::new() }
    }

    /// Records what was written since the last call, in its order, before the commands that read it. What is recorded and not
    /// submitted is lost.
    pub fn record(&mut self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) {
        let mut sent = 0;
        for StagedCopy { from, from_byte, to, to_byte, bytes } in self.copies.drain(..) {
            encoder.copy_buffer_to_buffer(&from, from_byte, &to, to_byte, Some(bytes));
            sent += bytes;
        }
        self.belt.finish_and_recall_on_submit(encoder);
        if sent > KEPT_BYTES {
            self.belt = StagingBelt::new(gpu.device.clone(), CHUNK_BYTES);
        }
    }
}

impl<'a> BufferWrites<'a> {
    /// Writes that take effect before the next submission.
    pub fn by_queue(gpu: &'a Gpu) -> Self {
        Self { gpu, ring: None }
    }

    /// Writes that take effect where `ring` is recorded.
    pub fn staged(gpu: &'a Gpu, ring: &'a mut StagingRing) -> Self {
        Self { gpu, ring: Some(ring) }
    }

    /// Writes `bytes` from `offset` on, which is a multiple of four, into a buffer that holds them; those up to the next multiple
    /// of four are zero.
    pub fn write(&mut self, buffer: &wgpu::Buffer, offset: u64, bytes: &[u8]) {
        let aligned = bytes.len() - bytes.len() % ALIGNMENT as usize;
        self.write_aligned(buffer, offset, &bytes[..aligned]);
        if aligned < bytes.len() {
            let mut last = [0; ALIGNMENT as usize];
            last[..bytes.len() - aligned].copy_from_slice(&bytes[aligned..]);
            self.write_aligned(buffer, offset + aligned as u64, &last);
        }
    }

    fn write_aligned(&mut self, to: &wgpu::Buffer, to_byte: u64, bytes: &[u8]) {
        let Some(ring) = &mut self.ring else { return self.gpu.queue.write_buffer(to, to_byte, bytes) };
        let size = wgpu::BufferSize::new(bytes.len() as u64);
        let Some((size, alignment)) = size.zip(wgpu::BufferSize::new(ALIGNMENT)) else { return };
        let place = ring.belt.allocate(size, alignment);
        let mapped = place.get_mapped_range_mut();
        mapped.expect("the ring's buffers are mapped until they are recorded").copy_from_slice(bytes);
        let (from, from_byte) = (place.buffer().clone(), place.offset());
        ring.copies.push(StagedCopy { from, from_byte, to: to.clone(), to_byte, bytes: size.get() });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapter::GpuApi;
    use crate::test_device::{gpu, read};

    fn buffer(gpu: &Gpu, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
        gpu.device.create_buffer(&descriptor)
    }

    #[test]
    fn what_is_staged_arrives_in_its_order_as_what_the_queue_writes() {
        let Some(gpu) = gpu(&[GpuApi::Vulkan, GpuApi::Gl]) else { return };
        let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let mut ring = StagingRing::new(&gpu);
        // More than the ring keeps in one of the frames, and frames after it.
        for (frame, count) in [3, 40, 1200, 2].into_iter().enumerate() {
            let [staged, queued] = [(); 2].map(|()| buffer(&gpu, 1 << 16, usage));
            let [mut by_ring, mut by_queue] =
                [BufferWrites::staged(&gpu, &mut ring), BufferWrites::by_queue(&gpu)];
            for number in 0..count {
                let bytes = vec![(number + frame) as u8; 8000 + number % 7];
                let offset = (number * 2236 % 50_000 / 4 * 4) as u64;
                by_ring.write(&staged, offset, &bytes);
                by_queue.write(&queued, offset, &bytes);
            }
            by_ring.write(&staged, 0, &[]);
            let mut encoder = gpu.encoder("test");
            ring.record(&gpu, &mut encoder);
            let staged = read(&gpu, encoder, &staged);
            assert!(staged == read(&gpu, gpu.encoder("test"), &queued), "frame {frame}");
            assert!(staged.iter().any(|byte| *byte != 0));
        }
    }

    #[test]
    fn the_buffers_of_the_ring_are_used_again() {
        let Some(gpu) = gpu(&[GpuApi::Vulkan, GpuApi::Gl]) else { return };
        let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let (mut ring, to) = (StagingRing::new(&gpu), buffer(&gpu, 1 << 16, usage));
        let mut buffers = Vec::new();
        for frame in 0..20u8 {
            for _ in 0..4 {
                BufferWrites::staged(&gpu, &mut ring).write(&to, 0, &[frame; 4096]);
            }
            ring.copies.iter().for_each(|copy| buffers.push(copy.from.clone()));
            let mut encoder = gpu.encoder("test");
            ring.record(&gpu, &mut encoder);
            assert_eq!(read(&gpu, encoder, &to)[0], frame);
        }
        assert_eq!(buffers.len(), 80);
        assert!(buffers.iter().all(|buffer| *buffer == buffers[0]), "one is enough for what is sent");
    }
}
