//! The names of a scene over its view, decluttered anew each frame without flicker.
//!
//! Labels are placed one after another, the important first, each where no other is; a label that was shown in the frame
//! before comes before others of nearly its importance, and may overlap its neighbors a little: what is shown stays until
//! it is in the way for good.

use std::collections::BTreeMap;
use std::sync::Arc;

use egui::text::LayoutJob;
use egui::{Align, Align2, Color32, Painter, Pos2, Rect, Stroke, pos2, vec2};
use glam::Vec3;

use crate::lettering::font;
use crate::window_point::window_point;
use sandtable_description::words::LabelKind;
use sandtable_scene::scene_label::SceneLabel;
use sandtable_view::camera::Camera;

/// A label that is shown comes as if its rank were lower by this: labels of one rank do not take turns.
const SHOWN_BONUS: f64 = 0.5;
/// A label that is not shown needs this room around it, in points; one that is shown needs none.
const NEW_MARGIN: f32 = 6.0;
/// How long a label stays when its place is hidden behind ground for a moment, in frames.
const PATIENCE: u8 = 6;
/// The most labels of a frame: what is less important would find no room.
const MOST_SHOWN: usize = 300;
/// How much of its letters' opacity a label gains or loses in a frame.
const FADE: f32 = 0.2;

/// The labels of the frames before.
#[derive(Clone, Debug, Default)]
pub struct LabelLayer {
    states: BTreeMap<usize, LabelState>,
}

#[derive(Clone, Copy, Debug, Default)]
struct LabelState {
    opacity: f32,
    hidden_for: u8,
    is_placed: bool,
}

/// A label on the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedLabel {
    /// Which of the scene's.
    pub index: usize,
    /// The place on the ground, in points of the window.
    pub ground: Pos2,
    /// The upper end of its line.
    pub top: Pos2,
    /// Where its letters are.
    pub letters: Rect,
    /// 0 to 1.
    pub opacity: f32,
}

/// The picture that labels are placed on.
pub struct LabelPicture<'a> {
    /// How it is seen.
    pub camera: &'a Camera,
    /// Where it is, in points of the window.
    pub rect: Rect,
    /// What labels leave free.
    pub taken: &'a [Rect],
    /// Whether a place in world space is in sight.
    pub is_seen: &'a dyn Fn(Vec3) -> bool,
    /// Whether a label, by its number, stands at its place and not along a line.
    pub is_at_place: &'a dyn Fn(usize) -> bool,
    /// The size of a label's letters, in points.
    pub size: &'a dyn Fn(&SceneLabel) -> egui::Vec2,
}

impl LabelLayer {
    /// The labels of this frame. Labels that come and go do so over a few frames.
    pub fn place(&mut self, labels: &[SceneLabel], picture: &LabelPicture<'_>) -> Vec<PlacedLabel> {
        let mut candidates: Vec<(f64, f32, usize, Pos2, Pos2)> = Vec::new();
        for (index, label) in labels.iter().enumerate() {
            // One that has found a place along its line goes as it came.
            if !(picture.is_at_place)(index) && !self.states.contains_key(&index) {
                continue;
            }
            let Some((ground, depth_m)) = on_screen(label.ground, picture) else { continue };
            let top = on_screen(label.anchor, picture).map_or(ground, |(top, _)| top);
            let top = pos2(top.x, top.y.min(ground.y - leader(label.kind)));
            let bonus = if self.is_shown(index) { SHOWN_BONUS } else { 0.0 };
            candidates.push((label.rank - bonus, depth_m, index, ground, top));
        }
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut taken: Vec<Rect> = picture.taken.to_vec();
        let mut placed = Vec::new();
        let mut states = BTreeMap::new();
        for (_, _, index, ground, top) in candidates {
            let before = self.states.get(&index).copied().unwrap_or_default();
            let letters = Align2::CENTER_BOTTOM.anchor_size(top, (picture.size)(&labels[index]));
            let needed = if before.is_placed { letters.shrink(2.0) } else { letters.expand(NEW_MARGIN) };
            let has_room = placed.len() < MOST_SHOWN
                && (picture.is_at_place)(index)
                && !taken.iter().any(|other| other.intersects(needed));
            let is_seen = has_room && (picture.is_seen)(labels[index].anchor.max(labels[index].ground));
            let hidden_for = if is_seen { 0 } else { before.hidden_for.saturating_add(1) };
            let is_placed = has_room && (is_seen || (before.is_placed && hidden_for <= PATIENCE));
            let opacity = (before.opacity + if is_placed { FADE } else { -FADE }).clamp(0.0, 1.0);
            if is_placed {
                taken.push(letters);
            }
            if opacity > 0.0 {
                placed.push(PlacedLabel { index, ground, top, letters, opacity });
                states.insert(index, LabelState { opacity, hidden_for, is_placed });
            }
        }
        self.states = states;
        placed
    }

    /// Whether labels are coming or going, so that a next frame differs though nothing moves.
    pub fn is_changing(&self) -> bool {
        let changes = |state: &LabelState| !state.is_placed || state.opacity < 1.0 || state.hidden_for > 0;
        self.states.values().any(changes)
    }

