//! Names along rivers and roads and across areas, and the texts of tactical graphics, decluttered anew each frame without
//! flicker.
//!
//! ```text
//!  a line on the ground ─► its pieces on the picture ─► the held place, else some others ─► letters along it
//! ```
//!
//! What is held from frame to frame is a place on the ground, so that a name stays where it is while the camera moves, until
//! it does not fit there any more.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use egui::Painter;

use crate::labels::ink;
use crate::letter_run::{HeldPlace, LineLetter, letter_box, paint, place};
use crate::lettering::font;
use crate::line_piece::LinePicture;
use crate::name_lines::{LabelLines, LineName, NameKey, graphic_names};
use crate::opened::OpenedScene;
use sandtable_picture::placed_text::PlacedText;
use sandtable_view::camera::Camera;

/// Names that are not shown are tried in turns of so many frames: trying takes longer than holding.
const TURNS: u32 = 4;
/// The most names that are shown.
const MOST_SHOWN: usize = 120;
/// How much of its opacity a name gains or loses in a frame.
const FADE: f32 = 0.2;
/// How long a name stays when its place is hidden for a moment, in frames.
const PATIENCE: u8 = 6;

/// A name in the frames before.
#[derive(Clone, Debug, Default)]
struct NameState {
    /// Where it is; `None` while it finds no room.
    held: Option<HeldPlace>,
    opacity: f32,
    hidden_for: u8,
    letters: Vec<LineLetter>,
}

/// The names along lines of the frames before.
#[derive(Clone, Debug, Default)]
pub struct LineNames {
    states: BTreeMap<NameKey, NameState>,
    /// The lines of the scene's labels, computed once.
    courses: Vec<Option<LabelLines>>,
    /// The numbers of those labels, the important first.
    order: Vec<usize>,
    /// The labels that found no place along their lines.
    failed: BTreeSet<usize>,
    frame: u32,
    /// The camera of the frame before, and for how many frames it is the same.
    rests: Option<(Camera, u32)>,
}

impl LineNames {
    /// Whether a label of the scene must be drawn at its place, because it has no line, or found no room along it.
    pub fn is_at_place(&self, label: usize) -> bool {
        self.courses.get(label).is_none_or(Option::is_none) || self.failed.contains(&label)
    }

    /// Whether names are coming or going, or are still to be tried, so that a next frame differs though nothing moves.
    pub fn is_changing(&self) -> bool {
        let is_waiting =
            self.rests.as_ref().is_some_and(|(_, frames)| *frames <= TURNS) && !self.order.is_empty();
        let changes = |state: &NameState| {
            (state.opacity > 0.0 && state.opacity < 1.0)
                || state.hidden_for > 0 && state.held.is_some()
                || state.held.is_some_and(|held| held.is_easing)
        };
        is_waiting || self.states.values().any(changes)
    }

    /// Places and paints the names of this frame.
    pub fn show(&mut self, painter: &Painter, opened: &OpenedScene, picture: &LinePicture<'_>) {
        self.frame = self.frame.wrapping_add(1);
        self.rests = Some(match self.rests {
            Some((camera, frames)) if camera == *picture.camera => (camera, frames.saturating_add(1)),
            _ => (*picture.camera, 0),
        });
        self.know_courses(opened);
        let mut taken = picture.taken.to_vec();
        let before = std::mem::take(&mut self.states);
        let mut shown = 0;
        let is_turn = |turn: usize| turn % TURNS as usize == self.frame as usize % TURNS as usize;
        let is_shown = |text: &PlacedText| !opened.hidden.contains(&text.feature);
        let shown_texts = opened.walk.graphic_texts().iter().filter(|text| is_shown(text));
        let graphics = graphic_names(shown_texts, picture);
        let labels = self.order.iter().enumerate().filter_map(|(turn, &index)| {
            let is_known = before.contains_key(&NameKey::Label(index));
            let lines = self.courses[index].as_ref().filter(|_| is_known || is_turn(turn))?;
            let label = &opened.scene.labels[index];
            Some(LineName {
                key: NameKey::Label(index),
                text: label.text.clone(),
                lines: if lines.may_show(picture) { Arc::clone(&lines.lines) } else { Arc::default() },
                side: lines.side,
                font: font(label.kind),
                ink: ink(label.kind),
            })
        });
        let names: Vec<LineName> = graphics.into_iter().chain(labels).collect();
        for name in names {
            let mut state = before.get(&name.key).cloned().unwrap_or_default();
            let is_tried = state.held.is_some() || shown < MOST_SHOWN;
            let placed = if is_tried { place(&name, state.held, picture, &taken) } else { None };
            state.hidden_for = if placed.is_some() { 0 } else { state.hidden_for.saturating_add(1) };
            match placed {
                Some((held, letters)) => (state.held, state.letters) = (Some(held), letters),
                None if state.hidden_for > PATIENCE => state.held = None,
                None => {}
            }
            let is_shown = state.held.is_some();
            state.opacity = (state.opacity + if is_shown { FADE } else { -FADE }).clamp(0.0, 1.0);
            if let NameKey::Label(label) = name.key {
                if is_shown {
                    self.failed.remove(&label)
                } else {
                    self.failed.insert(label)
                };
            }
            if is_shown {
                shown += 1;
                taken.extend(state.letters.iter().map(|letter| letter_box(letter, name.font.size)));
            }
            if state.opacity > 0.0 {
                paint(painter, &name, &state.letters, state.opacity);
                self.states.insert(name.key, state);
            }
        }
    }

    /// Computes the lines of the scene's labels where that was not done yet.
    fn know_courses(&mut self, opened: &OpenedScene) {
        let labels = &opened.scene.labels;
        if self.courses.len() == labels.len() {
            return;
        }
        self.courses = LabelLines::of_labels(opened);
        self.order = (0..labels.len()).filter(|&at| self.courses[at].is_some()).collect();
        self.order.sort_by(|&a, &b| labels[a].rank.total_cmp(&labels[b].rank).then(a.cmp(&b)));
    }
}
