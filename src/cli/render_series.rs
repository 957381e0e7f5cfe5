//! The pictures of `sandtable render`: of one camera or all, in one phase or all, in files or on a sheet.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::error::CliError;
use crate::picture_maker::{ComposedPicture, MadePicture, PictureMaker};
use crate::progress::StepTimer;
use crate::render::{RenderArguments, find_camera, named_by_option};
use sandtable_annotate::contact_sheet::{ContactPicture, ContactSheet};
use sandtable_annotate::report::AnnotationReport;
use sandtable_base::message::suggest::quoted;
use sandtable_draw::list::DrawList;
use sandtable_draw::pixels::Pixels;
use sandtable_files::disk;
use sandtable_files::fingerprint::fingerprint;
use sandtable_files::output_files::OutputFiles;
use sandtable_files::png::encode_png;
use sandtable_render::RenderBackend;
use sandtable_scene::planned_pictures::{ElevationNeed, PlannedCameras, PlannedPictures};
use sandtable_scene::scene_file::{open_scene_for, phases};
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::SceneView;
use sandtable_sheet::in_order::PicturesInOrder;
use sandtable_sheet::picture::{ComposedView, PictureSize, near_ground};
use sandtable_sheet::picture_buffers::PictureBuffers;
use sandtable_sheet::picture_statistics::PictureStatistics;
use sandtable_sheet::sheet_file::{picture_description, write_sheet};

/// A scene in one phase, and the pictures of it.
pub struct RenderedScene {
    pub scene: SceneModel,
    pub pictures: Vec<RenderedPicture>,
}

/// A picture, and what it shows.
pub struct RenderedPicture {
    pub output: PictureOutput,
    pub camera: String,
    /// Triangles drawn of the ground and of each kind of feature.
    pub triangles: BTreeMap<&'static str, usize>,
    pub ground_triangles: usize,
    pub annotations: AnnotationReport,
    /// Measured where JSON is printed.
    pub statistics: Option<PictureStatistics>,
}

/// Where a picture went.
pub enum PictureOutput {
    File(PathBuf),
    /// To a sheet: its pixels, which are few.
    Sheet(Pixels),
}

impl RenderedPicture {
    /// The file that it was written to.
    pub fn path(&self) -> Option<&Path> {
        match &self.output {
            PictureOutput::File(path) => Some(path),
            PictureOutput::Sheet(_) => None,
        }
    }
}

/// The pictures of a scene file.
pub struct RenderedFile {
    pub scenes: Vec<RenderedScene>,
    /// The pictures that could not be drawn, while others could.
    pub failures: Vec<RenderFailure>,
}

/// A scene, phase or camera that could not be rendered.
pub struct RenderFailure {
    pub name: String,
    pub error: CliError,
}

/// Renders the pictures of a scene file that the arguments select, and writes them when all are rendered. A phase or
/// camera that cannot be drawn is left out where there are others, but not of a sheet.
pub fn render(
    arguments: &RenderArguments,
    backend: RenderBackend,
    file: &Path,
    path: &Path,
    steps: &StepTimer,
) -> Result<RenderedFile, CliError> {
    let check = if arguments.sheet { disk::check_picture_output } else { disk::check_sheet_output };
    check(path, &[file]).map_err(|error| named_by_option(error, "this is the scene file itself"))?;
    let mut series = RenderSeries {
        arguments,
        backend,
        file,
        steps,
        outputs: OutputFiles::default(),
        failures: Vec::new(),
    };
    let scenes = series.scenes(path)?;
    if arguments.sheet {
        steps.begin("writing the sheet");
        series.outputs.write(path, &encode_png(&contact_sheet(arguments, &scenes)?))?;
    }
    series.outputs.publish()?;
    Ok(RenderedFile { scenes, failures: series.failures })
}

/// The pictures of a scene file while they are made.
struct RenderSeries<'a> {
    arguments: &'a RenderArguments,
    backend: RenderBackend,
    /// The scene file.
    file: &'a Path,
    steps: &'a StepTimer,
    outputs: OutputFiles,
    failures: Vec<RenderFailure>,
}

/// Which of the scenes of a file it is, one in each phase.
#[derive(Clone, Copy)]
struct SceneNumber {
    index: usize,
    count: usize,
}

impl SceneNumber {
    /// Its share of the file's pictures.
    fn share(self) -> Range<f64> {
        let at = |index: usize| index as f64 / self.count as f64;
        at(self.index)..at(self.index + 1)
    }
}

