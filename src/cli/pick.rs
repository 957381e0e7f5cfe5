//! `sandtable pick`: what a picture shows at a pixel, and where that is.

use clap::Args;
use serde_json::{Value, json};

use crate::error::CliError;
use crate::options::SceneArguments;
use crate::output::{print, print_lines, row};
use crate::positions::{PositionPrinter, PositionsArguments};
use crate::progress::StepTimer;
use crate::render::find_camera;
use crate::values::{picture_size, pixel};
use sandtable_base::message::numbers::fixed;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::picture::PictureSize;
use sandtable_sheet::picture_buffers::{PickedPlace, pick};

#[derive(Debug, Args)]
#[command(
    after_help = "Pixels count from the upper left corner, from 0. Heights are elevations, without exaggeration."
)]
pub struct PickArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// The pixels, column and row each
    #[arg(long, value_name = "X,Y", required = true, num_args = 1.., value_parser = pixel)]
    pub pixel: Vec<[u32; 2]>,
    /// Size of the picture in pixels [default: the camera's paper, 1920x1080, or in plan the shape of the ground]
    #[arg(long, value_name = "WxH", value_parser = picture_size)]
    pub size: Option<PictureSize>,
    /// The camera of the scene that the picture is seen through [default: its first]
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub positions: PositionsArguments,
}

pub fn run(arguments: &PickArguments) -> Result<(), CliError> {
    let steps = StepTimer::default();
    let progress = |step| steps.begin(step);
    let scene = open_scene(&arguments.scene.scene, &arguments.scene.access.allow, &progress)?;
    let view = find_camera(&scene, arguments.camera.as_deref())?;
    let printer = arguments.positions.printer(&scene.crs)?;
    let size = arguments.size.unwrap_or_else(|| PictureSize::of(&scene, view));
    let PictureSize { width, height } = size;
    if let Some([x, y]) = arguments.pixel.iter().find(|[x, y]| *x >= width || *y >= height) {
        return Err(CliError::Usage(format!(
            "the pixel {x},{y} is not on a picture of {width}x{height}; columns end at {}, rows at {}",
            width - 1,
            height - 1
        )));
    }
    let places = pick(&scene, view, size, &arguments.pixel, &progress)?;
    steps.finish();
    let picked = arguments.pixel.iter().zip(&places);
    if arguments.json {
        let places: Vec<Value> =
            picked.map(|(pixel, place)| as_json(&scene, *pixel, place.as_ref(), printer)).collect();
        return print(&format!("{:#}\n", Value::from(places)));
    }
    let lines: Vec<String> =
        picked.flat_map(|(pixel, place)| text(&scene, *pixel, place.as_ref(), printer)).collect();
    print_lines(&lines)
}

fn text(
    scene: &SceneModel,
    [x, y]: [u32; 2],
    place: Option<&PickedPlace>,
    printer: PositionPrinter<'_>,
) -> Vec<String> {
    let Some(PickedPlace { at, elevation_m, distance_m, feature }) = place else {
        return vec![format!("{x},{y}"), row(10, "shows", "nothing of the scene")];
    };
    vec![
        format!("{x},{y}"),
        row(10, "shows", scene.feature_name(*feature)),
        row(10, "at", {
            printer.row(*at, || format!("{}, {} in {}", fixed(at.x, 1), fixed(at.y, 1), scene.crs.name()))
        }),
        row(10, "elevation", format!("{} m", fixed(*elevation_m, 2))),
        row(10, "distance", format!("{distance_m:.1} m")),
    ]
}

fn as_json(
    scene: &SceneModel,
    pixel: [u32; 2],
    place: Option<&PickedPlace>,
    printer: PositionPrinter<'_>,
) -> Value {
    let Some(PickedPlace { at, elevation_m, distance_m, feature }) = place else {
        return json!({ "pixel": pixel, "feature": null });
    };
    let mut object = json!({
        "pixel": pixel,
        "feature": scene.feature_name(*feature),
        "at": [at.x, at.y],
        "crs": scene.crs.name(),
        "elevation_m": elevation_m,
        "distance_m": distance_m,
    });
    printer.add_to(&mut object, *at);
    object
}
