//! `sandtable lod`: the methods of showing an elevation model, side by side.
//!
//! Every method flies the same flight and answers for the same things: what it shows, what changed, what it sent,
//! how long it took, how far it is off. [`method`] says which methods there are; each kind of them is a file that
//! implements [`follow::Follow`].

pub mod choice;
pub mod deferring;
pub mod fly;
pub mod follow;
pub mod full;
pub mod kept;
pub mod method;
pub mod mipmapping;
pub mod prepared;
pub mod refining;
pub mod report;
pub mod stations;
pub mod way;
pub mod writing;

use crate::app::arguments::LodOptions;
use crate::app::failure::CliError;
use crate::app::ground::metric_lattice;
use crate::app::lod::prepared::PreparedGround;
use crate::app::output;
use crate::app::progress::StepTimer;

/// Flies every method that is asked for and prints them side by side.
///
/// # Errors
/// No method is what was asked for; the elevation file or the flight cannot be had or read.
pub fn run(options: &LodOptions) -> Result<(), CliError> {
    let methods = options.wanted().methods()?;
    let steps = StepTimer::default();
    steps.begin("reading elevation");
    let lattice = metric_lattice(&options.file, options.heights)?;
    let flight = way::cameras(&options.flight, options.frames as usize, &lattice)?;
    steps.begin("measuring terrain");
    let terrain = PreparedGround::new(lattice, options.tolerance_px)
        .map_err(|reason| CliError::input(format!("{}: {reason}", options.file.display())))?;
    let budget = options.budget.map(|triangles| triangles as usize);
    let reports: Vec<_> = methods
        .iter()
        .map(|&method| {
            steps.begin("flying");
            fly::fly(method, follow::follower(method, &terrain, budget).as_mut(), &terrain, &flight)
        })
        .collect();
    steps.finish();
    if options.json {
        output::print(&format!("{}\n", report::json(&reports)))
    } else {
        output::print(&report::table(&reports, &terrain, &options.flight, options.budget))
    }
}
