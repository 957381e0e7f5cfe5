//! The times of the frames of the last few seconds, and what they were spent on.

use std::collections::VecDeque;

/// The frames kept: four seconds of sixty a second.
const KEPT: usize = 240;

/// The times of one frame, in milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameTime {
    /// Refining the ground and cutting its draped features.
    pub update_ms: f32,
    /// Handing over what changed, while the next frame is made.
    pub upload_ms: f32,
    /// Recording, sending and presenting the picture, while the next frame is made; without a window, with waiting until the one
    /// before is drawn.
    pub draw_ms: f32,
    /// Laying out the panels and the labels.
    pub panels_ms: f32,
    /// Waiting until the frame before is handed over and sent, and for the window's surface.
    pub wait_ms: f32,
}

impl FrameTime {
    /// The time from frame to frame: what the thread that draws does meanwhile counts as far as it is waited for.
    pub fn total_ms(&self) -> f32 {
        self.panels_ms + self.update_ms + self.wait_ms
    }
}

/// The load of a frame: what it showed and sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameLoad {
    /// Triangles of ground in view.
    pub ground_triangles: usize,
    /// Patches in view.
    pub patches: usize,
    /// Triangles drawn, of the ground and of its draped features.
    pub drawn_triangles: u64,
    /// Calls of the device.
    pub calls: u32,
    /// Bytes sent to the device.
    pub bytes: u64,
    /// Patches whose triangles changed.
    pub changed_patches: usize,
    /// The width of the scene's picture, pixels.
    pub width: u32,
    /// The width of the view that shows it, pixels.
    pub view_width: u32,
}

impl FrameLoad {
    /// The share of the view's side that was drawn, 0 to 1: less than 1 while a software adapter keeps up with what moves.
    pub fn side_share(&self) -> f32 {
        self.width as f32 / self.view_width.max(1) as f32
    }
}

/// The frames of the last seconds.
#[derive(Clone, Debug, Default)]
pub struct FrameTimes {
    times: VecDeque<FrameTime>,
    /// The last frame's load.
    pub load: FrameLoad,
}

impl FrameTimes {
    /// Adds a frame.
    pub fn add(&mut self, time: FrameTime, load: FrameLoad) {
        if self.times.len() == KEPT {
            self.times.pop_front();
        }
        self.times.push_back(time);
        self.load = load;
    }

    /// The frames, the oldest first.
    pub fn times(&self) -> impl Iterator<Item = &FrameTime> {
        self.times.iter()
    }

    /// The `share` of frames, 0 to 1, that took no longer than this many milliseconds in `part`; 0 without frames.
    pub fn percentile_ms(&self, share: f32, part: impl Fn(&FrameTime) -> f32) -> f32 {
        percentile(self.times.iter().map(part).collect(), share)
    }
}

/// The value below which a `share` of `values` lies, 0 to 1; 0 of none.
pub fn percentile(mut values: Vec<f32>, share: f32) -> f32 {
    values.sort_by(f32::total_cmp);
    let last = values.len().saturating_sub(1);
    values.get((last as f32 * share.clamp(0.0, 1.0)).round() as usize).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_last_seconds_count() {
        let mut times = FrameTimes::default();
        for frame in 0..1_000u16 {
            times.add(FrameTime { wait_ms: f32::from(frame), ..FrameTime::default() }, FrameLoad::default());
        }
        assert_eq!(times.times().count(), KEPT);
        assert_eq!(times.percentile_ms(0.0, FrameTime::total_ms), 760.0);
        assert_eq!(times.percentile_ms(1.0, FrameTime::total_ms), 999.0);
        assert_eq!(times.percentile_ms(0.5, |time| time.update_ms), 0.0);
        assert_eq!(FrameTimes::default().percentile_ms(0.5, FrameTime::total_ms), 0.0);
    }
}
