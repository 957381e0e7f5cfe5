//! Analyses in the window: one that is prepared, made beside the window, shown over the ground, and kept or discarded.
//!
//! ```text
//!  fields ─► arguments, checked ─► a thread, which can be stopped ─► tint, lines and legend ─► kept: [[analysis]], built anew
//!     ▲            │ wrong                  │ wrong                           └────────────► discarded
//!     └────────────┴────── by its key ──────┘
//! ```

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use egui::{CollapsingHeader, RichText, Ui};
use serde_json::{Value, json};

use crate::active_tool::ActiveTool;
use crate::analysis_listing::AnalysisListing;
use crate::app::ViewerApp;
use crate::loading::opening_error;
use crate::panels::analyses::{AnalysesEvent, AnalysesPanel, analyses_panel};
use crate::panels::analysis_form::{AnalysisForm, AnalysisFormEvent, RunningAnalysis, analysis_form};
use crate::place_picking::PlacePicking;
use crate::worker::WorkerJob;
use sandtable_analysis::error::AnalysisError;
use sandtable_analysis::movement::vehicle::BUILT_IN_NAMES;
use sandtable_catalog::kind;
use sandtable_draw::list::FeatureId;
use sandtable_editing::analysis_draft::AnalysisDraft;
use sandtable_picture::tried_analysis::TriedAnalysis;
use sandtable_query::analysis::AnalyzeError;
use sandtable_scene::assets::Assets;
use sandtable_terrain::stop_flag::StopFlag;
use sandtable_walk::analysis_task::AnalysisSources;

/// How often the time that an analysis has taken is shown anew.
const PROGRESS_EVERY: Duration = Duration::from_millis(250);

/// The analysis that is prepared, the one that is being made, and the one that is shown.
#[derive(Default)]
pub struct Analyzing {
    /// What the form holds.
    pub draft: Option<AnalysisDraft>,
    /// The one that is shown and not in the scene.
    pub tried: Option<ShownAnalysis>,
    /// What is wrong beside the fields; empty for nothing.
    problem: String,
    making: Option<MadeAnalysis>,
}

/// An analysis that is shown and not in the scene.
pub struct ShownAnalysis {
    /// What it was made of.
    draft: AnalysisDraft,
    /// What the panel shows of it.
    pub listing: AnalysisListing,
    /// Whether the ground has changed since.
    is_outdated: bool,
    /// Whether the scene is being built with it.
    is_kept: bool,
}

/// An analysis that is being made.
struct MadeAnalysis {
    draft: AnalysisDraft,
    job: WorkerJob<Result<(TriedAnalysis, AnalysisListing), AnalyzeError>>,
    stop: Arc<StopFlag>,
    step: Arc<Mutex<&'static str>>,
    since: Instant,
}

impl Drop for MadeAnalysis {
    fn drop(&mut self) {
        // Nobody needs it any more.
        self.stop.stop();
    }
}

impl Analyzing {
    /// Whether an analysis is being made.
    pub fn is_busy(&self) -> bool {
        self.making.is_some()
    }

    /// The ground has changed under the one that is shown.
    pub fn outdate(&mut self) {
        self.tried.iter_mut().for_each(|tried| tried.is_outdated = true);
    }

    /// The name of the one that is shown and not in the scene.
    pub fn tried_name(&self) -> Option<&str> {
        self.tried.as_ref().map(|tried| tried.listing.name.as_str())
    }

    /// The outcome of the last run, for reports: figures, features, tables, or what is wrong.
    pub fn report(&self) -> Value {
        let problems = self.draft.iter().flat_map(|draft| &draft.fields);
        let problems: Vec<&String> = problems.filter_map(|field| field.problem.as_ref()).collect();
        let Some(ShownAnalysis { listing, .. }) = &self.tried else {
            return json!({ "problem": self.problem, "fields": problems });
        };
        let figures = listing.figures.iter().map(|figure| (figure.name.clone(), figure.value.into()));
        json!({
            "kind": listing.kind.name,
            "figures": figures.collect::<serde_json::Map<String, Value>>(),
            "classes": listing.classes.iter().map(|class| class.label.as_str()).collect::<Vec<_>>(),
            "features": listing.features,
            "tables": listing.tables.len(),
        })
    }
}

impl ViewerApp {
    /// Makes the analysis that the form holds, instead of the one that is shown; says at its fields what is wrong.
    pub(super) fn run_analysis(&mut self) {
        self.analyzing.problem.clear();
        let Some((opened, draft)) = self.opened.as_ref().zip(self.analyzing.draft.as_mut()) else { return };
        if draft.check(&opened.scene.crs) {
            let draft = draft.clone();
            self.discard_analysis();
            self.make_analysis(draft);
        }
    }

