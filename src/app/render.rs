//! `sandtable render`: a scene file to an annotated PNG.

use std::path::{Path, PathBuf};

use image::ImageEncoder;

use crate::annotate::paint::annotate;
use crate::annotate::report::Report;
use crate::app::arguments::{Backend, RenderOptions};
use crate::app::check::contents;
use crate::app::failure::Failure;
use crate::app::progress::Steps;
use crate::app::{files, labels, load, output};
use crate::description::suggest::{nearest, quoted};
use crate::draw::list::DrawList;
use crate::draw::pixels::Pixels;
use crate::render::{cpu, gpu, picture::Picture};
use crate::scene::kind::{Scene, View};
use crate::scene::picture::{Shot, camera, shoot};
use crate::view::camera::Camera;

/// Renders the scene and prints where the picture is, what is in it, and how long each step took.
///
/// # Errors
/// Whatever is wrong with the scene; no adapter for `--backend gpu`; the picture cannot be written.
pub fn run(options: &RenderOptions) -> Result<(), Failure> {
    let threads = options.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(Failure::input)?;
    let place = options.output.clone().unwrap_or_else(|| default_output(&options.scene));
    files::check_place(&place, &options.scene)?;
    let steps = Steps::default();
    let done = pool.scope(|_| render(options, &place, &steps))?;
    let times = steps.finish();
    let mut lines = vec![format!("{}", place.display())];
    lines.extend(contents(&done.scene));
    lines.extend(picture(&done));
    let times: Vec<String> = times.iter().map(|(step, seconds)| format!("{step} {seconds:.2} s")).collect();
    lines.push(format!("  time      {}", times.join(", ")));
    output::print(&output::text_of(&lines))?;
    for missing in &done.report.missing_glyphs {
        output::complain(&format!(
            "warning: the font lacks {} characters of '{}'",
            missing.count, missing.text
        ));
    }
    Ok(())
}

/// A rendered scene, written.
struct Done {
    scene: Scene,
    view: String,
    ground_triangles: usize,
    triangles: usize,
    report: Report,
}

fn render(options: &RenderOptions, place: &Path, steps: &Steps) -> Result<Done, Failure> {
    let scene = load::scene(&options.scene, &options.access, steps)?;
    let view = find_view(&scene, options.camera.as_deref())?.clone();
    let camera = camera(&scene, &view, (options.size.width, options.size.height)).map_err(Failure::input)?;
    let Shot { list, ground_triangles, .. } = shoot(&scene, &camera, &|step| steps.begin(step));
    steps.begin("drawing");
    let mut picture = draw(&list, &camera, options.backend)?;
    steps.begin("annotating");
    let annotations = labels::annotations(&scene, &camera, &picture);
    let report = annotate(&mut picture.pixels, &annotations);
    steps.begin("writing the picture");
    files::write_whole(place, &encode_png(&picture.pixels)?)?;
    Ok(Done { view: view.name, ground_triangles, triangles: list.triangle_count(), report, scene })
}

fn find_view<'a>(scene: &'a Scene, name: Option<&str>) -> Result<&'a View, Failure> {
    scene.view(name).ok_or_else(|| {
        let names: Vec<&str> = scene.cameras.iter().map(|view| view.name.as_str()).collect();
        let wanted = name.unwrap_or_default();
        let meant = nearest(wanted, names.iter().copied());
        let meant = meant.map(|name| format!("; did you mean '{name}'?")).unwrap_or_default();
        let (wanted, names) = (quoted(wanted), names.join(", "));
        Failure::Usage(format!("the scene has no camera '{wanted}'; it has {names}{meant}"))
    })
}

fn draw(list: &DrawList, camera: &Camera, backend: Backend) -> Result<Picture, Failure> {
    match backend {
        Backend::Cpu => cpu::render(list, camera, &cpu::Options::default()).map_err(Failure::input),
        Backend::Gpu => gpu::render(list, camera).map_err(Failure::input),
    }
}

/// The scene's name with `.png`, in the current folder.
fn default_output(scene: &Path) -> PathBuf {
    PathBuf::from(scene.file_stem().unwrap_or("scene".as_ref())).with_extension("png")
}

/// The picture as PNG without alpha.
fn encode_png(pixels: &Pixels) -> Result<Vec<u8>, Failure> {
    let rgb: Vec<u8> = pixels.data().iter().flat_map(|color| [color.0[0], color.0[1], color.0[2]]).collect();
    let mut png = Vec::new();
    image::codecs::png::PngEncoder::new(&mut png)
        .write_image(&rgb, pixels.width(), pixels.height(), image::ExtendedColorType::Rgb8)
        .map_err(Failure::input)?;
    Ok(png)
}

/// What the picture shows, and which labels it does not, in lines.
fn picture(done: &Done) -> Vec<String> {
    let ground = done.ground_triangles;
    let mut lines =
        vec![format!("  camera    {}: {} triangles, {ground} of them ground", done.view, done.triangles)];
    let left_out = [
        ("hidden", &done.report.hidden),
        ("outside the picture", &done.report.outside),
        ("without room", &done.report.crowded_out),
        ("shortened", &done.report.shortened),
    ];
    for (why, labels) in left_out.iter().filter(|(_, labels)| !labels.is_empty()) {
        let names: Vec<String> = labels.iter().map(|label| label.replace('\n', " ")).collect();
        lines.push(format!("  labels    {why}: {}", names.join(", ")));
    }
    lines
}
