//! The graph of frame times, split into what they were spent on.

use egui::{Color32, Rect, Role, Sense, Ui, WidgetInfo, pos2, vec2};

use crate::frame_times::{FrameTime, FrameTimes};

/// The height of the graph, in points.
const HEIGHT: f32 = 70.0;
/// What the graph's top means at least: two frames of a screen with sixty a second.
const LEAST_TOP_MS: f32 = 33.3;

/// A part of a frame by its name.
type FramePart = (&'static str, Color32, fn(&FrameTime) -> f32);

/// The parts of which a frame consists, from the bottom of the graph up.
const PARTS: [FramePart; 3] = [
    ("update", Color32::from_rgb(88, 166, 92), |time| time.update_ms),
    ("panels", Color32::from_rgb(150, 120, 180), |time| time.panels_ms),
    ("wait", Color32::from_rgb(120, 120, 120), |time| time.wait_ms),
];

/// The parts of its drawing, while the next frame is made.
const MEANWHILE: [FramePart; 2] = [
    ("upload", Color32::from_rgb(224, 160, 48), |time| time.upload_ms),
    ("draw", Color32::from_rgb(74, 130, 200), |time| time.draw_ms),
];

/// Draws the graph, its legend with medians, and what the last frame showed.
pub fn timing_panel(ui: &mut Ui, frames: &FrameTimes) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    let median = frames.percentile_ms(0.5, FrameTime::total_ms);
    let slowest = frames.percentile_ms(0.99, FrameTime::total_ms);
    let summary = format!("{median:.1} ms a frame, 99 % within {slowest:.1} ms");
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("Frame times: {summary}")));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    let top_ms = frames.percentile_ms(1.0, FrameTime::total_ms).max(LEAST_TOP_MS);
    let count = frames.times().count();
    let width = rect.width() / count.max(60) as f32;
    for (index, time) in frames.times().enumerate() {
        let left = rect.right() - (count - index) as f32 * width;
        let mut bottom = rect.bottom();
        for (_, color, part) in PARTS {
            let top = bottom - part(time) / top_ms * rect.height();
            painter.rect_filled(Rect::from_min_max(pos2(left, top), pos2(left + width, bottom)), 0.0, color);
            bottom = top;
        }
    }
    ui.label(summary);
    ui.horizontal_wrapped(|ui| {
        for (name, color, part) in PARTS.into_iter().chain(MEANWHILE) {
            ui.colored_label(color, format!("{name} {:.1} ms", frames.percentile_ms(0.5, part)));
        }
    });
    let load = frames.load;
    ui.label(format!(
        "{} triangles of ground in {} patches; {} drawn in {} calls",
        load.ground_triangles, load.patches, load.drawn_triangles, load.calls
    ));
    ui.label(format!("{} patches changed, {:.1} kB sent", load.changed_patches, load.bytes as f64 / 1e3));
    if load.side_share() < 1.0 {
        ui.label(format!("moving: {:.0} % of the pixels of a side", load.side_share() * 100.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame_times::FrameLoad;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    #[test]
    fn times_are_split_and_the_last_load_is_told() {
        let mut frames = FrameTimes::default();
        for _ in 0..10 {
            let time =
                FrameTime { update_ms: 1.0, upload_ms: 2.0, draw_ms: 4.0, panels_ms: 0.5, wait_ms: 5.5 };
            frames.add(time, FrameLoad { ground_triangles: 321, bytes: 4_200, ..FrameLoad::default() });
        }
        let harness = Harness::new_ui(|ui| timing_panel(ui, &frames));
        for part in ["update 1.0 ms", "panels 0.5 ms", "wait 5.5 ms", "upload 2.0 ms", "draw 4.0 ms"] {
            harness.get_by_label(part);
        }
        harness.get_by_label("7.0 ms a frame, 99 % within 7.0 ms");
        harness.get_by_label_contains("321 triangles of ground");
        harness.get_by_label("0 patches changed, 4.2 kB sent");
    }
}
