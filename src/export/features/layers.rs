//! The layers of a scene: what it shows, as points, lines and polygons of its map.

use glam::{DVec2, DVec3, IVec2};
use serde_json::Value;

use super::features_of::{MapPlaces, feature, meters, properties};
use super::outlines::{of_plan, of_solid};
use super::{ExportFeature, ExportKind, ExportLayer, ExportShape, LayerLook};
use sandtable_annotate::nice::NiceNumber;
use sandtable_base::message::choice::Choice;
use sandtable_description::words::{GraphicSide, GraphicStatus};
use sandtable_draw::color::Srgba;
use sandtable_geom::cell_outlines::cell_outlines;
use sandtable_geom::isolines::{ValueGrid, isolines};
use sandtable_geom::rect::Rect;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::scene_graphic::SceneGraphic;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::seen_ground::{PostFrame, SeenPosts};
use sandtable_symbology::graphic::drawing::TextCourse;
use sandtable_symbology::texts::TEXT_FIELDS;
use sandtable_terrain::lattice::Post;
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_terrain::sight::viewshed::PostVisibility;
use sandtable_vector::overlay_schema as schema;

/// The text height of drawn graphics as a share of their size: teeth and dashes as on a sheet that shows each whole.
const TEXT_SHARE: f64 = 1.0 / 40.0;
/// Contours of a scene without any: about this many over its heights.
const CONTOURS: f32 = 20.0;
/// More lines across one cell are not told apart.
const MOST_IN_CELL: usize = 64;

/// All layers that hold a feature.
pub(super) fn layers(scene: &SceneModel) -> Vec<ExportLayer> {
    let places = MapPlaces { scene };
    let mut layers = Vec::new();
    let mut add = |name,
                   kind,
                   label,
                   (stroke, width_mm, fill): (u32, f32, Option<u32>),
                   features: Vec<ExportFeature>| {
        if !features.is_empty() {
            let look = LayerLook { stroke: rgb(stroke), width_mm, fill: fill.map(faint) };
            layers.push(ExportLayer { name, kind, label, look, features });
        }
    };
    use ExportKind::{Lines, Points, Polygons};
    add(
        "areas",
        Polygons,
        "name",
        (0x4f_6b_3a, 0.1, Some(0x6f_8f_4f)),
        ribbons(&places, &[FeatureKind::Area]),
    );
    add(
        "lakes",
        Polygons,
        "name",
        (0x1b_5a_8c, 0.2, Some(0x6f_a8_d6)),
        ribbons(&places, &[FeatureKind::Lake]),
    );
    add(
        "rivers",
        Polygons,
        "name",
        (0x1b_5a_8c, 0.2, Some(0x6f_a8_d6)),
        ribbons(&places, &[FeatureKind::River]),
    );
    add(
        "roads",
        Polygons,
        "name",
        (0x5a_3c_1e, 0.2, Some(0xc8_a0_6e)),
        ribbons(&places, &[FeatureKind::Road]),
    );
    add("centerlines", Lines, "name", (0x8a_2c_1e, 0.4, None), centerlines(&places));
    let [cuts, fills] = earthworks(&places);
    add("cuts", Polygons, "", (0x8c_3a_14, 0.2, Some(0xd2_78_3c)), cuts);
    add("fills", Polygons, "", (0x3c_5a_14, 0.2, Some(0x96_b4_50)), fills);
    add("contours", Lines, "elevation", (0x8c_5a_28, 0.15, None), contours(&places));
    add(
        "buildings",
        Polygons,
        "name",
        (0x30_30_30, 0.2, Some(0x90_88_80)),
        solids(&places, FeatureKind::Building),
    );
    add(
        "bridges",
        Polygons,
        "name",
        (0x30_30_30, 0.3, Some(0xb0_b0_b0)),
        solids(&places, FeatureKind::Bridge),
    );
    let [spots, labels] = labels(&places);
    add("spot_heights", Points, "text", (0x40_30_20, 0.8, None), spots);
    add("labels", Points, "text", (0x20_20_20, 0.8, None), labels);
    let [seen, hidden] = viewsheds(&places);
    add("seen", Polygons, "name", (0x00_82_28, 0.1, Some(0x3c_c8_46)), seen);
    add("hidden", Polygons, "name", (0x18_14_34, 0.1, Some(0x18_14_34)), hidden);
    add("sight_lines", Lines, "name", (0x00_82_28, 0.5, None), sights(&places));
    add("ranges", Lines, "name", (0x08_28_8c, 0.4, None), ranges(&places));
    let [points, lines, areas] = graphics(&places);
    add("graphic_areas", Polygons, "unique_designation", (0x08_28_8c, 0.5, None), areas);
    add("graphic_lines", Lines, "unique_designation", (0x08_28_8c, 0.5, None), lines);
    add("graphic_points", Points, "unique_designation", (0x08_28_8c, 1.5, None), points);
    let [drawn, texts] = drawn_graphics(&places);
    add("graphics_drawn", Lines, "", (0x08_28_8c, 0.5, None), drawn);
    add("graphic_texts", Points, "text", (0x08_28_8c, 0.5, None), texts);
    add("symbols", Points, "unique_designation", (0x00_00_00, 2.0, None), symbols(&places));
    layers
}

