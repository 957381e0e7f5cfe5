//! The scene file's tables, key by key: which there are, what each may hold, and which exclude each other.

use std::collections::BTreeMap;
use std::sync::Arc;

use toml::Spanned;

use crate::description::bounds::{Bounds, ELEVATION};
use crate::description::decode_features as features;
use crate::description::document::{
    CameraTable, ContourTable, Document, FurnitureTable, LabelTable, LightTable, StyleTable, TerrainTable,
};
use crate::description::reader::TableReader;
use crate::description::source_text::SourceText;
use crate::description::styles::Styles;
use crate::geom::crs::Crs;

/// Compass directions in degrees.
pub(super) const DIRECTION: Bounds = Bounds::Within(-360.0, 360.0);

/// The whole file.
pub(super) fn document(reader: &mut TableReader<'_, '_>, source: Arc<SourceText>) -> Option<Document> {
    // Gathered before anything is read.
    let _ = reader.get("include", |item| item.one_or_more_texts());
    let title = plain_text(reader, "title");
    let subtitle = plain_text(reader, "subtitle");
    let crs = reader.get("crs", |item| item.crs(metric));
    let points_crs = any_crs(reader, "points_crs");
    let terrain = reader.require_table("terrain", terrain);
    let style = reader.table("style", style).unwrap_or_default();
    let styles = Styles::read_all(reader);
    let roads = styles.read(reader, "road", features::road);
    let bridges = styles.read(reader, "bridge", features::bridge);
    let rivers = styles.read(reader, "river", features::river);
    let lakes = styles.read(reader, "lake", features::lake);
    let areas = styles.read(reader, "area", features::area);
    let buildings = styles.read(reader, "building", features::building);
    let fences = styles.read(reader, "fence", features::fence);
    let models = styles.read(reader, "model", features::model);
    let scatters = styles.read(reader, "scatter", features::scatter);
    let labels = reader.tables("label", label);
    let cameras = reader.tables("camera", camera);
    distinct_names(reader, &source, &cameras);
    let furniture = reader.table("furniture", furniture).unwrap_or_default();
    let terrain = terrain.flatten()?;
    Some(Document {
        source,
        title,
        subtitle,
        crs,
        points_crs,
        terrain,
        style,
        roads,
        bridges,
        rivers,
        lakes,
        areas,
        buildings,
        fences,
        models,
        scatters,
        labels,
        cameras,
        furniture,
    })
}

fn terrain(reader: &mut TableReader<'_, '_>) -> Option<TerrainTable> {
    let dem = reader.require("dem", |item| item.files(&[]));
    let crs = any_crs(reader, "crs");
    let height_scale = number(reader, "height_scale", Bounds::Above(0.0, 1e6));
    let height_offset = number(reader, "height_offset", ELEVATION);
    let height_encoding = reader.get("height_encoding", |item| item.word());
    let raw = reader.get("raw", |item| item.filled_text());
    let vertical_datum = reader.get("vertical_datum", |item| item.filled_text());
    let fill_voids = reader.get("fill_voids", |item| item.switch());
    let cell = number(reader, "cell", Bounds::Above(0.0, 1e6));
    let vertical_exaggeration = number(reader, "vertical_exaggeration", Bounds::Above(0.0, 1000.0));
    let tolerance_px = number(reader, "tolerance_px", Bounds::Above(0.0, 1000.0));
    Some(TerrainTable {
        dem: dem?,
        crs,
        height_scale,
        height_offset,
        height_encoding,
        raw,
        vertical_datum,
        fill_voids,
        cell,
        vertical_exaggeration,
        tolerance_px,
    })
}

fn style(reader: &mut TableReader<'_, '_>) -> StyleTable {
    StyleTable {
        ramp: reader.get("ramp", |item| item.ramp()),
        contours: reader.table("contours", contours).flatten(),
        light: reader.table("light", light).unwrap_or_default(),
        haze: number(reader, "haze", Bounds::Within(0.0, 1e9)),
    }
}

fn contours(reader: &mut TableReader<'_, '_>) -> Option<ContourTable> {
    let interval = reader.require("interval", |item| item.number(Bounds::Within(0.01, 100_000.0)));
    let major_every = reader.get("major_every", |item| item.whole(1..=1000));
    let color = reader.get("color", |item| item.color());
    Some(ContourTable { interval: interval?, major_every, color })
}

