//! The report on models: single ones corner by corner, instances of one table by their extremes.
//!
//! A gap is the displayed height of a corner of the model's foot above the ground under it: above 0 it floats, below 0 it
//! is buried. Gaps are measured over the finest ground; in a picture they differ by the error of the displayed ground.

use std::collections::BTreeMap;

use glam::Vec3;

use crate::description::words::Clamp;
use crate::scene::Placement;
use crate::scene::builder::SceneBuilder;
use crate::scene::footprint::ModelFootprint;
use crate::scene::models::{InstanceGroup, PlacedModels};
use crate::scene::placement::stand;
use crate::scene::report::{InstancesRow, ModelRow};
use crate::scene::vertical_scale::DrawnGround;
use crate::scene::world_frame::WorldFrame;
use crate::terrain::lattice::Lattice;
use crate::terrain::support_surface::SupportSurface;
use crate::terrain::triangle_surface::TriangleSurface;
use crate::terrain::volumes::Volumes;

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
        let stand = |index: usize| {
            let placement = &placed.placements[index];
            let footprint = placed.library.footprint(placement.model);
            StandReport::new(placement, footprint, &finest, volumes.get(&index).copied())
        };
        let all: Vec<StandReport> = group.placements.clone().filter_map(stand).collect();
        let name = group.table.name.clone().unwrap_or_else(|| group.table.file.to_string());
        if group.table.instances.is_some() {
            note(group, &name, &mut collected.notes);
            collected.report.instances.push(instances(group, name, &all));
        } else {
            collected.report.models.extend(all.iter().map(|stand| stand.row(name.clone())));
        }
    }
}

/// How one model stands, in meters as they are drawn, but for the anchor's elevation.
struct StandReport {
    anchor_m: Option<f64>,
    gaps_m: [Option<f64>; 4],
    tilt_deg: f64,
    plinth_m: Option<f64>,
    moved: Option<Volumes>,
}

impl StandReport {
    fn new(
        placement: &Placement,
        footprint: &ModelFootprint,
        finest: &DrawnGround<'_>,
        moved: Option<Volumes>,
    ) -> Option<Self> {
        let ground = SupportSurface { displayed: finest, ground: finest };
        let pose = stand(placement, footprint, ground)?;
        let gap =
            |corner: Vec3| Some(f64::from(corner.z) - finest.displayed_z(corner.truncate().as_dvec2())?);
        Some(Self {
            anchor_m: (placement.clamp != Clamp::Absolute).then(|| finest.scale.elevation_m(pose.anchor_z)),
            gaps_m: pose.base(footprint).map(gap),
            tilt_deg: pose.tilt_rad.to_degrees(),
            plinth_m: pose.plinth_height_m(placement, footprint, ground),
            moved,
        })
    }

    fn row(&self, name: String) -> ModelRow {
        let [gap_front_left, gap_front_right, gap_back_right, gap_back_left] = self.gaps_m;
        ModelRow {
            name,
            anchor: self.anchor_m,
            gap_front_left,
            gap_front_right,
            gap_back_right,
            gap_back_left,
            tilt: self.tilt_deg,
            plinth: self.plinth_m,
            cut: self.moved.map(|moved| moved.cut_m3),
            fill: self.moved.map(|moved| moved.fill_m3),
        }
    }
}

fn instances(group: &InstanceGroup<'_>, name: String, all: &[StandReport]) -> InstancesRow {
    let gaps = || all.iter().flat_map(|stand| stand.gaps_m).flatten();
    let total = |of: fn(&Volumes) -> f64| {
        let moved: Vec<f64> = all.iter().filter_map(|stand| stand.moved.as_ref()).map(of).collect();
        (!moved.is_empty()).then(|| moved.iter().sum())
    };
    InstancesRow {
        name,
        models: group.placements.len(),
        off_the_ground: group.off,
        of_no_variant: group.unknown,
        least_gap: gaps().min_by(f64::total_cmp),
        greatest_gap: gaps().max_by(f64::total_cmp),
        greatest_tilt: all.iter().map(|stand| stand.tilt_deg).max_by(f64::total_cmp),
        highest_plinth: all.iter().filter_map(|stand| stand.plinth_m).max_by(f64::total_cmp),
        cut: total(|moved| moved.cut_m3),
        fill: total(|moved| moved.fill_m3),
    }
}

fn note(group: &InstanceGroup<'_>, name: &str, notes: &mut Vec<String>) {
    let models = |count: usize| if count == 1 { "1 model".into() } else { format!("{count} models") };
    if group.off > 0 {
        notes.push(format!("{} of '{name}' left out: off the elevation model", models(group.off)));
    }
    if group.unknown > 0 {
        let file = group.table.file.as_str();
        let (what, name_s) = (models(group.unknown), if group.unknown == 1 { "names" } else { "name" });
        notes.push(format!("{what} of '{name}' {name_s} none of its variants; '{file}' was taken"));
    }
}
