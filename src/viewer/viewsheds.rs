//! The viewshed from a place, tinted over the ground until it is cleared. It is computed beside the window, and again when
//! the ground changes.

use glam::DVec2;

use crate::active_tool::ActiveTool;
use crate::app::ViewerApp;
use crate::measuring::{MeasureKind, seen_facts, viewshed_from};
use crate::worker::WorkerJob;
use sandtable_picture::recut::SeenTint;
use sandtable_query::viewshed::ViewshedSummary;

/// The viewshed that is shown, or will be.
pub struct ViewshedOverlay {
    /// Map coordinates of the eye.
    at: DVec2,
    job: Option<WorkerJob<SeenFromPlace>>,
    /// Whether the ground has changed since it was begun.
    is_outdated: bool,
}

/// What a job has computed.
struct SeenFromPlace {
    /// `None` for a place without ground.
    summary: Option<ViewshedSummary>,
    tint: Option<SeenTint>,
}

impl ViewshedOverlay {
    /// Whether it is being computed.
    pub fn is_busy(&self) -> bool {
        self.job.is_some()
    }
}

impl ViewerApp {
    /// Tints what is seen from a place, instead of what is tinted now.
    pub(super) fn look_around(&mut self, at: DVec2) {
        let in_memory = self.opened.as_mut().filter(|opened| opened.paged.is_none());
        let Some(opened) = in_memory else { return };
        opened.walk.clear_tint();
        let task = opened.walk.viewshed_task(viewshed_from(at));
        let work = move || {
            let seen = task.seen().ok();
            let tint = seen.as_ref().and_then(|seen| task.tint(seen));
            SeenFromPlace { summary: seen.map(|seen| seen.summary), tint }
        };
        let job = WorkerJob::start(&self.context, work);
        self.viewshed = Some(ViewshedOverlay { at, job: Some(job), is_outdated: false });
    }

    /// Takes the tint away.
    pub(super) fn clear_viewshed(&mut self) {
        if let (Some(_), Some(opened)) = (self.viewshed.take(), &mut self.opened) {
            opened.walk.clear_tint();
        }
    }

    /// Looks around again: the ground has changed.
    pub(super) fn renew_viewshed(&mut self) {
        let Some(overlay) = &mut self.viewshed else { return };
        match overlay.job {
            Some(_) => overlay.is_outdated = true,
            None => {
                let at = overlay.at;
                self.look_around(at);
            }
        }
    }

    /// Shows what was computed meanwhile.
    pub(super) fn follow_viewshed(&mut self) {
        let Some(overlay) = &mut self.viewshed else { return };
        let Some(done) = WorkerJob::take(&mut overlay.job) else { return };
        let (at, is_outdated) = (overlay.at, overlay.is_outdated);
        match done {
            _ if is_outdated => self.look_around(at),
            Ok(SeenFromPlace { summary, tint }) => {
                if let Some(ActiveTool::Measure(measuring)) = &mut self.tool
                    && measuring.kind == MeasureKind::Viewshed
                    && measuring.points.first() == Some(&at)
                {
                    measuring.facts = seen_facts(summary.as_ref());
                }
                if let (Some(opened), Some(tint)) = (&mut self.opened, tint) {
                    opened.walk.lay_tint(tint);
                    opened.relist();
                }
            }
            Err(failure) => self.notices.warn(format!("looking around failed: {failure}")),
        }
        self.context.request_repaint();
    }
}
