//! The state of the window without its surface: what is open, what is shown, what the user requested.

use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};

use egui::{CentralPanel, Context, Frame, Ui};
use glam::{DVec2, Vec2};

use crate::active_tool::{ActiveTool, ToolPreview};
use crate::analyzing::Analyzing;
use crate::awaited_answers::DiskAnswers;
use crate::commands::{ViewCommand, pressed};
use crate::drawing_job::DrawingJob;
use crate::following::FollowedFiles;
use crate::frame_times::FrameTimes;
use crate::lettering;
use crate::loading::{LoadingTask, SceneLoading, opening_error};
use crate::measuring::{MeasureKind, Measuring};
use crate::notices::ViewerNotices;
use crate::opened::{OpenedScene, OpeningView, SceneFrame};
use crate::panels::detail::DetailSettings;
use crate::panels::light::LightPanel;
use crate::panels::open::OpenPanel;
use crate::panels::tree::TreePanel;
use crate::picked_part::PickedPart;
use crate::place::PlaceText;
use crate::recent::RecentFiles;
use crate::saving_question::{Leaving, SavingQuestion};
use crate::scene_load::LoaderSlot;
use crate::session::EditingSession;
use crate::view_area::ViewArea;
use crate::viewsheds::ViewshedOverlay;
use sandtable_draw::list::FeatureId;
use sandtable_editing::edit::{EditValue, SceneEdit};
use sandtable_editing::editor::OnConflict;
use sandtable_editing::tool::{DrawingTool, ToolKind};
use sandtable_editing::viewing::ViewerOptions;
use sandtable_files::disk;
use sandtable_picture::tried_analysis::tried_feature;
use sandtable_scene::feature::FeatureKind;
use sandtable_view::camera::Camera;
use sandtable_view::navigation::pose::{ViewPose, wrapped};
use sandtable_view::navigation::{NavigationMode, TRANSITION_S};

/// A request of the app to the window.
#[derive(Clone, Debug, PartialEq)]
pub enum WindowRequest {
    /// Shows this title.
    Title(String),
    /// Fills the screen, or not any more.
    FullScreen,
    /// Takes this size, in pixels.
    Resize(u32, u32),
    /// Writes the next frame into this file.
    Picture(PathBuf),
    /// Closes.
    Close,
}

/// The content of the middle of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewerStage {
    /// Nothing is open.
    Empty,
    /// A first file is being opened.
    Loading,
    /// A scene is shown; another may be on its way.
    Ready,
    /// The file cannot be opened, and there is no scene from before.
    Failed,
}

/// A file that could not be opened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct OpeningFailure {
    pub path: PathBuf,
    pub message: String,
}

/// The texts about a picked place.
#[derive(Clone, Debug, PartialEq)]
pub struct PickedText {
    /// The kind and the name of the feature; of bare ground, `ground`.
    pub feature: String,
    /// The place on the ground; `None` for the sky.
    pub place: Option<PlaceText>,
    /// The table of the scene file that states it; `None` where it cannot be edited.
    pub part: Option<PickedPart>,
}

/// The window's state.
pub struct ViewerApp {
    /// The adapter's name.
    pub adapter: String,
    /// How long frames took.
    pub frames: FrameTimes,
    /// What brings scenes to the window's renderer.
    pub slot: LoaderSlot,
    pub(super) options: ViewerOptions,
    pub(super) context: Context,
    pub(super) recent: RecentFiles,
    pub(super) open_panel: OpenPanel,
    pub(super) shows_open: bool,
    pub(super) shows_help: bool,
    pub(super) shows_panels: bool,
    pub(super) loading: Option<SceneLoading>,
    pub(super) opened: Option<Box<OpenedScene>>,
    pub(super) failure: Option<OpeningFailure>,
    pub(super) notices: ViewerNotices,
    pub(super) view: ViewArea,
    pub(super) tree: TreePanel,
    pub(super) light: LightPanel,
    pub(super) detail: DetailSettings,
    pub(super) picked: Option<PickedText>,
    pub(super) drawing: Option<DrawingJob>,
    /// The camera of the picture that was drawn last.
    pub(super) snapshot_camera: Option<String>,
    pub(super) camera_number: usize,
    pub(super) session: Option<EditingSession>,
    pub(super) tool: Option<ActiveTool>,
    pub(super) preview: Option<ToolPreview>,
    pub(super) viewshed: Option<ViewshedOverlay>,
    pub(super) analyzing: Analyzing,
    pub(super) question: Option<SavingQuestion>,
    pub(super) answers: DiskAnswers,
    pub(super) files: FollowedFiles,
    title: String,
    pub(super) requests: Vec<WindowRequest>,
}

