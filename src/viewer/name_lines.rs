//! Names along lines: labels of the scene along rivers and roads and across areas, and texts of tactical graphics.

use std::sync::Arc;

use egui::{Color32, FontId};
use glam::{DVec2, Vec2, Vec3};

use crate::lettering::font;
use crate::line_piece::LinePicture;
use crate::opened::OpenedScene;
use sandtable_description::words::LabelKind;
use sandtable_draw::color::Srgba;
use sandtable_geom::aabb::Aabb;
use sandtable_geom::axis::axis;
use sandtable_picture::placed_text::{PlacedCourse, PlacedText};
use sandtable_scene::label_course::LabelCourse;

/// Lines whose half is shorter than this take no name, in pixels.
const LEAST_RADIUS_PX: f32 = 12.0;

/// The identity of a name along a line: the number of the scene's label, or a text of a graphic and which of its
/// places.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum NameKey {
    /// A label of the scene.
    Label(usize),
    /// A text of a graphic.
    Graphic(String, u32, usize),
}

/// The position of a name relative to its line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NameSide {
    /// Beside it.
    Above,
    /// On it.
    On,
    /// On it, over most of its length.
    Spread,
    /// Level, at one place.
    Level,
}

/// A name that looks for a place.
pub struct LineName {
    /// What it names.
    pub key: NameKey,
    /// Its letters.
    pub text: String,
    /// On the ground; none where it cannot be shown.
    pub lines: Arc<Vec<Vec<Vec3>>>,
    /// How it lies to them.
    pub side: NameSide,
    /// Its letters' font.
    pub font: FontId,
    /// Their color.
    pub ink: Color32,
}

/// The lines of a label of the scene.
#[derive(Clone, Debug)]
pub struct LabelLines {
    /// On the ground.
    pub lines: Arc<Vec<Vec<Vec3>>>,
    /// How a name lies to them.
    pub side: NameSide,
    /// The middle of their bounds.
    center: Vec3,
    /// Half of the diagonal of their bounds, meters.
    radius_m: f32,
}

impl LabelLines {
    /// The lines of each label of a scene; `None` of those at a place.
    pub fn of_labels(opened: &OpenedScene) -> Vec<Option<Self>> {
        let on_ground = |at: DVec2| Some(at.extend(opened.ground_z(at)?).as_vec3());
        let middle = |ring: &Vec<Vec3>| -> Vec<Vec3> {
            let outline: Vec<DVec2> = ring.iter().map(|at| at.truncate().as_dvec2()).collect();
            axis(&outline).into_iter().filter_map(on_ground).collect()
        };
        let course = |course: &LabelCourse| {
            let (lines, side) = match course {
                LabelCourse::Place => return None,
                LabelCourse::Along(lines) => (lines.clone(), NameSide::Above),
                LabelCourse::Across(rings) => (rings.iter().map(middle).collect(), NameSide::Spread),
            };
            let bounds = Aabb::around(lines.iter().flatten().copied())?;
            let (center, radius_m) = (bounds.center(), bounds.size().length() * 0.5);
            Some(LabelLines { lines: Arc::new(lines), side, center, radius_m })
        };
        opened.scene.labels.iter().map(|label| course(&label.course)).collect()
    }

    /// Whether a name may find room along them: they are on the picture, and longer than a few letters.
    pub fn may_show(&self, picture: &LinePicture<'_>) -> bool {
        let camera = picture.camera;
        let Some(seen) = camera.project(self.center) else {
            return camera.eye().distance(self.center) < self.radius_m;
        };
        let (width, height) = camera.size();
        let radius_px = self.radius_m * camera.pixels_per_meter(seen.depth_m);
        let outside = (-seen.pixel).max(seen.pixel - Vec2::new(width as f32, height as f32)).max_element();
        radius_px > LEAST_RADIUS_PX && outside < radius_px
    }
}

/// The texts of graphics as names: along their lines, or level at their places.
pub fn graphic_names<'a>(
    texts: impl Iterator<Item = &'a PlacedText>,
    picture: &LinePicture<'_>,
) -> Vec<LineName> {
    let mut names = Vec::new();
    for (index, text) in texts.enumerate() {
        let Srgba([red, green, blue, _]) = text.color;
        let mut add = |number: usize, lines: Vec<Vec<Vec3>>, side: NameSide| {
            let lines = Arc::new(lines);
            names.push(LineName {
                key: NameKey::Graphic(text.text.clone(), text.feature.0, index * 2 + number),
                text: text.text.replace('\n', "  "),
                lines,
                side,
                font: font(LabelKind::Point),
                ink: Color32::from_rgb(red, green, blue),
            });
        };
        match &text.course {
            PlacedCourse::Level => add(0, level_line(text, picture), NameSide::Level),
            PlacedCourse::Once(lines) | PlacedCourse::Repeated(lines) => {
                add(0, lines.clone(), NameSide::Above)
            }
            PlacedCourse::Ends(lines) => {
                for (number, third) in end_thirds(lines).into_iter().enumerate() {
                    add(number, vec![third], NameSide::On);
                }
            }
        }
    }
    names
}

/// The first and the last third of the longest line.
fn end_thirds(lines: &[Vec<Vec3>]) -> Vec<Vec<Vec3>> {
    let Some(line) = lines.iter().max_by_key(|line| line.len()) else { return Vec::new() };
    let third = line.len().div_ceil(3).max(2).min(line.len());
    vec![line[..third].to_vec(), line[line.len() - third..].to_vec()]
}

/// A line across the picture through the place of a text, as long as two of its widths, on the side where it is.
fn level_line(text: &PlacedText, picture: &LinePicture<'_>) -> Vec<Vec<Vec3>> {
    let camera = picture.camera;
    let Some(place) = camera.project(text.at) else { return Vec::new() };
    let (widths, height) = (picture.widths)(&[text.text.replace('\n', "  ")], &font(LabelKind::Point));
    let scale = camera.size().0 as f32 / picture.rect.width().max(1.0);
    let half_m =
        (widths.iter().sum::<f32>() * 0.55 + 2.0) * scale / camera.pixels_per_meter(place.depth_m).max(1e-9);
    let toward = camera.project(text.toward).map_or(Vec2::ZERO, |toward| toward.pixel - place.pixel);
    let aside =
        toward.normalize_or_zero() * Vec2::new(half_m, height * half_m / widths.iter().sum::<f32>().max(1.0));
    let middle = text.at + camera.right() * aside.x - camera.up() * aside.y;
    vec![vec![middle - camera.right() * half_m, middle, middle + camera.right() * half_m]]
}
