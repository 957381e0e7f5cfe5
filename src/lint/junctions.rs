//! Junctions that cannot be trimmed: two roads leave at so small an angle that their edges meet far away.
//!
//! ```text
//!        ═══════════════════════╗    the edges meet at h·(1 + cos θ)/sin θ, which grows without bound
//!   at ●═══════════════════     ╚═   with a smaller angle; a junction is cut off before, and the
//!        ══════════════════════════  roads lie on one another beyond
//! ```

use glam::DVec2;

use crate::context::LintContext;
use crate::ground_line::place;
use crate::sink::FindingSink;
use crate::worst::WorstOfTables;
use sandtable_description::finding_code::FindingCode;
use sandtable_draw::list::FeatureId;
use sandtable_geom::polyline::{VertexKey, vertex_key};
use sandtable_ribbon::junction::LONGEST_REACH;
use sandtable_scene::symbols::LineSymbol;

/// The part of a road that leaves a vertex.
#[derive(Clone, Copy, Debug)]
struct LeavingRoad {
    road: FeatureId,
    at: DVec2,
    /// Its direction, one meter long.
    along: DVec2,
    half_m: f64,
    /// How far it goes on straight.
    leg_m: f64,
}

/// Finds such junctions among the roads on the ground.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    let mut leaving: Vec<(VertexKey, LeavingRoad)> =
        context.roads_on_ground().flat_map(leaving_roads).collect();
    // Stable: of one place in the order of the roads.
    leaving.sort_by_key(|(key, _)| *key);
    let mut worst = WorstOfTables::default();
    for meeting in leaving.chunk_by(|(one, _), (other, _)| one == other) {
        let mut around: Vec<LeavingRoad> = meeting.iter().map(|(_, road)| *road).collect();
        let angle = |road: &LeavingRoad| libm::atan2(road.along.y, road.along.x);
        around.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        for (index, one) in around.iter().enumerate() {
            let other = &around[(index + 1) % around.len()];
            let Some((meet_m, trimmed_m)) = untrimmed(one, other) else { continue };
            worst.add(context.origin(one.road), meet_m, || {
                format!(
                    "{} and {} leave {} at {:.1}° to each other: their edges meet {meet_m:.0} m away, and the junction is cut \
                     off after {trimmed_m:.0} m",
                    context.name(one.road),
                    context.name(other.road),
                    place(context.scene, one.at),
                    one.along.angle_to(other.along).abs().to_degrees()
                )
            });
        }
    }
    let help = "let one road begin farther along the other, at an angle";
    worst.report(context, FindingCode::JunctionUntrimmed, help, sink);
}

fn leaving_roads(line: &LineSymbol) -> impl Iterator<Item = (VertexKey, LeavingRoad)> + '_ {
    let (points, stations) = (line.alignment.line.points(), line.alignment.line.stations());
    (0..points.len()).flat_map(move |vertex| {
        let next = [vertex.checked_sub(1), (vertex + 1 < points.len()).then_some(vertex + 1)];
        next.into_iter().flatten().map(move |next| {
            let way = points[next] - points[vertex];
            let road = LeavingRoad {
                road: line.feature,
                at: points[vertex],
                along: way.normalize_or_zero(),
                half_m: line.alignment.width.at(stations[vertex]) / 2.0,
                leg_m: way.length(),
            };
            (vertex_key(points[vertex]), road)
        })
    })
}

/// Where the edges between two roads meet and where their junction is cut off, in meters from the vertex, where both go on
/// straight at least so far; `None` where the junction is whole, or a road bends away before.
fn untrimmed(one: &LeavingRoad, other: &LeavingRoad) -> Option<(f64, f64)> {
    let (sine, cosine) = (one.along.perp_dot(other.along), one.along.dot(other.along));
    if one.road == other.road || cosine <= 0.0 || sine <= 0.0 {
        return None;
    }
    let meet_m = (other.half_m + one.half_m * cosine) / sine;
    let trimmed_m = 2.0 * one.half_m.max(other.half_m) * LONGEST_REACH;
    let is_straight = one.leg_m.min(other.leg_m) > trimmed_m;
    (meet_m > trimmed_m && is_straight).then_some((meet_m, trimmed_m))
}
