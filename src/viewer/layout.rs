//! The layout of the panels: the menu above, the status below, the sections at the side, windows over the middle.

use egui::{Align2, CollapsingHeader, ComboBox, Context, Grid, Panel, RichText, ScrollArea, Ui, Window};

use crate::app::{ViewerApp, ViewerStage};
use crate::commands::{ViewCommand, key_text};
use crate::panels::detail::detail_panel;
use crate::panels::findings::{findings_panel, findings_title};
use crate::panels::help::help_panel;
use crate::panels::light::{LightEvent, light_panel};
use crate::panels::open::open_panel;
use crate::panels::paging::paging_panel;
use crate::panels::timing::timing_panel;
use crate::panels::tree::{TreeEvent, tree_panel};
use crate::place::PlaceText;
use crate::saving_question::Leaving;
use crate::viewsheds::ViewshedOverlay;
use sandtable_files::disk;
use sandtable_view::navigation::NavigationMode;

/// The width of the sections at the side, in points.
const SIDE_WIDTH: f32 = 290.0;

/// The ways to move, as the menu names them.
const MODES: [(&str, NavigationMode, ViewCommand); 3] = [
    ("Orbit", NavigationMode::Orbit, ViewCommand::Orbit),
    ("Fly", NavigationMode::Flight, ViewCommand::Fly),
    ("Walk", NavigationMode::OnFoot, ViewCommand::Walk),
];

/// The commands that are buttons while a scene is open.
const BUTTONS: [(&str, ViewCommand); 4] = [
    ("Whole scene", ViewCommand::Home),
    ("Picture", ViewCommand::Snapshot),
    ("Keep view", ViewCommand::KeepCamera),
    ("Panels", ViewCommand::Panels),
];

/// A button that says the key of its command; whether it is clicked.
fn command_button(ui: &mut Ui, text: &str, command: ViewCommand) -> bool {
    ui.button(text).on_hover_text(format!("Key: {}", key_text(command))).clicked()
}

