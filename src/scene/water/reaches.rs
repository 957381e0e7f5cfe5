//! What reaches of a river show besides water: white water where it falls, falls where it drops, bars in its bends.
//!
//! ```text
//!  fall        reach (Montgomery and Buffington 1997)     shown
//!  ≥ 0.30      falls                                      falls
//!  ≥ 0.04      step-pool, cascade                         rapids
//!  < 0.015     pool-riffle, dune-ripple                   bars on the inner side of bends
//! ```
//!
//! Bars grow where a bend is narrower than some widths of the river: meanders have a radius of two to three (Leopold and
//! Wolman 1960).

use glam::{DVec2, FloatExt};

use sandtable_earthworks::alignment::{Alignment, Width};
use sandtable_geom::polyline::Polyline;
use sandtable_geom::profile::Profile;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::{Interpolation, ground_height};

/// The fall from which on water is white, and from which on it drops; meters for each along it.
const RAPIDS_FALL: f64 = 0.04;
const FALLS_FALL: f64 = 0.30;
/// The fall up to which a river lays down bars.
const BARS_FALL: f64 = 0.015;
/// The width in meters from which on a river has bars: those of a narrower one are too small to be seen where its water is
/// not a line.
const LEAST_BARRED_M: f64 = 8.0;
/// The stretch before and after a place that tells how it bends, in widths.
const BEND_WIDTHS: f64 = 1.5;
/// Bars begin where a bend is as wide as one over this, in widths, and are at their widest from one over that.
const BENT: [f64; 2] = [1.0 / 7.0, 1.0 / 2.5];
/// The widest bar, and the narrowest that is one, as shares of the river's width.
const BAR_SHARES: [f64; 2] = [0.42, 0.02];
/// The distance between places along a bar in widths, and how many of them to either side its width is a mean of.
const BAR_STEP: f64 = 0.4;
const TAPER: usize = 4;
/// The most places that are looked at along a river; on longer ones they lie farther apart.
const MOST_PLACES: f64 = 20_000.0;
/// Vertices nearer than this to one another are one, in meters.
const MERGE_M: f64 = 0.05;

/// The reaches of a river, downstream, that show more than water, with what they show: over it, within its width.
pub fn reaches(water: &Alignment, lattice: &Lattice) -> Vec<(Alignment, RibbonSurface)> {
    let mut found = white_water(water, lattice);
    if water.width.widest_m() >= LEAST_BARRED_M {
        found.extend(bars(water, lattice));
    }
    found
}

/// The places along a line that are looked at, about `step_m` apart.
fn places(line: &Polyline, step_m: f64) -> Vec<f64> {
    let steps = (line.length() / step_m).ceil().clamp(1.0, MOST_PLACES);
    (0..=steps as u32).map(|step| line.length() * f64::from(step) / steps).collect()
}

/// The heights at stations of a line; NaN beyond the ground.
fn heights(line: &Polyline, stations: &[f64], lattice: &Lattice) -> Vec<f64> {
    let height = |&station: &f64| {
        ground_height(lattice, Interpolation::Planar, line.at(station) + lattice.origin()).height_m()
    };
    stations.iter().map(|station| height(station).unwrap_or(f64::NAN)).collect()
}

fn white_water(water: &Alignment, lattice: &Lattice) -> Vec<(Alignment, RibbonSurface)> {
    let line = &water.line;
    let stations = places(line, lattice.cell().min_element());
    let heights = heights(line, &stations, lattice);
    let seen = |index: usize| -> Option<RibbonSurface> {
        let fall = (heights[index] - heights[index + 1]) / (stations[index + 1] - stations[index]);
        if fall >= FALLS_FALL {
            return Some(RibbonSurface::Falls);
        }
        (fall >= RAPIDS_FALL).then_some(RibbonSurface::Rapids)
    };
    let legs: Vec<usize> = (0..stations.len() - 1).collect();
    let runs = legs.chunk_by(|&a, &b| seen(a) == seen(b));
    let reach = |run: &[usize]| {
        let (first, last) = (*run.first()?, *run.last()?);
        let (from, to) = (stations[first], stations[last + 1]);
        let surface = seen(first)?;
        let line = line.slice(from, to, MERGE_M)?;
        let width = water.width.along(&line, from);
        Some((Alignment { line, level: None, width, support: water.support }, surface))
    };
    runs.filter_map(reach).collect()
}

/// How a river bends at a place: the share of its width that the bar on the inner side of the bend takes, above 0 on its left.
fn bar_share(line: &Polyline, station: f64, width_m: f64) -> f64 {
    let arm_m = BEND_WIDTHS * width_m;
    if station < arm_m || station + arm_m > line.length() {
        return 0.0;
    }
    let [before, here, after] = [-arm_m, 0.0, arm_m].map(|off| line.at(station + off));
    let turn = (here - before).angle_to(after - here);
    let bent = turn.abs() / BEND_WIDTHS;
    let [from, to] = BENT;
    BAR_SHARES[0] * bent.smoothstep(from, to) * turn.signum()
}

