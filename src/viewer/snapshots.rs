//! Pictures of the view, drawn on a thread by the renderer of pictures.

use egui::Ui;

use crate::app::ViewerApp;
use crate::drawing_job::DrawingJob;
use crate::loading::opening_error;
use sandtable_editing::edit::SceneEdit;
use sandtable_editing::view_snapshot::{self, ViewSnapshot};
use sandtable_editing::viewed_camera::ViewedCamera;
use sandtable_sheet::picture::PictureSize;

impl ViewerApp {
    /// Says where a picture is that was drawn meanwhile.
    pub(super) fn follow_drawing(&mut self, ui: &Ui) {
        let Some(result) = self.drawing.as_ref().and_then(DrawingJob::poll) else { return };
        let Some(drawing) = self.drawing.take() else { return };
        match result {
            Ok(path) => {
                let ViewSnapshot { name, camera, size, .. } = drawing.snapshot;
                let PictureSize { width, height } = size;
                let text = format!(
                    "{} is the picture of this camera; its table is copied. `sandtable render --camera {name} --size \
                     {width}x{height}` draws it again once the table is in the scene file:",
                    path.display()
                );
                self.snapshot_camera = Some(camera.clone());
                self.notices.tell_with_text(text, camera);
            }
            Err(error) => self.notices.warn(error),
        }
        ui.ctx().request_repaint();
    }

    /// Adds the view to the scene as a camera: an edit.
    pub(super) fn keep_camera(&mut self) {
        let Some((opened, camera)) = self.opened.as_ref().zip(self.view.camera) else { return };
        let Some(session) = &self.session else { return self.refuse() };
        let known: Vec<&str> =
            session.editor.document().cameras.iter().map(|camera| camera.name.as_str()).collect();
        let mut names = (1..=u32::MAX).map(|number| format!("view-{number}"));
        let Some(name) = names.find(|name| !known.contains(&name.as_str())) else { return };
        match ViewedCamera::new(&opened.scene, &camera) {
            Ok(camera) => {
                if self.edit(&SceneEdit::add_camera(&name, &camera)) {
                    let now = self.context.input(|input| input.time);
                    self.notices.tell(now, format!("this view is the camera '{name}' of the scene"));
                }
            }
            Err(error) => self.notices.warn(opening_error(&error)),
        }
    }

    /// Draws a picture of the view on a thread.
    pub(super) fn take_snapshot(&mut self) {
        let Some((opened, camera)) = self.opened.as_ref().zip(self.view.camera) else { return };
        let Some(session) = &self.session else { return self.refuse() };
        if self.drawing.is_some() {
            let now = self.context.input(|input| input.time);
            self.notices.tell(now, "the picture before is still being drawn");
            return;
        }
        let (width, height) = camera.size();
        let snapshot = || -> Result<ViewSnapshot, String> {
            let told = |error: view_snapshot::ViewSnapshotError| opening_error(&error);
            let source = session.editor.source().clone();
            let name = view_snapshot::free_name(&opened.scene, &source.path).map_err(told)?;
            let camera = view_snapshot::camera_table(&opened.scene, &camera, &name).map_err(told)?;
            let size = PictureSize { width: width.clamp(16, 16_384), height: height.clamp(16, 16_384) };
            Ok(ViewSnapshot { source, name, camera, size })
        };
        match snapshot() {
            Ok(snapshot) => {
                self.context.copy_text(snapshot.camera.clone());
                self.drawing = Some(DrawingJob::start(&self.context, snapshot));
            }
            Err(error) => self.notices.warn(error),
        }
    }
}
