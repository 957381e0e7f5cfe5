//! Looking over the ground: what is found in passing over blocks is what the plain walk finds, and both are what geometry
//! says.

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::profile::{ProfileSummary, profile};
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::crossings::crossings;
use sandtable_terrain::sight::ground::SightGround;
use sandtable_terrain::sight::line::{Sight, SightEnd, line_of_sight};
use sandtable_terrain::sight::ray::{Ray, RayHit};
use sandtable_terrain::sight::rise::{Raised, required_rise};

/// Knuth's linear congruence (MMIX), from 0 up to 1.
struct Random(u64);

impl Random {
    fn part(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, count: u32) -> u32 {
        (self.part() * f64::from(count)) as u32
    }
}

const ORIGIN: DVec2 = DVec2::new(500_000.0, 4_000_000.0);
const CELL: DVec2 = DVec2::new(10.0, 12.5);

fn lattice(columns: u32, rows: u32, height: impl FnMut((u32, u32)) -> f32) -> Lattice {
    let posts = (0..columns * rows).map(|index| (index % columns, index / columns));
    Lattice::new(ORIGIN, CELL, columns, posts.map(height).collect()).expect("sound")
}

/// Grounds that differ in what a line meets on them.
fn grounds() -> Vec<(&'static str, Lattice)> {
    let mut random = Random(7);
    let mut noise = Random(11);
    let mut holes = Random(13);
    let hills = |(column, row): (u32, u32)| {
        let (x, y) = (f64::from(column) * 0.11, f64::from(row) * 0.07);
        (60.0 * (x.sin() + (y * 1.3).cos()) + 9.0 * (x * 5.0).sin() * (y * 6.0).cos()) as f32
    };
    vec![
        ("rough", lattice(97, 61, |_| (random.part() * 300.0) as f32)),
        ("flat", lattice(70, 83, |_| 0.0)),
        ("hills", lattice(129, 101, hills)),
        ("stepped", lattice(65, 65, |(column, _)| (column / 9 * 20) as f32)),
        (
            "holed",
            lattice(
                101,
                77,
                |at| {
                    if holes.part() < 0.1 { f32::NAN } else { hills(at) + noise.part() as f32 }
                },
            ),
        ),
        ("narrow", lattice(2, 200, |(_, row)| (row % 17) as f32)),
        ("tiny", lattice(2, 2, |(column, row)| (column + row) as f32)),
        ("far from sea level", lattice(90, 90, |at| 8_000_000.0 + hills(at))),
    ]
}

/// A place on the lattice: between posts, on a row or column of them, or at one.
fn place(lattice: &Lattice, random: &mut Random) -> DVec2 {
    let last = DVec2::new(f64::from(lattice.columns() - 1), f64::from(lattice.rows() - 1));
    let grid = last * DVec2::new(random.part(), random.part());
    match random.below(6) {
        0 => DVec2::new(grid.x.round(), grid.y),
        1 => DVec2::new(grid.x, grid.y.round()),
        2 => grid.round(),
        3 => DVec2::new(if random.below(2) == 0 { 0.0 } else { last.x }, grid.y),
        _ => grid,
    }
}

/// Two ends; some along an edge, some along a diagonal, some very near to each other.
fn ends(lattice: &Lattice, random: &mut Random) -> (SightEnd, SightEnd) {
    let from = place(lattice, random);
    let other = place(lattice, random);
    let last = DVec2::new(f64::from(lattice.columns() - 1), f64::from(lattice.rows() - 1));
    let to = match random.below(8) {
        0 => DVec2::new(from.x, other.y),
        1 => DVec2::new(other.x, from.y),
        2 => (from + DVec2::splat((other.x - from.x).round())).clamp(DVec2::ZERO, last),
        3 => (from + (other - from) * 1e-9).clamp(DVec2::ZERO, last),
        4 => from,
        _ => other,
    };
    let mut end = |grid: DVec2| {
        let above_m = [0.0, 1.8, 30.0, 400.0][random.below(4) as usize] * random.part();
        SightEnd { at: lattice.origin() + grid * lattice.cell(), above_m }
    };
    (end(from), end(to))
}

