//! A script at work: its commands frame by frame, and the report of what they did.

use std::collections::{BTreeMap, VecDeque};
use std::io::Write;
use std::path::Path;
use std::time::Instant;

use serde_json::{Value, json};

use crate::app::{ViewerApp, ViewerStage, WindowRequest};
use crate::commands::ViewCommand;
use crate::error::ViewerError;
use crate::frame_drawer::{DrawnFrame, LaidFrame};
use crate::frame_times::{FrameTime, percentile};
use crate::script::{ScriptCommand, parse_script};
use sandtable_draw::list::FeatureId;
use sandtable_editing::edit::{EarthworkDraft, SceneEdit};
use sandtable_files::disk;
use sandtable_gpu::pass_timer::PassTime;
use sandtable_view::navigation::pose::ViewPose;

/// The time that each frame of a script counts, in seconds: the same on every machine.
pub const FRAME_S: f64 = 1.0 / 60.0;
/// A frame that takes longer is seen to stutter, in milliseconds.
const DROPPED_MS: f32 = 33.3;

/// A script and what it did.
pub struct ScriptRun {
    commands: VecDeque<(String, ScriptCommand)>,
    most_frames: Option<u32>,
    started: Instant,
    first_window_s: Option<f64>,
    first_picture_s: Option<f64>,
    waits: u32,
    frames: u32,
    times: Vec<FrameTime>,
    /// What the passes of each frame took on the adapter, by their names, milliseconds.
    passes: BTreeMap<&'static str, Vec<f32>>,
    /// What all passes of a frame took, milliseconds.
    device: Vec<f32>,
    /// Calls of the adapter in each frame.
    calls: Vec<f32>,
    /// Triangles of the ground and of what lies on it in each frame.
    drawn_triangles: Vec<f32>,
    /// The share of the view's side that each frame drew.
    side_shares: Vec<f32>,
    pipelines: usize,
    triangles: usize,
    bytes: u64,
    done: Vec<Value>,
    /// A command whose effect is awaited.
    awaited: Option<(String, usize)>,
    /// When the frame before was begun; `None` before the first picture.
    begun: Option<Instant>,
    /// The longest time from frame to frame, and the longest of the window's own work in one, in milliseconds: of the command
    /// that is carried out, and of all.
    longest: [LongestFrame; 2],
    is_over: bool,
}

/// The longest times of frames, milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct LongestFrame {
    /// From the begin of a frame to the begin of the next.
    gap_ms: f32,
    /// What the window's thread did in a frame, but for waiting for the one before and for the surface.
    own_ms: f32,
}

impl ScriptRun {
    /// The script of a file, which begins when the scene is open.
    ///
    /// # Errors
    /// [`ViewerError::Script`] and [`ViewerError::Read`].
    pub fn read(path: &Path, most_frames: Option<u32>, started: Instant) -> Result<Self, ViewerError> {
        let commands = parse_script(&disk::read_text(path)?)
            .map_err(|error| ViewerError::Script { path: path.to_owned(), error })?;
        Ok(Self::new(commands, most_frames, started))
    }

    /// Prints the report of what the script did; who asked for it and does not read it gets none.
    pub fn print_report(&self, adapter: &str) {
        let _ = writeln!(std::io::stdout(), "{:#}", self.report(adapter));
    }

    /// Commands that begin when the scene is open.
    pub(super) fn new(
        commands: Vec<(String, ScriptCommand)>,
        most_frames: Option<u32>,
        started: Instant,
    ) -> Self {
        Self {
            commands: commands.into(),
            most_frames,
            started,
            first_window_s: None,
            first_picture_s: None,
            waits: 0,
            frames: 0,
            times: Vec::new(),
            passes: BTreeMap::new(),
            device: Vec::new(),
            calls: Vec::new(),
            drawn_triangles: Vec::new(),
            side_shares: Vec::new(),
            pipelines: 0,
            triangles: 0,
            bytes: 0,
            done: Vec::new(),
            awaited: None,
            begun: None,
            longest: [LongestFrame::default(); 2],
            is_over: false,
        }
    }

    /// Notes that a frame is begun.
    pub fn note_begin(&mut self, now: Instant) {
        if self.first_picture_s.is_none() {
            return;
        }
        if let Some(before) = self.begun.replace(now) {
            let gap_ms = now.duration_since(before).as_secs_f32() * 1e3;
            self.longest.iter_mut().for_each(|longest| longest.gap_ms = longest.gap_ms.max(gap_ms));
        }
    }

