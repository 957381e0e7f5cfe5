//! Models hundreds of times too big or small, and those that lie on their sides.
//!
//! Formats leave the unit and, in practice, the upright axis to whoever writes the file. A size that nothing has tells of
//! the one. For the other, who models a thing that stands puts the origin in the middle of its foot: the box around it
//! begins at 0 along the upright axis and lies evenly about 0 along the others.
//!
//! ```text
//!     upright:  z  ┌──┐        on its side:  z     ┌──────┐
//!                  │  │                        0 ──┤      │   begins at 0 along y, even about 0 along z
//!               0 ─┴──┴─ y                         └──────┘ y
//! ```

use glam::Vec3;

use crate::context::LintContext;
use crate::models::standing::StandingModel;
use crate::sink::FindingSink;
use crate::worst::WorstOfTables;
use sandtable_description::finding_code::FindingCode;
use sandtable_geom::aabb::Aabb;

/// The largest side of a model, meters: the highest building of the world has 828.
const LARGEST_M: f32 = 1000.0;

/// The largest side of a model that is too small to be seen in any scene, meters: a brick has 0.25.
const SMALLEST_M: f32 = 0.15;

/// A box begins at 0 where it begins nearer to it than this share of its side.
const BEGINS: f32 = 0.03;

/// A box lies evenly about 0 where its middle is nearer to it than this share of its side.
const EVEN: f32 = 0.05;

/// What lies on its side is at least so many times as long as it seems high: less may as well be square.
const LONGER: f32 = 1.3;

/// Finds such models among `standing`.
pub fn check(context: &LintContext<'_>, standing: &[StandingModel<'_>], sink: &mut FindingSink) {
    let [mut sizes, mut sides] = std::array::from_fn(|_| WorstOfTables::default());
    for model in standing {
        let (size, feature) = (model.size_m(), model.placement.feature);
        let largest_m = size.max_element();
        let name = || context.name(feature);
        if largest_m > LARGEST_M {
            sizes.add(context.origin(feature), f64::from(largest_m), || {
                format!("{} is {}", name(), too_large(model))
            });
        } else if largest_m < SMALLEST_M && largest_m > 0.0 {
            sizes.add(context.origin(feature), f64::from(1.0 / largest_m), || {
                format!("{} is {}", name(), too_small(model))
            });
        }
        if lies_on_its_side(&model.shape.bounds) {
            sides.add(context.origin(feature), f64::from(size.y / size.z), || {
                format!(
                    "{} seems to lie on its side: its box begins at its origin toward the {}, {:.1} m long, and lies evenly \
                     about it in height, {:.1} m",
                    name(),
                    if model.shape.bounds.center().y > 0.0 { "back" } else { "front" },
                    size.y,
                    size.z
                )
            });
        }
    }
    let help = "state in `scale` how many meters a unit of the file has";
    sizes.report(context, FindingCode::ModelSize, help, sink);
    let help = "write the file anew with the upright axis of its format: Y in OBJ and glTF, Z in 3DS";
    sides.report(context, FindingCode::ModelOnSide, help, sink);
}

fn sides(size: Vec3) -> String {
    let side = |meters: f32| if meters < 10.0 { format!("{meters:.2}") } else { format!("{meters:.0}") };
    format!("{} × {} × {} m", side(size.x), side(size.y), side(size.z))
}

fn too_large(model: &StandingModel<'_>) -> String {
    let (size, scale) = (model.size_m(), model.placement.scale);
    format!(
        "{} large, more than any building; of a file in centimeters or millimeters, `scale = {}` or `scale = {}` makes it {} \
         or {}",
        sides(size),
        scale * 0.01,
        scale * 0.001,
        sides(size * 0.01),
        sides(size * 0.001)
    )
}

fn too_small(model: &StandingModel<'_>) -> String {
    let (size, scale) = (model.size_m(), model.placement.scale);
    format!(
        "{} large, less than a brick; `scale = {}` or `scale = {}` makes it {} or {}",
        sides(size),
        scale * 100.0,
        scale * 1000.0,
        sides(size * 100.0),
        sides(size * 1000.0)
    )
}

/// Whether a model with these bounds, Z up, has its foot toward the front or the back.
fn lies_on_its_side(bounds: &Aabb) -> bool {
    let (size, middle) = (bounds.size(), bounds.center().abs());
    let begins = bounds.min.y.abs().min(bounds.max.y.abs()) <= BEGINS * size.y;
    let is_even = middle.z <= EVEN * size.z && middle.x <= EVEN * size.x;
    begins && is_even && size.z > 0.0 && size.y >= LONGER * size.z
}

#[cfg(test)]
mod tests {
    use super::*;

    fn aabb(min: [f32; 3], max: [f32; 3]) -> Aabb {
        Aabb { min: min.into(), max: max.into() }
    }

    #[test]
    fn a_tower_lies_on_its_side_where_its_foot_is_before_or_behind_it() {
        assert!(lies_on_its_side(&aabb([-3.0, 0.0, -3.0], [3.0, 20.0, 3.0])));
        assert!(lies_on_its_side(&aabb([-3.0, -20.0, -3.0], [3.0, 0.0, 3.0])));
        for upright in [
            aabb([-3.0, -3.0, 0.0], [3.0, 3.0, 20.0]),
            aabb([-3.0, -10.0, 0.0], [3.0, 10.0, 4.0]),
            aabb([-3.0, -10.0, -2.0], [3.0, 10.0, 2.0]),
            aabb([0.0, 0.0, 0.0], [9.0, 20.0, 6.0]),
        ] {
            assert!(!lies_on_its_side(&upright), "{upright:?}");
        }
    }
}