const CURVATURES: [Curvature; 4] = [
    Curvature::FLAT,
    Curvature { radius_m: 6_371_008.8, refraction: 1.0 / 7.0 },
    // A world so small that lines hang deep, and air that bends light upward.
    Curvature { radius_m: 3000.0, refraction: 0.0 },
    Curvature { radius_m: 3000.0, refraction: 2.0 },
];

#[test]
fn passing_over_blocks_gives_the_plain_walks_answer_to_the_last_bit() {
    let mut random = Random(1);
    for (name, lattice) in grounds() {
        let ground = SightGround::new(Arc::new(lattice));
        let lattice = ground.lattice();
        let (mut blocked, mut clear) = (0, 0);
        for _ in 0..4000 {
            let (observer, target) = ends(lattice, &mut random);
            for curvature in CURVATURES {
                let plain = line_of_sight(lattice, observer, target, curvature);
                let quick = ground.line_of_sight(observer, target, curvature);
                assert_eq!(plain, quick, "{name}: {observer:?} {target:?} {curvature:?}");
                blocked += u32::from(matches!(plain, Sight::Blocked(_)));
                clear += u32::from(plain == Sight::Clear);
            }
        }
        assert!(clear > 1000 && (blocked > 1000 || name == "tiny"), "{name}: {blocked} and {clear}");
    }
}

#[test]
fn the_rise_that_is_needed_is_the_plain_walks_to_the_last_bit_and_just_enough() {
    let mut random = Random(2);
    for (name, lattice) in grounds() {
        let ground = SightGround::new(Arc::new(lattice));
        let lattice = ground.lattice();
        for _ in 0..1500 {
            let (observer, target) = ends(lattice, &mut random);
            let curvature = CURVATURES[random.below(4) as usize];
            for raised in [Raised::Target, Raised::Observer, Raised::Both] {
                let plain = required_rise(lattice, observer, target, curvature, raised);
                assert_eq!(plain, ground.required_rise(observer, target, curvature, raised), "{name}");
                let Ok(Some(rise)) = plain else { continue };
                let blocked =
                    matches!(line_of_sight(lattice, observer, target, curvature), Sight::Blocked(_));
                assert_eq!(blocked, rise.rise_m > 0.0, "{name}: {observer:?} {target:?} {rise:?}");
                // Right under an end the other one's rise lifts the line by next to nothing.
                let length_m = observer.at.distance(target.at);
                let inner = |distance_m: f64| (1e-3..1.0 - 1e-3).contains(&(distance_m / length_m));
                if !inner(rise.grazing.distance_m) {
                    continue;
                }
                let risen = |more_m: f64| {
                    let (mut observer, mut target) = (observer, target);
                    observer.above_m += if raised == Raised::Target { 0.0 } else { rise.rise_m + more_m };
                    target.above_m += if raised == Raised::Observer { 0.0 } else { rise.rise_m + more_m };
                    line_of_sight(lattice, observer, target, curvature)
                };
                // Of heights of millions of meters an f64 keeps some 1e-9, and the line is lifted by a thousandth at least.
                let little_m = 1e-3;
                let enough = match risen(little_m) {
                    Sight::Blocked(blocker) => !inner(blocker.distance_m),
                    sight => sight == Sight::Clear,
                };
                assert!(enough, "{name}: {observer:?} {target:?} {rise:?}");
                assert!(
                    matches!(risen(-little_m), Sight::Blocked(_)),
                    "{name}: {observer:?} {target:?} {rise:?}"
                );
            }
        }
    }
}

#[test]
fn after_an_edit_lines_see_the_new_ground_and_the_old_snapshot_its_own() {
    let (_, lattice) = grounds().swap_remove(1);
    let before = SightGround::new(Arc::new(lattice.clone()));
    let mut edited = lattice;
    for row in 20..40 {
        edited.pin(Post { column: 33, row }, 50.0);
    }
    let rect = PostRect { first: Post { column: 33, row: 20 }, last: Post { column: 33, row: 39 } };
    let after = SightGround::again(Arc::clone(before.pyramid()), Arc::new(edited.clone()), &[rect]);
    let end = |column: f64| SightEnd { at: ORIGIN + DVec2::new(column, 30.0) * CELL, above_m: 2.0 };
    assert_eq!(before.line_of_sight(end(3.0), end(60.5), Curvature::FLAT), Sight::Clear);
    let blocked = line_of_sight(&edited, end(3.0), end(60.5), Curvature::FLAT);
    assert!(matches!(blocked, Sight::Blocked(_)));
    assert_eq!(after.line_of_sight(end(3.0), end(60.5), Curvature::FLAT), blocked);
    after.pyramid().check(&edited);
}