impl ViewerApp {
    /// The state of a window that begins with the file of `options`.
    pub fn new(options: &ViewerOptions, context: &Context) -> Self {
        let is_offscreen = options.offscreen.is_some();
        let recent = if is_offscreen { RecentFiles::default() } else { RecentFiles::of_user() };
        Self::with_recent(options, context, recent)
    }

    /// The same with a list of files opened last.
    pub(super) fn with_recent(options: &ViewerOptions, context: &Context, recent: RecentFiles) -> Self {
        let folder = options.file.as_deref().and_then(Path::parent);
        let folder = folder.filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut app = Self {
            adapter: String::new(),
            frames: FrameTimes::default(),
            slot: LoaderSlot::default(),
            options: options.clone(),
            context: context.clone(),
            recent,
            open_panel: OpenPanel::at(folder),
            shows_open: options.file.is_none(),
            shows_help: false,
            shows_panels: options.offscreen.is_none(),
            loading: None,
            opened: None,
            failure: None,
            notices: ViewerNotices::default(),
            view: ViewArea::new(),
            tree: TreePanel::default(),
            light: LightPanel::default(),
            detail: DetailSettings { tolerance_px: 1.0, wireframe: false, frozen: false, is_fixed: false },
            picked: None,
            drawing: None,
            snapshot_camera: None,
            camera_number: 0,
            session: None,
            tool: None,
            preview: None,
            viewshed: None,
            analyzing: Analyzing::default(),
            question: None,
            answers: DiskAnswers::default(),
            files: FollowedFiles::default(),
            title: String::new(),
            requests: Vec::new(),
        };
        lettering::set_fonts(context, None);
        if let Some(file) = &options.file {
            app.open(file);
        }
        app
    }

    /// The content of the middle of the window.
    pub fn stage(&self) -> ViewerStage {
        match (&self.opened, &self.loading, &self.failure) {
            (Some(_), _, _) => ViewerStage::Ready,
            (None, Some(_), _) => ViewerStage::Loading,
            (None, None, Some(_)) => ViewerStage::Failed,
            (None, None, None) => ViewerStage::Empty,
        }
    }

    /// The requests to the window since this was called last.
    pub fn take_requests(&mut self) -> Vec<WindowRequest> {
        std::mem::take(&mut self.requests)
    }

    /// The frame for the scene's renderer, of whose picture `drawn_size` says how many pixels are drawn; `None` where there is no
    /// scene, or its camera sees nothing.
    pub fn scene_frame(&mut self, drawn_size: impl FnOnce(&Camera) -> (u32, u32)) -> Option<SceneFrame> {
        let opened = self.opened.as_mut().filter(|_| self.view.size.0 > 0)?;
        match opened.frame(self.view.size, drawn_size) {
            Ok(frame) => {
                self.view.camera = Some(frame.camera);
                if frame.statistics.waiting_patches > 0 || frame.wants_ground {
                    self.context.request_repaint();
                }
                Some(frame)
            }
            Err(error) => {
                self.notices.warn(opening_error(&error));
                None
            }
        }
    }

    /// Whether the renderer outlines triangles.
    pub fn shows_edges(&self) -> bool {
        self.detail.wireframe
    }

    /// Loads the whole scene again, because the renderer has lost it.
    pub fn reload_scene(&mut self) {
        if let Some(opened) = &mut self.opened {
            opened.reload();
        }
    }