impl ViewerApp {
    pub(super) fn show_menu(&mut self, ui: &mut Ui) {
        let mut commands = Vec::new();
        let (mut camera, mut phase) = (None, None);
        Panel::top("menu").show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                for (text, command) in [("Open", ViewCommand::Open), ("Keys", ViewCommand::Help)] {
                    if command_button(ui, text, command) {
                        commands.push(command);
                    }
                }
                if let Some(opened) = &self.opened {
                    ui.separator();
                    for (text, mode, command) in MODES {
                        let is_chosen = opened.navigator.mode() == mode;
                        let hover = format!("Key: {}", key_text(command));
                        if ui.selectable_label(is_chosen, text).on_hover_text(hover).clicked() {
                            commands.push(command);
                        }
                    }
                    ui.separator();
                    let combo = ComboBox::from_id_salt("camera").selected_text("Cameras");
                    let combo = combo.show_ui(ui, |ui| {
                        for (number, view) in opened.scene.cameras.iter().enumerate() {
                            if ui.selectable_label(false, &view.name).clicked() {
                                camera = Some(number);
                            }
                        }
                    });
                    combo.response.accessible_name("Cameras");
                    phase = self.phase_choice(ui);
                    for (text, command) in BUTTONS {
                        if command_button(ui, text, command) {
                            commands.push(command);
                        }
                    }
                    ui.checkbox(&mut self.view.shows_labels, "Labels")
                        .on_hover_text(key_text(ViewCommand::Labels));
                }
                ui.separator();
                let is_dark = ui.visuals().dark_mode;
                if ui
                    .button(if is_dark { "Light" } else { "Dark" })
                    .on_hover_text("Colors of the panels")
                    .clicked()
                {
                    ui.ctx().set_theme(if is_dark { egui::Theme::Light } else { egui::Theme::Dark });
                }
                if let Some(loading) = &self.loading {
                    ui.spinner();
                    ui.label(format!("{}: {}", disk::file_name(&loading.path), loading.step));
                }
                if self.drawing.is_some() {
                    ui.spinner();
                    ui.label("drawing the picture");
                }
                if self.viewshed.as_ref().is_some_and(ViewshedOverlay::is_busy) {
                    ui.spinner();
                    ui.label("looking around");
                }
                if self.analyzing.is_busy() {
                    ui.spinner();
                    ui.label("analyzing");
                }
                if self.opened.as_ref().is_some_and(|opened| opened.is_relisting()) {
                    ui.spinner();
                    ui.label("setting light and models");
                }
            });
        });
        commands.into_iter().for_each(|command| self.run(command));
        if let Some(number) = camera {
            self.go_to_camera(number);
        }
        if let Some(name) = phase {
            self.show_phase(&name);
        }
    }

    pub(super) fn show_status(&mut self, ui: &mut Ui) {
        let Some(opened) = &self.opened else { return };
        let text = match &self.view.hovered {
            Some(place) => PlaceText::of(&opened.scene, place).line(),
            None => format!("{}   ? shows the keys", self.adapter),
        };
        let hint = self.tool_hint();
        Panel::bottom("status").show(ui, |ui| {
            ui.horizontal(|ui| {
                if !hint.is_empty() {
                    ui.strong(hint);
                    ui.separator();
                }
                ui.label(text);
            });
        });
    }

    pub(super) fn show_sides(&mut self, ui: &mut Ui) {
        if !self.shows_panels || self.opened.is_none() {
            return;
        }
        Panel::left("side").default_size(SIDE_WIDTH).show(ui, |ui| {
            ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| self.show_sections(ui));
        });
    }

    fn show_sections(&mut self, ui: &mut Ui) {
        self.show_picked(ui);
        self.show_tools(ui);
        self.show_analyses(ui);
        let Some(opened) = &mut self.opened else { return };
        let (mut exaggeration, mut light) = (None, None);
        let header = |title: &str| CollapsingHeader::new(RichText::new(title).strong()).id_salt(title);
        header("Scene").default_open(true).show(ui, |ui| {
            match tree_panel(ui, &mut self.tree, &opened.scene.features) {
                Some(TreeEvent::Visibility) => opened.hide(&self.tree.hidden),
                Some(TreeEvent::GoTo(feature)) if !opened.go_to_feature(feature) => {
                    let now = ui.input(|input| input.time);
                    self.notices.tell(now, "this feature lies nowhere on the ground of the scene");
                }
                Some(TreeEvent::GoToPosition(position)) => {
                    let now = ui.input(|input| input.time);
                    let text = opened.go_to_position(&position).unwrap_or_else(|refusal| refusal);
                    self.notices.tell(now, text);
                }
                Some(TreeEvent::GoTo(_)) | None => {}
            }
        });
        if !opened.scene.findings.is_empty() {
            let title = RichText::new(findings_title(&opened.scene.findings)).strong();
            let header = CollapsingHeader::new(title).id_salt("Findings");
            header.show(ui, |ui| findings_panel(ui, &opened.scene.findings));
        }
        header("Light and heights").show(ui, |ui| {
            let (middle, crs) =
                (opened.scene.lattice.map_point(opened.bounds().center()), opened.scene.crs.clone());
            match light_panel(ui, &mut self.light, &crs, middle) {
                Some(LightEvent::Sun(to_sun)) => {
                    opened.set_sun(to_sun);
                    light = Some(to_sun);
                }
                Some(LightEvent::Exaggeration(factor)) => exaggeration = Some(factor),
                None => {}
            }
        });
        if let Some(paged) = &opened.paged {
            header("Terrain on disk").default_open(true).show(ui, |ui| {
                paging_panel(ui, paged.size, &paged.stage(), &paged.kept);
            });
        }
        let mut detail = self.detail;
        header("Level of detail").show(ui, |ui| detail_panel(ui, &mut detail));
        if detail.tolerance_px != self.detail.tolerance_px {
            opened.walk.set_tolerance_px(detail.tolerance_px);
        }
        let is_frozen_anew = detail.frozen != self.detail.frozen;
        self.detail = detail;
        header("Frames").show(ui, |ui| timing_panel(ui, &self.frames));
        if is_frozen_anew {
            self.set_frozen(detail.frozen);
        }
        if light.is_some() {
            self.keep_light();
        }
        if let Some(factor) = exaggeration {
            self.exaggerate(factor);
        }
    }

    fn show_picked(&mut self, ui: &mut Ui) {
        let Some(picked) = &self.picked else {
            ui.weak("Click at anything to see what it is.");
            return;
        };
        ui.label(RichText::new(&picked.feature).strong());
        self.show_picked_place(ui);
        self.show_part(ui);
    }

    fn show_picked_place(&self, ui: &mut Ui) {
        let Some(place) = self.picked.as_ref().and_then(|picked| picked.place.as_ref()) else { return };
        Grid::new("picked").num_columns(2).show(ui, |ui| {
            for (name, value) in [
                ("Map", &place.map),
                ("Lon, lat", &place.geographic),
                ("MGRS", &place.grid),
                ("Height", &place.height),
                ("Top", &place.top),
                ("Slope", &place.slope),
                ("Distance", &place.distance),
            ] {
                if !value.is_empty() {
                    ui.weak(name);
                    ui.label(value);
                    ui.end_row();
                }
            }
        });
        if ui.button("Copy place").clicked() {
            ui.ctx().copy_text(place.line());
        }
    }

    pub(super) fn show_middle(&mut self, ui: &mut Ui) {
        match self.stage() {
            ViewerStage::Empty => {
                ui.centered_and_justified(|ui| ui.label("Nothing is open."));
            }
            ViewerStage::Loading => {
                if let Some(loading) = &self.loading {
                    ui.ctx().request_repaint_after_secs(0.25);
                    let seconds = loading.since.elapsed().as_secs();
                    let text = format!("Opening {} …\n{}, {seconds} s", loading.path.display(), loading.step);
                    ui.centered_and_justified(|ui| ui.label(RichText::new(text).size(18.0)));
                }
            }
            ViewerStage::Failed => {
                if let Some(failure) = &self.failure {
                    ui.vertical_centered(|ui| {
                        ui.add_space(40.0);
                        ui.heading(format!("{} cannot be opened", failure.path.display()));
                        ui.monospace(&failure.message);
                    });
                }
            }
            ViewerStage::Ready => {
                let Some(opened) = &mut self.opened else { return };
                let part = self.picked.as_ref().and_then(|picked| picked.part.as_ref());
                self.view.grabbed_part = part.filter(|_| self.tool.is_none()).and_then(|part| part.grab);
                let event = self.view.show(ui, opened);
                if let Some(event) = event {
                    self.take_view_event(event);
                }
                if let Some(rect) = self.view.rect {
                    self.show_tool(ui, rect);
                }
            }
        }
    }

    pub(super) fn show_windows(&mut self, context: &Context) {
        let mut shows_help = self.shows_help;
        let window = Window::new("Keys").open(&mut shows_help).default_height(620.0).collapsible(false);
        window.anchor(Align2::CENTER_CENTER, [0.0, 0.0]).show(context, help_panel);
        self.shows_help = shows_help;
        let mut shows_open = self.shows_open;
        let window =
            Window::new("Open").open(&mut shows_open).default_size([560.0, 460.0]).collapsible(false);
        let window = window.anchor(Align2::CENTER_CENTER, [0.0, 0.0]);
        let chosen = window.show(context, |ui| open_panel(ui, &mut self.open_panel, &self.recent));
        self.shows_open = shows_open;
        if let Some(path) = chosen.and_then(|window| window.inner).flatten() {
            self.leave(Leaving::Open(path));
        }
        self.show_question(context);
    }
}
