//! Moves, turns, resizes and removes the picked part of the scene file.
//!
//! A click picks. Dragging from what is picked moves a model or a label over the ground, with Ctrl it turns a model; until the
//! button is released, a ghost shows how it will stand, and a line leads there.

use egui::{DragValue, Ui};
use glam::DVec2;

use crate::app::ViewerApp;
use crate::picked_part::{GrabTarget, PickedPart, heading_deg};
use sandtable_draw::list::FeatureId;
use sandtable_editing::edit::{EditPlace, EditValue, SceneEdit};

/// What was done with a picked part.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PartEvent {
    Width(f64),
    Remove,
}

/// The lists whose tables state a width.
const WIDE: [&str; 2] = ["road", "river"];

impl ViewerApp {
    /// The part of the scene file that a picked feature is.
    pub(super) fn part_of_feature(&self, feature: FeatureId) -> Option<PickedPart> {
        let (opened, session) = self.opened.as_ref().zip(self.session.as_ref())?;
        let scene = &opened.scene;
        let placement = scene.placements.iter().position(|placement| placement.feature == feature);
        let of_model = placement.and_then(|number| {
            let place = session.editor.place_of_model(number, scene)?;
            let at = opened.walk.model_pose(number).at.as_dvec2() + scene.lattice.origin();
            Some(PickedPart { place, grab: Some(GrabTarget::Model(feature)), at, width_m: None, file: None })
        });
        of_model.or_else(|| {
            let known = scene.features.get(feature.index()?)?;
            let place = session.editor.place_of_feature(&session.built_of, known)?;
            let EditPlace::Table { name, .. } = &place else { return None };
            let width_m = session.editor.stated_number(&place, "width");
            let width_m = width_m.filter(|_| WIDE.contains(&name.as_str()));
            let file = session.editor.stated_text(&place, "file").filter(|_| name != "model");
            Some(PickedPart { place, grab: None, at: DVec2::ZERO, width_m, file })
        })
    }

    /// The part of the scene file that a label is.
    pub(super) fn part_of_label(&self, label: usize) -> Option<PickedPart> {
        let (opened, session) = self.opened.as_ref().zip(self.session.as_ref())?;
        let place = session.editor.place_of_label(label, &opened.scene)?;
        let at = opened.scene.lattice.map_point(opened.scene.labels.get(label)?.ground);
        Some(PickedPart { place, grab: Some(GrabTarget::Label(label)), at, width_m: None, file: None })
    }

    /// Shows the table of what was picked, and what can be done with it.
    pub(super) fn show_part(&mut self, ui: &mut Ui) {
        let Some(part) = self.picked.as_ref().and_then(|picked| picked.part.clone()) else { return };
        let mut event = None;
        ui.weak(part.place.to_string());
        if part.grab.is_some() {
            ui.weak(match part.grab {
                Some(GrabTarget::Model(_)) => "Drag it to move it, with Ctrl to turn it",
                _ => "Drag it to move it",
            });
        }
        ui.horizontal(|ui| {
            if let Some(mut width_m) = part.width_m {
                let label = ui.label("Width");
                let width = DragValue::new(&mut width_m).range(0.1..=1_000.0).speed(0.1).suffix(" m");
                let width = ui.add(width).labelled_by(label.id);
                if width.drag_stopped() || width.lost_focus() {
                    event = Some(PartEvent::Width(width_m));
                } else if width.changed()
                    && let Some(picked) = &mut self.picked
                {
                    picked.part = Some(PickedPart { width_m: Some(width_m), ..part.clone() });
                }
            }
            let all = part.file.as_ref().map(|file| format!("Remove all of {file}"));
            if ui.button(all.as_deref().unwrap_or("Remove")).clicked() {
                event = Some(PartEvent::Remove);
            }
        });
        match event {
            Some(PartEvent::Width(width_m)) => {
                let stated = self
                    .session
                    .as_ref()
                    .and_then(|session| session.editor.stated_number(&part.place, "width"));
                if stated != Some(width_m) {
                    self.edit(&SceneEdit::set(part.place, "width", EditValue::Number(width_m)));
                }
            }
            Some(PartEvent::Remove) if self.edit(&SceneEdit::Remove(part.place)) => self.picked = None,
            Some(PartEvent::Remove) | None => {}
        }
    }

    /// Moves or turns what was picked: it was dragged to a place on the ground, map coordinates.
    pub(super) fn move_part(&mut self, to: DVec2, turns: bool) {
        let Some(part) = self.picked.as_ref().and_then(|picked| picked.part.clone()) else { return };
        let edit = match turns {
            true => {
                SceneEdit::set(part.place.clone(), "heading", EditValue::Number(heading_deg(part.at, to)))
            }
            false => SceneEdit::set(part.place.clone(), "at", EditValue::Point(to.to_array())),
        };
        if self.edit(&edit)
            && !turns
            && let Some(picked) = &mut self.picked
        {
            picked.part = Some(PickedPart { at: to, ..part });
        }
    }
}
