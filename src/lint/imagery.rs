//! Pictures of the ground that are too coarse for it.

use crate::context::LintContext;
use crate::sink::FindingSink;
use sandtable_description::finding_code::FindingCode;

/// A pixel wider than so many cells of the elevation model is seen as a blur before the ground shows its own cells.
const MOST_CELLS: f32 = 4.0;
/// The pixels across the ground below which even an overview in a small picture shows them.
const LEAST_PIXELS: u32 = 400;

/// Finds a picture of which one pixel is stretched over several cells of the ground.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    let (Some(imagery), Some(table)) = (&context.scene.imagery, &context.document.style.imagery) else {
        return;
    };
    let across = imagery.pixels.width().max(imagery.pixels.height());
    let pixel_m = imagery.size.max_element() / across as f32;
    let cell_m = context.scene.lattice.cell().max_element() as f32;
    if across < LEAST_PIXELS && pixel_m > MOST_CELLS * cell_m {
        let message = format!(
            "a pixel of '{}' is stretched over {pixel_m:.1} m, {:.0} cells of the elevation model; all the ground has {across} \
             pixels of it",
            table.file.as_str(),
            pixel_m / cell_m
        );
        let span = table.file.span().unwrap_or_default();
        sink.add(
            context
                .finding(FindingCode::TextureStretched, span, message)
                .with_help("take a picture of finer pixels"),
        );
    }
}
