//! Channels: the ground cut so that water falls along every river of a network, as far as the ground lets it.
//!
//! ```text
//!  flow ──► which end of each line is the lower one
//!  course ► stations where the line crosses the finest triangles, with the ground across the water there
//!  reaches► the pieces of each line on which water can fall without too deep a cut; between them it climbs
//!  levels ► the level at every station: it never rises along a reach, through the whole network, and no bank drowns
//!  bed ───► the posts under the water and its banks, set to the level beside them
//!  carve ─► posts lowered until the ground along no reach rises from one triangle to the next: exact on any cells
//! ```
//!
//! The first five make a bed as a river has one. The last makes sure: cells may be ten times as wide as the stream, and
//! then no level at a post says what the ground between the posts does. What it lowers it lowers as little as it can.
//!
//! Posts that are pinned already, under a lake, stay: a river that runs through a lake takes its level.
//!
//! What is promised: no post is cut deeper than its channels allow, the ground never rises along a line but where a
//! [`Climb`] says so, and climbs are few: there the line does not follow the model's valley. To cut through them all, as
//! tools that condition models for hydrology do, draws canyons where there are none.

mod bed;
mod carve;
mod course;
pub mod flow;
mod levels;
mod reaches;
pub mod river_cut;

use rayon::prelude::*;

use crate::channel::bed::ChannelBed;
use crate::channel::carve::CenterlinePiece;
use crate::channel::course::ChannelCourse;
use crate::channel::river_cut::{Channel, ChannelError, Climb, Cut, Cuts};
use sandtable_geom::polyline::Polyline;
use sandtable_terrain::lattice::Lattice;

/// Cuts the ground so that it never rises along any of `channels` but at the climbs in their cuts.
///
/// # Errors
/// See [`ChannelError`]; the ground is then as it was.
pub fn cut(lattice: &mut Lattice, channels: &[Channel]) -> Result<Cuts, ChannelError> {
    let mut courses: Vec<ChannelCourse<'_>> =
        channels.par_iter().map(|channel| ChannelCourse::of(lattice, channel)).collect();
    levels::settle(&mut courses);
    let pieces = carve::pieces(lattice, &courses);
    let mut bed = ChannelBed::shaped(lattice, &courses, &pieces)?;
    let climbing = carve::carve(&mut bed, &pieces);
    let mut cuts: Vec<Cut> = courses.iter().map(levels::ends).collect();
    for (index, rise_m) in climbing {
        let CenterlinePiece { channel, stations_m: [from_m, to_m], .. } = pieces[index];
        cuts[channel as usize].climbs.push(Climb { from_m, to_m, rise_m });
    }
    cuts.iter_mut().for_each(|cut| joined(&mut cut.climbs));
    bed.dig(lattice, &mut cuts);
    Ok(Cuts { cuts })
}

/// Sorts climbs, and makes one of those that meet.
fn joined(climbs: &mut Vec<Climb>) {
    climbs.sort_by(|a, b| a.from_m.total_cmp(&b.from_m).then(a.to_m.total_cmp(&b.to_m)));
    climbs.dedup_by(|next, climb| {
        let meet = next.from_m <= climb.to_m;
        if meet {
            climb.to_m = climb.to_m.max(next.to_m);
            climb.rise_m += next.rise_m;
        }
        meet
    });
}

/// How far apart two stations may be that mean one place, in meters: rounding of world coordinates to map coordinates.
const SAME_STATION_M: f64 = 1e-6;

/// The most by which the ground rises along `line`, world coordinates downstream, above where it was lower before; 0
/// where it never rises. The promise of every channel, on the finest triangles; where a line leaves the ground
/// and comes back, and at each of `climbs`, it begins anew.
pub fn check_rise(lattice: &Lattice, line: &Polyline, climbs: &[Climb]) -> f64 {
    let map: Vec<_> = line.points().iter().map(|&at| at + lattice.origin()).collect();
    let stations = sandtable_terrain::profile::profile(lattice, &map);
    let (mut lowest_m, mut rise_m, mut passed) = (f64::INFINITY, 0.0, 0);
    for station in stations {
        let at_m = station.station_m;
        passed += climbs[passed..].iter().take_while(|climb| climb.to_m + SAME_STATION_M < at_m).count();
        let climbing = climbs.get(passed).is_some_and(|climb| climb.from_m + SAME_STATION_M < at_m);
        match station.ground.height_m() {
            Some(height_m) => {
                lowest_m = if climbing { height_m } else { height_m.min(lowest_m) };
                rise_m = (height_m - lowest_m).max(rise_m);
            }
            None => lowest_m = f64::INFINITY,
        }
    }
    rise_m
}