fn rgb(number: u32) -> Srgba {
    let [_, red, green, blue] = number.to_be_bytes();
    Srgba::opaque(red, green, blue)
}

/// The color of an area through which a map shows.
fn faint(number: u32) -> Srgba {
    let Srgba([red, green, blue, _]) = rgb(number);
    Srgba([red, green, blue, 110])
}

fn is_of(scene: &SceneModel, feature: sandtable_draw::list::FeatureId, kinds: &[FeatureKind]) -> bool {
    let found = feature.index().and_then(|index| scene.features.get(index));
    found.is_some_and(|feature| kinds.contains(&feature.kind))
}

/// What lies on the ground, each ribbon with its outline.
fn ribbons(places: &MapPlaces<'_>, kinds: &[FeatureKind]) -> Vec<ExportFeature> {
    let ribbons = places.scene.ribbons.iter().filter(|ribbon| is_of(places.scene, ribbon.feature, kinds));
    ribbons
        .flat_map(|ribbon| {
            let surface = Value::from(format!("{:?}", ribbon.surface).to_lowercase());
            of_plan(&ribbon.plan).into_iter().map(move |rings| {
                let named = properties([("name", places.name(ribbon.feature)), ("surface", surface.clone())]);
                feature(places.polygon(&rings), named)
            })
        })
        .collect()
}

/// The centerlines of roads and rivers with their heights and widths.
fn centerlines(places: &MapPlaces<'_>) -> Vec<ExportFeature> {
    let scene = places.scene;
    let line = |symbol: &sandtable_scene::symbols::LineSymbol| {
        let points = symbol.alignment.line.points();
        let kind = symbol.feature.index().and_then(|index| scene.features.get(index));
        let kind = kind.map_or("", |feature| feature.kind.noun(1));
        let shape = ExportShape::Line(points.iter().map(|&at| on_ground(places, at)).collect());
        feature(shape, properties([("name", places.name(symbol.feature)), ("kind", Value::from(kind))]))
    };
    scene.symbols.iter().map(line).collect()
}

/// A place in world space with the height of the ground there.
fn on_ground(places: &MapPlaces<'_>, at: DVec2) -> DVec3 {
    let flat = places.flat(at);
    let height = ground_height(&places.scene.lattice, Interpolation::Planar, flat.truncate()).height_m();
    flat.truncate().extend(height.unwrap_or(f64::NAN))
}

/// Where the ground was cut, and where it was filled: squares around the posts whose height changed.
fn earthworks(places: &MapPlaces<'_>) -> [Vec<ExportFeature>; 2] {
    let lattice = &places.scene.lattice;
    let (columns, rows) = (lattice.columns() as usize, lattice.rows() as usize);
    if places.scene.dug.is_empty() || lattice.heights().len() != columns * rows {
        return [Vec::new(), Vec::new()];
    }
    let mut rise = vec![0.0f32; columns * rows];
    // The first change of a post knows its height before all.
    for change in places.scene.dug.iter().rev() {
        for post in change.posts.posts() {
            let index = lattice.index(post);
            let before = change.height_before(post);
            if before.is_finite() {
                rise[index] = lattice.heights()[index] - before;
            }
        }
    }
    let frame = PostFrame::of(lattice);
    let cell_m2 = frame.cell.x.abs() * frame.cell.y.abs();
    [-1.0f32, 1.0].map(|sign| {
        let is_inside = |x: usize, y: usize| rise[y * columns + x] * sign > 0.005;
        let parts = cell_outlines(columns, rows, is_inside);
        let to_feature = |part: sandtable_geom::cell_outlines::CellOutline| {
            let rings: Vec<Vec<DVec2>> = std::iter::once(&part.exterior)
                .chain(&part.holes)
                .map(|ring| corners(&frame, ring))
                .collect();
            let area: f64 = rings.iter().map(|ring| sandtable_geom::polygon::doubled_area(ring) * 0.5).sum();
            let posts = area / cell_m2;
            let shape = ExportShape::Polygon(
                rings
                    .into_iter()
                    .map(|ring| ring.into_iter().map(|at| at.extend(f64::NAN)).collect())
                    .collect(),
            );
            feature(shape, properties([("area_m2", meters(area)), ("posts", Value::from(posts.round()))]))
        };
        parts.into_iter().map(to_feature).collect()
    })
}

