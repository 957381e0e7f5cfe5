//! Names along rivers and roads and across areas, and the texts of tactical graphics, decluttered anew each frame without
//! flicker.
//!
//! ```text
//!  a line on the ground ─► its pieces on the picture ─► the held place, else some others ─► letters along it
//! ```
//!
//! What is held from frame to frame is a place on the ground, so that a name stays where it is while the camera moves, until
//! it does not fit there any more.

use std::collections::{BTreeMap, BTreeSet};
use std::f32::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use egui::epaint::TextShape;
use egui::{Color32, FontId, Painter, Pos2, Rect, Shape, vec2};
use glam::{DVec2, Vec2, Vec3};

use crate::annotate::fonts::is_joined;
use crate::description::words::LabelKind;
use crate::draw::color::Srgba;
use crate::geom::aabb::Aabb;
use crate::geom::axis::axis;
use crate::scene::label_course::LabelCourse;
use crate::scene::picture::placed_text::{PlacedCourse, PlacedText};
use crate::view::camera::Camera;
use crate::viewer::labels::ink;
use crate::viewer::lettering::font;
use crate::viewer::opened::OpenedScene;

/// The most that neighboring letters may turn against each other, radians: sharper bends tear words apart.
const MOST_BEND: f32 = 0.45;
/// The same for a name that is shown: what is shown stays until it is bad for good.
const MOST_HELD_BEND: f32 = 0.65;
/// The most that a letter may turn against its name's direction, radians.
const MOST_TURN: f32 = 1.0;
/// Places tried along a piece for a name that is not shown.
const TRIED: usize = 7;
/// Names that are not shown are tried in turns of so many frames: trying takes longer than holding.
const TURNS: u32 = 4;
/// The most names that are shown.
const MOST_SHOWN: usize = 120;
/// How much of its opacity a name gains or loses in a frame.
const FADE: f32 = 0.2;
/// How long a name stays when its place is hidden for a moment, in frames.
const PATIENCE: u8 = 6;
/// A name that is not shown needs this room around it, in points.
const NEW_MARGIN: f32 = 4.0;
/// The distance of a name beside its line, in heights of its letters.
const LIFT: f32 = 0.75;
/// How far the letters of an area's name are spread, as a share of its axis, and at the most in widths of the name.
const SPREAD: [f32; 2] = [0.6, 2.2];
/// Lines whose half is shorter than this take no name, in pixels.
const LEAST_RADIUS_PX: f32 = 12.0;

/// What names a line: the number of the scene's label, or a text of a graphic and which of its places.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum NameKey {
    Label(usize),
    Graphic(String, u32, usize),
}

/// How a name lies to its line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum NameSide {
    Above,
    On,
    Spread,
    /// Level, at one place.
    Level,
}

/// A name that looks for a place.
struct LineName {
    key: NameKey,
    text: String,
    lines: Arc<Vec<Vec<Vec3>>>,
    side: NameSide,
    font: FontId,
    ink: Color32,
}

/// The lines of a label of the scene.
#[derive(Clone, Debug)]
struct LabelLines {
    lines: Arc<Vec<Vec<Vec3>>>,
    side: NameSide,
    /// The middle of their bounds.
    center: Vec3,
    /// Half of the diagonal of their bounds, meters.
    radius_m: f32,
}

/// A name in the frames before.
#[derive(Clone, Debug, Default)]
struct NameState {
    /// Which of its lines, and where along it on the ground, meters.
    held: Option<(usize, f32)>,
    is_reversed: bool,
    opacity: f32,
    hidden_for: u8,
    letters: Vec<LineLetter>,
}

/// A letter, or a word whose letters touch each other, on the picture.
#[derive(Clone, Debug, PartialEq)]
struct LineLetter {
    text: String,
    center: Pos2,
    angle: f32,
}

/// A vertex of a line on the picture.
#[derive(Clone, Copy, Debug)]
struct NamePoint {
    at: Vec2,
    world: Vec3,
    /// Along the line on the ground, meters.
    station_m: f32,
    /// Along the piece on the picture, points.
    along: f32,
}

/// Measures letters in points: the width of each, and the height of all.
pub type LetterWidths<'a> = &'a dyn Fn(&[String], &FontId) -> (Vec<f32>, f32);

