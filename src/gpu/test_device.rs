//! The devices that this crate's tests run on, and what their buffers hold.

#[cfg(test)]
use crate::adapter::{Gpu, GpuApi};

/// A device of this machine by one of some interfaces; `None` with a loud line where there is none. With
/// `SANDTABLE_REQUIRE_GPU` set the test fails then.
pub fn gpu(apis: &[GpuApi]) -> Option<Gpu> {
    let opened = Gpu::open(apis);
    assert!(opened.is_ok() || std::env::var_os("SANDTABLE_REQUIRE_GPU").is_none(), "{opened:?}");
    opened.inspect_err(|error| eprintln!("SKIPPED: no GPU adapter: {error}")).ok()
}

/// What `buffer` holds once `encoder`'s commands are carried out.
pub fn read(gpu: &Gpu, mut encoder: wgpu::CommandEncoder, buffer: &wgpu::Buffer) -> Vec<u8> {
    let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
    let size = buffer.size();
    let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
    let copy = gpu.device.create_buffer(&descriptor);
    encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, size);
    gpu.queue.submit([encoder.finish()]);
    copy.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapped"));
    gpu.device.poll(wgpu::PollType::Wait { submission_index: None, timeout: None }).expect("copied");
    copy.get_mapped_range(..).expect("mapped").to_vec()
}
