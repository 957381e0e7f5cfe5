//! Names along lines and across areas, projected to the picture.

use glam::{DVec2, Vec2, Vec3};

use sandtable_annotate::annotation::{LineLabel, LinePlacement, PictureLabel};
use sandtable_draw::list::FeatureId;
use sandtable_geom::axis::axis;
use sandtable_geom::polygon::inner_point;
use sandtable_geom::rect::Rect;
use sandtable_render::picture::Rendering;
use sandtable_scene::label_course::LabelCourse;
use sandtable_scene::scene_label::SceneLabel;
use sandtable_view::camera::{Camera, Projected};

/// How far the drawn width of a line is looked for to each side, in pixels.
const WIDEST_PX: i64 = 48;
/// Places along a line at which its drawn width is measured.
const WIDTHS: usize = 15;
/// Hidden stretches of a line shorter than this many vertices do not break it: a tree or a mast before it.
const SHORTEST_BREAK: usize = 2;

/// The label of `scene` as one along a line; `None` for a label at a place. `fallback` is drawn where no letters fit.
pub fn line_label(
    label: &SceneLabel,
    fallback: Option<PictureLabel>,
    camera: &Camera,
    picture: &Rendering,
) -> Option<LineLabel> {
    let (path_px, placement, half_width_px) = match &label.course {
        LabelCourse::Place => return None,
        LabelCourse::Along(lines) => {
            let pieces: Vec<Vec<Vec2>> =
                lines.iter().flat_map(|line| visible_pieces(line, camera, picture)).collect();
            let half_width = drawn_half_width(&pieces, picture);
            (pieces, LinePlacement::Repeated, half_width)
        }
        LabelCourse::Across(rings) => {
            let axes = rings.iter().flat_map(|ring| area_axes(ring, camera, picture)).collect();
            (axes, LinePlacement::Spread, 0.0)
        }
    };
    Some(LineLabel {
        text: label.text.clone(),
        path_px,
        half_width_px,
        placement,
        kind: label.kind,
        ink: None,
        rank: label.rank,
        size: label.size,
        shield: label.shield,
        // A number without its shield says nothing.
        fallback: fallback.filter(|_| label.shield.is_none()),
    })
}

/// The parts of a world line that the picture shows, in pixels.
pub fn visible_pieces(line: &[Vec3], camera: &Camera, picture: &Rendering) -> Vec<Vec<Vec2>> {
    let mut pieces: Vec<Vec<Vec2>> = Vec::new();
    let mut hidden: Vec<Vec2> = Vec::new();
    let mut is_broken = true;
    for &at in line {
        let seen = camera.project(at);
        match seen.filter(|at| is_seen(picture, at.pixel, at.depth_m)) {
            Some(at) if is_broken || hidden.len() > SHORTEST_BREAK => {
                pieces.push(vec![at.pixel]);
                (is_broken, hidden) = (false, Vec::new());
            }
            Some(at) => {
                let piece = pieces.last_mut().expect("a piece was begun where the line was last broken");
                piece.append(&mut hidden);
                piece.push(at.pixel);
            }
            None => match seen {
                Some(at) => hidden.push(at.pixel),
                None => is_broken = true,
            },
        }
    }
    pieces.retain(|piece| piece.len() >= 2);
    pieces
}

/// Whether a place is in front of, or within 2 % of, the depth of one of the pixels around it. The drawn ground may be
/// off by its tolerance, and the pixel of a summit may show the ground behind it.
pub fn is_seen(picture: &Rendering, pixel: Vec2, depth_m: f32) -> bool {
    let (width, height) = (i64::from(picture.pixels.width()), i64::from(picture.pixels.height()));
    // A place near the plane of the eye may project beyond the range of an i32.
    let (column, row) = (i64::from(pixel.x.floor() as i32), i64::from(pixel.y.floor() as i32));
    (-2..=1).any(|up| {
        (-1..=1).any(|aside| {
            let (x, y) = (column + aside, row + up);
            let inside = (0..width).contains(&x) && (0..height).contains(&y);
            inside && picture.depth_m[(y * width + x) as usize] >= depth_m * 0.98
        })
    })
}

/// Half of the width with which lines are drawn: the median of some places; 0 where they are not drawn.
fn drawn_half_width(pieces: &[Vec<Vec2>], picture: &Rendering) -> f32 {
    let Some(longest) = pieces.iter().max_by_key(|piece| piece.len()) else { return 0.0 };
    let mut widths: Vec<f32> = (0..WIDTHS)
        .filter_map(|number| {
            let index = number * (longest.len() - 1) / WIDTHS;
            let across = (longest[index + 1] - longest[index]).perp().try_normalize()?;
            Some(drawn_width_at(longest[index], across, picture))
        })
        .collect();
    widths.sort_by(f32::total_cmp);
    widths.get(widths.len() / 2).map_or(0.0, |width| width * 0.5)
}

/// The pixels across a line at `at` that show the feature that the pixel there shows.
fn drawn_width_at(at: Vec2, across: Vec2, picture: &Rendering) -> f32 {
    let (width, height) = (i64::from(picture.pixels.width()), i64::from(picture.pixels.height()));
    let feature = |at: Vec2| {
        let (x, y) = (i64::from(at.x.floor() as i32), i64::from(at.y.floor() as i32));
        let inside = (0..width).contains(&x) && (0..height).contains(&y);
        inside.then(|| picture.features[(y * width + x) as usize])
    };
    let Some(own) = feature(at).filter(|own| own.index().is_some() && *own != FeatureId::NONE) else {
        return 0.0;
    };
    let reach = |side: f32| {
        (1..=WIDEST_PX).take_while(|&n| feature(at + across * (n as f32 * side)) == Some(own)).count()
    };
    (reach(1.0) + reach(-1.0) + 1) as f32
}

/// The axis of an area on the picture and, for where that is too bent, its widest level span; none where less than most
/// of it is seen.
fn area_axes(ring: &[Vec3], camera: &Camera, picture: &Rendering) -> Vec<Vec<Vec2>> {
    let Some(seen) = ring.iter().map(|&at| camera.project(at)).collect::<Option<Vec<Projected>>>() else {
        return Vec::new();
    };
    let size = DVec2::new(picture.pixels.width().into(), picture.pixels.height().into());
    let inside = seen.iter().map(|at| at.pixel.as_dvec2().clamp(DVec2::ZERO, size));
    let outline: Vec<DVec2> = inside.collect();
    let depths = seen.iter().map(|at| at.depth_m);
    let (near, far) = depths.fold((f32::MAX, 0.0f32), |(near, far), depth| (near.min(depth), far.max(depth)));
    let middles = axis(&outline);
    let shown = |at: &DVec2| {
        let (x, y) = (at.x as usize, at.y as usize);
        let depth = picture.depth_m.get(y * picture.pixels.width() as usize + x);
        depth.is_some_and(|depth| (near * 0.97..=far * 1.03).contains(depth))
    };
    let count = middles.iter().filter(|at| shown(at)).count();
    /// Less of an area seen is another hill's foreground.
    const LEAST_SEEN: f32 = 0.8;
    if middles.len() < 2 || (count as f32) < LEAST_SEEN * middles.len() as f32 {
        return Vec::new();
    }
    let picture_rect = Rect { min: DVec2::ZERO, max: size };
    let span = inner_point([outline.as_slice()], &picture_rect).map(|(middle, width)| {
        let half = Vec2::new(width as f32 * 0.5, 0.0);
        vec![middle.as_vec2() - half, middle.as_vec2() + half]
    });
    std::iter::once(middles.iter().map(|at| at.as_vec2()).collect()).chain(span).collect()
}
