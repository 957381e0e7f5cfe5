//! Answers that need reading a file: picks and measurements on terrain that is not in memory.

use std::sync::Arc;

use egui::Context;
use glam::Vec2;

use crate::active_tool::ActiveTool;
use crate::app::ViewerApp;
use crate::awaited_answers::PickJob;
use crate::finer_ground::FinerGround;
use crate::loading::opening_error;
use crate::measuring::{MeasureKind, Measuring};
use crate::opened::OpenedScene;
use crate::paging::{DiskQuestions, PagedTerrain, PagingStage};
use crate::place::PlaceText;
use crate::worker::WorkerJob;
use sandtable_geom::rect::Rect;
use sandtable_terrain::sight::ground::SightGround;
use sandtable_view::camera::Camera;
use sandtable_walk::pick::{PickedWorld, WalkPick, described, pixel_ray};

impl OpenedScene {
    /// Whether the terrain on disk is being measured or read.
    pub fn is_paging(&self) -> bool {
        let is_busy = |paged: &PagedTerrain| match paged.stage() {
            PagingStage::Measuring(_) => true,
            PagingStage::Shown => paged.is_busy(),
            PagingStage::Failed(_) => false,
        };
        self.paged.as_ref().is_some_and(is_busy) || self.finer.as_ref().is_some_and(FinerGround::is_busy)
    }

    /// The exact place of a pick on terrain that is not in memory; `None` where the pick is exact.
    pub fn exact_pick(
        &self,
        (camera, pixel): (&Camera, Vec2),
        pick: &WalkPick,
        context: &Context,
    ) -> Option<PickJob> {
        let paged = self.paged.as_ref().filter(|_| pick.ground_m.is_none())?;
        let (questions, scene) = (paged.questions(), Arc::clone(&self.scene));
        let (ray, expected, feature) = (pixel_ray(camera, pixel), pick.world, pick.place.feature);
        let work = move || {
            let found = questions.answer(|disk| disk.pick(ray, expected))?;
            Ok(found.map(|(world, ground)| {
                let (at, distance_m) = (ground.origin() + world.truncate(), world.distance(ray.origin));
                described(&scene, Some(&ground), PickedWorld { world, at, distance_m, feature })
            }))
        };
        Some(WorkerJob::start(context, work))
    }
}

impl ViewerApp {
    /// Measures with places enough: at once on ground in memory, and on a thread what must be read.
    pub(super) fn measure_again(&mut self) {
        let Some(opened) = &self.opened else { return };
        let Some(ActiveTool::Measure(measuring)) = &mut self.tool else { return };
        let Some(paged) = &opened.paged else { return measuring.measure(&opened.walk) };
        if measuring.kind == MeasureKind::Viewshed {
            measuring.facts = vec![paged.refusal()];
            return;
        }
        measuring.facts.clear();
        measuring.profile.clear();
        if measuring.has_enough() {
            measuring.facts = vec!["reading the ground …".to_owned()];
            let (questions, asked) = (paged.questions(), measuring.clone());
            let work = move || measured(asked, &questions);
            self.answers.measuring = Some(WorkerJob::start(&self.context, work));
        }
    }

    /// Shows the answers that have come.
    pub(super) fn follow_answers(&mut self) {
        if let Some(done) = WorkerJob::take(&mut self.answers.measuring) {
            match (done, &mut self.tool) {
                (Ok(done), Some(ActiveTool::Measure(asked))) if asked.points == done.points => {
                    (asked.facts, asked.profile) = (done.facts, done.profile);
                }
                (Err(failure), _) => self.notices.warn(format!("measuring failed: {failure}")),
                _ => {}
            }
        }
        let Some(done) = WorkerJob::take(&mut self.answers.pick) else { return };
        match (done, &self.opened, &mut self.picked) {
            (Ok(Ok(Some(pick))), Some(opened), Some(picked)) => {
                picked.place = Some(PlaceText::of(&opened.scene, &pick));
            }
            (Ok(Err(error)), _, _) => self.notices.warn(opening_error(&error)),
            (Err(failure), _, _) => self.notices.warn(format!("reading the place failed: {failure}")),
            _ => {}
        }
    }
}

/// A measurement on the part of the terrain that its places span.
fn measured(mut asked: Measuring, questions: &DiskQuestions) -> Measuring {
    let rect = Rect::around(asked.points.iter().copied());
    let part = questions.answer(|disk| disk.part(&rect));
    match part {
        Ok(part) => asked.measure(&SightGround::new(Arc::new(part))),
        Err(error) => asked.facts = vec![opening_error(&error)],
    }
    asked
}
