//! Names, heights and furniture painted on a finished picture.
//!
//! [`paint::annotate`] is the one door: it takes a picture and [`annotation::Annotations`] in picture
//! coordinates, paints, and says in a [`report::AnnotationReport`] what it drew and what it could not.
//!
//! ```text
//! Annotations ──► furniture (title, north, scale_bar, legend, credit) ──► Drawing ──► Canvas ──► Pixels
//!             └─► labels ──► positions ──► place (pure, two dimensions) ──► Drawing ──┘
//! ```
//!
//! Every mark is a filled path ([`drawing`]), so the box a thing is laid out with is the box it paints.
//! Type is set in the fonts embedded in the program and never in the machine's ([`text`]): the same input
//! gives the same bytes everywhere.

pub mod annotation;
pub mod canvas;
pub mod chart;
pub mod chart_ground;
pub mod chart_profile;
pub mod chart_sight;
pub mod credit;
pub mod drawing;
pub mod labels;
pub mod legend;
pub mod map;
pub mod nice;
pub mod north;
pub mod paint;
pub mod paragraph;
pub mod pixel_box;
pub mod place;
pub mod positions;
pub mod report;
pub mod scale_bar;
pub mod sheet;
pub mod text;
pub mod title;