    /// Prepares and makes an analysis of a kind with arguments by their names, as a script says.
    pub(super) fn analyze_by_name(&mut self, name: &str, arguments: &[(String, String)]) {
        let Some(kind) = kind(name) else {
            return self.warn(format!("there is no analysis '{name}'"));
        };
        let mut draft = AnalysisDraft::new(kind);
        for (name, text) in arguments {
            match draft.field_mut(name) {
                Some(field) => field.set(text.clone()),
                None if name == "name" => draft.name.clone_from(text),
                None => return self.warn(format!("the analysis {} has no parameter '{name}'", kind.name)),
            }
        }
        self.analyzing.draft = Some(draft);
        self.run_analysis();
    }

    fn make_analysis(&mut self, draft: AnalysisDraft) {
        if let Some(refusal) = self.refusal() {
            self.analyzing.problem = refusal;
            return;
        }
        let Some((opened, session)) = self.opened.as_ref().zip(self.session.as_ref()) else { return };
        let source = session.editor.source().clone();
        let assets = match Assets::new(&source.path, &source.allowed) {
            Ok(assets) => assets,
            Err(error) => {
                self.analyzing.problem = opening_error(&error);
                return;
            }
        };
        let task = opened.walk.analysis_task((draft.kind, draft.title()), draft.arguments());
        let stop = Arc::new(StopFlag::default());
        let step = Arc::new(Mutex::new("starting"));
        let (stopped, said) = (Arc::clone(&stop), Arc::clone(&step));
        let work = move || {
            let progress = |step| *said.lock().unwrap_or_else(PoisonError::into_inner) = step;
            let ground_in_phase = |phase: &str| source.ground_in_phase(phase);
            let true_to_scale = || source.build_land();
            let sources = AnalysisSources {
                assets: &assets,
                ground_in_phase: &ground_in_phase,
                true_to_scale: &true_to_scale,
            };
            let tried = task.run(&sources, &stopped, &progress)?;
            let listing = AnalysisListing::new(tried.analysis());
            Ok((tried, listing))
        };
        let job = WorkerJob::start(&self.context, work);
        self.analyzing.making = Some(MadeAnalysis { draft, job, stop, step, since: Instant::now() });
    }

    /// Shows what was made meanwhile.
    pub(super) fn follow_analysis(&mut self) {
        let Some(making) = &self.analyzing.making else { return };
        let Some(done) = making.job.poll() else {
            return self.context.request_repaint_after(PROGRESS_EVERY);
        };
        let draft = making.draft.clone();
        self.analyzing.making = None;
        match (done, &mut self.opened) {
            (Ok(Ok((tried, listing))), Some(opened)) => {
                opened.walk.lay_analysis(tried);
                opened.relist();
                let shown = ShownAnalysis { draft, listing, is_outdated: false, is_kept: false };
                self.analyzing.tried = Some(shown);
            }
            (Ok(Err(AnalyzeError::Analysis(AnalysisError::Stopped))), _) => {
                self.analyzing.problem = "The analysis was stopped.".to_owned();
            }
            (Ok(Err(error)), _) => self.note_analysis_error(&draft, &error),
            (Err(failure), _) => self.analyzing.problem = format!("The analysis failed: {failure}"),
            (Ok(Ok(_)), None) => {}
        }
        self.context.request_repaint();
    }

    /// Shows an error at the field that it is about, where the form still holds that analysis.
    fn note_analysis_error(&mut self, of: &AnalysisDraft, error: &AnalyzeError) {
        let same = self.analyzing.draft.as_mut().filter(|draft| draft.kind.name == of.kind.name);
        let is_noted = same.is_some_and(|draft| draft.note(error));
        if !is_noted {
            self.analyzing.problem = opening_error(error);
        }
    }

    /// Ends making an analysis.
    pub(super) fn stop_analysis(&mut self) {
        if let Some(making) = &self.analyzing.making {
            making.stop.stop();
        }
    }

    /// Takes the analysis away that is shown and not in the scene.
    pub(super) fn discard_analysis(&mut self) {
        self.analyzing.making = None;
        if let (Some(tried), Some(opened)) = (self.analyzing.tried.take(), &mut self.opened) {
            self.tree.hidden.remove(&tried.listing.feature);
            opened.hidden.remove(&tried.listing.feature);
            opened.walk.clear_analysis();
        }
        self.context.request_repaint();
    }

    /// Writes the analysis that is shown into the scene file's text, and builds the scene with it.
    pub(super) fn keep_analysis(&mut self) {
        let Some((opened, tried)) = self.opened.as_ref().zip(self.analyzing.tried.as_ref()) else {
            return self.warn("there is no analysis to keep");
        };
        let feature = tried.listing.feature;
        match tried.draft.edit(&opened.scene.crs) {
            Ok(edit) if self.edit(&edit) => {
                self.analyzing.tried.iter_mut().for_each(|tried| tried.is_kept = true);
                self.tree.hidden.remove(&feature);
            }
            Ok(_) => {}
            Err(error) => self.notices.warn(opening_error(&error)),
        }
    }

