//! The pages of terrain on disk that are in memory, and how much of it was read.

use egui::Ui;

use crate::paging::{MOST_PAGES, PagesKept, PagingStage};

/// Draws the state of the pages of a terrain of `size` samples.
pub fn paging_panel(ui: &mut Ui, size: (u32, u32), stage: &PagingStage, kept: &PagesKept) {
    ui.label(format!("{} x {} samples on disk", size.0, size.1));
    match stage {
        PagingStage::Measuring(share) => {
            ui.label(format!("measuring them, {:.0} %; an overview is shown meanwhile", share * 100.0));
        }
        PagingStage::Failed(text) => {
            ui.colored_label(ui.visuals().error_fg_color, text);
        }
        PagingStage::Shown => {
            let megabytes = kept.bytes as f64 / 1e6;
            ui.label(format!("{} of at most {MOST_PAGES} pages in memory, {megabytes:.0} MB", kept.pages));
            let counts = kept.counts;
            ui.label(format!(
                "{} read, {} found in memory, {} dropped",
                counts.loads, counts.hits, counts.evictions
            ));
            if kept.waiting > 0 {
                ui.label(format!("{} wait to be read and are shown coarser", kept.waiting));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;
    use sandtable_roam::paging::ground::PagingCounts;

    #[test]
    fn pages_are_counted_and_those_that_wait_are_named() {
        let counts = PagingCounts { loads: 70, hits: 900, evictions: 6, peak: 64 };
        let kept = PagesKept { pages: 64, bytes: 12_000_000, waiting: 3, counts };
        let harness = Harness::new_ui(|ui| paging_panel(ui, (16_385, 16_385), &PagingStage::Shown, &kept));
        harness.get_by_label("16385 x 16385 samples on disk");
        harness.get_by_label("64 of at most 1024 pages in memory, 12 MB");
        harness.get_by_label("70 read, 900 found in memory, 6 dropped");
        harness.get_by_label("3 wait to be read and are shown coarser");
        let stage = PagingStage::Measuring(0.424);
        let harness = Harness::new_ui(|ui| paging_panel(ui, (9, 9), &stage, &PagesKept::default()));
        harness.get_by_label_contains("42 %");
    }
}
