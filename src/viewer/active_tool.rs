//! The tool in use, and what it would do.

use std::time::Instant;

use crate::measuring::Measuring;
use crate::place_picking::PlacePicking;
use sandtable_editing::effect::EditPreview;
use sandtable_editing::tool::DrawingTool;

/// The tool in use.
#[derive(Clone, Debug, PartialEq)]
pub enum ActiveTool {
    /// Draws into the scene.
    Draw(DrawingTool),
    /// Measures.
    Measure(Measuring),
    /// Picks positions of an analysis.
    Pick(PlacePicking),
}

/// The earth of an edit that is being drawn, and when it was computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolPreview {
    /// The earth.
    pub preview: EditPreview,
    /// When.
    pub since: Instant,
}