    /// Whether a file is being opened or read, a picture is being drawn, or solids and models are being placed again.
    pub fn is_busy(&self) -> bool {
        let is_relisting = self.opened.as_ref().is_some_and(|opened| opened.is_relisting());
        let is_looking = self.viewshed.as_ref().is_some_and(ViewshedOverlay::is_busy);
        let is_paging = self.opened.as_ref().is_some_and(|opened| opened.is_paging() || opened.is_reaching());
        self.loading.is_some()
            || self.drawing.is_some()
            || is_relisting
            || is_looking
            || self.analyzing.is_busy()
            || is_paging
            || self.answers.is_busy()
    }

    /// The notices in the window, the oldest first.
    pub fn notice_texts(&self) -> impl Iterator<Item = &str> {
        self.notices.texts()
    }

    /// Why the file cannot be opened; empty where it can.
    pub fn failure_text(&self) -> &str {
        self.failure.as_ref().map_or("", |failure| failure.message.as_str())
    }

    /// Makes each frame count `seconds`, however long it takes, as in a script.
    pub fn keep_step(&mut self, seconds: f64) {
        self.view.fixed_step_s = Some(seconds);
    }

    /// Shows an error in the window.
    pub fn warn(&mut self, text: impl Into<String>) {
        self.notices.warn(text);
    }

    /// The user closes the window.
    pub fn ask_to_close(&mut self) {
        self.leave(Leaving::Close);
    }

    /// Opens a file; the scene from before stays until it is there. Edits of it that are not saved are lost.
    pub fn open(&mut self, path: &Path) {
        // A file that is read again is shown in the phase from before.
        let source = self.session.as_ref().map(|session| session.editor.source());
        let phase = source.filter(|source| source.path == path).and_then(|source| source.phase.clone());
        self.start_loading(LoadingTask::File(path.to_owned(), self.options.allowed.clone(), phase));
        self.shows_open = false;
    }

    fn start_loading(&mut self, task: LoadingTask) {
        let (LoadingTask::File(path, ..) | LoadingTask::Edited(path, _)) = &task;
        let before = self.opened.as_ref().filter(|before| before.path == *path);
        let view = before.map_or_else(OpeningView::default, |before| OpeningView {
            seen: Some(before.seen_from(self.view.size)),
            hidden: self.tree.hidden.clone(),
        });
        let replaces = match &task {
            LoadingTask::File(..) => self.session.as_ref().map(|session| session.editor.text().to_owned()),
            LoadingTask::Edited(..) => None,
        };
        let context = self.context.clone();
        let wake = move || context.request_repaint();
        let mut loading = SceneLoading::start(task, view, self.slot.clone(), wake);
        loading.replaces = replaces;
        self.loading = Some(loading);
        self.failure = None;
    }

    /// Builds the scene anew as it is edited now.
    pub(super) fn rebuild(&mut self) {
        if let Some((opened, session)) = self.opened.as_ref().zip(self.session.as_ref()) {
            let (path, source) = (opened.path.clone(), session.editor.source().clone());
            self.start_loading(LoadingTask::Edited(path, source));
        }
    }

    /// Draws the window of one frame.
    pub fn show(&mut self, ui: &mut Ui) {
        self.follow_loading(ui);
        self.follow_drawing(ui);
        self.follow_viewshed();
        self.follow_analysis();
        self.follow_relisting();
        self.follow_paging();
        self.follow_answers();
        self.follow_files(ui);
        if !ui.ctx().text_edit_focused() {
            let commands = ui.input_mut(pressed);
            commands.into_iter().for_each(|command| self.run(command));
        }
        // Without a window, a frame is the scene alone until its panels are wanted.
        let has_panels = self.shows_panels || self.options.offscreen.is_none();
        if has_panels {
            self.show_menu(ui);
            self.show_status(ui);
            self.show_sides(ui);
        }
        CentralPanel::default().frame(Frame::NONE).show(ui, |ui| {
            self.show_middle(ui);
            if has_panels {
                self.notices.show(ui);
            }
        });
        if has_panels {
            self.show_windows(ui.ctx());
        }
        self.follow_title();
    }

    /// Reads the file again.
    pub(super) fn reload(&mut self) {
        let opened = self.opened.as_ref().map(|opened| opened.path.clone());
        let failed = self.failure.as_ref().map(|failure| failure.path.clone());
        if let Some(path) = opened.or(failed) {
            self.open(&path);
        }
    }