/// Where a ray first meets any of all the triangles: every one is tried (Möller and Trumbore 1997).
fn brute_force(lattice: &Lattice, ray: Ray, farthest_m: f64) -> Option<(f64, DVec3)> {
    let direction = ray.direction.normalize();
    let corner = |column: u32, row: u32| {
        let at = DVec2::new(f64::from(column), f64::from(row)) * lattice.cell();
        at.extend(f64::from(lattice.height(Post { column, row })))
    };
    let mut first: Option<(f64, DVec3)> = None;
    for row in 0..lattice.rows() - 1 {
        for column in 0..lattice.columns() - 1 {
            let [sw, se] = [corner(column, row), corner(column + 1, row)];
            let [nw, ne] = [corner(column, row + 1), corner(column + 1, row + 1)];
            let triangles = if column % 2 == row % 2 {
                [[sw, se, ne], [sw, ne, nw]]
            } else {
                [[sw, se, nw], [se, ne, nw]]
            };
            for [a, b, c] in triangles {
                let (u, v) = (b - a, c - a);
                let across = direction.cross(v);
                let determinant = u.dot(across);
                let from = ray.origin - a;
                let first_part = from.dot(across) / determinant;
                let second = from.cross(u);
                let second_part = direction.dot(second) / determinant;
                let distance = v.dot(second) / determinant;
                const BORDER: f64 = 1e-9;
                let inside = first_part >= -BORDER
                    && second_part >= -BORDER
                    && first_part + second_part <= 1.0 + BORDER
                    && distance >= 0.0
                    && distance <= farthest_m;
                if inside && first.is_none_or(|(nearest, _)| distance < nearest) {
                    first = Some((distance, u.cross(v).normalize()));
                }
            }
        }
    }
    first
}

#[test]
fn a_ray_meets_the_triangle_that_trying_every_one_finds() {
    let mut random = Random(4);
    let mut grounds: Vec<_> =
        grounds().into_iter().filter(|(name, _)| *name != "far from sea level").collect();
    let mut bumps = Random(5);
    grounds.push(("small", lattice(13, 9, |_| (bumps.part() * 40.0) as f32)));
    for (name, lattice) in grounds {
        let ground = SightGround::new(Arc::new(lattice));
        let lattice = ground.lattice();
        let (low, high) = lattice.height_range();
        let (low, high) = (f64::from(low) - 20.0, f64::from(high) + 20.0);
        let extent = lattice.extent().max;
        let (mut met, mut missed) = (0, 0);
        for _ in 0..500 {
            let mut spot = |spread: f64| {
                let plan = extent * DVec2::new(random.part(), random.part()) * spread
                    - extent * (spread - 1.0) / 2.0;
                plan.extend(low + (high - low) * random.part())
            };
            let (origin, toward) = (spot(1.4), spot(1.0));
            let ray = Ray { origin, direction: toward - origin };
            let farthest_m = if random.below(4) == 0 { origin.distance(toward) } else { f64::INFINITY };
            let found = ground.pick(ray, farthest_m);
            let expected = brute_force(lattice, ray, farthest_m);
            match (found, expected) {
                (Some(RayHit { distance_m, at, normal }), Some((distance, expected_normal))) => {
                    let far = 1e-6 * distance.max(1.0);
                    assert!((distance_m - distance).abs() < far, "{name}: {ray:?} {distance_m} {distance}");
                    let along = ray.origin + ray.direction.normalize() * distance_m;
                    assert!(along.distance(at) < far, "{name}: {ray:?} {along} {at}");
                    assert!((normal.length() - 1.0).abs() < 1e-12 && normal.z > 0.0);
                    // Where two triangles meet either may answer.
                    met += u32::from(normal.dot(expected_normal) > 1.0 - 1e-9);
                }
                (None, None) => missed += 1,
                _ => panic!("{name}: {ray:?} found {found:?}, every triangle {expected:?}"),
            }
        }
        assert!(met > 50 && missed > 20, "{name}: {met} met, {missed} missed");
    }
}