/// Corners of the squares around posts as map coordinates.
fn corners(frame: &PostFrame, ring: &[IVec2]) -> Vec<DVec2> {
    let first = frame.map_position(Post { column: 0, row: 0 });
    ring.iter().map(|corner| first + (corner.as_dvec2() - 0.5) * frame.cell).collect()
}

/// Lines of equal height: at the interval of the scene, or of the heights.
fn contours(places: &MapPlaces<'_>) -> Vec<ExportFeature> {
    let (scene, lattice) = (places.scene, &places.scene.lattice);
    let columns = lattice.columns() as usize;
    if lattice.heights().len() != columns * lattice.rows() as usize {
        return Vec::new();
    }
    let (low, high) = scene.height_range_m;
    let stated = scene.contours.as_ref().map(|contours| contours.interval_m);
    let interval = stated.unwrap_or_else(|| nice_interval((high - low) / CONTOURS));
    let frame = PostFrame::of(lattice);
    let first = frame.map_position(Post { column: 0, row: 0 });
    let grid = ValueGrid { columns, values: lattice.heights() };
    let line = |line: sandtable_geom::isolines::Isoline| {
        let elevation = line.level as f64 * f64::from(interval);
        let mut points: Vec<DVec3> =
            line.points.iter().map(|at| (first + *at * frame.cell).extend(elevation)).collect();
        points.dedup();
        feature(ExportShape::Line(points), properties([("elevation", meters(elevation))]))
    };
    let lines = isolines(&grid, interval, MOST_IN_CELL, |_, _| true).into_iter().map(line);
    lines.filter(|line| line.shape.vertices().nth(1).is_some()).collect()
}

/// 1, 2 or 5 times a power of ten, not below a length.
fn nice_interval(least: f32) -> f32 {
    NiceNumber::at_least(f64::from(least).max(1e-3)).map_or(1.0, |nice| nice.value() as f32)
}

/// What solids cover, with their heights.
fn solids(places: &MapPlaces<'_>, kind: FeatureKind) -> Vec<ExportFeature> {
    let scene = places.scene;
    let of_kind = scene.solids.iter().filter(|solid| is_of(scene, solid.feature, &[kind]));
    of_kind
        .flat_map(|solid| {
            let (polygons, [low, high]) = of_solid(&solid.mesh);
            let heights = [low, high].map(|z| scene.scale.elevation_m(z));
            polygons.into_iter().map(move |rings| {
                let named = properties([
                    ("name", places.name(solid.feature)),
                    ("base", meters(heights[0])),
                    ("top", meters(heights[1])),
                    ("height", meters(heights[1] - heights[0])),
                ]);
                feature(places.polygon(&rings), named)
            })
        })
        .collect()
}

/// Spot heights, and names.
fn labels(places: &MapPlaces<'_>) -> [Vec<ExportFeature>; 2] {
    // The scene file states names, and not the heights that are found.
    [true, false].map(|spots| {
        let of_kind = places.scene.labels.iter().filter(|label| label.stated.is_empty() == spots);
        let point = |label: &sandtable_scene::scene_label::SceneLabel| {
            let at = places.at(label.ground);
            let kind = Value::from(label.kind.word());
            feature(
                ExportShape::Point(at),
                properties([
                    ("text", Value::from(label.text.as_str())),
                    ("kind", kind),
                    ("elevation", meters(at.z)),
                ]),
            )
        };
        of_kind.map(point).collect()
    })
}