    fn is_shown(&self, index: usize) -> bool {
        self.states.get(&index).is_some_and(|state| state.is_placed)
    }
}

/// Where a place is on the window, and how far away; `None` outside the picture.
fn on_screen(at: Vec3, picture: &LabelPicture<'_>) -> Option<(Pos2, f32)> {
    window_point(picture.camera, picture.rect, at).filter(|(at, _)| picture.rect.contains(*at))
}

fn leader(kind: LabelKind) -> f32 {
    match kind {
        LabelKind::Summit => 22.0,
        LabelKind::Place | LabelKind::Water | LabelKind::Area => 18.0,
        LabelKind::Road | LabelKind::Point => 14.0,
    }
}

/// The color of a name.
pub fn ink(kind: LabelKind) -> Color32 {
    match kind {
        LabelKind::Water => Color32::from_rgb(18, 68, 120),
        LabelKind::Area => Color32::from_rgb(70, 66, 58),
        _ => Color32::from_rgb(26, 24, 20),
    }
}

/// Where letters are painted for their halo, in points.
const HALO: [(f32, f32); 8] =
    [(-1.2, 0.0), (1.2, 0.0), (0.0, -1.2), (0.0, 1.2), (-0.9, -0.9), (0.9, 0.9), (-0.9, 0.9), (0.9, -0.9)];

/// Paints labels: letters with a halo over a line to their place.
pub fn paint(painter: &Painter, labels: &[SceneLabel], placed: &[PlacedLabel]) {
    for label in placed {
        let SceneLabel { text, kind, .. } = &labels[label.index];
        let halo = Color32::from_rgb(250, 248, 240).gamma_multiply(label.opacity * 0.85);
        let ink = ink(*kind).gamma_multiply(label.opacity);
        painter.line_segment([label.ground, label.top], Stroke::new(2.6, halo));
        painter.line_segment([label.ground, label.top], Stroke::new(1.0, ink));
        painter.circle(label.ground, 2.6, ink, Stroke::new(1.2, halo));
        let letters = |color: Color32| {
            let mut job = LayoutJob::simple(text.clone(), font(*kind), color, f32::INFINITY);
            job.halign = Align::Center;
            painter.layout_job(job)
        };
        let (at, around) = (label.letters.center_top(), letters(halo));
        for offset in HALO {
            painter.galley(at + vec2(offset.0, offset.1), Arc::clone(&around), halo);
        }
        painter.galley(at, letters(ink), ink);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_scene::label_course::LabelCourse;

    fn label(x: f32, rank: f64) -> SceneLabel {
        let ground = Vec3::new(x, 0.0, 0.0);
        let (text, course, kind) = (format!("at {x}"), LabelCourse::Place, LabelKind::Point);
        SceneLabel { text, stated: 0..0, ground, anchor: ground, course, kind, rank, size: 1.0, shield: None }
    }

    fn shown(
        layer: &mut LabelLayer,
        labels: &[SceneLabel],
        eye_x: f32,
        is_seen: &dyn Fn(Vec3) -> bool,
    ) -> Vec<usize> {
        let eye = Vec3::new(eye_x, -500.0, 100.0);
        let target = Vec3::new(eye_x, 0.0, 0.0);
        let camera = Camera::new(eye, target, 0.8, (800, 600), (1.0, 1e5)).expect("sound");
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(800.0, 600.0));
        let size = |_: &SceneLabel| vec2(60.0, 14.0);
        let picture =
            LabelPicture { camera: &camera, rect, taken: &[], is_seen, is_at_place: &|_| true, size: &size };
        let mut placed: Vec<usize> = Vec::new();
        for label in layer.place(labels, &picture) {
            if layer.is_shown(label.index) {
                placed.push(label.index);
            }
        }
        placed
    }

    #[test]
    fn the_important_label_is_shown_where_two_have_no_room() {
        let mut layer = LabelLayer::default();
        let labels = [label(0.0, 2.0), label(10.0, 1.0), label(200.0, 3.0)];
        assert_eq!(shown(&mut layer, &labels, 0.0, &|_| true), [1, 2]);
    }

    #[test]
    fn labels_of_one_rank_do_not_take_turns_while_the_camera_moves() {
        let mut layer = LabelLayer::default();
        let labels = [label(0.0, 1.0), label(20.0, 1.0)];
        let first = shown(&mut layer, &labels, -60.0, &|_| true);
        assert_eq!(first.len(), 1);
        for step in 0..120 {
            assert_eq!(shown(&mut layer, &labels, -60.0 + step as f32, &|_| true), first, "step {step}");
        }
    }

    #[test]
    fn a_label_hidden_for_a_moment_stays_and_one_hidden_for_long_goes() {
        let mut layer = LabelLayer::default();
        let labels = [label(0.0, 1.0)];
        assert_eq!(shown(&mut layer, &labels, 0.0, &|_| true), [0]);
        for _ in 0..PATIENCE {
            assert_eq!(shown(&mut layer, &labels, 0.0, &|_| false), [0]);
        }
        assert!(shown(&mut layer, &labels, 0.0, &|_| false).is_empty());
        for _ in 0..10 {
            shown(&mut layer, &labels, 0.0, &|_| false);
        }
        assert!(!layer.is_changing());
    }
}
