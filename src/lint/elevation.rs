//! Implausible samples of the elevation model: spikes, pits and unmarked voids.

use glam::DVec2;

use crate::context::LintContext;
use crate::sink::FindingSink;
use sandtable_base::message::numbers::fixed;
use sandtable_description::finding_code::FindingCode;
use sandtable_raster::outliers::{OutlierKind, Outliers, outliers};
use sandtable_raster::raster::Raster;
use sandtable_raster::undeclared::undeclared_nodata;

/// Finds spikes, pits and unmarked voids.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    let snapshot = context.scene.heights.snapshot();
    let raster = snapshot.source();
    let spacing = raster.spacing().max_element();
    let cell_m = match &raster.crs {
        Some(crs) => spacing * crs.meters_northward_per_unit(),
        None => spacing,
    };
    let span = context.document.terrain.dem.span().unwrap_or_default();
    let undeclared = undeclared_nodata(raster);
    let is_told = |found: &Outliers| undeclared.iter().any(|known| known.value == found.value);
    for found in outliers(raster, cell_m).into_iter().filter(|found| !is_told(found)) {
        let (code, what) = sentence(&found);
        let at = place(raster, found.at);
        let message = format!("{what}, at {at}, where the value is {}", found.value);
        let help = "correct the file, for example with gdal_fillnodata, or state the value as `nodata`";
        sink.add(context.finding(code, span.clone(), message).with_help(help));
    }
}

fn sentence(found: &Outliers) -> (FindingCode, String) {
    let Outliers { samples, step_m, .. } = found;
    let single = |word: &str| match samples {
        1 => format!("one sample of the elevation model is {step_m:.0} m {word} all around it"),
        _ => format!(
            "{samples} samples of the elevation model are far {word} all around them, by {step_m:.0} m at most"
        ),
    };
    match found.kind {
        OutlierKind::Spike => (FindingCode::Spike, single("above")),
        OutlierKind::Pit => (FindingCode::Pit, single("below")),
        OutlierKind::Hole => (
            FindingCode::UnmarkedVoid,
            match samples {
                1 => format!("one sample ends in a step of {step_m:.0} m all around"),
                _ => format!("{samples} samples of one value end in a step of {step_m:.0} m all around"),
            },
        ),
    }
}

/// A sample's place in the raster's own system.
fn place(raster: &Raster, (column, row): (u32, u32)) -> String {
    let grid = DVec2::new(f64::from(column), f64::from(row)) + 0.5;
    let at = raster.map_from_grid.transform_point2(grid);
    let decimals = if raster.crs.as_ref().is_some_and(|crs| crs.is_geographic()) { 5 } else { 0 };
    format!("({}, {})", fixed(at.x, decimals), fixed(at.y, decimals))
}