/// The picture that names are placed on.
pub struct LinePicture<'a> {
    /// How it is seen.
    pub camera: &'a Camera,
    /// Where it is, in points of the window.
    pub rect: Rect,
    /// What names leave free.
    pub taken: &'a [Rect],
    /// Whether a place in world space is in sight.
    pub is_seen: &'a dyn Fn(Vec3) -> bool,
    /// The widths of letters, and their height, in points.
    pub widths: LetterWidths<'a>,
}

/// The names along lines of the frames before.
#[derive(Clone, Debug, Default)]
pub struct LineNames {
    states: BTreeMap<NameKey, NameState>,
    /// The lines of the scene's labels, computed once.
    courses: Vec<Option<LabelLines>>,
    /// The numbers of those labels, the important first.
    order: Vec<usize>,
    /// The labels that found no place along their lines.
    failed: BTreeSet<usize>,
    frame: u32,
    /// The camera of the frame before, and for how many frames it is the same.
    rests: Option<(Camera, u32)>,
}

impl LineNames {
    /// Whether a label of the scene is to be placed at its place: it has no line, or found no room along it.
    pub fn is_at_place(&self, label: usize) -> bool {
        self.courses.get(label).is_none_or(Option::is_none) || self.failed.contains(&label)
    }

    /// Whether names are coming or going, or are still to be tried, so that a next frame differs though nothing moves.
    pub fn is_changing(&self) -> bool {
        let is_waiting =
            self.rests.as_ref().is_some_and(|(_, frames)| *frames <= TURNS) && !self.order.is_empty();
        let changes = |state: &NameState| {
            (state.opacity > 0.0 && state.opacity < 1.0) || state.hidden_for > 0 && state.held.is_some()
        };
        is_waiting || self.states.values().any(changes)
    }

    /// Places and paints the names of this frame.
    pub fn show(&mut self, painter: &Painter, opened: &OpenedScene, picture: &LinePicture<'_>) {
        self.frame = self.frame.wrapping_add(1);
        self.rests = Some(match self.rests {
            Some((camera, frames)) if camera == *picture.camera => (camera, frames.saturating_add(1)),
            _ => (*picture.camera, 0),
        });
        self.know_courses(opened);
        let mut taken = picture.taken.to_vec();
        let before = std::mem::take(&mut self.states);
        let mut shown = 0;
        let is_turn = |turn: usize| turn % TURNS as usize == self.frame as usize % TURNS as usize;
        let graphics = graphic_names(opened.walk.graphic_texts(), picture);
        let labels = self.order.iter().enumerate().filter_map(|(turn, &index)| {
            let is_known = before.contains_key(&NameKey::Label(index));
            let lines = self.courses[index].as_ref().filter(|_| is_known || is_turn(turn))?;
            let label = &opened.scene.labels[index];
            Some(LineName {
                key: NameKey::Label(index),
                text: label.text.clone(),
                lines: if lines.may_show(picture) { Arc::clone(&lines.lines) } else { Arc::default() },
                side: lines.side,
                font: font(label.kind),
                ink: ink(label.kind),
            })
        });
        let names: Vec<LineName> = graphics.into_iter().chain(labels).collect();
        for name in names {
            let mut state = before.get(&name.key).cloned().unwrap_or_default();
            let is_tried = state.held.is_some() || shown < MOST_SHOWN;
            let placed = if is_tried { place(&name, &state, picture, &taken) } else { None };
            state.hidden_for = if placed.is_some() { 0 } else { state.hidden_for.saturating_add(1) };
            match placed {
                Some((held, is_reversed, letters)) => {
                    (state.held, state.is_reversed, state.letters) = (Some(held), is_reversed, letters);
                }
                None if state.hidden_for > PATIENCE => state.held = None,
                None => {}
            }
            let is_shown = state.held.is_some();
            state.opacity = (state.opacity + if is_shown { FADE } else { -FADE }).clamp(0.0, 1.0);
            if let NameKey::Label(label) = name.key {
                if is_shown {
                    self.failed.remove(&label)
                } else {
                    self.failed.insert(label)
                };
            }
            if is_shown {
                shown += 1;
                taken.extend(state.letters.iter().map(|letter| letter_box(letter, name.font.size)));
            }
            if state.opacity > 0.0 {
                paint(painter, &name, &state);
                self.states.insert(name.key, state);
            }
        }
    }

