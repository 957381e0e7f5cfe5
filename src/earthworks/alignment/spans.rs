//! The stretches on which a road leaves the ground and needs a bridge or a tunnel.
//!
//! A stretch begins where the fill exceeds what an embankment may have. Its abutments stand further out, where the fill
//! has fallen to a share of that: a bridge that ended at the very limit would end on the highest embankment allowed, and
//! along ground that wavers about the limit there would be a bridge every few meters.
//!
//! ```text
//!                 ┌──────── bridge ────────┐
//!   ══════════════╪════════════════════════╪═══════   road
//!   ─────────╲    │                        │ ╱─────   ground
//!             ╲___│                       _│╱
//!                 ╲____              ____╱            │ fill = ABUTMENT · max_fill
//!                      ╲____________╱                 below: fill > max_fill
//! ```

use crate::alignment::{Support, SupportSpan};

/// The share of the highest embankment, or deepest cutting, at which a bridge's abutment or a tunnel's portal stands.
/// Nearer to 1 spans are shorter and follow the limit's every waver; nearer to 0 they are long, and costly.
pub const ABUTMENT: f64 = 0.5;

/// The shortest bridge or tunnel in meters; a culvert or a wall is shorter.
const SHORTEST_M: f64 = 12.0;

/// Two of one kind nearer to each other than this are one, in meters.
const NEAREST_M: f64 = 30.0;

/// The greatest heights of embankments and depths of cuttings, in meters; infinite for any.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EarthworkLimits {
    /// The highest embankment.
    pub max_fill_m: f64,
    /// The deepest cutting.
    pub max_cut_m: f64,
}

impl EarthworkLimits {
    /// Any embankment and any cutting.
    pub const NONE: Self = Self { max_fill_m: f64::INFINITY, max_cut_m: f64::INFINITY };

    /// The share of the limit that a road `rise_m` above the ground needs: above 0 for fill, below for cut, beyond ±1
    /// for too much; 0 where there is no ground.
    pub fn need(&self, rise_m: f64) -> f64 {
        if rise_m > 0.0 {
            rise_m / self.max_fill_m
        } else if rise_m < 0.0 {
            rise_m / self.max_cut_m
        } else {
            0.0
        }
    }
}

/// The spans of a road with this [need](EarthworkLimits::need) at its stations, in order and apart from each other.
pub fn spans(stations_m: &[f64], needs: &[f64]) -> Vec<SupportSpan> {
    let (Some(&start), Some(&end)) = (stations_m.first(), stations_m.last()) else { return Vec::new() };
    let fills = exceeding(stations_m, needs, Support::Bridge);
    let cuts: Vec<f64> = needs.iter().map(|need| -need).collect();
    let mut all = merged(fills);
    all.extend(merged(exceeding(stations_m, &cuts, Support::Tunnel)));
    all.sort_by(|a, b| a.from_m.total_cmp(&b.from_m));
    for span in &mut all {
        let lacks = (SHORTEST_M - (span.to_m - span.from_m)).max(0.0) / 2.0;
        (span.from_m, span.to_m) = ((span.from_m - lacks).max(start), (span.to_m + lacks).min(end));
    }
    for index in 1..all.len() {
        let reached = all[index - 1].to_m;
        all[index].from_m = all[index].from_m.max(reached);
    }
    all.retain(|span| span.to_m > span.from_m);
    all
}

/// Where the need is above [`ABUTMENT`], for as long as it somewhere exceeds 1.
fn exceeding(stations_m: &[f64], needs: &[f64], support: Support) -> Vec<SupportSpan> {
    let mut found = Vec::new();
    let (mut from_m, mut highest) = (None, 0.0_f64);
    for index in 0..needs.len() {
        let (station, need) = (stations_m[index], needs[index]);
        let crossing = |before: usize| {
            let part = (ABUTMENT - needs[before]) / (need - needs[before]);
            stations_m[before] + (station - stations_m[before]) * part
        };
        match (from_m, need > ABUTMENT) {
            (None, true) => {
                from_m = Some(if index == 0 { station } else { crossing(index - 1) });
                highest = need;
            }
            (Some(_), true) => highest = highest.max(need),
            (Some(from), false) => {
                if highest > 1.0 {
                    found.push(SupportSpan { support, from_m: from, to_m: crossing(index - 1) });
                }
                from_m = None;
            }
            (None, false) => {}
        }
    }
    if let (Some(from_m), Some(&to_m)) = (from_m, stations_m.last())
        && highest > 1.0
    {
        found.push(SupportSpan { support, from_m, to_m });
    }
    found
}

/// Spans of one kind in order, those with little between made one.
fn merged(spans: Vec<SupportSpan>) -> Vec<SupportSpan> {
    let mut all: Vec<SupportSpan> = Vec::with_capacity(spans.len());
    for span in spans {
        match all.last_mut() {
            Some(last) if span.from_m - last.to_m < NEAREST_M => last.to_m = span.to_m,
            _ => all.push(span),
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spans_of(needs: &[f64]) -> Vec<(Support, f64, f64)> {
        let stations: Vec<f64> = (0..needs.len()).map(|index| index as f64 * 20.0).collect();
        spans(&stations, needs).into_iter().map(|span| (span.support, span.from_m, span.to_m)).collect()
    }

    #[test]
    fn a_bridge_reaches_from_abutment_to_abutment() {
        let needs = [0.0, 0.0, 1.0, 1.5, 1.5, 1.0, 0.0, 0.0];
        assert_eq!(spans_of(&needs), [(Support::Bridge, 30.0, 110.0)]);
    }

    #[test]
    fn an_embankment_that_is_just_allowed_stays_one() {
        assert_eq!(spans_of(&[0.0, 0.9, 1.0, 0.9, 0.0]), []);
        assert_eq!(spans_of(&[0.0, -0.9, -1.0, -0.9, 0.0]), []);
    }

    #[test]
    fn a_deep_cut_becomes_a_tunnel_and_two_near_ones_are_one() {
        let needs = [0.0, -2.0, -2.0, 0.2, -2.0, -2.0, 0.0, 0.0, 0.0];
        assert_eq!(spans_of(&needs), [(Support::Tunnel, 5.0, 115.0)]);
    }

    #[test]
    fn a_short_one_is_lengthened_and_none_lies_over_another() {
        let stations = [0.0, 50.0, 52.0, 54.0, 56.0, 58.0, 100.0];
        let found = spans(&stations, &[0.0, 0.0, 2.0, 0.0, -2.0, 0.0, 0.0]);
        assert_eq!(found.len(), 2);
        assert!((found[0].to_m - found[0].from_m - 12.0).abs() < 1e-9);
        assert!(found[0].to_m <= found[1].from_m, "{found:?}");
    }

    #[test]
    fn without_limits_or_ground_nothing_is_needed() {
        let any = EarthworkLimits::NONE;
        assert_eq!((any.need(900.0), any.need(-900.0), any.need(f64::NAN)), (0.0, 0.0, 0.0));
        let some = EarthworkLimits { max_fill_m: 8.0, max_cut_m: 10.0 };
        assert_eq!((some.need(4.0), some.need(-20.0)), (0.5, -2.0));
    }
}
