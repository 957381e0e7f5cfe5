//! Vertical alignments: `ProfAlign` of points of vertical intersection and the curves at them.

use sandtable_geom::profile::Profile;

use crate::xml::XmlElement;

/// Stretches that a vertical curve is cut into: its chords lie within a centimeter of one that turns 10 % in 500 m.
const CURVE_STEPS: usize = 48;

/// A point of vertical intersection: station and elevation, and the curve that rounds it.
#[derive(Clone, Copy, Debug)]
struct Intersection {
    station: f64,
    elevation: f64,
    curve: VerticalCurve,
}

/// The curve at a point of vertical intersection.
#[derive(Clone, Copy, Debug)]
enum VerticalCurve {
    None,
    /// Two parabolas that share a tangent, over the lengths before and behind the point.
    Parabola {
        before: f64,
        behind: f64,
    },
    /// An arc.
    Circle {
        radius: f64,
    },
}

/// The elevations of a `ProfAlign` over stations, straight between the chords of its curves; `None` where it has fewer
/// than two points.
///
/// # Errors
/// A sentence on the first element that cannot be read.
pub(super) fn elevations(profile: &XmlElement<'_>) -> Result<Option<Profile>, String> {
    let mut points = Vec::new();
    for element in profile.children() {
        let curve = match element.name() {
            "PVI" => VerticalCurve::None,
            "ParaCurve" => {
                let half = length(element, "length")? / 2.0;
                VerticalCurve::Parabola { before: half, behind: half }
            }
            "UnsymParaCurve" => VerticalCurve::Parabola {
                before: length(element, "lengthIn")?,
                behind: length(element, "lengthOut")?,
            },
            "CircCurve" => VerticalCurve::Circle { radius: length(element, "radius")? },
            _ => continue,
        };
        let text = element.text();
        let mut numbers =
            text.split_whitespace().map(|word| word.parse::<f64>().ok().filter(|at| at.is_finite()));
        let (Some(Some(station)), Some(Some(elevation))) = (numbers.next(), numbers.next()) else {
            return Err(format!("a {} is not a station and an elevation", element.name()));
        };
        points.push(Intersection { station, elevation, curve });
    }
    if points.windows(2).any(|pair| pair[0].station >= pair[1].station) {
        return Err("the stations of a profile do not rise".to_owned());
    }
    let mut line: Vec<[f64; 2]> = Vec::new();
    for index in 0..points.len() {
        let before = index.checked_sub(1).map(|before| points[before]);
        line.extend(rounded(before, points[index], points.get(index + 1).copied()));
    }
    if line.windows(2).any(|pair| pair[0][0] > pair[1][0] + 1e-6) {
        return Err("the vertical curves of a profile overlap".to_owned());
    }
    line.dedup_by(|next, last| next[0] <= last[0]);
    let (stations, values) = line.into_iter().map(|[station, elevation]| (station, elevation)).unzip();
    Ok(Profile::new(stations, values))
}

fn length(element: &XmlElement<'_>, name: &str) -> Result<f64, String> {
    let found = element.number::<f64>(name).filter(|length| length.is_finite() && *length >= 0.0);
    found.ok_or_else(|| format!("a {} has no {name}", element.name()))
}

/// The line around a point of intersection: the point itself, or the chords of its curve.
fn rounded(before: Option<Intersection>, at: Intersection, behind: Option<Intersection>) -> Vec<[f64; 2]> {
    let own = vec![[at.station, at.elevation]];
    let (Some(before), Some(behind)) = (before, behind) else { return own };
    let grade =
        |from: Intersection, to: Intersection| (to.elevation - from.elevation) / (to.station - from.station);
    let [first, last] = [grade(before, at), grade(at, behind)];
    let steps = |from: f64, to: f64, level: &dyn Fn(f64) -> f64| {
        let station = |step: usize| from + (to - from) * step as f64 / CURVE_STEPS as f64;
        (0..=CURVE_STEPS).map(|step| [station(step), level(station(step))]).collect()
    };
    match at.curve {
        VerticalCurve::Parabola { before, behind } if before > 0.0 && behind > 0.0 => {
            // How far the curve lies over the point of intersection.
            let lift = before * behind * (last - first) / (2.0 * (before + behind));
            let level = |station: f64| {
                let off = station - at.station;
                let (grade, reach) = if off <= 0.0 { (first, before) } else { (last, behind) };
                let share = 1.0 - off.abs() / reach;
                at.elevation + grade * off + lift * share * share
            };
            steps(at.station - before, at.station + behind, &level)
        }
        VerticalCurve::Circle { radius } if radius > 0.0 && first != last => {
            let [from, to] = [libm::atan(first), libm::atan(last)];
            let tangent = radius * libm::tan(((to - from) / 2.0).abs());
            let start = [at.station - tangent * libm::cos(from), at.elevation - tangent * libm::sin(from)];
            let end = at.station + tangent * libm::cos(to);
            // Up from a sag, down from a crest.
            let side = (to - from).signum();
            let center =
                [start[0] - side * radius * libm::sin(from), start[1] + side * radius * libm::cos(from)];
            let level = |station: f64| {
                let off = station - center[0];
                center[1] - side * (radius * radius - off * off).max(0.0).sqrt()
            };
            steps(start[0], end, &level)
        }
        _ => own,
    }
}