    /// Computes the lines of the scene's labels where that was not done yet.
    fn know_courses(&mut self, opened: &OpenedScene) {
        let labels = &opened.scene.labels;
        if self.courses.len() == labels.len() {
            return;
        }
        let on_ground = |at: DVec2| Some(at.extend(opened.walk.ground_z(at)?).as_vec3());
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
        self.courses = labels.iter().map(|label| course(&label.course)).collect();
        self.order = (0..labels.len()).filter(|&at| self.courses[at].is_some()).collect();
        self.order.sort_by(|&a, &b| labels[a].rank.total_cmp(&labels[b].rank).then(a.cmp(&b)));
    }
}

impl LabelLines {
    /// Whether a name may find room along them: they are on the picture, and longer than a few letters.
    fn may_show(&self, picture: &LinePicture<'_>) -> bool {
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
fn graphic_names(texts: &[PlacedText], picture: &LinePicture<'_>) -> Vec<LineName> {
    let mut names = Vec::new();
    for (index, text) in texts.iter().enumerate() {
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

/// The letters of a name at its held place or at another, with that place and whether they run against the line.
fn place(
    name: &LineName,
    state: &NameState,
    picture: &LinePicture<'_>,
    taken: &[Rect],
) -> Option<((usize, f32), bool, Vec<LineLetter>)> {
    let is_whole = is_joined(&name.text);
    let letters: Vec<String> =
        if is_whole { vec![name.text.clone()] } else { name.text.chars().map(String::from).collect() };
    let (mut widths, height) = (picture.widths)(&letters, &name.font);
    let own: f32 = widths.iter().sum();
    let is_free = |letters: &[LineLetter], margin: f32| {
        letters.iter().all(|letter| {
            let own = letter_box(letter, name.font.size).expand(margin);
            picture.rect.contains_rect(own) && !taken.iter().any(|other| other.intersects(own))
        })
    };
    let lift = if name.side == NameSide::Above { height * LIFT } else { 0.0 };
    let held = state.held;
    for (number, line) in name.lines.iter().enumerate() {
        if held.is_some_and(|(line, _)| line != number) {
            continue;
        }
        for piece in pieces(line, picture) {
            let length = piece.last().map_or(0.0, |last| last.along);
            if name.side == NameSide::Spread && !is_whole {
                let spread = (length * SPREAD[0]).min(own * SPREAD[1]).max(own);
                let gap = (spread - own) / letters.len().max(1) as f32;
                widths = (picture.widths)(&letters, &name.font).0.iter().map(|width| width + gap).collect();
            }
            let width: f32 = widths.iter().sum();
            if length < width {
                continue;
            }
            let places: Vec<f32> = match held {
                _ if name.side == NameSide::Level => vec![length * 0.5],
                Some((_, station_m)) => along_at(&piece, station_m).into_iter().collect(),
                None => (0..TRIED).map(|tried| length * place_share(tried)).collect(),
            };
            let bend = if held.is_some() { MOST_HELD_BEND } else { MOST_BEND };
            for along in places {
                let run = LetterRun {
                    letters: &letters,
                    widths: &widths,
                    lift,
                    bend,
                    was_reversed: state.is_reversed,
                };
                let Some((is_reversed, set)) = run.set(&piece, along) else { continue };
                let margin = if held.is_some() { -1.0 } else { NEW_MARGIN };
                let ends = [along - width * 0.5, along, along + width * 0.5];
                let is_seen = || ends.into_iter().all(|at| (picture.is_seen)(point_at(&piece, at).1));
                if is_free(&set, margin) && is_seen() {
                    return Some(((number, point_at(&piece, along).2), is_reversed, set));
                }
            }
        }
    }
    None
}

/// The share of a piece at which the middle of a name is tried: the middle first, then outward.
fn place_share(tried: usize) -> f32 {
    let step = tried.div_ceil(2) as f32 / (TRIED as f32 + 1.0);
    if tried.is_multiple_of(2) { 0.5 + step } else { 0.5 - step }
}

/// The parts of a line that are on the picture.
fn pieces(line: &[Vec3], picture: &LinePicture<'_>) -> Vec<Vec<NamePoint>> {
    let (camera, rect) = (picture.camera, picture.rect);
    let (width, height) = camera.size();
    let (mut found, mut open): (Vec<Vec<NamePoint>>, Vec<NamePoint>) = (Vec::new(), Vec::new());
    let (mut station_m, mut before) = (0.0, None);
    for &world in line {
        station_m += before.map_or(0.0, |before: Vec3| before.distance(world));
        before = Some(world);
        let at = camera.project(world).map(|seen| {
            let share = Vec2::new(seen.pixel.x / width as f32, seen.pixel.y / height as f32);
            Vec2::new(rect.min.x + share.x * rect.width(), rect.min.y + share.y * rect.height())
        });
        match at.filter(|at| rect.contains(Pos2::new(at.x, at.y))) {
            Some(at) => {
                let along = open.last().map_or(0.0, |last| last.along + last.at.distance(at));
                open.push(NamePoint { at, world, station_m, along });
            }
            None => found.push(std::mem::take(&mut open)),
        }
    }
    found.push(open);
    found.retain(|piece| piece.len() >= 2);
    found.sort_by(|a, b| b[b.len() - 1].along.total_cmp(&a[a.len() - 1].along));
    found
}

/// Where a station on the ground is along a piece; `None` where the piece lacks it.
fn along_at(piece: &[NamePoint], station_m: f32) -> Option<f32> {
    let after = piece.partition_point(|point| point.station_m < station_m);
    let (from, to) = (piece.get(after.checked_sub(1)?)?, piece.get(after)?);
    let share = (station_m - from.station_m) / (to.station_m - from.station_m).max(1e-6);
    Some(from.along + (to.along - from.along) * share)
}

/// The place on the picture, on the ground, and the station of a length along a piece.
fn point_at(piece: &[NamePoint], along: f32) -> (Vec2, Vec3, f32) {
    let after = piece.partition_point(|point| point.along < along).clamp(1, piece.len() - 1);
    let (from, to) = (piece[after - 1], piece[after]);
    let share = ((along - from.along) / (to.along - from.along).max(1e-6)).clamp(0.0, 1.0);
    let station_m = from.station_m + (to.station_m - from.station_m) * share;
    (from.at.lerp(to.at, share), from.world.lerp(to.world, share), station_m)
}

/// Letters that are set along a line.
struct LetterRun<'a> {
    letters: &'a [String],
    widths: &'a [f32],
    /// How far above the line, points.
    lift: f32,
    /// The most that neighbors turn against each other.
    bend: f32,
    was_reversed: bool,
}

impl LetterRun<'_> {
    /// The letters with their middle at a length along a piece, so that they are read from the left; `None` where they
    /// reach past its ends or bend too much.
    fn set(&self, piece: &[NamePoint], middle: f32) -> Option<(bool, Vec<LineLetter>)> {
        let width: f32 = self.widths.iter().sum();
        let (start, end) = (middle - width * 0.5, middle + width * 0.5);
        if start < 0.0 || end > piece[piece.len() - 1].along {
            return None;
        }
        let chord = point_at(piece, end).0 - point_at(piece, start).0;
        // What runs almost upward keeps its direction.
        let slack = if self.was_reversed { 0.15 } else { -0.15 } * width;
        let is_reversed = chord.x < slack;
        let whole = if is_reversed { -chord } else { chord };
        let direction = whole.y.atan2(whole.x);
        let (mut at, mut set) = (0.0, Vec::with_capacity(self.letters.len()));
        let mut before: Option<f32> = None;
        for (letter, width) in self.letters.iter().zip(self.widths) {
            let center = at + width * 0.5;
            at += width;
            let along =
                |offset: f32| if is_reversed { end - center - offset } else { start + center + offset };
            let reach = (width * 0.5).max(2.0);
            let tangent = point_at(piece, along(reach)).0 - point_at(piece, along(-reach)).0;
            let angle = tangent.y.atan2(tangent.x);
            let turned = |from: f32| ((angle - from + PI).rem_euclid(TAU) - PI).abs();
            if before.is_some_and(|before| turned(before) > self.bend) || turned(direction) > MOST_TURN {
                return None;
            }
            before = Some(angle);
            let up = Vec2::from_angle(angle - FRAC_PI_2) * self.lift;
            let center = point_at(piece, along(0.0)).0 + up;
            set.push(LineLetter { text: letter.clone(), center: Pos2::new(center.x, center.y), angle });
        }
        Some((is_reversed, set))
    }
}

fn letter_box(letter: &LineLetter, size: f32) -> Rect {
    Rect::from_center_size(letter.center, vec2(size * 0.9 * letter.text.chars().count() as f32, size * 0.9))
}

/// Where letters are painted for their halo, in points.
const HALO: [(f32, f32); 4] = [(-1.1, -0.6), (1.1, 0.6), (0.6, -1.1), (-0.6, 1.1)];

fn paint(painter: &Painter, name: &LineName, state: &NameState) {
    let halo = Color32::from_rgb(250, 248, 240).gamma_multiply(state.opacity * 0.8);
    let ink = name.ink.gamma_multiply(state.opacity);
    let letter = |letter: &LineLetter, offset: (f32, f32), color: Color32| {
        let galley = painter.layout_no_wrap(letter.text.clone(), name.font.clone(), color);
        let half = galley.size() * 0.5;
        let (sin, cos) = letter.angle.sin_cos();
        let corner = vec2(half.x * cos - half.y * sin, half.x * sin + half.y * cos);
        let at = letter.center - corner + vec2(offset.0, offset.1);
        painter.add(Shape::Text(TextShape::new(at, galley, color).with_angle(letter.angle)));
    };
    for offset in HALO {
        state.letters.iter().for_each(|set| letter(set, offset, halo));
    }
    state.letters.iter().for_each(|set| letter(set, (0.0, 0.0), ink));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(points: &[(f32, f32)]) -> Vec<NamePoint> {
        let mut piece: Vec<NamePoint> = Vec::new();
        for &(x, y) in points {
            let at = Vec2::new(x, y);
            let along = piece.last().map_or(0.0, |last| last.along + last.at.distance(at));
            piece.push(NamePoint { at, world: at.extend(0.0), station_m: along * 10.0, along });
        }
        piece
    }

    fn run<'a>(letters: &'a [String], widths: &'a [f32]) -> LetterRun<'a> {
        LetterRun { letters, widths, lift: 6.0, bend: MOST_BEND, was_reversed: false }
    }

    #[test]
    fn letters_are_read_from_the_left_whichever_way_the_line_runs() {
        let (letters, widths) = (["a", "b", "c"].map(String::from), [10.0; 3]);
        for (points, reversed) in
            [([(0.0, 50.0), (100.0, 60.0)], false), ([(100.0, 60.0), (0.0, 50.0)], true)]
        {
            let (is_reversed, set) = run(&letters, &widths).set(&piece(&points), 50.0).expect("straight");
            assert_eq!(is_reversed, reversed);
            assert!(set[0].center.x < set[1].center.x && set[1].center.x < set[2].center.x, "{set:?}");
            assert!(set.iter().all(|letter| letter.angle.abs() < 0.2), "{set:?}");
            assert!(set.iter().all(|letter| letter.center.y < 55.0), "above the line: {set:?}");
        }
    }

    #[test]
    fn a_sharp_bend_and_a_short_line_take_no_name() {
        let (letters, widths) = (["a", "b", "c", "d"].map(String::from), [10.0; 4]);
        let bent = piece(&[(0.0, 0.0), (50.0, 0.0), (50.0, 60.0)]);
        assert!(run(&letters, &widths).set(&bent, 50.0).is_none());
        assert!(run(&letters, &widths).set(&bent, 22.0).is_some(), "beside the bend");
        assert!(run(&letters, &widths).set(&bent, 10.0).is_none(), "past its end");
    }

    #[test]
    fn a_place_on_the_ground_is_found_again_on_the_picture() {
        let piece = piece(&[(0.0, 0.0), (30.0, 40.0), (60.0, 40.0)]);
        let (at, world, station_m) = point_at(&piece, 65.0);
        assert_eq!((at, station_m), (Vec2::new(45.0, 40.0), 650.0));
        assert_eq!(world, at.extend(0.0));
        assert_eq!(along_at(&piece, 650.0), Some(65.0));
        assert_eq!(along_at(&piece, 900.0), None);
    }
}
