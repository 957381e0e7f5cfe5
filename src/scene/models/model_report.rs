//! The report on models: single ones corner by corner, instances of one table by their extremes.
//!
//! A gap is the displayed height of a corner of the model's foot above the ground under it: above 0 it floats, below 0 it
//! is buried. Gaps are measured over the finest ground; in a picture they differ by the error of the displayed ground.

use std::collections::BTreeMap;

use glam::Vec3;

use crate::builder::SceneBuilder;
use crate::footprint::ModelFootprint;
use crate::models::placed_models::{InstanceGroup, PlacedModels};
use crate::placed_model::Placement;
use crate::placement::stand;
use crate::report::{InstancesRow, ModelRow};
use crate::scene_findings::SceneFindings;
use crate::vertical_scale::DrawnGround;
use crate::world_frame::WorldFrame;
use sandtable_description::feature_source::FeatureSource;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::words::Clamp;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::support_surface::SupportSurface;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_terrain::volumes::Volumes;

/// Adds a row for each single model and for each table of instances. `volumes` holds the earth moved by the index of the
/// placement.
pub fn add(
    placed: &PlacedModels<'_>,
    volumes: &BTreeMap<usize, Volumes>,
    frame: &WorldFrame<'_>,
    lattice: &Lattice,
    collected: &mut SceneBuilder,
) {
    let finest = frame.scale.ground(lattice);
    for group in &placed.groups {
        let name = group.table.name.clone().unwrap_or_else(|| group.table.file.to_string());
        let rows = group.placements.clone().filter_map(|index| {
            let placement = &placed.placements[index];
            row(placement, placed.library.footprint(placement.model), &finest, volumes.get(&index))
        });
        if group.table.instances.is_some() {
            find(group, &name, &mut collected.findings);
            collected.report.instances.push(instances(group, name, &rows.collect::<Vec<_>>()));
        } else {
            collected.report.models.extend(rows.map(|row| ModelRow { name: name.clone(), ..row }));
        }
    }
}

/// How one model stands, without its name, in meters as they are drawn, but for the anchor's elevation; `None` where there
/// is no ground.
fn row(
    placement: &Placement,
    footprint: &ModelFootprint,
    finest: &DrawnGround<'_>,
    moved: Option<&Volumes>,
) -> Option<ModelRow> {
    let ground = SupportSurface { displayed: finest, ground: finest };
    let pose = stand(placement, footprint, ground)?;
    let gap = |corner: Vec3| Some(f64::from(corner.z) - finest.displayed_z(corner.truncate().as_dvec2())?);
    let [gap_front_left, gap_front_right, gap_back_right, gap_back_left] = pose.base(footprint).map(gap);
    let is_on_ground = placement.clamp != Clamp::Absolute;
    Some(ModelRow {
        name: String::new(),
        anchor: is_on_ground.then(|| finest.scale.elevation_m(pose.anchor_z)),
        gap_front_left,
        gap_front_right,
        gap_back_right,
        gap_back_left,
        tilt: pose.tilt_rad.to_degrees(),
        plinth: pose.plinth_height_m(placement, footprint, ground),
        cut: moved.map(|moved| moved.cut_m3),
        fill: moved.map(|moved| moved.fill_m3),
    })
}

fn instances(group: &InstanceGroup<'_>, name: String, all: &[ModelRow]) -> InstancesRow {
    let gaps = || {
        let corners =
            |row: &ModelRow| [row.gap_front_left, row.gap_front_right, row.gap_back_right, row.gap_back_left];
        all.iter().flat_map(corners).flatten()
    };
    let total = |of: fn(&ModelRow) -> Option<f64>| {
        let moved: Vec<f64> = all.iter().filter_map(of).collect();
        (!moved.is_empty()).then(|| moved.iter().sum())
    };
    InstancesRow {
        name,
        models: group.placements.len(),
        off_the_ground: group.off,
        of_no_variant: group.unknown,
        least_gap: gaps().min_by(f64::total_cmp),
        greatest_gap: gaps().max_by(f64::total_cmp),
        greatest_tilt: all.iter().map(|row| row.tilt).max_by(f64::total_cmp),
        highest_plinth: all.iter().filter_map(|row| row.plinth).max_by(f64::total_cmp),
        cut: total(|row| row.cut),
        fill: total(|row| row.fill),
    }
}

fn find(group: &InstanceGroup<'_>, name: &str, findings: &mut SceneFindings) {
    let span = group.table.instances.as_ref().map(FeatureSource::span).unwrap_or_default();
    let models = |count: usize| if count == 1 { "1 model".into() } else { format!("{count} models") };
    if group.off > 0 {
        let message = format!("{} of '{name}' left out: off the elevation model", models(group.off));
        findings.add(FindingCode::LeftOut, span.clone(), message);
    }
    if group.unknown > 0 {
        let file = group.table.file.as_str();
        let (what, name_s) = (models(group.unknown), if group.unknown == 1 { "names" } else { "name" });
        let message = format!("{what} of '{name}' {name_s} none of its variants; '{file}' was taken");
        findings.add(FindingCode::UnknownVariant, span, message);
    }
}