    /// Draws heights another number of times as high: an edit of the scene.
    pub(super) fn exaggerate(&mut self, factor: f64) {
        let factor = EditValue::Number(factor);
        self.edit(&SceneEdit::set_value("terrain.vertical_exaggeration", factor));
    }

    /// Writes the sun's direction into the scene, as it is shown already.
    pub(super) fn keep_light(&mut self) {
        let angle =
            |name, degrees: f32| SceneEdit::set_value(name, EditValue::Number(f64::from(degrees).round()));
        let edit = SceneEdit::Together(vec![
            angle("style.light.azimuth", self.light.azimuth_deg),
            angle("style.light.altitude", self.light.altitude_deg.max(1.0)),
        ]);
        let Some((opened, session)) = self.opened.as_ref().zip(self.session.as_mut()) else { return };
        if let Err(error) = session.editor.apply(&edit, &opened.scene) {
            self.notices
                .warn(format!("the sun is shown here but not kept in the scene: {}", opening_error(&error)));
        }
    }

    /// Says what the picture shows at a pixel.
    pub(super) fn pick(&mut self, pixel: Vec2) {
        let Some((opened, camera)) = self.opened.as_ref().zip(self.view.camera) else { return };
        if let Some(label) = self.view.label_at(pixel).filter(|&label| label < opened.scene.labels.len()) {
            let feature = format!("label {}", opened.scene.labels[label].text);
            self.picked = Some(PickedText { feature, place: None, part: self.part_of_label(label) });
            return;
        }
        let pick = opened.pick(&camera, pixel);
        self.answers.pick =
            pick.as_ref().and_then(|pick| opened.exact_pick((&camera, pixel), pick, &self.context));
        self.picked = Some(match pick {
            Some(pick) => PickedText {
                feature: feature_text(opened, self.analyzing.tried_name(), pick.place.feature),
                place: Some(PlaceText::of(&opened.scene, &pick)),
                part: self.part_of_feature(pick.place.feature),
            },
            None => PickedText { feature: "sky".to_owned(), place: None, part: None },
        });
    }

    /// Carries out a command.
    pub(super) fn run(&mut self, command: ViewCommand) {
        match command {
            ViewCommand::Help => self.shows_help = !self.shows_help,
            ViewCommand::Open => self.shows_open = true,
            ViewCommand::Cancel if self.question.take().is_some() => {}
            ViewCommand::Cancel if self.shows_help || self.shows_open => {
                (self.shows_help, self.shows_open) = (false, false);
            }
            ViewCommand::Cancel => {
                if !self.leave_tool() {
                    self.notices.clear();
                }
            }
            ViewCommand::FullScreen => self.requests.push(WindowRequest::FullScreen),
            ViewCommand::Quit => self.ask_to_close(),
            ViewCommand::Reload => self.leave(Leaving::Reload),
            ViewCommand::Panels => self.shows_panels = !self.shows_panels,
            ViewCommand::Labels => self.view.shows_labels = !self.view.shows_labels,
            ViewCommand::Wireframe => self.detail.wireframe = !self.detail.wireframe,
            ViewCommand::Freeze => self.set_frozen(!self.detail.frozen),
            ViewCommand::Find => (self.shows_panels, self.tree.focuses_find) = (true, true),
            ViewCommand::Snapshot => self.take_snapshot(),
            ViewCommand::KeepCamera => self.keep_camera(),
            ViewCommand::Home => self.go_to_camera(0),
            ViewCommand::NextCamera => self.go_to_camera(self.camera_number + 1),
            ViewCommand::PreviousCamera => self.go_to_camera(self.camera_number + usize::MAX),
            ViewCommand::NextPhase => self.step_phase(1),
            ViewCommand::PreviousPhase => self.step_phase(-1),
            ViewCommand::Orbit => self.set_mode(NavigationMode::Orbit),
            ViewCommand::Fly => self.set_mode(NavigationMode::Flight),
            ViewCommand::Walk => self.set_mode(NavigationMode::OnFoot),
            ViewCommand::North => self.look(Some(0.0), None),
            ViewCommand::Down => self.look(None, Some(-FRAC_PI_2)),
            ViewCommand::Save => self.save(OnConflict::Refuse),
            ViewCommand::TakeBackPoint => self.take_back_point(),
            ViewCommand::Undo => self.step_back(),
            ViewCommand::Redo => self.step_forward(),
            ViewCommand::Crater => {
                self.shows_panels = true;
                self.take_tool(Some(ActiveTool::Draw(DrawingTool::new(ToolKind::Crater))));
            }
            ViewCommand::MeasureLine => self.measure(MeasureKind::Line),
            ViewCommand::MeasureArea => self.measure(MeasureKind::Area),
        }
        self.context.request_repaint();
    }