#[test]
fn rays_straight_down_along_edges_and_from_below_meet_the_ground_too() {
    let ground = SightGround::new(Arc::new(lattice(33, 33, |(column, _)| column as f32)));
    let cast = |origin: DVec3, direction: DVec3| ground.pick(Ray { origin, direction }, f64::INFINITY);
    let down = cast(DVec3::new(100.0, 125.0, 500.0), DVec3::NEG_Z).expect("a post below");
    assert_eq!((down.distance_m, down.at), (490.0, DVec3::new(100.0, 125.0, 10.0)));
    let up = cast(DVec3::new(103.0, 126.0, -50.0), DVec3::Z * 7.0).expect("the ground above");
    assert!((up.distance_m - 60.3).abs() < 1e-9 && up.normal.z > 0.0, "{up:?}");
    assert_eq!(cast(DVec3::new(100.0, 125.0, 500.0), DVec3::Z), None, "away from the ground");
    // Along the row of posts at y = 125, down at 45°: x + z falls to where the ground, x/10, is.
    let along = cast(DVec3::new(0.0, 125.0, 220.0), DVec3::new(1.0, 0.0, -1.0)).expect("the row");
    assert!((along.at.x - 200.0).abs() < 1e-9 && (along.at.z - 20.0).abs() < 1e-9, "{along:?}");
    let border = cast(DVec3::new(0.0, 0.0, 220.0), DVec3::new(1.0, 0.0, -1.0)).expect("the border");
    assert!((border.at.x - 200.0).abs() < 1e-9, "{border:?}");
    assert_eq!(cast(DVec3::new(100.0, -1.0, 50.0), DVec3::NEG_Z), None, "beside the model");
}

#[test]
fn what_is_no_ray_meets_nothing() {
    let ground = SightGround::new(Arc::new(lattice(9, 9, |_| 0.0)));
    let origin = DVec3::new(40.0, 40.0, 10.0);
    for (origin, direction, farthest_m) in [
        (origin, DVec3::ZERO, f64::INFINITY),
        (origin, DVec3::NAN, f64::INFINITY),
        (origin, DVec3::new(0.0, 0.0, f64::NEG_INFINITY), f64::INFINITY),
        (DVec3::NAN, DVec3::NEG_Z, f64::INFINITY),
        (origin, DVec3::NEG_Z, f64::NAN),
        (origin, DVec3::NEG_Z, -1.0),
        (origin, DVec3::NEG_Z, 9.9),
    ] {
        assert_eq!(
            ground.pick(Ray { origin, direction }, farthest_m),
            None,
            "{origin} {direction} {farthest_m}"
        );
    }
    assert!(ground.pick(Ray { origin, direction: DVec3::NEG_Z }, 10.0).is_some());
    let far = Ray { origin: DVec3::new(1e12, 40.0, 10.0), direction: DVec3::new(-1e12, 0.0, -10.0) };
    assert!(ground.pick(far, f64::INFINITY).is_some());
}

#[test]
fn a_ray_passes_through_a_hole_and_meets_what_lies_behind_it() {
    let holed = lattice(41, 9, |(column, _)| if (10..=14).contains(&column) { f32::NAN } else { 0.0 });
    let ground = SightGround::new(Arc::new(holed));
    let toward =
        |x: f64| Ray { origin: DVec3::new(x - 50.0, 45.0, 50.0), direction: DVec3::new(1.0, 0.01, -1.0) };
    assert!(ground.pick(toward(85.0), f64::INFINITY).is_some());
    assert_eq!(ground.pick(toward(95.0), f64::INFINITY), None, "a triangle with a corner in the hole");
    assert_eq!(ground.pick(toward(120.0), f64::INFINITY), None);
    assert!(ground.pick(toward(155.0), f64::INFINITY).is_some());
    // From below, through the hole, with level ground before and behind: no side is changed over the hole.
    let rising = Ray { origin: DVec3::new(95.0, 45.0, -1.0), direction: DVec3::new(50.0, 0.0, 2.0) };
    assert_eq!(ground.pick(rising, f64::INFINITY), None);
}

