//! `sandtable lod`: the methods of showing an elevation model, side by side.
//!
//! Every method flies the same flight and answers for the same things: what it shows, what changed, what it sent,
//! how long it took, how far it is off. A method is a line of the table in [`method`] and, where it is of a new
//! kind, a file of its own that implements [`follow::Follow`].

pub mod fly;
pub mod follow;
pub mod method;
pub mod prepared;
pub mod rebuild;
pub mod report;
pub mod stations;
pub mod way;

use crate::app::arguments::LodOptions;
use crate::app::failure::Failure;
use crate::app::ground::metric_lattice;
use crate::app::lod::prepared::Prepared;
use crate::app::output;
use crate::app::progress::Steps;

/// Flies every method that is asked for and prints them side by side.
///
/// # Errors
/// No method is what was asked for; the elevation file or the flight cannot be had or read.
pub fn run(options: &LodOptions) -> Result<(), Failure> {
    let methods = method::chosen(method::ALL, options.wanted())?;
    let steps = Steps::default();
    steps.begin("reading elevation");
    let lattice = metric_lattice(&options.file, options.heights)?;
    let flight = way::cameras(&options.flight, options.frames as usize, &lattice)?;
    steps.begin("measuring terrain");
    let terrain = Prepared::new(lattice, options.tolerance_px)
        .map_err(|reason| Failure::input(format!("{}: {reason}", options.file.display())))?;
    let reports: Vec<_> = methods
        .iter()
        .map(|&method| {
            steps.begin("flying");
            fly::fly(method, follow::follower(method, &terrain).as_mut(), &terrain, &flight)
        })
        .collect();
    steps.finish();
    if options.json {
        output::print(&format!("{}\n", report::json(&reports)))
    } else {
        output::print(&report::table(&reports, &terrain, &options.flight))
    }
}