/// The ground that observers see, and that which they do not.
fn viewsheds(places: &MapPlaces<'_>) -> [Vec<ExportFeature>; 2] {
    let scene = places.scene;
    let layers = scene.sight.viewsheds.iter().filter_map(|layer| Some((layer, layer.seen(&scene.lattice)?)));
    let all: Vec<_> = layers.collect();
    [PostVisibility::Visible, PostVisibility::Hidden].map(|wanted| {
        let mut features = Vec::new();
        for (layer, SeenPosts { viewshed, frame }) in &all {
            let columns = viewshed.columns as usize;
            let parts = cell_outlines(columns, viewshed.rows as usize, |x, y| {
                viewshed.posts[y * columns + x] == wanted
            });
            for part in parts {
                let rings = std::iter::once(&part.exterior).chain(&part.holes);
                let ring = |ring: &Vec<IVec2>| {
                    corners(frame, ring).into_iter().map(|at| at.extend(f64::NAN)).collect()
                };
                let shape = ExportShape::Polygon(rings.map(ring).collect());
                features.push(feature(shape, properties([("name", Value::from(layer.name.as_str()))])));
            }
        }
        features
    })
}

/// Lines of sight, each stretch with whether it is in sight.
fn sights(places: &MapPlaces<'_>) -> Vec<ExportFeature> {
    let scene = places.scene;
    let mut features = Vec::new();
    for sight in &scene.sight.sights {
        for (target, found) in sight.targets.iter().zip(sight.lines(&scene.lattice).iter()) {
            let Some(found) = found else { continue };
            let clear = if found.is_clear { "clear" } else { "blocked" };
            let on_map = |at: DVec2| {
                let height =
                    ground_height(&scene.lattice, Interpolation::Planar, at).height_m().unwrap_or(f64::NAN);
                at.extend(height)
            };
            let shape = ExportShape::Line(vec![on_map(sight.observer.at), on_map(target.at)]);
            let named = properties([
                ("name", Value::from(sight.name.as_str())),
                ("sight", Value::from(clear)),
                ("observer_height", meters(sight.observer.above_m)),
                ("target_height", meters(target.above_m)),
            ]);
            features.push(feature(shape, named));
        }
    }
    features
}

fn ranges(places: &MapPlaces<'_>) -> Vec<ExportFeature> {
    let rings = places.scene.sight.ranges.iter().flat_map(|range| {
        range.distances_m.iter().map(move |&distance| {
            let named = properties([
                ("name", Value::from(range.name.as_str())),
                ("distance", meters(distance)),
                ("side", Value::from(range.side.word())),
            ]);
            feature(places.line(&range.ring(distance)), named)
        })
    });
    rings.collect()
}

/// The control points of graphics, by the shape they make.
fn graphics(places: &MapPlaces<'_>) -> [Vec<ExportFeature>; 3] {
    let mut by_shape = [Vec::new(), Vec::new(), Vec::new()];
    for graphic in &places.scene.graphics {
        let (index, shape) = match (graphic.points.len(), graphic.kind.is_area()) {
            (1, _) => (0, ExportShape::Point(on_ground(places, graphic.points[0]))),
            (_, true) => {
                let holes = graphic.style.iter().flat_map(|style| style.holes.iter().cloned());
                let rings: Vec<Vec<DVec2>> = std::iter::once(graphic.points.clone()).chain(holes).collect();
                (2, places.polygon(&rings))
            }
            (_, false) => (1, places.line(&graphic.points)),
        };
        by_shape[index].push(feature(shape, graphic_properties(places, graphic)));
    }
    by_shape
}

fn graphic_properties(places: &MapPlaces<'_>, graphic: &SceneGraphic) -> serde_json::Map<String, Value> {
    let fields = &graphic.fields;
    let text = |text: &str| Value::from(text);
    let numbers = |list: &[f64]| Value::from(list.iter().map(f64::to_string).collect::<Vec<_>>().join(" "));
    let mut all = properties([
        (schema::SIDC, Value::from(graphic_code(graphic).unwrap_or_default())),
        (schema::KIND, text(graphic.kind.word)),
        (schema::NAME, places.name(graphic.feature)),
        (schema::IDENTITY, text(graphic.side.word())),
        (schema::STATUS, text(graphic.status.word())),
        (schema::UNIQUE_DESIGNATION, text(&fields.designation)),
        (schema::DESIGNATION_2, text(&fields.designation_2)),
        (schema::ECHELON, text(&fields.echelon)),
        (schema::COUNTRY, text(&fields.country)),
        (schema::HOSTILE, text(&fields.hostile)),
        (schema::ADDITIONAL_INFORMATION, text(&fields.further)),
        (schema::TARGET, text(&fields.target)),
        (schema::DTG, text(&fields.from)),
        (schema::DTG_2, text(&fields.until)),
        (schema::DISTANCES, numbers(&fields.distances_m)),
        (schema::AZIMUTHS, numbers(&fields.azimuths_deg)),
        (schema::WIDTH, graphic.width_m.map_or(Value::Null, meters)),
    ]);
    if let Some(style) = &graphic.style {
        all.remove(schema::IDENTITY);
        let hex =
            |Srgba([red, green, blue, _]): Srgba| Value::from(format!("#{red:02x}{green:02x}{blue:02x}"));
        let opacity =
            |Srgba([.., alpha]): Srgba| Value::from((f64::from(alpha) / 255.0 * 1000.0).round() / 1000.0);
        let stated = properties([
            (schema::STROKE, style.stroke.map_or(Value::from("none"), hex)),
            (schema::STROKE_OPACITY, style.stroke.map_or(Value::Null, opacity)),
            (schema::STROKE_WIDTH, Value::from(style.width_px)),
            (schema::STROKE_DASHES, Value::from(if style.is_dashed { "6,4" } else { "" })),
            (schema::FILL, style.fill.map_or(Value::from("none"), hex)),
            (schema::FILL_OPACITY, style.fill.map_or(Value::Null, opacity)),
        ]);
        all.extend(stated);
    }
    all
}

