//! The texts of a sheet's margin: facts on the coordinates, sources, the three norths, the locator.

use glam::{DVec2, UVec2, Vec2, Vec3};

use sandtable_analysis::outcome::{GRID_REFERENCE, OutcomeTable};
use sandtable_annotate::locator::LocatorMap;
use sandtable_annotate::margin::MarginNotes;
use sandtable_annotate::margin_table::MarginTable;
use sandtable_annotate::nice::format_trimmed;
use sandtable_annotate::norths::ThreeNorths;
use sandtable_annotate::sheet_frame::SheetFrame;
use sandtable_description::words::{GridName, SheetLayout};
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;
use sandtable_geom::crs::Crs;
use sandtable_geom::declination::{convergence_deg, declination};
use sandtable_geom::mgrs::GridZone;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::full_resolution::FullResolution;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_view::camera::Camera;

/// The longer side of the locator as a share of the page's lesser side.
const LOCATOR_SHARE: f64 = 0.15;
/// The rise that shades the locator's relief fully, of a cell of it.
const STEEP: f64 = 0.5;
/// The light of level ground on it.
const LEVEL: f64 = 0.86;

/// The notes for a page; the norths are those at the map coordinates `middle`.
pub fn margin_notes(
    scene: &SceneModel,
    camera: &Camera,
    (frame, middle): (&SheetFrame, DVec2),
    grid: Option<&str>,
) -> MarginNotes {
    let furniture = &scene.furniture;
    let is_military = furniture.layout == SheetLayout::Military;
    MarginNotes {
        frame: frame.clone(),
        classification: furniture.classification.clone(),
        facts: facts(scene, grid),
        sources: sources(scene),
        tables: tables(scene),
        norths: if is_military { norths(scene, middle) } else { None },
        locator: Some(locator(scene, camera, frame)),
    }
}

fn facts(scene: &SceneModel, grid: Option<&str>) -> Vec<String> {
    let mut facts = Vec::new();
    if !scene.crs.proj_text().is_empty() {
        let (major_m, minor_m) = scene.crs.ellipsoid();
        let flattening = if major_m == minor_m {
            "sphere".to_owned()
        } else {
            format!("1/{}", format_trimmed(major_m / (major_m - minor_m), 3))
        };
        facts.push(system_name(&scene.crs));
        facts.push(format!("Ellipsoid {} m, {flattening}", format_trimmed(major_m, 1)));
    }
    facts.extend(grid.map(str::to_owned));
    let datum = scene.heights.snapshot().source_header().vertical_datum.clone();
    let datum = datum.map(|datum| format!(" above {datum}")).unwrap_or_default();
    let exaggeration = scene.scale.0;
    let stretched = match exaggeration == 1.0 {
        true => "true to scale".to_owned(),
        false => format!("drawn ×{}", format_trimmed(exaggeration.into(), 2)),
    };
    facts.push(format!("Heights in meters{datum}, {stretched}"));
    facts
}

/// The code of a system and what is known of it in words.
fn system_name(crs: &Crs) -> String {
    let name = crs.name();
    match crs.epsg() {
        Some(code @ 32601..=32660) => format!("WGS 84 / UTM zone {} N ({name})", code - 32600),
        Some(code @ 32701..=32760) => format!("WGS 84 / UTM zone {} S ({name})", code - 32700),
        Some(5041) => format!("WGS 84 / UPS North ({name})"),
        Some(5042) => format!("WGS 84 / UPS South ({name})"),
        _ => format!("Coordinates {name}"),
    }
}

fn sources(scene: &SceneModel) -> Vec<String> {
    let furniture = &scene.furniture;
    let date = furniture.date.as_ref().map(|date| format!("Information as of {}", date.as_str()));
    let lines = furniture.sources.iter().flatten().cloned().chain(date);
    lines.chain(furniture.notes.iter().flatten().cloned()).collect()
}

/// The tables of the scene's analyses.
fn tables(scene: &SceneModel) -> Vec<MarginTable> {
    let all = scene.analyses.iter().flat_map(|analysis| {
        analysis.outcome.tables.iter().map(|table| (format!("{}: {}", table.title, analysis.name), table))
    });
    all.map(|(title, table)| margin_table(title, table)).collect()
}

fn margin_table(title: String, table: &OutcomeTable) -> MarginTable {
    let columns = table.columns.iter().map(|column| (column.name.to_owned(), column.unit.to_owned()));
    let mut margin = MarginTable { title, columns: columns.collect(), rows: table.written_rows().collect() };
    if let Some(column) = table.columns.iter().position(|column| column.name == GRID_REFERENCE) {
        shorten_references(&mut margin, column);
    }
    margin
}

/// Moves what the grid references of a column have in common, the zone or the zone and the square, into the heading.
fn shorten_references(table: &mut MarginTable, column: usize) {
    let words = |row: &Vec<String>| row[column].split(' ').map(str::to_owned).collect::<Vec<_>>();
    let references: Vec<Vec<String>> = table.rows.iter().map(words).collect();
    let Some(first) = references.first() else { return };
    // Easting and northing stay.
    let most = references.iter().map(|words| words.len().saturating_sub(2)).min().unwrap_or(0);
    let common =
        (0..most).take_while(|&word| references.iter().all(|words| words[word] == first[word])).count();
    table.columns[column] = ("grid".to_owned(), first[..common].join(" "));
    for (row, words) in table.rows.iter_mut().zip(&references) {
        row[column] = words[common..].join(" ");
    }
}