fn bars(water: &Alignment, lattice: &Lattice) -> Vec<(Alignment, RibbonSurface)> {
    let line = &water.line;
    let stations = places(line, BAR_STEP * water.width.widest_m());
    let heights = heights(line, &stations, lattice);
    let share = |index: usize| {
        let width_m = water.width.at(stations[index]);
        // Over several places: the ground of a channel has steps of its own.
        let [before, after] = [index.saturating_sub(TAPER), (index + TAPER).min(stations.len() - 1)];
        let fall = (heights[before] - heights[after]) / (stations[after] - stations[before]).max(MERGE_M);
        if fall < BARS_FALL { bar_share(line, stations[index], width_m) } else { 0.0 }
    };
    let bends: Vec<f64> = (0..stations.len()).map(share).collect();
    // A bar begins and ends in a point, however sharp the vertices of the bend are.
    let smooth = |index: usize| {
        let around = &bends[index.saturating_sub(TAPER)..(index + TAPER + 1).min(bends.len())];
        let share = around.iter().sum::<f64>() / around.len() as f64;
        if share.abs() < BAR_SHARES[1] { 0.0 } else { share }
    };
    let shares: Vec<f64> = (0..bends.len()).map(smooth).collect();
    let all: Vec<usize> = (0..stations.len()).collect();
    let side = |index: usize| if shares[index] == 0.0 { 0.0 } else { shares[index].signum() };
    let runs = all.chunk_by(|&a, &b| side(a) == side(b)).filter(|run| run.len() > 1 && side(run[0]) != 0.0);
    let bar = |run: &[usize]| {
        let place = |index: usize| {
            let (station, share) = (stations[index], shares[index]);
            let width_m = water.width.at(station);
            let way = tangent(line, station, width_m).perp() * share.signum();
            (line.at(station) + way * (0.5 * width_m * (1.0 - share.abs())), share.abs() * width_m)
        };
        let (points, widths): (Vec<DVec2>, Vec<f64>) = run.iter().map(|&index| place(index)).unzip();
        let line =
            Polyline::new(points.iter().copied(), 0.0).filter(|line| line.points().len() == points.len())?;
        let width = Width::Varying(Profile::new(line.stations().to_vec(), widths)?);
        Some((Alignment { line, level: None, width, support: water.support }, RibbonSurface::Bar))
    };
    runs.filter_map(bar).collect()
}

/// The direction downstream at a station, over half a width to either side.
fn tangent(line: &Polyline, station: f64, width_m: f64) -> DVec2 {
    let half_m = 0.5 * width_m;
    (line.at(station + half_m) - line.at(station - half_m)).normalize_or(DVec2::X)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn river(points: &[(f64, f64)], width_m: f64) -> Alignment {
        let line = Polyline::new(points.iter().map(|&(x, y)| DVec2::new(x, y)), 0.0).expect("a line");
        Alignment::on_ground(line, width_m)
    }

    /// 100 by 100 cells of 10 m that fall eastward by a profile.
    fn ground(height: impl Fn(f32) -> f32) -> Lattice {
        let heights = (0..101 * 101).map(|index| height((index % 101) as f32 * 10.0)).collect();
        Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 101, heights).expect("a lattice")
    }

    fn across(lattice: &Lattice, y: f64) -> [(f64, f64); 2] {
        let extent = lattice.extent();
        let x = extent.center().x;
        [(x - 450.0, y), (x + 450.0, y)]
    }

    #[test]
    fn water_is_white_where_it_falls_and_falls_where_it_drops() {
        let steep = ground(|x| {
            if x < 400.0 {
                0.02 * (400.0 - x)
            } else {
                -0.1 * (x - 400.0).min(300.0) - 0.6 * (x - 700.0).clamp(0.0, 40.0)
            }
        });
        let found = reaches(&river(&across(&steep, 0.0), 4.0), &steep);
        let surfaces: Vec<RibbonSurface> = found.iter().map(|(_, surface)| *surface).collect();
        assert_eq!(surfaces, [RibbonSurface::Rapids, RibbonSurface::Falls], "{found:?}");
        let length = |index: usize| found[index].0.line.length();
        assert!(
            (length(0) - 300.0).abs() < 25.0 && (length(1) - 40.0).abs() < 25.0,
            "{} {}",
            length(0),
            length(1)
        );
        let level = ground(|_| 5.0);
        assert!(reaches(&river(&across(&level, 0.0), 40.0), &level).is_empty());
    }

    #[test]
    fn bars_lie_on_the_inner_side_of_bends_within_the_water() {
        let level = ground(|x| 100.0 - 0.001 * x);
        let center = level.extent().center();
        let bend = |angle: f64| (center.x + 60.0 * libm::cos(angle), center.y + 60.0 * libm::sin(angle));
        let arc: Vec<(f64, f64)> = (0..=36).map(|step| bend(f64::from(step) * 0.1)).collect();
        let found = reaches(&river(&arc, 20.0), &level);
        assert!(!found.is_empty());
        for (bar, surface) in &found {
            assert_eq!(*surface, RibbonSurface::Bar);
            for (at, station) in bar.line.points().iter().zip(bar.line.stations()) {
                let (off, half) = (at.distance(center), 0.5 * bar.width.at(*station));
                // It turns left, so that its left side is the inner one.
                assert!(off + half < 60.0 && off - half > 49.0, "{off} {half}");
            }
        }
        let wide = reaches(&river(&arc, 6.0), &level);
        assert!(wide.is_empty(), "a bend of ten widths, and a narrow river");
    }

    #[test]
    fn a_river_beyond_the_ground_shows_nothing() {
        let level = ground(|_| 5.0);
        assert!(reaches(&river(&[(1e5, 1e5), (2e5, 1e5)], 4.0), &level).is_empty());
    }
}
