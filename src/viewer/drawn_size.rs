//! The size at which the scene's picture is drawn: lower while it moves where the processor draws, whole when it rests.
//!
//! An adapter that is a processor shades some ten million pixels a second, so that a window of a million pixels moves in
//! jerks. While the camera moves, the sides of the picture are therefore a share of those of the view, the largest that was
//! drawn in time, and the view stretches it. Once the camera has rested for some frames, all pixels are drawn. The first share
//! follows from what all pixels took before the camera moved.

use sandtable_view::camera::Camera;

/// The shares of a side that are drawn, the whole first: with a quarter, one pixel in sixteen.
const SHARES: [f32; 6] = [1.0, 0.75, 0.625, 0.5, 0.375, 0.25];
/// A frame that takes longer is late, in milliseconds: thirty frames a second.
const LATE_MS: f32 = 33.0;
/// How many frames in time raise the share: fewer would lower and raise it by turns.
const STEADY_FRAMES: u32 = 12;
/// The share of [`LATE_MS`] that the next larger picture may be expected to take: what is not in pixels takes time too.
const HEADROOM: f32 = 0.8;
/// How many frames the camera rests before all pixels are drawn: a pause of a hand is no rest.
const RESTING_FRAMES: u32 = 4;

/// The purpose of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FramePurpose {
    /// It is looked at until the next one.
    Shown,
    /// It is written to a file.
    Kept,
}

/// Chooses the sizes of pictures by what the frames before took.
#[derive(Debug)]
pub struct DrawnSize {
    /// The index of the share while the camera moves.
    step: usize,
    /// The camera of the frame before.
    camera: Option<Camera>,
    /// Frames for which the camera has rested.
    resting: u32,
    /// What the last frame took before the camera first moved, milliseconds; `None` once it has moved.
    before_moving_ms: Option<f32>,
    /// The index of the share of the frame before.
    drawn: usize,
    /// What the last frame took that was drawn while the camera moved, milliseconds; 0 where it was in time.
    late_ms: f32,
    /// Frames in time since the share changed.
    steady: u32,
    /// The longest of them, milliseconds.
    longest_ms: f32,
}

impl DrawnSize {
    /// All pixels, until frames are late.
    pub fn new() -> Self {
        let resting = RESTING_FRAMES;
        let before_moving_ms = Some(0.0);
        Self {
            step: 0,
            camera: None,
            resting,
            before_moving_ms,
            drawn: 0,
            late_ms: 0.0,
            steady: 0,
            longest_ms: 0.0,
        }
    }

    /// The size in pixels of the picture of the next frame, which `camera` sees in a view of its own size.
    pub fn of_next(&mut self, camera: &Camera, purpose: FramePurpose) -> (u32, u32) {
        let has_moved = self.camera.replace(*camera).is_some_and(|before| before != *camera);
        self.resting = if has_moved { 0 } else { self.resting.saturating_add(1) };
        if let Some(whole_ms) = self.before_moving_ms.take_if(|_| has_moved) {
            self.lower_for(whole_ms);
        }
        let is_whole = purpose == FramePurpose::Kept || self.resting >= RESTING_FRAMES;
        self.drawn = if is_whole { 0 } else { self.step };
        let (width, height) = camera.size();
        let side = |pixels: u32| ((pixels as f32 * SHARES[self.drawn]).round() as u32).max(1);
        (side(width), side(height))
    }

    /// Whether the frame before shows fewer pixels than the view has, so that another one is to follow.
    pub fn is_lowered(&self) -> bool {
        self.drawn > 0
    }

    /// Notes what the frame before took in all, in milliseconds.
    pub fn note_time(&mut self, taken_ms: f32) {
        if let Some(whole_ms) = &mut self.before_moving_ms {
            *whole_ms = taken_ms;
        }
        // What a picture at rest takes says little of how those that move do.
        if self.resting >= RESTING_FRAMES || self.drawn != self.step {
            return;
        }
        if taken_ms > LATE_MS {
            // One late frame is a hitch, two are too many pixels.
            let least_ms = self.late_ms.min(taken_ms);
            self.late_ms = taken_ms;
            (self.steady, self.longest_ms) = (0, 0.0);
            if least_ms > 0.0 {
                self.lower_for(least_ms);
                self.late_ms = 0.0;
            }
            return;
        }
        self.late_ms = 0.0;
        self.steady += 1;
        self.longest_ms = self.longest_ms.max(taken_ms);
        if self.steady >= STEADY_FRAMES && self.step > 0 {
            let pixels = SHARES[self.step - 1] / SHARES[self.step];
            if self.longest_ms * pixels * pixels < LATE_MS * HEADROOM {
                self.step -= 1;
            }
            (self.steady, self.longest_ms) = (0, 0.0);
        }
    }

