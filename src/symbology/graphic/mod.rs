//! Tactical graphics: control measures of symbol set 25 of MIL-STD-2525D (2014), appendix H, and of 2525E, and the lines and
//! areas of weather and sea of sets 45 and 46, drawn in the plane.
//!
//! A [`kind`] names the draw rule of a graphic, how many points it has and which texts. Its draw function turns points in
//! meters, the height of a text and the texts into a [`drawing::GraphicDrawing`]: lines, filled rings and texts in the same
//! plane. What the standard leaves to the display - teeth, dashes, arrowheads that no point sizes - is measured in text
//! heights, so that a graphic looks the same on a sheet of any scale.
//!
//! ```text
//! kind_table    ─► lines, teeth, wire, axis, area, zone, fires, task, maneuver, crossing, corridor ─┐
//! point_table   ─► icon ─► letters                                                                  ├─► plane, drawing
//! weather_table ─► weather, fronts ─────────────────────────────────────────────────────────────────┘
//! check ─► kind, rules
//! ```

mod area;
mod axis;
pub mod check;
mod corridor;
mod crossing;
pub mod drawing;
pub mod fields;
mod fires;
mod fronts;
pub(crate) mod icon;
pub mod kind;
pub mod kind_table;
mod letters;
mod lines;
mod maneuver;
#[cfg(test)]
mod oracle;
pub mod plain;
mod plane;
mod point_table;
pub mod rules;
mod task;
mod teeth;
mod weather;
mod weather_table;
mod wire;
mod zone;