impl RenderSeries<'_> {
    /// The scene in each phase that the arguments ask for, rendered.
    fn scenes(&mut self, path: &Path) -> Result<Vec<RenderedScene>, CliError> {
        let (arguments, file, steps) = (self.arguments, self.file, self.steps);
        let progress = |step| steps.begin(step);
        let allowed = &arguments.access.allow;
        let pictures = planned_pictures(arguments);
        let need = ElevationNeed::Pictures(&pictures);
        if !arguments.all_phases {
            let scene = open_scene_for(file, allowed, arguments.phase.as_deref(), need, &progress)?;
            return Ok(vec![self.scene(scene, path, SceneNumber { index: 0, count: 1 })?]);
        }
        let names = phases(file, allowed)?;
        if names.is_empty() {
            let message = "--all-phases has no effect: the scene has no [[phase]]; remove it";
            return Err(CliError::Usage(message.into()));
        }
        let mut scenes = Vec::new();
        for (index, (phase, path)) in names.iter().zip(named_paths(path, &names)).enumerate() {
            let scene = open_scene_for(file, allowed, Some(phase), need, &progress);
            match scene {
                Ok(scene) => {
                    let number = SceneNumber { index, count: names.len() };
                    scenes.push(self.scene(scene, &path, number)?);
                }
                Err(error) => self.leave_out("phase", phase, error.into(), names.len())?,
            }
        }
        Ok(scenes)
    }

    /// Notes what cannot be rendered; an error where nothing else can be.
    fn leave_out(&mut self, what: &str, name: &str, error: CliError, all: usize) -> Result<(), CliError> {
        if all == 1 || self.arguments.sheet {
            return Err(error);
        }
        let name = format!("{what} {} of {}", quoted(name), self.file.display());
        self.failures.push(RenderFailure { name, error });
        Ok(())
    }

    /// Renders one of the scenes of the file.
    fn scene(
        &mut self,
        scene: SceneModel,
        path: &Path,
        number: SceneNumber,
    ) -> Result<RenderedScene, CliError> {
        let arguments = self.arguments;
        let views: Vec<&SceneView> = match arguments.shows_all_cameras() {
            true => scene.cameras.iter().collect(),
            false => vec![find_camera(&scene, arguments.camera.as_deref())?],
        };
        let small =
            if arguments.sheet { Some(sheet_of(arguments, views.len() * number.count)?) } else { None };
        let small = small.map(|sheet| sheet.picture_size());
        let names: Vec<String> = views.iter().map(|view| view.name.clone()).collect();
        let paths = if arguments.all_cameras {
            named_paths(path, &names)
        } else {
            vec![path.to_owned(); views.len()]
        };
        for path in &paths {
            let sidecar = arguments.sidecar.then(|| sidecar_path(path));
            for output in std::iter::once(path).chain(&sidecar) {
                disk::check_output(output, &scene.files)
                    .map_err(|error| named_by_option(error, "the scene is made of this file"))?;
            }
        }
        let fingerprint = match arguments.sidecar {
            true => Some(fingerprint(self.file, &scene.files)?),
            false => None,
        };
        let mut pictures = Vec::new();
        let (steps, series) = (self.steps, self.steps.series().map(|series| Arc::clone(&series.flag)));
        let series = series.unwrap_or_default();
        series.stretch(number.share(), views.len());
        let (backend, file, fingerprint) = (self.backend, self.file, fingerprint.as_deref());
        let maker = PictureMaker { arguments, backend, scene: &scene, file, fingerprint, steps };
        let making = PicturesInOrder {
            count: views.len(),
            make: &|index, progress| maker.made((index, views[index]), small, progress),
            bytes: &|made| made.as_ref().map_or(u64::MAX, MadePicture::bytes),
            progress: &|step| steps.begin(step),
        };
        making.each(|index, made| {
            let (view, path) = (views[index], paths[index].clone());
            match made {
                Ok(made) => pictures.push(self.picture(&maker, view, made, (path, small.is_some()))?),
                Err(error) => self.leave_out("camera", &view.name, error.into(), views.len())?,
            }
            series.did(1);
            Ok::<_, CliError>(())
        })?;
        Ok(RenderedScene { scene, pictures })
    }

    /// Writes a picture to its file, with a sidecar where the scene has a fingerprint, or keeps it for a sheet.
    fn picture(
        &mut self,
        maker: &PictureMaker<'_>,
        camera: &SceneView,
        made: MadePicture,
        (path, is_small): (PathBuf, bool),
    ) -> Result<RenderedPicture, CliError> {
        let (arguments, steps, outputs) = (self.arguments, self.steps, &mut self.outputs);
        let progress = |step| steps.begin(step);
        let scene = maker.scene;
        let composed = match made {
            MadePicture::Composed(composed) => composed,
            MadePicture::Drawn(drawn) => {
                if let Some(folder) = &arguments.buffers {
                    progress("writing buffers");
                    // The buffers of several pictures lie in folders named as the pictures are.
                    let is_one =
                        !arguments.all_cameras && !arguments.all_phases && arguments.scenes.len() == 1;
                    let folder = if is_one { folder.clone() } else { folder.join(disk::file_stem(&path)) };
                    disk::make_folder(&folder)?;
                    let buffers = PictureBuffers { scene, camera: &drawn.camera, rendering: &drawn.picture };
                    buffers.write(outputs, &folder)?;
                }
                maker.composed(camera, *drawn, &progress)
            }
        };
        let ComposedPicture { view, draft, statistics } = *composed;
        let ComposedView { sheet, drawn, annotations } = view;
        let (triangles, ground_triangles) = (triangles(scene, &drawn.list), drawn.ground_triangles);
        let output = if is_small {
            PictureOutput::Sheet(sheet.painted())
        } else {
            progress("writing the picture");
            let description = picture_description(scene, camera);
            let texts = (scene.title.as_deref(), description.as_str());
            // What was drawn is given back while the picture is packed.
            let (written, ()) =
                rayon::join(|| write_sheet(outputs, &path, sheet, camera.dpi(), texts), || drop(drawn));
            written?;
            if let Some(draft) = draft {
                let text = format!("{:#}\n", draft.finished(&annotations));
                outputs.write(&sidecar_path(&path), text.as_bytes())?;
            }
            PictureOutput::File(path)
        };
        let camera = camera.name.clone();
        Ok(RenderedPicture { output, camera, triangles, ground_triangles, annotations, statistics })
    }
}

