//! How the ground looks: ramp and contours.

use crate::description::color::{Color, RampChoice};
use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::description::words::RampName;
use crate::draw::color::Srgba;
use crate::draw::ground::{ColorRamp, Contours};
use crate::geom::declination::CalendarDay;
use crate::message::suggest::quoted;
use crate::scene::ramps::{TintedGround, named};

/// Where the colors of the ground come from.
#[derive(Clone, Debug, PartialEq)]
pub enum RampSource {
    /// A built-in ramp, which spans the heights of the ground.
    Named(RampName),
    /// A ramp with heights of its own.
    Own(ColorRamp),
}

impl RampSource {
    /// The document's ramp.
    ///
    /// # Errors
    /// Stops that do not rise.
    pub fn new(document: &Document) -> Result<Self, Diagnostic> {
        let choice = &document.style.ramp;
        match &**choice {
            RampChoice::Named(name) => Ok(Self::Named(*name)),
            RampChoice::Stops(stops) => {
                let stop = |&(height, Color(channels)): &(f64, Color)| (height as f32, Srgba(channels));
                let ramp = ColorRamp::new(stops.iter().map(stop).collect());
                let failed = || document.error(choice, "the ramp's heights do not rise");
                ramp.map(Self::Own).ok_or_else(failed)
            }
        }
    }

    /// The colors of `ground`.
    pub fn over(&self, ground: &TintedGround) -> ColorRamp {
        match self {
            Self::Named(name) => named(*name, ground),
            Self::Own(ramp) => ramp.clone(),
        }
    }
}

/// The document's contour lines.
pub fn contours(document: &Document) -> Option<Contours> {
    document.style.contours.as_ref().map(|contours| Contours {
        interval_m: contours.interval as f32,
        major_every: contours.major_every,
        color: contours.color.map_or(Srgba([112, 74, 40, 150]), |color| Srgba(color.0)),
        width_px: 1.0,
    })
}

/// The day that the document's furniture names.
///
/// # Errors
/// The text is not a day.
pub fn sheet_day(document: &Document) -> Result<Option<CalendarDay>, Diagnostic> {
    let day = document.furniture.date.as_ref().map(|date| {
        let message = format!("'{}' is not a day", quoted(date));
        CalendarDay::parse(date)
            .ok_or_else(|| document.error(date, message).with_help("write it as in \"2026-06-21\""))
    });
    day.transpose()
}
