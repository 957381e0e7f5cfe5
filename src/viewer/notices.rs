//! The notices of the window: news that disappear by themselves, and errors that stay until they are dismissed.

use egui::{Align2, Area, Frame, Id, Ui, vec2};

/// How long news stay, in seconds: long enough to read two lines.
const NEWS_S: f64 = 8.0;
/// The most notices at a time; older ones go.
const MOST: usize = 6;

/// What is said.
#[derive(Clone, Debug, PartialEq)]
struct ViewerNotice {
    text: String,
    /// When it goes, in seconds of `egui`'s clock; `None` for when it is dismissed.
    until: Option<f64>,
    /// A text that can be copied.
    copied: Option<String>,
}

/// All notices, the newest last.
#[derive(Clone, Debug, Default)]
pub struct ViewerNotices {
    notices: Vec<ViewerNotice>,
}

impl ViewerNotices {
    /// Says news, at `now` on `egui`'s clock.
    pub fn tell(&mut self, now: f64, text: impl Into<String>) {
        self.push(ViewerNotice { text: text.into(), until: Some(now + NEWS_S), copied: None });
    }

    /// Says news with a text to copy; they stay until they are dismissed.
    pub fn tell_with_text(&mut self, text: impl Into<String>, copied: impl Into<String>) {
        self.push(ViewerNotice { text: text.into(), until: None, copied: Some(copied.into()) });
    }

    /// Says what is wrong; it stays until it is dismissed.
    pub fn warn(&mut self, text: impl Into<String>) {
        self.push(ViewerNotice { text: text.into(), until: None, copied: None });
    }

    fn push(&mut self, notice: ViewerNotice) {
        self.notices.retain(|other| other.text != notice.text);
        if self.notices.len() == MOST {
            self.notices.remove(0);
        }
        self.notices.push(notice);
    }

    /// Dismisses all.
    pub fn clear(&mut self) {
        self.notices.clear();
    }

    /// The texts of the current notices.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.notices.iter().map(|notice| notice.text.as_str())
    }

    /// Draws the notices in the upper right corner of what `ui` has left.
    pub fn show(&mut self, ui: &Ui) {
        let now = ui.input(|input| input.time);
        self.notices.retain(|notice| notice.until.is_none_or(|until| until > now));
        if self.notices.is_empty() {
            return;
        }
        ui.ctx().request_repaint_after_secs(0.5);
        let corner = ui.max_rect().right_top() + vec2(-10.0, 10.0);
        let area = Area::new(Id::unique("notices")).fixed_pos(corner).pivot(Align2::RIGHT_TOP);
        let mut dismissed = None;
        area.show(ui.ctx(), |ui| {
            ui.set_max_width(460.0);
            for (index, notice) in self.notices.iter().enumerate() {
                Frame::popup(ui.style()).show(ui, |ui| {
                    ui.label(&notice.text);
                    if let Some(text) = &notice.copied {
                        ui.monospace(text);
                    }
                    ui.horizontal(|ui| {
                        if let Some(text) = &notice.copied
                            && ui.button("Copy").clicked()
                        {
                            ui.ctx().copy_text(text.clone());
                        }
                        if ui.button("Dismiss").clicked() {
                            dismissed = Some(index);
                        }
                    });
                });
            }
        });
        if let Some(index) = dismissed {
            self.notices.remove(index);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    #[test]
    fn news_go_by_themselves_and_errors_when_they_are_dismissed() {
        let mut notices = ViewerNotices::default();
        notices.tell(0.0, "saved");
        notices.warn("scene.toml:3: there is no key `wdth`");
        let draw = |ui: &mut Ui, notices: &mut ViewerNotices| notices.show(ui);
        let builder = Harness::builder().with_size([700.0, 400.0]).with_step_dt(1.0);
        let mut harness = builder.build_ui_state(draw, notices);
        harness.step();
        harness.get_by_label("saved");
        harness.run_steps(12);
        assert!(harness.query_by_label("saved").is_none());
        harness.get_by_label_contains("scene.toml:3");
        // A pointer that is held for a step of a second does not click.
        harness.get_by_label("Dismiss").click_accesskit();
        harness.run_steps(2);
        assert_eq!(harness.state().texts().count(), 0);
    }
}
