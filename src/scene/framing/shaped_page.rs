//! The shape of a picture whose size nothing states.
//!
//! In perspective, ground has a horizon, and a picture as wide as a screen suits it. Parallel rays show a block as it is: a
//! portrait block in a landscape picture leaves most of it empty. So a view by parallel rays whose scale is fitted has, of all
//! pages with as many pixels as a screen, the one on which what it shows is largest:
//!
//! ```text
//!   ┌────────────────┐        ┌───────┐
//!   │     ┌───┐      │        │┌─────┐│
//!   │     │   │      │  ──►   ││     ││
//!   │     └───┘      │        ││     ││
//!   └────────────────┘        │└─────┘│
//!                             └───────┘
//! ```

use crate::framing::fit::ParallelSpan;
use crate::framing::fitted_view::silhouette;
use crate::framing::panorama_frame::panorama_size;
use crate::framing::parallel_view::fitted_px_per_m;
use crate::paper_sheet::SCREEN_PX;
use crate::scene_model::SceneModel;
use crate::scene_view::{ParallelView, SceneView, ViewAim};
use sandtable_view::axes::DirectionAxes;

/// Pages between a square and the longest: each is 1.1 % longer for its width than the one before, so that the best of them
/// shows things at most half a percent smaller than the best of all.
const STEPS: i32 = 64;

/// The sides of the longest pages are as 2 to 1: longer ones fit no screen and no wall, and leave a title no width.
const LONGEST: f64 = 2.0;

/// How many times as large a page shows things at least, to take the place of the screen's: less is not seen, and pictures of
/// one size lie better side by side.
const WORTH: f64 = 1.05;

/// Width and height of all pages that a picture may have.
pub(super) fn pages() -> impl Iterator<Item = (u32, u32)> {
    let (width, height) = SCREEN_PX;
    let area = f64::from(width) * f64::from(height);
    let shaped = (-STEPS..=STEPS).map(move |step| {
        let width = libm::round(libm::sqrt(area * libm::pow(LONGEST, f64::from(step) / f64::from(STEPS))));
        (width as u32, libm::round(area / width) as u32)
    });
    std::iter::once(SCREEN_PX).chain(shaped)
}

/// The view by parallel rays whose page has the shape of what it shows; `None` of views whose paper or scale is stated, and of
/// views in perspective.
fn shaping(view: &SceneView) -> Option<&ParallelView> {
    match &view.aim {
        ViewAim::Parallel(parallel) if view.paper.is_none() && parallel.scale.is_none() => Some(parallel),
        _ => None,
    }
}

/// Width and height in pixels of the page of a view whose size nothing states: its paper, that of a panorama, the page that has the shape of what
/// it shows, or a screen. `picture_size` returns the size of the picture on a page.
pub fn page_size(
    scene: &SceneModel,
    view: &SceneView,
    picture_size: impl Fn((u32, u32)) -> (u32, u32),
) -> (u32, u32) {
    if let ViewAim::Panorama(panorama) = &view.aim {
        return panorama_size(scene, panorama);
    }
    let Some(parallel) = shaping(view) else {
        return view.paper.map_or(SCREEN_PX, |paper| paper.size_px());
    };
    let axes = DirectionAxes::new(parallel.azimuth_rad, parallel.pitch_rad);
    let shown = ParallelSpan::new(silhouette(scene, parallel.shown), &axes);
    let size_on = |page| fitted_px_per_m(parallel, &shown, picture_size(page));
    let screen = size_on(SCREEN_PX);
    let best = pages()
        .map(|page| (size_on(page), page))
        .fold((screen, SCREEN_PX), |best, next| if next.0 > best.0 { next } else { best });
    if best.0 > screen * WORTH { best.1 } else { SCREEN_PX }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_have_as_many_pixels_and_sides_of_at_most_two_to_one() {
        let screen = f64::from(SCREEN_PX.0) * f64::from(SCREEN_PX.1);
        for (width, height) in pages().map(|(width, height)| (f64::from(width), f64::from(height))) {
            assert!((width * height / screen - 1.0).abs() < 1e-3, "{width} {height}");
            assert!((width / height).max(height / width) < 2.001, "{width} {height}");
        }
    }
}
