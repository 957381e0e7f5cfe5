//! Derives the demonstration landscape of `assets/jacksboro/` from its elevation model.
//!
//! Run it from the repository with `cargo run --example derive-jacksboro`; it writes the files anew and says
//! where roads meet, where they cross streams and how steep they are.

use std::io::Write;
use std::path::Path;

use image::{ImageBuffer, Luma};
use jacksboro::ground::Ground;
use jacksboro::samples;

mod jacksboro;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = Path::new(env!("SANDTABLE_ROOT")).join("assets/jacksboro");
    let derived = jacksboro::derive(&Ground::read(&std::fs::read(folder.join("dem.tif"))?));
    std::fs::write(folder.join("streams.geojson"), derived.streams)?;
    std::fs::write(folder.join("lake.geojson"), derived.lakes)?;
    std::fs::write(folder.join("roads.geojson"), derived.roads)?;
    std::fs::write(folder.join("valley.asc"), derived.valley)?;
    let hills: Option<ImageBuffer<Luma<u16>, Vec<u16>>> =
        ImageBuffer::from_raw(samples::HILLS_SIDE, samples::HILLS_SIDE, samples::hills());
    hills.ok_or("the hills do not fill their square")?.save(folder.join("hills.png"))?;
    let mut out = std::io::stdout().lock();
    derived.notes.iter().try_for_each(|note| writeln!(out, "{note}"))?;
    Ok(())
}