/// The norths at map coordinates; `None` where they have no place on Earth.
fn norths(scene: &SceneModel, middle: DVec2) -> Option<ThreeNorths> {
    let place = scene.crs.transform(&Crs::wgs84(), middle).ok()?;
    let grid = match scene.grid {
        GridName::Utm | GridName::Mgrs => GridZone::at(place)?.crs()?,
        _ => scene.crs.clone(),
    };
    let (low_m, high_m) = scene.height_range_m;
    let height_m = f64::from(low_m.midpoint(high_m));
    let day = scene.sheet_day;
    let needle = day.and_then(|day| declination(place, height_m, day));
    let stated = scene.furniture.date.as_ref().map(|date| date.to_string()).unwrap_or_default();
    let magnetic_note = match (day, needle) {
        (None, _) => "MN: no date stated".to_owned(),
        (_, None) => format!("MN: no model of {stated}"),
        _ => format!("WMM, {stated}"),
    };
    Some(ThreeNorths {
        grid_deg: convergence_deg(&grid, place),
        magnetic_deg: needle.map(|needle| (needle.east_deg, needle.error_deg)),
        magnetic_note,
    })
}

/// The model in plan, with what the camera sees of it.
fn locator(scene: &SceneModel, camera: &Camera, frame: &SheetFrame) -> LocatorMap {
    let extent = scene.lattice.extent();
    let (page_x, page_y) = frame.page_size();
    let longer_px = (f64::from(page_x.min(page_y)) * LOCATOR_SHARE).max(16.0);
    let px_per_m = longer_px / extent.size().max_element();
    let size = (extent.size() * px_per_m).ceil().max(DVec2::splat(8.0));
    let world = |pixel: DVec2| extent.min + DVec2::new(pixel.x, size.y - pixel.y) / size * extent.size();
    let pixel = |world: Vec2| {
        let share = (world.as_dvec2() - extent.min) / extent.size();
        (DVec2::new(share.x, 1.0 - share.y) * size).as_vec2()
    };
    let ground = FullResolution { lattice: &scene.lattice };
    let height = |at: DVec2| ground.displayed_z(at.clamp(extent.min, extent.max));
    let UVec2 { x: width, y: height_px } = size.as_uvec2();
    let step_m = extent.size() / size;
    let (low_m, high_m) = scene.height_range_m;
    let steepness = (f64::from(high_m - low_m) / (extent.size().max_element() * 0.04)).max(1e-6);
    let relief = Pixels::from_fn(width, height_px, |x, y| {
        let at = world(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
        let (west, east) = (height(at - DVec2::X * step_m), height(at + DVec2::X * step_m));
        let (south, north) = (height(at - DVec2::Y * step_m), height(at + DVec2::Y * step_m));
        let (Some((west, east)), Some((south, north))) = (west.zip(east), south.zip(north)) else {
            return Srgba::WHITE;
        };
        // Light from the north-west; what rises toward it is lit.
        let slope = ((east - west) / step_m.x - (north - south) / step_m.y) / (2.0 * steepness);
        let light = LEVEL + (1.0 - LEVEL) * 1.6 * (slope / STEEP).clamp(-3.0, 1.0);
        let gray = (light.clamp(0.25, 1.0) * 255.0 + 0.5) as u8;
        Srgba::opaque(gray, gray, gray)
    });
    let eye = camera.parallel_frame().is_none().then(|| pixel(camera.eye().truncate()));
    LocatorMap { relief, seen: seen(scene, camera).into_iter().map(pixel).collect(), eye }
}

/// The corners, in world X and Y, of the level ground that a camera sees; as far as the model is long where it sees the
/// horizon.
fn seen(scene: &SceneModel, camera: &Camera) -> Vec<Vec2> {
    let (min, max) = scene.bounds;
    let z = min.z.midpoint(max.z);
    let far_m = (max - min).truncate().length() + (camera.eye() - (min + max) * 0.5).length();
    let (width, height) = camera.size();
    let (width, height) = (width as f32, height as f32);
    let on_ground = |pixel: Vec2| {
        let (from, ray): (Vec3, Vec3) = (camera.ray_origin(pixel), camera.ray_through(pixel));
        let level = ray.truncate().length().max(1e-6);
        let reach_m = if camera.parallel_frame().is_some() { f32::MAX } else { far_m / level };
        let depth_m = if ray.z < -1e-6 { (z - from.z) / ray.z } else { reach_m };
        (from + ray * depth_m.clamp(0.0, reach_m)).truncate()
    };
    [Vec2::new(0.0, height), Vec2::ZERO, Vec2::new(width, 0.0), Vec2::new(width, height)]
        .map(on_ground)
        .to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_square_that_grid_references_share_stands_in_the_heading() {
        let shortened = |references: [&str; 2]| {
            let mut table = MarginTable {
                title: String::new(),
                columns: vec![("zone".into(), String::new()), (GRID_REFERENCE.into(), String::new())],
                rows: references.map(|reference| vec!["LZ".into(), reference.into()]).into(),
            };
            shorten_references(&mut table, 1);
            let cells = table.rows.iter().map(|row| row[1].clone()).collect::<Vec<_>>();
            (table.columns[1].1.clone(), cells)
        };
        let texts = |unit: &str, cells: [&str; 2]| (unit.to_owned(), cells.map(str::to_owned).to_vec());
        assert_eq!(
            shortened(["16S GF 5000 1800", "16S GF 5120 1934"]),
            texts("16S GF", ["5000 1800", "5120 1934"])
        );
        assert_eq!(
            shortened(["16S GF 5000 1800", "16S GE 5120 9934"]),
            texts("16S", ["GF 5000 1800", "GE 5120 9934"])
        );
        let far = ["16S GF 5000 1800", "17S KA 5120 9934"];
        assert_eq!(shortened(far), texts("", far));
    }
}
