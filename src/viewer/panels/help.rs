//! The keys, drawn from the table that dispatches them.

use egui::{Grid, Key, RichText, ScrollArea, Ui};

use crate::commands::{KEYS, KeyAction, KeyBinding, shortcut_text};

/// What the mouse does, and two fingers on a trackpad.
const POINTER: [(&str, &str); 6] = [
    ("Drag", "Turn about the place under the pointer"),
    ("Shift + drag, or drag with the right button", "Move the ground along"),
    ("Wheel, or two fingers", "Come nearer to the place under the pointer"),
    ("Pinch", "Come nearer, or go farther off"),
    ("Click", "Say what is there"),
    ("Double click", "Go there"),
];

/// What the panel of analyses does.
const ANALYSES: &str = "Analyses, at the side: choose a kind, pick its places by clicks on the ground or type them, run it. Keep \
     writes it into the scene; Discard takes it away.";

/// Draws the keys and what the pointer does.
pub fn help_panel(ui: &mut Ui) {
    ScrollArea::vertical().auto_shrink([true, true]).show(ui, |ui| {
        Grid::new("keys").num_columns(4).spacing([18.0, 4.0]).striped(true).show(ui, |ui| {
            let rows: Vec<&KeyBinding> = KEYS.iter().filter(|binding| !binding.says.is_empty()).collect();
            let half = rows.len().div_ceil(2);
            for row in 0..half {
                for binding in [rows.get(row), rows.get(row + half)].into_iter().flatten() {
                    ui.label(RichText::new(keys_of(binding)).strong());
                    ui.label(binding.says);
                }
                ui.end_row();
            }
        });
        ui.separator();
        Grid::new("pointer").num_columns(2).spacing([18.0, 4.0]).striped(true).show(ui, |ui| {
            for (gesture, says) in POINTER {
                ui.label(RichText::new(gesture).strong());
                ui.label(says);
                ui.end_row();
            }
        });
        ui.label("Shift makes a held key four times as fast. Tab goes through the panels; Esc comes back.");
        ui.label(ANALYSES);
    });
}

/// All keys of an action.
fn keys_of(binding: &KeyBinding) -> String {
    let same = |action: KeyAction| action == binding.action;
    // The unshifted key of + is the same to a reader.
    let keys = KEYS.iter().filter(|other| same(other.action) && other.key.logical_key != Key::Equals);
    keys.map(|other| shortcut_text(&other.key)).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    #[test]
    fn help_shows_every_action_with_its_keys() {
        let harness = Harness::builder().with_size([900.0, 1200.0]).build_ui(help_panel);
        for binding in KEYS.iter().filter(|binding| !binding.says.is_empty()) {
            harness.get_by_label(binding.says);
        }
        harness.get_by_label("Ctrl+Shift+Z, Ctrl+Y");
        harness.get_by_label(ANALYSES);
    }
}