fn light(reader: &mut TableReader<'_, '_>) -> LightTable {
    LightTable {
        azimuth: number(reader, "azimuth", DIRECTION),
        altitude: number(reader, "altitude", Bounds::Above(0.0, 90.0)),
    }
}

fn label(reader: &mut TableReader<'_, '_>) -> Option<LabelTable> {
    let text = reader.require("text", |item| item.filled_text());
    let at = reader.require("at", |item| item.point());
    let crs = any_crs(reader, "crs");
    let height = number(reader, "height", Bounds::Within(0.0, 1e7));
    let kind = reader.get("kind", |item| item.word());
    Some(LabelTable { text: text?, at: at?, crs, height, kind })
}

fn camera(reader: &mut TableReader<'_, '_>) -> Option<CameraTable> {
    let name = reader.require("name", |item| item.filled_text());
    let eye = reader.require("eye", |item| item.point());
    let eye_height = number(reader, "eye_height", Bounds::Within(0.0, 1e7));
    let eye_elevation = number(reader, "eye_elevation", ELEVATION);
    let look_at = reader.require("look_at", |item| item.point());
    let look_at_height = number(reader, "look_at_height", ELEVATION);
    let crs = any_crs(reader, "crs");
    let field_of_view = number(reader, "field_of_view", Bounds::Within(1.0, 170.0));
    if let (Some(_), Some(elevation)) = (&eye_height, &eye_elevation) {
        let help = "keep `eye_height` to measure from the ground, or `eye_elevation` to measure from the sea";
        reader.error(elevation.span(), "the eye has both a height and an elevation", help);
    }
    let (name, eye, look_at) = (name?, eye?, look_at?);
    Some(CameraTable { name, eye, eye_height, eye_elevation, look_at, look_at_height, crs, field_of_view })
}

fn furniture(reader: &mut TableReader<'_, '_>) -> FurnitureTable {
    let shown = |reader: &mut TableReader<'_, '_>, key| {
        reader.get(key, |item| item.switch()).is_none_or(Spanned::into_inner)
    };
    FurnitureTable {
        title: shown(reader, "title"),
        north_arrow: shown(reader, "north_arrow"),
        scale_bar: shown(reader, "scale_bar"),
        legend: shown(reader, "legend"),
    }
}

fn distinct_names(reader: &mut TableReader<'_, '_>, source: &SourceText, cameras: &[CameraTable]) {
    let mut seen = BTreeMap::new();
    for camera in cameras {
        let name = camera.name.get_ref();
        if let Some(first) = seen.get(name) {
            let line = source.line_column(*first).line;
            let other = match source.name_at(*first) {
                file if file == source.name_at(camera.name.span().start) => String::new(),
                file => format!(" of {file}"),
            };
            let message = format!("the camera on line {line}{other} already has this name");
            reader.error(camera.name.span(), message, "give each camera a name of its own");
        } else {
            seen.insert(name, camera.name.span().start);
        }
    }
}

pub(super) fn plain_text(reader: &mut TableReader<'_, '_>, key: &'static str) -> Option<String> {
    reader.get(key, |item| item.text()).map(Spanned::into_inner)
}

pub(super) fn number(
    reader: &mut TableReader<'_, '_>,
    key: &'static str,
    bounds: Bounds,
) -> Option<Spanned<f64>> {
    reader.get(key, |item| item.number(bounds))
}

pub(super) fn any_crs(reader: &mut TableReader<'_, '_>, key: &'static str) -> Option<Spanned<String>> {
    reader.get(key, |item| item.crs(|_| Ok(())))
}

/// A scene's own system must be metric, since its heights, widths and distances are meters.
fn metric(crs: &Crs) -> Result<(), String> {
    if crs.is_geographic() {
        return Err(format!(
            "the scene's coordinate system must be metric, but {} is in degrees",
            crs.name()
        ));
    }
    let unit = crs.meters_per_unit();
    if unit != 1.0 {
        return Err(format!(
            "the scene's coordinate system must be metric, but a unit of {} is {unit} m",
            crs.name()
        ));
    }
    Ok(())
}