/// The code of a graphic; `None` for what is no control measure.
pub(super) fn graphic_code(graphic: &SceneGraphic) -> Option<String> {
    if graphic.kind.code.is_empty() {
        return None;
    }
    let identity = match graphic.side {
        GraphicSide::Friend => 3,
        GraphicSide::Hostile => 6,
        GraphicSide::Neutral => 4,
        GraphicSide::Unknown => 1,
    };
    let status = u8::from(graphic.status == GraphicStatus::Planned);
    Some(format!("100{identity}{:02}{status}000{}0000", graphic.kind.set, graphic.kind.code))
}

/// The lines of graphics as the standard draws them, and their texts.
fn drawn_graphics(places: &MapPlaces<'_>) -> [Vec<ExportFeature>; 2] {
    let (mut lines, mut texts) = (Vec::new(), Vec::new());
    for graphic in places.scene.graphics.iter().filter(|graphic| graphic.style.is_none()) {
        let size_m = Rect::around(graphic.points.iter().copied()).size().length();
        let reach_m = graphic.fields.distances_m.iter().copied().fold(0.0, f64::max);
        let em_m = (size_m.max(reach_m) * TEXT_SHARE).max(1.0);
        let drawing = graphic.kind.draw(&graphic.input(em_m, DVec2::Y));
        let of = || {
            properties([
                (schema::KIND, Value::from(graphic.kind.word)),
                (schema::SIDC, Value::from(graphic_code(graphic).unwrap_or_default())),
                (schema::IDENTITY, Value::from(graphic.side.word())),
            ])
        };
        lines.extend(drawing.strokes.iter().map(|stroke| feature(places.line(&stroke.points), of())));
        for text in &drawing.texts {
            let at = match &text.course {
                TextCourse::Level => text.at,
                TextCourse::Ends(line) | TextCourse::Once(line) | TextCourse::Repeated(line) => {
                    line[line.len() / 2]
                }
            };
            let mut named = of();
            named.insert("text".to_owned(), Value::from(text.text.as_str()));
            texts.push(feature(ExportShape::Point(places.flat(at)), named));
        }
    }
    [lines, texts]
}

fn symbols(places: &MapPlaces<'_>) -> Vec<ExportFeature> {
    let symbol = |(index, symbol): (usize, &sandtable_scene::military::SceneSymbol)| {
        let direction =
            symbol.direction_rad.map_or(Value::Null, |angle| meters(f64::from(angle.to_degrees())));
        let mut named = properties([
            (schema::SIDC, Value::from(symbol.code.digits())),
            (schema::NAME, Value::from(symbol.name.as_str())),
            (schema::DIRECTION, direction),
        ]);
        for (field, text) in &symbol.fields {
            if let Some(row) = TEXT_FIELDS.iter().find(|row| row.field == *field) {
                named.insert(row.key.to_owned(), Value::from(text.as_str()));
            }
        }
        let shape = ExportShape::Point(places.at(symbol.ground));
        ExportFeature { shape, properties: named, symbol: Some(index) }
    };
    places.scene.military.iter().enumerate().map(symbol).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_round_and_not_below_what_is_needed() {
        for (least, expected) in
            [(0.9, 1.0), (1.0, 1.0), (1.1, 2.0), (17.0, 20.0), (21.0, 50.0), (0.03, 0.05)]
        {
            assert!((nice_interval(least) / expected - 1.0).abs() < 1e-5, "{least}");
        }
    }
}