/// The pictures of a scene, as far as that is known before it is opened.
fn planned_pictures(arguments: &RenderArguments) -> PlannedPictures {
    let cameras = match &arguments.camera {
        _ if arguments.shows_all_cameras() => PlannedCameras::All,
        Some(name) => PlannedCameras::Named(name.clone()),
        None => PlannedCameras::First,
    };
    let near = near_ground(arguments.backend);
    PlannedPictures { cameras, size: arguments.size.map(|size| (size.width, size.height)), near }
}

/// The size of a contact sheet where none is stated.
const SHEET: PictureSize = PictureSize { width: 1920, height: 1080 };

fn sheet_of(arguments: &RenderArguments, pictures: usize) -> Result<ContactSheet, CliError> {
    let PictureSize { width, height } = arguments.size.unwrap_or(SHEET);
    let sheet = u32::try_from(pictures).ok().and_then(|pictures| ContactSheet::new(width, height, pictures));
    sheet.ok_or_else(|| {
        CliError::Usage(format!(
            "{pictures} pictures have no room on a sheet of {width}x{height}; state a larger --size"
        ))
    })
}

/// The pictures of all scenes on one sheet.
fn contact_sheet(arguments: &RenderArguments, scenes: &[RenderedScene]) -> Result<Pixels, CliError> {
    let caption = |scene: &SceneModel, picture: &RenderedPicture| {
        let phase = scene.phase.as_ref().filter(|_| arguments.all_phases);
        match (phase, arguments.shows_all_cameras()) {
            (Some(phase), true) => format!("{phase}: {}", picture.camera),
            (Some(phase), false) => phase.clone(),
            (None, _) => picture.camera.clone(),
        }
    };
    let all = scenes.iter().flat_map(|scene| scene.pictures.iter().map(|picture| (&scene.scene, picture)));
    let pictures: Vec<ContactPicture> = all
        .filter_map(|(scene, picture)| match &picture.output {
            PictureOutput::Sheet(pixels) => Some(ContactPicture { caption: caption(scene, picture), pixels }),
            PictureOutput::File(_) => None,
        })
        .collect();
    let first = scenes.first().map(|scene| &scene.scene);
    let title = first.and_then(|scene| scene.title.as_deref());
    let font = first.and_then(|scene| scene.font.as_ref());
    Ok(sheet_of(arguments, pictures.len())?.compose(title, &pictures, font))
}

/// The sidecar of a picture: its name with `.json` in place of the extension.
fn sidecar_path(path: &Path) -> PathBuf {
    path.with_extension("json")
}

/// A path for each of `names`: `path` with the name behind its own. Characters that are trouble in file names become
/// hyphens; what then has the name of an earlier one gets its number.
fn named_paths(path: &Path, names: &[String]) -> Vec<PathBuf> {
    let is_plain = |letter: char| letter.is_alphanumeric() || ['_', '.'].contains(&letter);
    let plain = |name: &String| name.replace(|letter| !is_plain(letter), "-");
    let mut taken = BTreeSet::new();
    let named = |(number, name): (usize, &String)| {
        let mut name = plain(name);
        if !taken.insert(name.clone()) {
            name = format!("{name}-{number}");
            taken.insert(name.clone());
        }
        let stem = disk::file_stem(path);
        let extension = path.extension().unwrap_or("png".as_ref()).to_string_lossy();
        path.with_file_name(format!("{stem}-{name}.{extension}"))
    };
    (1..).zip(names).map(named).collect()
}

/// The number of triangles drawn of the ground and of each kind of feature.
fn triangles(scene: &SceneModel, list: &DrawList) -> BTreeMap<&'static str, usize> {
    let mut counts = BTreeMap::new();
    for item in &list.items {
        let feature = item.feature.index().and_then(|index| scene.features.get(index));
        *counts.entry(feature.map_or("ground", |feature| feature.kind.noun(2))).or_default() +=
            item.triangles.len();
    }
    counts
}