    /// Notes a frame that is made, for which the window's thread worked so long, and the one before, which is drawn.
    pub fn note_frame(&mut self, made: &LaidFrame, before: Option<&DrawnFrame>, own_ms: f32) {
        self.first_window_s.get_or_insert(self.started.elapsed().as_secs_f64());
        before.into_iter().for_each(|before| self.note_drawn(before));
        self.frames += u32::from(made.scene.is_some());
        if self.begun.is_some() {
            self.longest.iter_mut().for_each(|longest| longest.own_ms = longest.own_ms.max(own_ms));
        }
    }

    /// Notes the times of the passes of a frame; of one without a scene, which has its panels alone, none.
    pub fn note_passes(&mut self, passes: &[PassTime]) {
        if passes.len() < 2 {
            return;
        }
        for pass in passes {
            self.passes.entry(pass.label).or_default().push(pass.ms);
        }
        self.device.push(passes.iter().map(|pass| pass.ms).sum());
    }

    /// Notes a frame that is drawn and sent.
    pub fn note_drawn(&mut self, drawn: &DrawnFrame) {
        let Some((time, load)) = drawn.scene else { return };
        self.first_picture_s.get_or_insert(self.started.elapsed().as_secs_f64());
        self.times.push(time);
        self.calls.push(load.calls as f32);
        self.drawn_triangles.push(load.drawn_triangles as f32);
        self.side_shares.push(load.side_share());
        self.triangles = load.ground_triangles;
        self.bytes += load.bytes;
        self.pipelines = drawn.pipelines;
    }

    /// Carries out what is due before the next frame.
    pub fn step(&mut self, app: &mut ViewerApp) {
        if self.is_over || app.is_busy() {
            return;
        }
        if self.waits > 0 {
            self.waits -= 1;
            return;
        }
        if let Some((line, notices)) = self.awaited.take() {
            let said: Vec<String> = app.notice_texts().skip(notices).map(str::to_owned).collect();
            let camera = app.snapshot_camera.take();
            let analysis = line.starts_with("analyze ").then(|| app.analyzing.report());
            let LongestFrame { gap_ms, own_ms } = std::mem::take(&mut self.longest[0]);
            self.done.push(json!({
                "command": line, "said": said, "camera": camera, "analysis": analysis,
                "longest_gap_ms": gap_ms, "longest_own_ms": own_ms,
            }));
        }
        let is_late = self.most_frames.is_some_and(|most| self.frames >= most);
        let has_failed = app.stage() == ViewerStage::Failed;
        match self.commands.pop_front() {
            Some((line, command)) if !is_late && !has_failed => self.run(line, command, app),
            next => {
                if has_failed {
                    self.done.push(json!({ "failed": app.failure_text() }));
                }
                if is_late || has_failed || next.is_none() && self.most_frames.is_none() {
                    self.is_over = true;
                    app.requests.push(WindowRequest::Close);
                }
            }
        }
    }

