//! A flight through a scene, frame by frame: numbered pictures in a folder, or one animated PNG.
//!
//! Frames in a folder are drawn once: a run that was ended goes on with the first that is not there. A note beside them
//! says of what they are, so that frames of different scenes, sizes or versions are never mixed.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use sandtable_draw::pixels::Pixels;
use sandtable_files::disk::{self, ReadFileError, WriteFileError};
use sandtable_files::fingerprint::fingerprint;
use sandtable_render::RenderBackend;
use sandtable_scene::flights::SceneFlight;
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::in_order::PicturesInOrder;
use sandtable_sheet::picture::{PictureError, PictureSize, bytes_of_making, render_view};

/// The note beside the frames.
const NOTE: &str = "frames.json";

/// The options for drawing a flight.
#[derive(Clone, Copy, Debug)]
pub struct FlyOptions {
    /// The size of a frame.
    pub size: PictureSize,
    /// How many frames there are; at least 1.
    pub frames: u32,
    /// Frames in a second.
    pub fps: u16,
    /// The renderer.
    pub backend: RenderBackend,
}

/// Why a flight is not drawn.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum FlyError {
    #[error(transparent)]
    Picture(#[from] PictureError),
    #[error(transparent)]
    Read(#[from] ReadFileError),
    #[error(transparent)]
    Write(#[from] WriteFileError),
    #[error("{}: these are frames of something else: the scene, the size, the frames or the program changed; name another folder, or remove this one", .0.display())]
    OtherFrames(PathBuf),
}

/// The number of frames that were drawn, and of those that existed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameCount {
    /// Drawn now.
    pub drawn: u32,
    /// Drawn by an earlier run.
    pub kept: u32,
}

/// Draws the frames of `flight` that are not in `folder` yet, as `frame-00001.png` and so on. `scene_file` is the file of
/// the scene. `done` is called after each frame with its number.
///
/// # Errors
/// See [`FlyError`].
pub fn fly_to_folder(
    (scene, scene_file): (&SceneModel, &Path),
    flight: &SceneFlight,
    options: &FlyOptions,
    folder: &Path,
    done: &dyn Fn(u32),
) -> Result<FrameCount, FlyError> {
    disk::make_folder(folder)?;
    let note = format!("{:#}\n", note(scene, scene_file, flight, options)?);
    let note_path = folder.join(NOTE);
    if note_path.is_file() {
        if disk::read(&note_path)? != note.as_bytes() {
            return Err(FlyError::OtherFrames(note_path));
        }
    } else {
        disk::write(&note_path, note.as_bytes())?;
    }
    let path = |number: u32| folder.join(format!("frame-{number:05}.png"));
    // A frame is written whole or not at all.
    let missing: Vec<u32> = (1..=options.frames).filter(|number| !path(*number).is_file()).collect();
    let mut finished = 0;
    let mut finish = |number: u32| {
        (finished + 1..=number).for_each(done);
        finished = number;
    };
    if let Some(&first) = missing.first() {
        disk::check_output(&path(first), &scene.files)?;
    }
    frames(scene, flight, options, &missing, |number, pixels| {
        finish(number - 1);
        disk::check_output(&path(number), &scene.files)?;
        disk::write_picture(&path(number), &pixels)?;
        finish(number);
        Ok::<_, FlyError>(())
    })?;
    finish(options.frames);
    let drawn = missing.len() as u32;
    Ok(FrameCount { drawn, kept: options.frames - drawn })
}

/// Draws all frames of `flight` into one animated PNG, which plays without end. `done` is called after each frame with its
/// number.
///
/// # Errors
/// See [`FlyError`].
pub fn fly_to_file(
    scene: &SceneModel,
    flight: &SceneFlight,
    options: &FlyOptions,
    path: &Path,
    done: &dyn Fn(u32),
) -> Result<(), FlyError> {
    disk::check_output(path, &scene.files)?;
    let mut failure = None;
    let written = disk::write_with(path, |out| {
        let mut animation = animation(out, options)?;
        let numbers: Vec<u32> = (1..=options.frames).collect();
        let drawn = frames(scene, flight, options, &numbers, |number, pixels| {
            let rgb: Vec<u8> =
                pixels.data().iter().flat_map(|color| [color.0[0], color.0[1], color.0[2]]).collect();
            animation.write_image_data(&rgb).map_err(|error| FrameError::Written(error.into()))?;
            done(number);
            Ok(())
        });
        match drawn {
            Ok(()) => Ok(animation.finish()?),
            Err(FrameError::Written(error)) => Err(error),
            Err(FrameError::Drawn(error)) => {
                failure = Some(error);
                Err(io::Error::other("a frame cannot be drawn"))
            }
        }
    });
    match failure {
        Some(error) => Err(error.into()),
        None => Ok(written?),
    }
}

/// Why a frame of an animation is missing.
enum FrameError {
    Drawn(PictureError),
    Written(io::Error),
}

impl From<PictureError> for FrameError {
    fn from(error: PictureError) -> Self {
        Self::Drawn(error)
    }
}

/// An animated PNG (PNG 3rd edition, section 11.3.4) without frames.
fn animation<W: Write>(out: W, options: &FlyOptions) -> io::Result<png::Writer<W>> {
    let mut encoder = png::Encoder::new(out, options.size.width, options.size.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_animated(options.frames, 0)?;
    encoder.set_frame_delay(1, options.fps)?;
    Ok(encoder.write_header()?)
}

/// Draws the frames with these numbers, from 1, and hands them to `take` in this order; several at once where the processor
/// draws.
fn frames<E: From<PictureError>>(
    scene: &SceneModel,
    flight: &SceneFlight,
    options: &FlyOptions,
    numbers: &[u32],
    mut take: impl FnMut(u32, Pixels) -> Result<(), E>,
) -> Result<(), E> {
    let frame = |number: u32| {
        let share = f64::from(number - 1) / f64::from((options.frames - 1).max(1));
        let view = render_view(scene, &flight.view(share), options.size, options.backend, &|_| ())?;
        let bytes = bytes_of_making(&view.drawn, &view.pixels);
        Ok::<_, PictureError>((view.pixels, bytes))
    };
    if let RenderBackend::Gpu(_) = options.backend {
        return numbers.iter().try_for_each(|&number| take(number, frame(number)?.0));
    }
    let making = PicturesInOrder {
        count: numbers.len(),
        make: &|index, _| frame(numbers[index]),
        bytes: &|made| made.as_ref().map_or(u64::MAX, |(_, bytes)| *bytes),
        progress: &|_| (),
    };
    making.each(|index, made| take(numbers[index], made?.0))
}

/// What the frames depend on.
fn note(
    scene: &SceneModel,
    scene_file: &Path,
    flight: &SceneFlight,
    options: &FlyOptions,
) -> Result<Value, ReadFileError> {
    Ok(json!({
        "program": concat!("sandtable ", env!("CARGO_PKG_VERSION")),
        "scene": fingerprint(scene_file, &scene.files)?,
        "flight": flight.name,
        "frames": options.frames,
        "frames_per_second": options.fps,
        "size": [options.size.width, options.size.height],
        "backend": format!("{:?}", options.backend).to_lowercase(),
    }))
}
