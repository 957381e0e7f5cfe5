//! The level of detail: the criterion, its tolerance, edges, freezing.

use egui::{Slider, Ui};

use crate::commands::{ViewCommand, key_text};

/// The settings of the panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetailSettings {
    /// The greatest error of the displayed ground, in pixels.
    pub tolerance_px: f32,
    /// Whether the edges of triangles are drawn.
    pub wireframe: bool,
    /// Whether the triangles stay as they are while the camera moves.
    pub frozen: bool,
    /// Whether the error cannot be set: that of terrain on disk stays as it was measured.
    pub is_fixed: bool,
}

/// Draws the settings.
pub fn detail_panel(ui: &mut Ui, settings: &mut DetailSettings) {
    ui.horizontal(|ui| {
        let label = ui.label("Error, px");
        let slider = Slider::new(&mut settings.tolerance_px, 0.25..=16.0).logarithmic(true).fixed_decimals(2);
        let slider = ui.add_enabled(!settings.is_fixed, slider).labelled_by(label.id);
        slider
            .on_hover_text(
                "How far the displayed ground may be off, on the picture: nested spheres round each vertex say from \
                 where its error shows",
            )
            .on_disabled_hover_text("Terrain on disk is measured once, for about a pixel");
    });
    let edges = ui.checkbox(&mut settings.wireframe, "Edges of triangles");
    edges.on_hover_text(key_text(ViewCommand::Wireframe));
    let frozen = ui.checkbox(&mut settings.frozen, "Freeze, and fly on");
    frozen.on_hover_text(format!(
        "{}: keeps the triangles of this place, so that they can be seen from another",
        key_text(ViewCommand::Freeze)
    ));
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    #[test]
    fn edges_and_freezing_are_switched_by_their_names() {
        let settings = DetailSettings { tolerance_px: 1.0, wireframe: false, frozen: false, is_fixed: false };
        let mut harness = Harness::new_ui_state(detail_panel, settings);
        harness.get_by_label("Edges of triangles").click();
        harness.get_by_label("Freeze, and fly on").click();
        harness.run();
        assert_eq!(*harness.state(), DetailSettings { wireframe: true, frozen: true, ..settings });
    }
}
