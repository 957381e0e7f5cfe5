//! The times of passes, by the device's own clock (WebGPU, section 20.2, timestamp queries).

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::adapter::Gpu;

/// The most passes of a frame that are timed.
const MOST_PASSES: u32 = 16;
/// The bytes of a time.
const TIME_BYTES: u64 = 8;
/// The bytes of the times of all passes of a frame: at their begins and at their ends.
const FRAME_BYTES: u64 = MOST_PASSES as u64 * 2 * TIME_BYTES;
/// The frames on their way to the device at a time, and one that is read.
const SLOTS: usize = 4;

/// How long a pass took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassTime {
    /// The pass.
    pub label: &'static str,
    /// Milliseconds on the device.
    pub ms: f32,
}

/// Times the passes of frames: each is recorded with [`PassTimer::writes`], and each frame ended with [`PassTimer::finish`].
#[derive(Debug)]
pub struct PassTimer {
    set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    period_ns: f32,
    frames: Mutex<TimedFrames>,
}

#[derive(Debug)]
struct TimedFrames {
    /// The passes of the frame that is recorded.
    labels: Vec<&'static str>,
    slots: Vec<TimeSlot>,
    /// The slot of the frame that is recorded.
    current: usize,
}

/// The times of a frame on their way.
#[derive(Debug)]
struct TimeSlot {
    buffer: wgpu::Buffer,
    labels: Vec<&'static str>,
    state: Arc<Mutex<SlotState>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SlotState {
    /// Nothing is on its way.
    Free,
    /// The device is to write it.
    Recorded,
    /// The processor waits for it.
    Requested,
    /// The processor can read it.
    Ready,
}

impl PassTimer {
    /// A timer; `None` where the device has no clock.
    pub fn new(gpu: &Gpu) -> Option<Self> {
        gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY).then(|| {
            let label = Some("times of passes");
            let set = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label,
                ty: wgpu::QueryType::Timestamp,
                count: MOST_PASSES * 2,
            });
            let buffer = |usage| {
                let size = FRAME_BYTES;
                gpu.device.create_buffer(&wgpu::BufferDescriptor {
                    label,
                    size,
                    usage,
                    mapped_at_creation: false,
                })
            };
            let slot = |_| TimeSlot {
                buffer: buffer(wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ),
                labels: Vec::new(),
                state: Arc::new(Mutex::new(SlotState::Free)),
            };
            let frames =
                TimedFrames { labels: Vec::new(), slots: (0..SLOTS).map(slot).collect(), current: 0 };
            Self {
                set,
                resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
                period_ns: gpu.queue.get_timestamp_period(),
                frames: Mutex::new(frames),
            }
        })
    }

    /// What a pass of the frame that is recorded writes; `None` beyond the passes that are timed.
    pub fn writes(&self, label: &'static str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.begin(label).map(|first| wgpu::RenderPassTimestampWrites {
            query_set: &self.set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        })
    }

    /// [`PassTimer::writes`] for a pass that computes.
    pub fn compute_writes(&self, label: &'static str) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        self.begin(label).map(|first| wgpu::ComputePassTimestampWrites {
            query_set: &self.set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        })
    }

    /// The place of a pass's first time; `None` beyond the passes that are timed.
    fn begin(&self, label: &'static str) -> Option<u32> {
        let mut frames = self.frames();
        let index = frames.labels.len() as u32;
        (index < MOST_PASSES).then(|| {
            frames.labels.push(label);
            index * 2
        })
    }

    /// Ends a frame. Where the times of too many are on their way, those of this one are not told.
    pub fn finish(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut frames = self.frames();
        let labels = std::mem::take(&mut frames.labels);
        let current = frames.current;
        let slot = &mut frames.slots[current];
        if labels.is_empty() || !slot.turns(SlotState::Free, SlotState::Recorded) {
            return;
        }
        let queries = labels.len() as u32 * 2;
        encoder.resolve_query_set(&self.set, 0..queries, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(
            &self.resolved,
            0,
            &slot.buffer,
            0,
            Some(u64::from(queries) * TIME_BYTES),
        );
        slot.labels = labels;
        frames.current = (current + 1) % SLOTS;
    }

    /// Asks for the times of the frames that were ended; after their commands were submitted.
    pub fn request(&self) {
        for slot in &self.frames().slots {
            if slot.turns(SlotState::Recorded, SlotState::Requested) {
                let state = Arc::clone(&slot.state);
                slot.buffer.map_async(wgpu::MapMode::Read, .., move |result| {
                    let after = if result.is_ok() { SlotState::Ready } else { SlotState::Free };
                    *state.lock().unwrap_or_else(PoisonError::into_inner) = after;
                });
            }
        }
    }

    /// The times of frames that are there, the oldest first, each once.
    pub fn take(&self) -> Vec<Vec<PassTime>> {
        let frames = self.frames();
        let oldest = (0..SLOTS).map(|slot| &frames.slots[(frames.current + slot) % SLOTS]);
        oldest.filter_map(|slot| slot.take(self.period_ns)).collect()
    }

    fn frames(&self) -> MutexGuard<'_, TimedFrames> {
        self.frames.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl TimeSlot {
    /// Goes from one state to another; false where it was in a third.
    fn turns(&self, before: SlotState, after: SlotState) -> bool {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let is_so = *state == before;
        if is_so {
            *state = after;
        }
        is_so
    }

    fn take(&self, period_ns: f32) -> Option<Vec<PassTime>> {
        if !self.turns(SlotState::Ready, SlotState::Free) {
            return None;
        }
        let times: Vec<u64> = match self.buffer.get_mapped_range(..) {
            Ok(view) => view.as_chunks().0.iter().copied().map(u64::from_ne_bytes).collect(),
            Err(_) => Vec::new(),
        };
        self.buffer.unmap();
        let passes = self.labels.iter().zip(times.as_chunks::<2>().0);
        let time = |(&label, &[begin, end]): (&&'static str, &[u64; 2])| PassTime {
            label,
            ms: end.saturating_sub(begin) as f32 * period_ns / 1e6,
        };
        Some(passes.map(time).collect())
    }
}
