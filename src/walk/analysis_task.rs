//! Analyses of the ground as it is now, tried before they are kept in the scene.

use std::sync::Arc;

use crate::Walk;
use sandtable_analysis::extent::PlacedOutcome;
use sandtable_analysis::land::Land;
use sandtable_catalog::kind::AnalysisKind;
use sandtable_catalog::parameter::{PHASE_PREFIX, ParameterForm, SOURCE_GROUND};
use sandtable_picture::tried_analysis::TriedAnalysis;
use sandtable_query::analysis::{AnalyzeError, Analyzed, OtherGrounds, WrittenArgument, analyze_among};
use sandtable_query::dataset::Dataset;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::SceneGround;
use sandtable_scene::land::land_of_drawn;
use sandtable_scene::scene_file::OpenSceneError;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::stop_flag::StopFlag;

/// The task of making an analysis on another thread. While it is kept, the next edit copies the heights.
pub struct AnalysisTask {
    scene: Arc<SceneModel>,
    elevations: Arc<Lattice>,
    kind: &'static AnalysisKind,
    name: String,
    arguments: Vec<WrittenArgument>,
}

/// What an analysis of a scene may read besides it.
pub struct AnalysisSources<'a> {
    /// The files that the scene may read.
    pub assets: &'a Assets,
    /// The ground of the scene as it is edited, in the phase of a name.
    pub ground_in_phase: &'a dyn Fn(&str) -> Result<SceneGround, OpenSceneError>,
    /// The scene as it is edited with heights true to scale; built only of one that exaggerates them, for what stands on it.
    pub true_to_scale: &'a dyn Fn() -> Result<SceneModel, OpenSceneError>,
}