    fn run(&mut self, line: String, command: ScriptCommand, app: &mut ViewerApp) {
        let notices = app.notice_texts().count();
        match command {
            ScriptCommand::Wait(frames) => self.waits = frames,
            ScriptCommand::Run(ViewCommand::Quit) => {
                // Nobody is there to answer whether edits are to be saved.
                let unsaved = app.session.as_ref().is_some_and(|session| session.editor.is_changed());
                self.done.push(json!({ "command": line, "unsaved": unsaved }));
                self.is_over = true;
                app.requests.push(WindowRequest::Close);
                return;
            }
            ScriptCommand::Run(command) => app.run(command),
            ScriptCommand::Fly { eye, target, frames } => {
                if let Some(opened) = &mut app.opened {
                    let origin = opened.scene.lattice.origin().extend(0.0);
                    let scale = opened.scene.scale;
                    let world = |at: glam::DVec3| (at - origin).with_z(scale.world_z(at.z));
                    if let Some(pose) = ViewPose::looking(world(eye), world(target)) {
                        opened.navigator.go_to(pose, f64::from(frames) * FRAME_S);
                        self.waits = frames;
                    }
                }
            }
            ScriptCommand::Camera(name) => {
                let number = app
                    .opened
                    .as_ref()
                    .and_then(|opened| opened.scene.cameras.iter().position(|view| view.name == name));
                match number {
                    Some(number) => app.go_to_camera(number),
                    None => app.warn(format!("the scene has no camera '{name}'")),
                }
                self.waits = 80;
            }
            ScriptCommand::Phase(name) => app.show_phase(&name),
            ScriptCommand::Pick(pixel) => {
                app.pick(pixel.as_vec2());
                let picked = app.picked.as_ref().map(|picked| {
                    let place = picked.place.as_ref().map(|place| place.line());
                    json!({ "feature": picked.feature, "place": place })
                });
                self.done.push(json!({ "command": line, "picked": picked }));
                return;
            }
            ScriptCommand::Sun(angles) => {
                let angles = angles.as_vec2();
                (app.light.azimuth_deg, app.light.altitude_deg) = (angles.x, angles.y);
                if let Some(opened) = &mut app.opened {
                    opened.set_sun(app.light.to_sun());
                }
                app.keep_light();
            }
            ScriptCommand::Heights(factor) => app.exaggerate(factor),
            ScriptCommand::Viewshed(at) => app.look_around(at),
            ScriptCommand::Analyze { kind, arguments } => app.analyze_by_name(&kind, &arguments),
            ScriptCommand::KeepAnalysis => app.keep_analysis(),
            ScriptCommand::DiscardAnalysis => app.discard_analysis(),
            ScriptCommand::Visibility { kind, shown } => {
                if let Some(opened) = &mut app.opened {
                    let features = (0..).map(FeatureId::of_index).zip(&opened.scene.features);
                    let meant = features.filter(|(_, feature)| feature.kind.noun(2) == kind);
                    for (id, _) in meant {
                        if shown {
                            app.tree.hidden.remove(&id)
                        } else {
                            app.tree.hidden.insert(id)
                        };
                    }
                    opened.hide(&app.tree.hidden);
                }
            }
            ScriptCommand::Crater { at, radius_m } => {
                let draft = EarthworkDraft::Crater { radius_m, depth_m: None };
                let is_made = app.edit(&SceneEdit::add_earthwork(&draft, vec![at.to_array()]));
                let moved = app.session.as_ref().and_then(|session| session.moved);
                let moved = moved.map(|moved| json!({ "cut_m3": moved.cut_m3, "fill_m3": moved.fill_m3 }));
                self.done.push(json!({ "command": line, "made": is_made, "moved": moved }));
                return;
            }
            ScriptCommand::Picture(path) => {
                app.requests.push(WindowRequest::Picture(path));
                self.waits = 1;
            }
            ScriptCommand::Resize(width, height) => {
                app.requests.push(WindowRequest::Resize(width, height));
                self.waits = 10;
            }
        }
        self.awaited = Some((line, notices));
    }

    /// The report of what the script did and of the times of its frames.
    pub fn report(&self, adapter: &str) -> Value {
        let part = |part: fn(&FrameTime) -> f32| spread(self.times.iter().map(part).collect());
        let passes = self.passes.iter().map(|(label, times)| ((*label).to_owned(), spread(times.clone())));
        let passes: serde_json::Map<String, Value> = passes.collect();
        let dropped = self.times.iter().filter(|time| time.total_ms() > DROPPED_MS).count();
        json!({
            "adapter": adapter,
            "window_s": self.first_window_s,
            "first_picture_s": self.first_picture_s,
            "commands": self.done,
            "frames": self.frames,
            "over_33_ms": dropped,
            "longest_gap_ms": self.longest[1].gap_ms,
            "longest_own_ms": self.longest[1].own_ms,
            "milliseconds": {
                "frame": part(FrameTime::total_ms),
                "update": part(|time| time.update_ms),
                "upload": part(|time| time.upload_ms),
                "draw": part(|time| time.draw_ms),
                "panels": part(|time| time.panels_ms),
                "wait": part(|time| time.wait_ms),
                "device": spread(self.device.clone()),
            },
            "passes": passes,
            "calls": percentile(self.calls.clone(), 0.5),
            "drawn_triangles": percentile(self.drawn_triangles.clone(), 0.5),
            "side_share": {
                "least": percentile(self.side_shares.clone(), 0.0),
                "median": percentile(self.side_shares.clone(), 0.5),
                "last": self.side_shares.last(),
            },
            "pipelines": self.pipelines,
            "ground_triangles": self.triangles,
            "bytes_sent": self.bytes,
        })
    }
}

/// The spread of times of frames in milliseconds; null of none.
fn spread(times: Vec<f32>) -> Value {
    if times.is_empty() {
        return Value::Null;
    }
    let longest = times.iter().copied().fold(0.0, f32::max);
    json!({ "median": percentile(times.clone(), 0.5), "p99": percentile(times, 0.99), "longest": longest })
}