    pub(super) fn set_mode(&mut self, mode: NavigationMode) {
        if let Some(opened) = &mut self.opened {
            opened.navigator.set_mode(mode);
        }
    }

    pub(super) fn set_frozen(&mut self, frozen: bool) {
        self.detail.frozen = frozen;
        if let Some(opened) = &mut self.opened {
            opened.frozen = frozen.then_some(opened.navigator.pose());
        }
    }

    /// Goes to a camera of the scene by its number, counted round.
    pub(super) fn go_to_camera(&mut self, number: usize) {
        let Some(opened) = &mut self.opened else { return };
        let count = opened.scene.cameras.len();
        self.camera_number = if number > usize::MAX / 2 { count - 1 } else { number % count };
        let view = opened.scene.cameras[self.camera_number].clone();
        let size = (self.view.size.0.max(16), self.view.size.1.max(16));
        if let Err(error) = opened.go_to_view(&view, size) {
            self.notices.warn(opening_error(&error));
        }
    }

    /// Looks in a direction, about the place in the middle of the picture.
    fn look(&mut self, azimuth_rad: Option<f64>, pitch_rad: Option<f64>) {
        let Some((opened, camera)) = self.opened.as_mut().zip(self.view.camera) else { return };
        let pivot = opened.focus(&camera);
        let before = opened.navigator.pose();
        let pitch = pitch_rad.map_or(0.0, |pitch| pitch - before.pitch_rad);
        let turn =
            DVec2::new(azimuth_rad.map_or(0.0, |azimuth| wrapped(azimuth - before.azimuth_rad)), pitch);
        let after = before.turned(turn);
        let eye = pivot + after.from_frame(before.to_frame(before.eye - pivot));
        opened.navigator.go_to(ViewPose { eye, ..after }, TRANSITION_S);
    }

    fn measure(&mut self, kind: MeasureKind) {
        self.shows_panels = true;
        self.take_tool(Some(ActiveTool::Measure(Measuring::new(kind))));
    }

    fn step_back(&mut self) {
        let Some((opened, session)) = self.opened.as_mut().zip(self.session.as_mut()) else { return };
        if let Some(outcome) = session.undo(opened) {
            self.note_outcome(outcome);
        }
    }

    fn step_forward(&mut self) {
        let Some((opened, session)) = self.opened.as_mut().zip(self.session.as_mut()) else { return };
        if let Some(outcome) = session.redo(opened) {
            self.note_outcome(outcome);
        }
    }

    /// Says in the title what is open, and whether it is saved.
    fn follow_title(&mut self) {
        let Some(opened) = &self.opened else { return };
        let is_changed = self.session.as_ref().is_some_and(|session| session.editor.is_changed());
        let mark = if is_changed { "* " } else { " " };
        let title = format!("{}{mark}· sandtable", disk::file_name(&opened.path));
        if title != self.title {
            self.requests.push(WindowRequest::Title(title.clone()));
            self.title = title;
        }
    }
}

/// A feature by kind and name; `tried` is the name of an analysis that is not in the scene.
fn feature_text(opened: &OpenedScene, tried: Option<&str>, feature: FeatureId) -> String {
    let known = feature.index().and_then(|index| opened.scene.features.get(index));
    match known {
        None if feature == tried_feature(&opened.scene) => {
            format!("{} {}", FeatureKind::Analysis.noun(1), tried.unwrap_or_default())
        }
        Some(feature) if feature.name.is_empty() => feature.kind.noun(1).to_owned(),
        Some(feature) => format!("{} {}", feature.kind.noun(1), feature.name),
        None if feature == FeatureId::GROUND => "ground".to_owned(),
        None => "the side of the block".to_owned(),
    }
}