#[test]
fn a_ray_meets_a_plane_and_a_cone_where_algebra_says() {
    let plane = SightGround::new(Arc::new(lattice(65, 65, |(column, row)| {
        (f64::from(column) * CELL.x * 0.25 - f64::from(row) * CELL.y * 0.5) as f32
    })));
    let ray = Ray { origin: DVec3::new(77.0, 311.0, 900.0), direction: DVec3::new(0.3, 0.2, -1.0) };
    let direction = ray.direction.normalize();
    // o.z + t d.z = (o.x + t d.x)/4 − (o.y + t d.y)/2.
    let exact = (ray.origin.x * 0.25 - ray.origin.y * 0.5 - ray.origin.z)
        / (direction.z - direction.x * 0.25 + direction.y * 0.5);
    let hit = plane.pick(ray, f64::INFINITY).expect("the plane");
    assert!((hit.distance_m - exact).abs() < 1e-9, "{} {exact}", hit.distance_m);
    assert!(hit.normal.distance(DVec3::new(-0.25, 0.5, 1.0).normalize()) < 1e-9);

    let apex = DVec2::new(320.0, 400.0);
    let cone = |at: DVec2| 500.0 - at.distance(apex);
    let ground = SightGround::new(Arc::new(lattice(65, 65, |(column, row)| {
        cone(DVec2::new(f64::from(column), f64::from(row)) * CELL) as f32
    })));
    // Level, 100 m below the apex: the cone is 100 m wide there, to the west of the apex.
    let level = Ray { origin: DVec3::new(5.0, 400.0, 400.0), direction: DVec3::X };
    let hit = ground.pick(level, f64::INFINITY).expect("the cone");
    assert!((hit.at.x - 220.0).abs() < 1e-3, "{hit:?}");
}

#[test]
fn over_a_cone_a_target_must_rise_to_the_tangent() {
    // A cone of slope 1 with its apex 100 m high, and level ground around.
    let apex = DVec2::new(640.0, 800.0);
    let cone = lattice(129, 129, |(column, row)| {
        let at = DVec2::new(f64::from(column), f64::from(row)) * CELL;
        (100.0 - at.distance(apex)).max(0.0) as f32
    });
    let ground = SightGround::new(Arc::new(cone));
    let end = |x: f64| SightEnd { at: ORIGIN + DVec2::new(x, 800.0), above_m: 0.0 };
    let (observer, target) = (end(140.0), end(1140.0));
    // The line from the ground, 500 m before the apex, over it, 500 m on: twice as high.
    let rise = ground.required_rise(observer, target, Curvature::FLAT, Raised::Target);
    let rise = rise.expect("both on the ground").expect("a cone between");
    assert_eq!((rise.rise_m, rise.grazing.distance_m, rise.grazing.height_m), (200.0, 500.0, 100.0));
    let both = ground.required_rise(observer, target, Curvature::FLAT, Raised::Both);
    assert_eq!(both.expect("ground").expect("a cone").rise_m, 100.0);
}

#[test]
fn over_the_sea_the_rise_is_that_of_the_horizon() {
    let sea = lattice(1025, 9, |_| 0.0);
    let ground = SightGround::new(Arc::new(sea));
    let curvature = Curvature { radius_m: 6_371_000.0, refraction: 0.0 };
    let end = |x: f64, above_m: f64| SightEnd { at: ORIGIN + DVec2::new(x, 50.0), above_m };
    // √(2Rh) = 5048 m to the horizon of an eye at 2 m; what stands 4000 m beyond shows above 4000²/2R = 1.256 m.
    let horizon_m = (2.0 * curvature.radius_m * 2.0f64).sqrt();
    let target = end(horizon_m + 4000.0, 0.0);
    let rise = ground.required_rise(end(0.0, 2.0), target, curvature, Raised::Target);
    let rise = rise.expect("both on the sea").expect("water between");
    assert!((rise.rise_m - 4000.0 * 4000.0 / (2.0 * curvature.radius_m)).abs() < 1e-3, "{rise:?}");
    assert!((rise.grazing.distance_m - horizon_m).abs() < 15.0, "{rise:?}");
}