    /// Lowers the share, of which a frame took so many milliseconds, if that is late.
    fn lower_for(&mut self, taken_ms: f32) {
        if taken_ms > LATE_MS {
            let wanted = SHARES[self.step] * libm::sqrtf(LATE_MS * HEADROOM / taken_ms);
            let fitting = SHARES.iter().position(|share| *share <= wanted).unwrap_or(SHARES.len() - 1);
            self.step = fitting.max(self.step);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// What a frame of a share of the side takes: so many milliseconds for all pixels, and some besides.
    fn taken_ms(size: (u32, u32), whole_ms: f32, besides_ms: f32) -> f32 {
        besides_ms + whole_ms * (size.0 as f32 / 800.0) * (size.1 as f32 / 600.0)
    }

    fn camera(x: f32) -> Camera {
        Camera::new(Vec3::new(x, 0.0, 9.0), Vec3::new(x, 50.0, 0.0), 1.0, (800, 600), (1.0, 900.0))
            .expect("sound")
    }

    /// The sizes of frames on a way, on a machine of this speed.
    fn flight(size: &mut DrawnSize, frames: u16, whole_ms: f32, besides_ms: f32) -> Vec<(u32, u32)> {
        let frame = |number| {
            let drawn = size.of_next(&camera(f32::from(number)), FramePurpose::Shown);
            size.note_time(taken_ms(drawn, whole_ms, besides_ms));
            drawn
        };
        (0..frames).map(frame).collect()
    }

    #[test]
    fn a_fast_machine_draws_all_pixels_of_every_frame() {
        let mut size = DrawnSize::new();
        assert!(flight(&mut size, 200, 20.0, 5.0).iter().all(|drawn| *drawn == (800, 600)));
        assert!(!size.is_lowered());
    }

    #[test]
    fn a_slow_machine_soon_draws_in_time_and_stays_there() {
        for (whole_ms, besides_ms) in [(40.0, 2.0), (120.0, 6.0), (160.0, 12.0), (250.0, 4.0)] {
            let mut size = DrawnSize::new();
            let drawn = flight(&mut size, 300, whole_ms, besides_ms);
            let late =
                drawn[8..].iter().filter(|drawn| taken_ms(**drawn, whole_ms, besides_ms) > LATE_MS).count();
            assert_eq!(late, 0, "{whole_ms} ms: {:?}", &drawn[..8]);
            let changes = drawn[8..].windows(2).filter(|pair| pair[0] != pair[1]).count();
            assert!(changes <= 2, "{whole_ms} ms: {changes} changes");
            assert!(size.is_lowered());
        }
    }

    #[test]
    fn what_all_pixels_took_at_rest_tells_how_many_the_first_that_moves_has() {
        let mut size = DrawnSize::new();
        let first = flight(&mut size, 2, 200.0, 4.0);
        assert_eq!(first, [(800, 600), (200, 150)]);
        let mut size = DrawnSize::new();
        let first = flight(&mut size, 2, 24.0, 4.0);
        assert_eq!(first, [(800, 600); 2], "in time");
    }

    #[test]
    fn one_late_frame_changes_nothing() {
        let mut size = DrawnSize::new();
        for number in 0..60u16 {
            assert_eq!(size.of_next(&camera(f32::from(number)), FramePurpose::Shown), (800, 600));
            size.note_time(if number % 9 == 5 { 400.0 } else { 12.0 });
        }
    }

    #[test]
    fn a_picture_at_rest_or_for_a_file_is_whole() {
        let mut size = DrawnSize::new();
        flight(&mut size, 30, 160.0, 5.0);
        assert!(size.is_lowered());
        assert_eq!(size.of_next(&camera(30.0), FramePurpose::Kept), (800, 600));
        let drawn: Vec<_> = (0..6).map(|_| size.of_next(&camera(31.0), FramePurpose::Shown)).collect();
        assert!(drawn[0].0 < 800 && drawn[3].0 < 800, "{drawn:?}");
        assert_eq!(drawn[4..], [(800, 600); 2]);
        let moving = size.of_next(&camera(32.0), FramePurpose::Shown);
        assert_eq!(moving, drawn[0], "what was learned stays");
    }

    #[test]
    fn a_machine_that_gets_faster_draws_more_pixels_again() {
        let mut size = DrawnSize::new();
        flight(&mut size, 30, 160.0, 5.0);
        let drawn = flight(&mut size, 120, 15.0, 2.0);
        assert_eq!(drawn.last(), Some(&(800, 600)));
    }
}