impl Walk {
    /// The task of an analysis that a legend calls `name`. Two numbers of an argument are a position in the scene's system.
    pub fn analysis_task(
        &self,
        (kind, name): (&'static AnalysisKind, String),
        arguments: Vec<WrittenArgument>,
    ) -> AnalysisTask {
        let (scene, elevations) = (Arc::clone(self.scene()), Arc::clone(self.elevations()));
        AnalysisTask { scene, elevations, kind, name, arguments }
    }
}

impl AnalysisTask {
    /// Makes the analysis, with the values of `sandtable analyze` of a scene file. `progress` is called with the name of each
    /// step as it begins.
    ///
    /// # Errors
    /// See [`AnalyzeError`]; [`AnalyzeError::Argument`] of a file that the scene may not read, [`AnalyzeError::Other`] of a phase
    /// that it does not have.
    pub fn run(
        &self,
        sources: &AnalysisSources<'_>,
        stop: &StopFlag,
        progress: &dyn Fn(&'static str),
    ) -> Result<TriedAnalysis, AnalyzeError> {
        let Self { scene, kind, .. } = self;
        let arguments: Vec<WrittenArgument> = self
            .arguments
            .iter()
            .map(|argument| self.resolved(argument, sources.assets))
            .collect::<Result<_, _>>()?;
        progress("gathering the land");
        let land = land_of_drawn(scene, kind.layers, sources.true_to_scale)
            .map_err(|error| AnalyzeError::Scene(Box::new(error)))?;
        let land = Land { ground: Arc::clone(&self.elevations), ..land };
        let phase = self.phase_compared(sources, progress)?;
        let named = |_: &str| phase.as_ref();
        let others = if phase.is_some() { OtherGrounds::Named(&named) } else { OtherGrounds::Files };
        progress("analyzing");
        let dataset = Dataset::from_scene("the scene", scene);
        let Analyzed { ground, outcome, .. } =
            analyze_among((&dataset, others), land, (*kind, &arguments), &scene.crs, stop)?;
        progress("laying it over the ground");
        Ok(TriedAnalysis::new(kind, self.name.clone(), PlacedOutcome { ground, outcome }, scene))
    }

    /// The ground of the phase that an argument names; `None` where none does.
    fn phase_compared(
        &self,
        sources: &AnalysisSources<'_>,
        progress: &dyn Fn(&'static str),
    ) -> Result<Option<Dataset>, AnalyzeError> {
        let phase = self.arguments.iter().filter(|argument| self.is_ground(argument));
        let mut phase =
            phase.filter_map(|argument| Some((argument, argument.text.strip_prefix(PHASE_PREFIX)?)));
        let Some((argument, phase)) = phase.next() else { return Ok(None) };
        progress("shaping the ground of the other phase");
        let ground = (sources.ground_in_phase)(phase).map_err(|error| AnalyzeError::Other {
            name: argument.name.clone(),
            source: Box::new(error.into()),
        })?;
        Ok(Some(Dataset::from_ground(&argument.text, ground)))
    }

    /// Whether an argument names another ground.
    fn is_ground(&self, argument: &WrittenArgument) -> bool {
        self.kind.parameter(&argument.name).is_some_and(|known| known.form == ParameterForm::Ground)
    }

    /// The argument with the path of the file that it names, which scene files name from their own folder.
    fn resolved(&self, argument: &WrittenArgument, assets: &Assets) -> Result<WrittenArgument, AnalyzeError> {
        let WrittenArgument { name, text } = argument;
        let is_file = text != SOURCE_GROUND && !text.is_empty() && !text.starts_with(PHASE_PREFIX);
        if !self.is_ground(argument) || !is_file {
            return Ok(argument.clone());
        }
        let refused = |problem: String| AnalyzeError::Argument { name: name.clone(), problem };
        let path = assets.resolve(text).map_err(|error| refused(error.to_string()))?;
        let text = path.to_str().ok_or_else(|| refused("its path is not Unicode".to_owned()))?.to_owned();
        Ok(WrittenArgument { name: name.clone(), text })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::WalkOptions;
    use glam::DVec2;
    use sandtable_analysis::outcome::PostValues;
    use sandtable_draw::list::DrawList;
    use sandtable_editing::viewing::open_to_view;
    use sandtable_picture as picture;
    use sandtable_picture::tried_analysis::tried_feature;
    use sandtable_query::analysis::analyze;
    use sandtable_scene::land::land_of;
    use sandtable_scene::scene_file::open_scene_land;
    use std::path::Path;

    const SCENE: &str = concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml");

    fn walk() -> Walk {
        let editor = open_to_view(Path::new(SCENE), &[]).expect("readable");
        let scene = editor.source().build(&|_| ()).expect("sound");
        Walk::new(Arc::new(scene), WalkOptions::default())
    }

    const NO_SCALE: fn() -> Result<SceneModel, OpenSceneError> = || panic!("heights are true to scale");

    const NO_PHASE: fn(&str) -> Result<SceneGround, OpenSceneError> =
        |name| Err(OpenSceneError::NoPhase { name: name.to_owned(), names: Vec::new() });

    fn written(arguments: &[(&str, &str)]) -> Vec<WrittenArgument> {
        let one = |&(name, text): &(&str, &str)| WrittenArgument { name: name.into(), text: text.into() };
        arguments.iter().map(one).collect()
    }

    fn tried(walk: &Walk, kind: &str, arguments: &[(&str, &str)]) -> Result<TriedAnalysis, AnalyzeError> {
        let kind = sandtable_catalog::kind(kind).expect("a kind");
        let task = walk.analysis_task((kind, kind.title.to_owned()), written(arguments));
        let assets = Assets::new(Path::new(SCENE), &[]).expect("a folder");
        let sources =
            AnalysisSources { assets: &assets, ground_in_phase: &NO_PHASE, true_to_scale: &NO_SCALE };
        task.run(&sources, &StopFlag::default(), &|_| ())
    }

    fn bits(values: &PostValues) -> Vec<u32> {
        (0..values.len()).map(|index| values.value(index).to_bits()).collect()
    }

    #[test]
    fn a_tried_analysis_has_the_bits_of_the_command() {
        let walk = walk();
        let of_command = open_scene_land(Path::new(SCENE), &[], &|_| ()).expect("sound");
        let dataset = Dataset::from_scene("road", &of_command);
        let from = "749000,4017500";
        let tries: [(&str, &[(&str, &str)]); 5] = [
            ("slope", &[]),
            ("obstacles", &[("vehicle", "wheeled")]),
            ("time", &[("from", from), ("extent", "748500,4017000,750500,4018500")]),
            ("flow", &[]),
            ("slope", &[("unit", "degrees"), ("extent", "16S GF 49000 17500; 16S GF 50000 18500")]),
        ];
        for (name, arguments) in tries {
            let kind = sandtable_catalog::kind(name).expect("a kind");
            let land = land_of(&of_command, kind.layers);
            let wanted =
                analyze(&dataset, land, (kind, &written(arguments)), &of_command.crs, &StopFlag::default())
                    .expect(name);
            let found = tried(&walk, name, arguments).expect(name);
            let found = found.analysis();
            assert_eq!(found.ground.map_extent(), wanted.ground.map_extent(), "{name}");
            assert_eq!(found.outcome.figures, wanted.outcome.figures, "{name}");
            let values = |outcome: &sandtable_analysis::outcome::Outcome| {
                bits(&outcome.raster.as_ref().expect("a raster").values)
            };
            assert_eq!(values(&found.outcome), values(&wanted.outcome), "{name}");
        }
    }

    #[test]
    fn on_an_exaggerated_scene_a_tried_analysis_has_the_bits_of_the_command() {
        let folder = std::env::temp_dir().join(format!("sandtable-exaggerated-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let path = folder.join("scene.toml");
        let dem = concat!(env!("SANDTABLE_ROOT"), "assets/jacksboro/valley.asc");
        let dem = serde_json::Value::from(dem);
        let text = format!(
            "[terrain]\ndem = {dem}\ncrs = \"EPSG:32616\"\nvertical_exaggeration = 2.7\n\
             [[building]]\npoints = [[751200, 4020800], [751500, 4020800], [751500, 4021000], [751200, 4021000]]\n\
             height = 11.3\n"
        );
        std::fs::write(&path, &text).expect("written");
        let allowed = [Path::new(env!("SANDTABLE_ROOT")).join("assets")];
        let source = sandtable_editing::editor::SceneSource {
            path: path.clone(),
            allowed: allowed.to_vec(),
            phase: None,
            text,
        };
        let of_command = open_scene_land(&path, &allowed, &|_| ()).expect("sound");
        let kind = sandtable_catalog::kind("viewsheds").expect("a kind");
        let arguments = written(&[("posts", "751800,4020500"), ("range", "4000")]);
        let dataset = Dataset::from_scene("scene", &of_command);
        let land = land_of(&of_command, kind.layers);
        assert!(land.obstacles_m.iter().flatten().any(|height_m| *height_m > 3.0), "a building stands there");
        let stop = StopFlag::default();
        let wanted = analyze(&dataset, land, (kind, &arguments), &of_command.crs, &stop).expect("an outcome");
        let walk = Walk::new(Arc::new(source.build(&|_| ()).expect("sound")), WalkOptions::default());
        let assets = Assets::new(&path, &allowed).expect("a folder");
        let true_to_scale = || source.build_land();
        let sources =
            AnalysisSources { assets: &assets, ground_in_phase: &NO_PHASE, true_to_scale: &true_to_scale };
        let task = walk.analysis_task((kind, "seen".to_owned()), arguments.clone());
        let tried = task.run(&sources, &stop, &|_| ()).expect("an outcome");
        let found = tried.analysis();
        assert_eq!(found.outcome.figures, wanted.outcome.figures);
        let values = |outcome: &sandtable_analysis::outcome::Outcome| {
            bits(&outcome.raster.as_ref().expect("a raster").values)
        };
        assert_eq!(values(&found.outcome), values(&wanted.outcome));
        let heights =
            |ground: &Lattice| ground.heights().iter().map(|height| height.to_bits()).collect::<Vec<_>>();
        assert!(heights(&found.ground) == heights(&wanted.ground), "the ground itself is the same");
        std::fs::remove_dir_all(&folder).expect("removed");
    }

    #[test]
    fn a_ground_that_the_scene_may_not_read_is_refused_by_its_key() {
        let kind = sandtable_catalog::kinds()
            .find_map(|kind| {
                let of_ground = |known: &&sandtable_catalog::parameter::AnalysisParameter| {
                    known.form == ParameterForm::Ground
                };
                Some((kind.name, kind.parameters.iter().find(of_ground)?.name))
            })
            .expect("a kind that compares grounds");
        let refused = tried(&walk(), kind.0, &[(kind.1, "../../../etc/passwd")]).err().expect("refused");
        assert!(refused.to_string().starts_with(&format!("`{}`: ", kind.1)), "{refused}");
    }

    /// A pit of 3 m in the phase `dug` of level ground, and none in `before`.
    const PIT: &str = "[terrain]\ndem = \"plane.asc\"\ncrs = \"EPSG:32633\"\n[[phase]]\nname = \"before\"\n\
        [[phase]]\nname = \"dug\"\n[[earthwork]]\nkind = \"level\"\nphases = [\"dug\"]\nlevel = 97\n\
        points = [[105, 105], [195, 105], [195, 195], [105, 195]]\n";

    #[test]
    fn the_phase_shown_is_compared_with_another_of_the_text_as_it_is_edited() {
        let folder = std::env::temp_dir().join(format!("sandtable-phase-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let grid = "ncols 31\nnrows 31\nxllcorner -5\nyllcorner -5\ncellsize 10\n";
        let plane = format!("{grid}{}", vec!["100"; 31 * 31].join(" "));
        std::fs::write(folder.join("plane.asc"), plane).expect("written");
        // The file has no pit: the text that is edited has.
        let path = folder.join("scene.toml");
        std::fs::write(&path, "[terrain]\ndem = \"plane.asc\"\n").expect("written");
        let source = |phase: &str| sandtable_editing::editor::SceneSource {
            path: path.clone(),
            allowed: Vec::new(),
            phase: Some(phase.to_owned()),
            text: PIT.to_owned(),
        };
        let net_m3 = |shown: &str, other: &str| {
            let source = source(shown);
            let scene = source.build(&|_| ()).expect("sound");
            let walk = Walk::new(Arc::new(scene), WalkOptions::default());
            let kind = sandtable_catalog::kind("cut-fill").expect("a kind");
            let arguments = written(&[("against", other)]);
            let task = walk.analysis_task((kind, "pit".to_owned()), arguments);
            let assets = Assets::new(&path, &[]).expect("a folder");
            let ground_in_phase = |name: &str| source.ground_in_phase(name);
            let sources = AnalysisSources {
                assets: &assets,
                ground_in_phase: &ground_in_phase,
                true_to_scale: &NO_SCALE,
            };
            let tried = task.run(&sources, &StopFlag::default(), &|_| ())?;
            let figures = &tried.analysis().outcome.figures;
            Ok::<_, AnalyzeError>(figures.iter().find(|figure| figure.name == "cut").map(|cut| cut.value))
        };
        let dug = net_m3("dug", "phase:before").expect("an outcome").expect("a figure");
        assert_eq!(dug, 36_300.0, "11 by 11 posts of 100 m² lie 3 m lower");
        assert_eq!(
            net_m3("before", "phase:dug").expect("an outcome"),
            Some(0.0),
            "the other way it is filled"
        );
        assert_eq!(net_m3("dug", "phase:dug").expect("an outcome"), Some(0.0));
        let missing = net_m3("dug", "phase:dusk").expect_err("no such phase");
        assert_eq!(missing.key(), Some("against"), "{missing}");
        std::fs::remove_dir_all(&folder).expect("removed");
    }

    #[test]
    fn a_tried_analysis_is_drawn_with_a_list_of_its_materials_and_taken_away() {
        let mut walk = walk();
        let scene = Arc::clone(walk.scene());
        let camera = picture::camera(&scene, &scene.cameras[0], (640, 400)).expect("sound");
        let at = DVec2::new(749_000.0, 4_017_500.0);
        let from = format!("{},{}", at.x, at.y);
        let arguments = [("from", from.as_str())];
        walk.lay_analysis(tried(&walk, "time", &arguments).expect("an outcome"));
        let feature = tried_feature(&scene);
        let drawn = |walk: &mut Walk| {
            let mut colors = std::collections::BTreeSet::new();
            for _ in 0..200 {
                let frame = walk.update(&camera).expect("in memory");
                let pieces = frame.changes.drapes.into_iter().flat_map(|patch| patch.pieces);
                colors.extend(pieces.filter(|piece| piece.feature == feature).map(|piece| piece.material.0));
                if frame.statistics.waiting_patches == 0 {
                    break;
                }
            }
            colors
        };
        assert!(drawn(&mut walk).is_empty(), "not before a list has its materials");
        let task = walk.standing_task(walk.to_sun());
        let list: DrawList = task.list(&camera, &|_| ());
        walk.take_standing(&task, &list);
        let materials = drawn(&mut walk);
        assert!(materials.len() > 1, "a tint and lines: {materials:?}");
        assert!(materials.iter().all(|&number| (number as usize) < list.materials.len()));
        let is_tint = |&number: &u32| list.materials[number as usize].texture.is_some();
        assert!(materials.iter().any(is_tint));
        walk.check();
        walk.clear_analysis();
        walk.forget_handed();
        assert!(drawn(&mut walk).is_empty(), "taken away");
        walk.check();
    }
}
