//! `sandtable fly`: a flight through a scene as numbered pictures or an animated one.

use std::path::PathBuf;

use clap::Args;

use crate::error::CliError;
use crate::options::SceneArguments;
use crate::output::{print_summary, row};
use crate::progress::{CountedBar, StepTimer};
use crate::values::{choice, number, picture_size};
use sandtable_base::limits::FLIGHT_FRAMES;
use sandtable_render::OtherRenderer;
use sandtable_render::backend_name::BackendName;
use sandtable_sheet::picture::PictureSize;
use sandtable_walk::flown_scene::open_scene_with_flight;
use sandtable_walk::fly::{FlyOptions, fly_to_file, fly_to_folder};

#[derive(Debug, Args)]
#[command(
    after_help = "The flight is a [[flight]] of the scene. Into a folder each frame is written as a picture of its own, and a run\n\
                  that was ended goes on where it stopped; for a video: ffmpeg -framerate 25 -i DIR/frame-%05d.png out.mp4"
)]
pub struct FlyArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Write frames into this folder, or into one animated picture where the name ends in .png
    #[arg(short, long, value_name = "DIR|OUT.png")]
    pub output: PathBuf,
    /// The flight of the scene [default: its first]
    #[arg(long, value_name = "NAME")]
    pub flight: Option<String>,
    /// Size of a frame in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = picture_size)]
    pub size: PictureSize,
    /// Frames in a second
    #[arg(long, value_name = "N", default_value = "25", value_parser = clap::value_parser!(u16).range(1..=240))]
    pub fps: u16,
    /// How long the flight takes [default: by its `speed`]
    #[arg(long, value_name = "SECONDS", value_parser = number::<f64>(0.01..=3600.0, "write seconds as a number from 0.01 to 3600"))]
    pub seconds: Option<f64>,
    /// The renderer: the processor, the same on every machine, or a graphics adapter
    #[arg(long, default_value = "cpu", value_parser = choice::<BackendName>())]
    pub backend: BackendName,
}

impl FlyArguments {
    /// Whether the frames go into one animated picture.
    pub fn is_one_file(&self) -> bool {
        self.output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"))
    }
}

pub fn run(arguments: &FlyArguments, gpu: Option<OtherRenderer>) -> Result<(), CliError> {
    let SceneArguments { scene: file, access } = &arguments.scene;
    let steps = StepTimer::default();
    let progress = |step| steps.begin(step);
    let (scene, flight) =
        open_scene_with_flight(file, &access.allow, arguments.flight.as_deref(), &progress)?;
    steps.finish();
    let seconds = arguments.seconds.unwrap_or(flight.seconds);
    let frames = (seconds * f64::from(arguments.fps)).round().max(1.0);
    if frames > FLIGHT_FRAMES.get() as f64 {
        return Err(CliError::Usage(format!(
            "{frames:.0} frames are more than the {FLIGHT_FRAMES} that are drawn; state fewer --seconds or a smaller --fps, or {FLIGHT_FRAMES:#}"
        )));
    }
    let options = FlyOptions {
        size: arguments.size,
        frames: frames as u32,
        fps: arguments.fps,
        backend: arguments.backend.renderer(gpu),
    };
    let bar = CountedBar::new("frame", u64::from(options.frames));
    let done = |number: u32| bar.set(u64::from(number));
    let count = if arguments.is_one_file() {
        fly_to_file(&scene, &flight, &options, &arguments.output, &done)?;
        format!("{} in one animated picture", options.frames)
    } else {
        let count = fly_to_folder((&scene, file), &flight, &options, &arguments.output, &done)?;
        format!("{}, {} of them there before", options.frames, count.kept)
    };
    drop(bar);
    let length = format!("{:.2} km in {seconds:.1} s", flight.length_m() / 1000.0);
    let mut lines = vec![
        arguments.output.display().to_string(),
        row(9, "flight", format!("{}: {length}", flight.name)),
        row(9, "frames", count),
    ];
    lines.extend(scene.notes().into_iter().map(|note| row(9, "note", note)));
    print_summary(&lines)
}
