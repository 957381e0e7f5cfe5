//! `sandtable view`: the arguments of the window.

use std::path::PathBuf;

use clap::Args;

use crate::ViewProgram;
use crate::error::CliError;
use crate::options::AccessArguments;
use crate::values::picture_size;
use sandtable_editing::viewing::ViewerOptions;
use sandtable_sheet::picture::PictureSize;

#[derive(Debug, Args)]
#[command(
    after_help = "Press ? in the window for its keys. Without a file it lists the files opened last.\n\
                  Lines of a --script: wait N | key NAME | fly X,Y,Z X,Y,Z SECONDS | pick X,Y | edit crater X,Y RADIUS |\n\
                  snapshot [FRAME.png] | resize WxH | undo | redo | save | quit"
)]
pub struct ViewArguments {
    /// The scene, or the elevation file
    pub file: Option<PathBuf>,
    /// Run the commands of this file, one a line, instead of waiting for a user, and close
    #[arg(long, value_name = "FILE")]
    pub script: Option<PathBuf>,
    /// Close after N frames [default: when the script ends]
    #[arg(long, value_name = "N", requires = "script")]
    pub frames: Option<u32>,
    /// Draw the frames of the script without a window or a display, the scene alone; `key P` adds the panels
    #[arg(long, requires_all = ["script", "file"])]
    pub offscreen: bool,
    /// Size of an offscreen frame in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = picture_size, requires = "offscreen")]
    pub size: PictureSize,
    /// Print JSON when the window closes: what each command of the script did, times and triangles of frames, bytes
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub access: AccessArguments,
}

pub fn run(arguments: &ViewArguments, view: Option<ViewProgram>) -> Result<(), CliError> {
    let view = view.ok_or_else(|| {
        CliError::usage(
            "this build has no window; build it with the feature `viewer`: cargo build --features viewer",
        )
    })?;
    let options = ViewerOptions {
        file: arguments.file.clone(),
        allowed: arguments.access.allow.clone(),
        script: arguments.script.clone(),
        frames: arguments.frames,
        offscreen: arguments.offscreen.then_some((arguments.size.width, arguments.size.height)),
        reports: arguments.json,
    };
    view(&options).map_err(|error| CliError::Input { error, hint: None })
}
