//! The commands and their arguments.

use std::path::Path;

use clap::{Parser, Subcommand};

use crate::analyze::AnalyzeCommand;
use crate::check::CheckArguments;
use crate::completions::CompletionsArguments;
use crate::convert::ConvertArguments;
use crate::dem_info::DemInfoArguments;
use crate::demo::DemoArguments;
use crate::explain::ExplainArguments;
use crate::export::ExportArguments;
use crate::fly::FlyArguments;
use crate::gather::GatherArguments;
use crate::grid::GridArguments;
use crate::height::HeightQueryArguments;
use crate::limit::{StatedLimit, stated_limit};
use crate::lod::LodArguments;
use crate::los::LosArguments;
use crate::mesh::MeshArguments;
use crate::model::ModelArguments;
use crate::new::NewArguments;
use crate::pick::PickArguments;
use crate::plan::PlanCommand;
use crate::profile::ProfileArguments;
use crate::render::RenderArguments;
use crate::report::ReportArguments;
use crate::serve::ServeArguments;
use crate::symbol::SymbolArguments;
use crate::view::ViewArguments;
use crate::viewshed::ViewshedArguments;
use crate::work::WorkArguments;
use sandtable_remote::address::AllowedHost;

/// Builds digital terrain models from scene files and renders annotated pictures of them.
#[derive(Debug, Parser)]
#[command(name = "sandtable", version, propagate_version = true)]
#[command(after_help = "Exit codes: 0 done, 1 the input is wrong, 2 wrong usage.")]
pub struct Arguments {
    /// Set a limit on input or work, as in raster-samples=1G; src/base/LIMITS.md lists them
    #[arg(long, global = true, value_name = "NAME=VALUE", value_parser = stated_limit)]
    pub limit: Vec<StatedLimit>,
    /// Allow reading files by their addresses from HOST, in a build with the feature `cloud`
    #[arg(long, global = true, value_name = "HOST", value_parser = AllowedHost::parse)]
    pub allow_remote: Vec<AllowedHost>,
    /// Show no progress, and say nothing of files that are written: print answers and errors alone
    #[arg(short, long, global = true)]
    pub quiet: bool,
    /// What to do; without it, what can be done with the files of the current folder
    #[command(subcommand)]
    pub command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene file to an annotated picture: PNG, PDF or SVG
    Render(RenderArguments),
    /// Open a window on a scene or an elevation file: walk through it, measure, dig, save
    View(ViewArguments),
    /// Say what a picture of a scene shows at a pixel: where it is, how high, and of which feature
    Pick(PickArguments),
    /// Draw a flight through a scene, frame by frame
    Fly(FlyArguments),
    /// Find what is wrong with a scene file, or looks wrong, without rendering it
    Check(CheckArguments),
    /// Explain a code of `check`, or list all
    Explain(ExplainArguments),
    /// Write a scene with its data out of the program, draw it, and open the picture
    Demo(DemoArguments),
    /// Write a first scene file for an elevation file and vector files
    New(NewArguments),
    /// Draw one military symbol: PNG or SVG
    Symbol(SymbolArguments),
    /// Print the JSON Schema of scene files, with which editors complete and check them
    Schema,
    /// Print the kinds of terrain analysis with their parameters, as JSON for programs that make forms of them
    Catalog,
    /// Print what completes the commands in a shell, or the manual page
    Completions(CompletionsArguments),
    /// Print the licenses of what this program is made of
    Licenses,
    /// Inspect, convert and make elevation files
    Dem {
        #[command(subcommand)]
        command: DemCommand,
    },
    /// Inspect model files
    Model {
        #[command(subcommand)]
        command: ModelCommand,
    },
    /// Print the heights of an elevation file or a scene at points
    Height(HeightQueryArguments),
    /// Print or chart the ground along a line
    Profile(ProfileArguments),
    /// Print or chart whether one point can be seen from another, and what blocks the view
    Los(LosArguments),
    /// Print, map or write as a raster what can be seen from a point
    Viewshed(ViewshedArguments),
    /// Analyze the ground: its form, movement, observation, landing, water, earth
    #[command(subcommand)]
    Analyze(AnalyzeCommand),
    /// Cut work that is too long for one machine into shards
    Plan {
        #[command(subcommand)]
        command: PlanCommand,
    },
    /// Do shards of a plan, those that are not done
    Work(WorkArguments),
    /// Check the shards of a plan, and join them where all are done
    Gather(GatherArguments),
    /// Answer height queries over HTTP
    Serve(ServeArguments),
    /// Print what building a scene found about single features: earth moved, gaps left, water levels
    Report(ReportArguments),
    /// Write a scene as a file that modeling programs open
    Export(ExportArguments),
    /// Write an elevation file as a mesh with an error bound
    Mesh(MeshArguments),
    /// Fly over an elevation file and compare level-of-detail methods
    Lod(LodArguments),
}

impl Command {
    /// What is there after Ctrl-C, and how to go on, as a user reads it.
    #[cfg(unix)]
    pub fn kept(&self) -> &'static str {
        match self {
            Self::Work(_) => "shards that are done are kept; the same command goes on with the rest",
            Self::Fly(arguments) if !arguments.is_one_file() => {
                "frames that are drawn are kept; the same command goes on with the rest"
            }
            Self::Render(arguments) if arguments.scenes.len() > 1 => {
                "pictures of scenes that are done are kept, and files that were there are as before"
            }
            _ => "files that were there are as before, and nothing half-written is left",
        }
    }

    /// The one scene file that the command reads; `None` where it may read another file as well, or several.
    pub fn scene(&self) -> Option<&Path> {
        match self {
            Self::Render(arguments) => match &arguments.scenes[..] {
                [scene] => Some(scene),
                _ => None,
            },
            Self::Pick(arguments) => Some(&arguments.scene.scene),
            Self::Fly(arguments) => Some(&arguments.scene.scene),
            // As JSON, an error is a finding.
            Self::Check(arguments) => (!arguments.json).then_some(&*arguments.scene.scene),
            Self::Report(arguments) => Some(&arguments.scene.scene),
            Self::Export(arguments) => Some(&arguments.scene.scene),
            _ => None,
        }
    }
}

/// The commands for elevation files.
#[derive(Debug, Subcommand)]
pub enum DemCommand {
    /// Print format, size, coordinate system, no-data value and statistics
    Info(DemInfoArguments),
    /// Write elevation files in another format, coordinate system or cell size; several are joined
    Convert(ConvertArguments),
    /// Make a grid of scattered points
    Grid(GridArguments),
}

/// The commands for model files.
#[derive(Debug, Subcommand)]
pub enum ModelCommand {
    /// Print meshes, vertices, faces, materials and bounds (Z up, the file's units)
    Info(ModelArguments),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_are_sound() {
        use clap::CommandFactory;
        Arguments::command().debug_assert();
    }
}