#[test]
fn lines_from_afar_from_nowhere_and_of_no_length_end() {
    let ground = lattice(9, 7, |(column, row)| (column * row) as f32);
    let met = |from: DVec2, to: DVec2| {
        let mut parts = Vec::new();
        let _ = crossings(&ground, from, to, |crossing| {
            parts.push(crossing.part);
            let last = DVec2::new(8.0, 6.0);
            assert!(
                crossing.grid.cmpge(DVec2::ZERO).all() && crossing.grid.cmple(last).all(),
                "{crossing:?}"
            );
            ControlFlow::<()>::Continue(())
        });
        assert!(parts.is_sorted(), "{from} {to}: {parts:?}");
        parts.len()
    };
    let inside = DVec2::new(3.5, 2.25);
    assert_eq!(met(DVec2::NAN, inside) + met(inside, DVec2::new(f64::INFINITY, 1.0)), 0);
    assert_eq!(met(inside, inside), 0);
    assert_eq!(met(DVec2::splat(-1e300), DVec2::new(-5.0, 3.0)), 0);
    assert_eq!(met(DVec2::new(-1e308, 2.0), DVec2::new(1e308, 2.0)), 0, "longer than a number can say");
    assert!(met(DVec2::new(-1e18, 2.0), DVec2::new(1e18, 2.0)) <= 9);
    // Across from outside: both borders, every column and diagonal between.
    assert_eq!(met(DVec2::new(-4.0, 2.5), DVec2::new(12.0, 2.5)), 9 + 8);
    assert_eq!(met(DVec2::new(12.0, 2.5), DVec2::new(-4.0, 2.5)), 9 + 8);
    assert_eq!(
        met(DVec2::new(-4.0, 2.5), DVec2::new(12.0, 30.0)),
        met(DVec2::new(12.0, 30.0), DVec2::new(-4.0, 2.5))
    );
    assert_eq!(met(DVec2::new(-1.0, 7.0), DVec2::new(9.0, 6.5)), 0, "beside it");
}

#[test]
fn a_profile_over_a_sinusoid_has_its_length_its_ascent_and_its_extremes() {
    // z = 50 sin(2πx/640) along x; over ten whole waves it climbs and falls 10 × 100 m.
    let wave = lattice(641, 5, |(column, _)| {
        (50.0 * (std::f64::consts::TAU * f64::from(column) * CELL.x / 640.0).sin()) as f32
    });
    let line = [ORIGIN + DVec2::new(0.0, 20.0), ORIGIN + DVec2::new(6400.0, 20.0)];
    let summary = ProfileSummary::from_stations(&profile(&wave, &line));
    assert!(
        (summary.ascent_m - 1000.0).abs() < 1e-3 && (summary.descent_m - 1000.0).abs() < 1e-3,
        "{summary:?}"
    );
    let (lowest, highest) = (summary.lowest.expect("ground"), summary.highest.expect("ground"));
    assert_eq!((lowest.height_m, highest.height_m), (-50.0, 50.0));
    assert_eq!((highest.station_m, lowest.station_m), (160.0, 480.0), "the first of each");
    // ∫√(1 + (dz/dx)²) dx by steps of a millimeter.
    let amplitude = 50.0 * std::f64::consts::TAU / 640.0;
    let exact: f64 = (0..640_000)
        .map(|step| {
            (amplitude * (std::f64::consts::TAU * (f64::from(step) + 0.5) / 640_000.0).cos()).hypot(1.0)
                * 1e-3
        })
        .sum();
    assert!((summary.ground_length_m / (10.0 * exact) - 1.0).abs() < 1e-4, "{summary:?} {exact}");
    assert_eq!(summary.length_m, 6400.0);
}

#[test]
fn on_a_real_elevation_model_lines_and_rays_are_those_of_the_plain_walk() {
    let Some(path) = crate::common::data::data("dem/bigtujunga_utm11_i16_tiled.tif") else { return };
    let bytes = std::fs::read(path).expect("readable");
    let raster = sandtable_dem::read::read("dem.tif", &bytes, &Default::default()).expect("sound");
    let ground = SightGround::new(Arc::new(Lattice::from_raster(&raster).expect("in meters")));
    ground.pyramid().check(ground.lattice());
    let mut random = Random(6);
    for _ in 0..3000 {
        let (observer, target) = ends(ground.lattice(), &mut random);
        let plain = line_of_sight(ground.lattice(), observer, target, Curvature::default());
        assert_eq!(plain, ground.line_of_sight(observer, target, Curvature::default()));
    }
}