    /// Follows a scene that was built anew: what was kept is its own now, what was not is made on its ground.
    pub(super) fn renew_analysis(&mut self) {
        let making = self.analyzing.making.take().map(|making| making.draft.clone());
        let tried = self.analyzing.tried.take().filter(|tried| !tried.is_kept);
        if let Some(draft) = making.or(tried.map(|tried| tried.draft)) {
            self.make_analysis(draft);
        }
    }

    /// Draws the section of analyses.
    pub(super) fn show_analyses(&mut self, ui: &mut Ui) {
        let header = CollapsingHeader::new(RichText::new("Analyses").strong()).id_salt("Analyses");
        let opens = self.opened.as_ref().is_some_and(|opened| !opened.analyses.is_empty());
        header.default_open(opens).show(ui, |ui| {
            self.show_listed(ui);
            ui.separator();
            ui.strong("New analysis");
            match self.refusal() {
                Some(refusal) => {
                    ui.label(refusal);
                }
                None => self.show_form(ui),
            }
        });
    }

    fn show_listed(&mut self, ui: &mut Ui) {
        let Some(opened) = &self.opened else { return };
        let tried = self.analyzing.tried.as_ref().filter(|tried| !tried.is_kept);
        let panel = AnalysesPanel {
            scene: &opened.analyses,
            tried: tried.map(|tried| &tried.listing),
            is_outdated: tried.is_some_and(|tried| tried.is_outdated),
            hidden: &self.tree.hidden,
        };
        match analyses_panel(ui, &panel) {
            Some(AnalysesEvent::Visibility(feature)) => self.turn_feature(feature),
            Some(AnalysesEvent::Keep) => self.keep_analysis(),
            Some(AnalysesEvent::Discard) => self.discard_analysis(),
            None => {}
        }
    }

    /// Hides a feature that is shown, or shows it.
    fn turn_feature(&mut self, feature: FeatureId) {
        if !self.tree.hidden.remove(&feature) {
            self.tree.hidden.insert(feature);
        }
        if let Some(opened) = &mut self.opened {
            opened.hide(&self.tree.hidden);
        }
    }

    fn show_form(&mut self, ui: &mut Ui) {
        let Some(opened) = &self.opened else { return };
        let own = opened.scene.vehicles.iter().map(|vehicle| vehicle.name.clone());
        let built_in = BUILT_IN_NAMES.into_iter().map(str::to_owned);
        let mut vehicles: Vec<String> = own.collect();
        let built_in = built_in.filter(|name| !vehicles.contains(name)).collect::<Vec<_>>();
        vehicles.extend(built_in);
        let running = self.analyzing.making.as_ref().map(|making| {
            let step = *making.step.lock().unwrap_or_else(PoisonError::into_inner);
            let share = making.stop.share().filter(|&share| share < 1.0);
            RunningAnalysis { step, seconds: making.since.elapsed().as_secs(), share }
        });
        let picking = match &self.tool {
            Some(ActiveTool::Pick(picking)) => Some(picking.parameter),
            _ => None,
        };
        let phases = self.session.iter().flat_map(|session| &session.editor.document().phases);
        let phases: Vec<String> = phases.map(|phase| phase.name.to_string()).collect();
        let mut form = AnalysisForm {
            draft: self.analyzing.draft.as_mut(),
            vehicles: &vehicles,
            phases: &phases,
            problem: &self.analyzing.problem,
            running,
            picking,
        };
        match analysis_form(ui, &mut form) {
            Some(AnalysisFormEvent::Kind(kind)) => {
                self.analyzing.draft = Some(AnalysisDraft::new(kind));
                self.analyzing.problem.clear();
                if picking.is_some() {
                    self.take_tool(None);
                }
            }
            Some(AnalysisFormEvent::Run) => self.run_analysis(),
            Some(AnalysisFormEvent::Stop) => self.stop_analysis(),
            Some(AnalysisFormEvent::Pick(parameter)) => {
                self.take_tool(Some(ActiveTool::Pick(PlacePicking::new(parameter))));
            }
            Some(AnalysisFormEvent::Away) => self.take_tool(None),
            None => {}
        }
    }

    /// Writes the positions that were picked into their field.
    pub(super) fn note_picked(&mut self) {
        let Some(ActiveTool::Pick(picking)) = &self.tool else { return };
        let field = self.analyzing.draft.as_mut().and_then(|draft| draft.field_mut(picking.parameter));
        field.into_iter().for_each(|field| field.set_points(&picking.points));
    }
}
