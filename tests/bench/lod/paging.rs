//! Terrain out of memory's reach: what a walk reads and holds where only 64 of 16,384 patches are kept.
//!
//! The terrain, 8193² posts ten meters apart, is a formula: no file, and no memory but what paging takes.

use std::fs;
use std::time::Instant;

use glam::{DAffine2, DMat2, DVec2, Vec3};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{Raster, Samples};
use sandtable_raster::windows::{RasterWindow, Windows};
use sandtable_roam::block::BlockSource;
use sandtable_roam::graph::Vertex;
use sandtable_roam::paging::ground::{PagedGround, PagingOptions, exact_spheres};
use sandtable_roam::paging::walk::walk;
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_roam::spheres::SphereMap;
use sandtable_view::camera::Camera;
use sandtable_view::frustum::Frustum;

/// Posts a side.
const POSTS: u32 = 8193;

/// Meters between posts.
const CELL_M: f64 = 10.0;

/// Patches that are kept.
const CAPACITY: usize = 64;

/// Frames of each walk.
const FRAMES: u16 = 240;

/// Meters of distance a meter of error: two pixels of a picture 1920 pixels wide, opened 60°.
const REACH: f32 = 830.0;

/// Rolling ground: three waves across the diagonals, and a little roughness of its own at every post.
struct Rolling {
    bare: Raster,
    along: [Vec<f32>; 2],
}

impl Rolling {
    fn new() -> Self {
        let axes = DMat2::from_diagonal(DVec2::new(CELL_M, -CELL_M));
        let bare = Raster {
            driver: "formula",
            data_type: "Float32",
            width: POSTS,
            height: POSTS,
            samples: Samples::F32(Vec::new()),
            meters_per_z: 1.0,
            states_z_unit: false,
            map_from_grid: DAffine2 { matrix2: axes, translation: DVec2::new(5e5, 4e6) },
            georeferenced: true,
            crs: None,
            ..Raster::without_place(1, 1)
        };
        let wave = |posts: f64| (0..POSTS).map(move |at| libm::sin(f64::from(at) / posts) as f32);
        let along =
            |one: f64, other: f64| wave(one).zip(wave(other)).map(|(a, b)| a * 40.0 + b * 1.5).collect();
        Self { bare, along: [along(190.0, 23.0), along(150.0, 29.0)] }
    }
}

impl Windows for Rolling {
    fn metadata(&self) -> &Raster {
        &self.bare
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        let mut out = Vec::with_capacity(window.samples());
        for row in window.row..window.row + window.height {
            out.extend((window.column..window.column + window.width).map(|column| {
                let mixed = column.wrapping_mul(0x9e37_79b1) ^ row.wrapping_mul(0x85eb_ca77);
                let rough = (mixed.wrapping_mul(0xc2b2_ae35) >> 16) as f32 * (0.3 / 65536.0);
                self.along[0][column as usize] + self.along[1][row as usize] + rough
            }));
        }
        Ok(Samples::F32(out))
    }
}

/// The most memory that the process had since [`forget_peak`], in MiB; `None` where the system does not tell.
fn peak_mib() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse::<f64>().ok().map(|kib| kib / 1024.0)
}

/// Lets the system measure the peak anew; without effect where it cannot.
fn forget_peak() -> Option<f64> {
    let _ = fs::write("/proc/self/clear_refs", "5");
    peak_mib()
}

/// Prints the section.
pub fn print() {
    println!("\n## Terrain out of memory's reach\n");
    println!(
        "{POSTS}² posts by a formula, {CELL_M} m apart, patches of 64 cells, {CAPACITY} of {} kept, error reach {REACH} m a meter.\n",
        128 * 128
    );
    let before = forget_peak();
    let start = Instant::now();
    let options = PagingOptions { capacity: CAPACITY, ..PagingOptions::default() };
    let mut ground = PagedGround::open(Rolling::new(), exact_spheres(REACH), &options).expect("a formula");
    let posts = f64::from(POSTS) * f64::from(POSTS);
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "Summaries of all patches: {seconds:.1} s, {:.0} ns a post; memory {} MiB before, {} MiB at its peak (the heights alone are {:.0} MiB).\n",
        seconds * 1e9 / posts,
        before.map_or("?".into(), |mib| format!("{mib:.0}")),
        peak_mib().map_or("?".into(), |mib| format!("{mib:.0}")),
        posts * 4.0 / f64::from(1 << 20),
    );
    println!(
        "| meters a frame | patches in view | read to be shown | loads a frame | worst frame | ms a load | triangles | peak kept | peak MiB |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for (meters, elsewhere) in [(10.0, 100), (2.0, 110)] {
        row(&mut ground, meters, elsewhere);
    }
}

fn row<S: Fn(PatchedGround<'_>) -> SphereMap>(
    ground: &mut PagedGround<Rolling, S>,
    meters: f32,
    elsewhere: i32,
) {
    forget_peak();
    let eye_at = |frame: u16| Vec3::new(20_000.0, 15_000.0 + meters * f32::from(frame), 150.0);
    let (mut seen, mut near, mut triangles, mut worst) = (0, 0, 0u64, 0);
    // The first frame reads all it shows; what follows is the walk.
    let mut count_frame = |ground: &mut PagedGround<Rolling, S>, frame: u16| {
        let eye = eye_at(frame);
        let patches = in_view(ground, eye);
        let before = ground.counts().loads;
        seen += patches.len();
        near += patches.iter().filter(|&&corner| !ground.is_far(corner, eye)).count();
        walk(ground, eye, patches, &mut |_| triangles += 1).expect("a formula");
        ground.check();
        ground.counts().loads - before
    };
    let first = count_frame(ground, 0);
    let before = ground.counts().loads;
    for frame in 1..FRAMES {
        worst = worst.max(count_frame(ground, frame));
    }
    let loads = ground.counts().loads - before;
    let frames = f64::from(FRAMES);
    println!(
        "| {meters} | {:.0} | {:.1} | {:.3} (first frame {first}) | {worst} | {:.1} | {:.0} | {} | {} |",
        seen as f64 / frames,
        near as f64 / frames,
        loads as f64 / (frames - 1.0),
        load_ms(ground, elsewhere),
        triangles as f64 / frames,
        ground.counts().peak,
        peak_mib().map_or("?".into(), |mib| format!("{mib:.0}")),
    );
}

/// The least time of twenty loads of patches that are not kept, those from patch number `elsewhere` on.
fn load_ms<S: Fn(PatchedGround<'_>) -> SphereMap>(
    ground: &mut PagedGround<Rolling, S>,
    elsewhere: i32,
) -> f64 {
    let far = (0..20).map(|at| Vertex::new(64 * (elsewhere + at % 5), 64 * (elsewhere + at / 5)));
    far.map(|corner| {
        let start = Instant::now();
        ground.block(corner).expect("a formula");
        start.elapsed().as_secs_f64() * 1e3
    })
    .fold(f64::INFINITY, f64::min)
}

fn in_view<S: Fn(PatchedGround<'_>) -> SphereMap>(
    ground: &PagedGround<Rolling, S>,
    eye: Vec3,
) -> Vec<Vertex> {
    let ahead = eye + Vec3::new(0.0, 1000.0, -80.0);
    let camera = Camera::new(eye, ahead, 1.047, (1920, 1080), (1.0, 30_000.0)).expect("a sound camera");
    let frustum = Frustum::new(&camera);
    let visible =
        |&corner: &Vertex| ground.bounds(corner).is_some_and(|(min, max)| frustum.may_see(min, max));
    ground.layout().patches().filter(visible).collect()
}
