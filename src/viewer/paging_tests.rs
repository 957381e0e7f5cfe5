//! The window over a file that is larger than memory: an overview at once, pages as they are read, exact answers.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use std::{env, fs, thread};

use egui_kittest::kittest::{NodeT, Queryable};
use glam::{DVec2, DVec3, Vec2};

use crate::active_tool::ActiveTool;
use crate::app_tests::{AppHarness, IN_VIEW, app, click, until, window};
use crate::loading::load_paged;
use crate::measuring::{MeasureKind, Measuring};
use crate::opened::{OpenedScene, OpeningView};
use crate::paging::{MOST_PAGES, PagingStage};
use crate::scene_load::LoaderSlot;
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::write;
use sandtable_draw::patches::PatchId;
use sandtable_geom::crs::Crs;
use sandtable_raster::raster::{Raster, Samples, north_up_nodes};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_view::camera::Camera;
use sandtable_view::navigation::pose::ViewPose;
use sandtable_walk::paged_elevation::PagedElevation;

/// A file of 1100 × 700 posts, ten meters apart, in a folder of its own.
struct LargeFile {
    folder: PathBuf,
    path: PathBuf,
    lattice: Lattice,
}

impl LargeFile {
    fn new(name: &str) -> Self {
        let folder = env::temp_dir().join(format!("sandtable-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        let height = |at: u32| {
            let (x, y) = (f64::from(at % 1100), f64::from(at / 1100));
            (80.0 * libm::sin(x * 0.021) * libm::cos(y * 0.017) + 6.0 * libm::sin(x * 0.9 + y)) as f32 + 500.0
        };
        let samples = Samples::F32((0..1100 * 700).map(height).collect());
        let mut raster =
            Raster::new(1100, samples).placed(north_up_nodes(DVec2::new(7.5e5, 4.02e6), DVec2::splat(10.0)));
        raster.crs = Some(Crs::parse("EPSG:32616").expect("known"));
        let path = folder.join("large.tif");
        let format = DemFormat::to_write("tif").expect("written");
        let written = write::write(&raster, format, "large").expect("written");
        fs::write(&path, written.bytes).expect("written");
        Self { folder, path, lattice: Lattice::from_raster(&raster).expect("sound") }
    }

    fn opened(&self) -> Box<OpenedScene> {
        let elevation = PagedElevation::open(&self.path, 1000).expect("readable").expect("large");
        assert_eq!((elevation.overview.width, elevation.overview.height), (550, 350));
        let shown = (&OpeningView::default(), &LoaderSlot::default());
        let loaded = load_paged((&self.path, &[]), elevation, shown, || (), &|_| ()).expect("sound");
        assert!(loaded.editor.is_none(), "nothing of it is edited");
        loaded.opened
    }
}

impl Drop for LargeFile {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.folder).ok();
    }
}

/// Draws frames until all is read that the camera needs; returns the patches that the renderer shows then.
fn settle(opened: &mut OpenedScene, shown: &mut std::collections::BTreeSet<PatchId>) {
    let end = Instant::now() + Duration::from_secs(120);
    loop {
        opened.paged.as_mut().expect("on disk").follow();
        let changes = opened.frame((800, 500), Camera::size).expect("in sight").changes;
        changes.hidden.iter().chain(&changes.dropped).for_each(|patch| {
            shown.remove(patch);
        });
        shown.extend(
            changes.triangles.iter().filter(|patch| !patch.triangles.is_empty()).map(|patch| patch.patch),
        );
        if !opened.is_paging() {
            return;
        }
        assert!(Instant::now() < end, "{:?}", opened.paged.as_ref().expect("on disk").stage());
        thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn a_file_that_fits_is_no_terrain_on_disk() {
    let file = LargeFile::new("fits");
    assert!(PagedElevation::open(&file.path, 1_000_000).expect("readable").is_none());
    assert!(
        PagedElevation::open(Path::new(concat!(env!("SANDTABLE_ROOT"), "assets/jacksboro/valley.asc")), 10)
            .expect("readable")
            .is_none()
    );
    let degrees =
        PagedElevation::open(Path::new(concat!(env!("SANDTABLE_ROOT"), "assets/jacksboro/dem.tif")), 10)
            .expect("readable");
    assert!(degrees.is_none(), "what fits is resampled in memory");
}

#[test]
fn a_large_file_is_flown_over_in_pages_whose_heights_are_those_of_the_file() {
    let file = LargeFile::new("flown");
    let mut opened = file.opened();
    let mut shown = std::collections::BTreeSet::new();
    settle(&mut opened, &mut shown);
    assert_eq!(opened.paged.as_ref().expect("on disk").stage(), PagingStage::Shown);
    assert!(!shown.is_empty());
    for step in 0..12u8 {
        let at = DVec3::new(1_000.0 + 700.0 * f64::from(step), 3_000.0, 720.0);
        let pose = ViewPose::looking(at, at + DVec3::new(900.0, 500.0, -160.0)).expect("a direction");
        opened.navigator.place(pose, &|_| None);
        settle(&mut opened, &mut shown);
        let paged = opened.paged.as_ref().expect("on disk");
        assert!(paged.kept.pages <= MOST_PAGES && paged.kept.counts.peak <= MOST_PAGES, "{:?}", paged.kept);
        let camera = opened.camera((800, 500)).expect("in sight");
        let mut known = 0;
        for pixel in [Vec2::new(400.0, 450.0), Vec2::new(250.0, 380.0), Vec2::new(600.0, 480.0)] {
            let Some(pick) = opened.pick(&camera, pixel) else { continue };
            let own = |at: DVec2| ground_height(&file.lattice, Interpolation::Planar, at).height_m();
            if let Some(ground_m) = pick.ground_m {
                assert_eq!(Some(ground_m), own(pick.place.at), "step {step}");
                assert!((pick.world.z - ground_m).abs() < 1e-6, "what is clicked at lies on the ground");
                known += 1;
            }
            let context = egui::Context::default();
            if let Some(job) = opened.exact_pick((&camera, pixel), &pick, &context) {
                let exact = loop {
                    match job.poll() {
                        Some(done) => break done.expect("no fault").expect("readable").expect("ground"),
                        None => thread::sleep(Duration::from_millis(1)),
                    }
                };
                assert_eq!(exact.ground_m, own(exact.place.at));
            }
        }
        assert!(known > 0, "step {step}: ground near the eye is in memory");
    }
    let counts = opened.paged.as_ref().expect("on disk").kept.counts;
    assert!(counts.loads > 0 && counts.loads < 11 * 18, "{counts:?}");
}

fn paged_window(file: &LargeFile) -> AppHarness {
    let mut harness = window(Some(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml"))));
    let opened = file.opened();
    let state = harness.state_mut().as_mut().expect("shown");
    (state.opened, state.session) = (Some(opened), None);
    until(&mut harness, |app| !app.is_busy());
    harness.run_steps(3);
    harness
}

#[test]
fn what_terrain_on_disk_does_not_allow_is_disabled_with_its_reason() {
    let file = LargeFile::new("refused");
    let harness = paged_window(&file);
    harness.get_by_label("1100 x 700 samples on disk");
    harness.get_by_label_contains("pages in memory");
    harness.get_by_label_contains("are more than the window holds in memory");
    assert!(harness.get_by_label("crater").accesskit_node().is_disabled());
    assert!(harness.get_by_label("Viewshed").accesskit_node().is_disabled());
    assert!(!harness.get_by_label("Line").accesskit_node().is_disabled());
    let mut harness = harness;
    let state = harness.state_mut().as_mut().expect("shown");
    state.take_snapshot();
    assert!(app(&harness).notice_texts().any(|text| text.contains("not edited, saved or drawn")));
}

#[test]
fn a_click_and_a_line_on_terrain_on_disk_say_what_the_file_holds() {
    let file = LargeFile::new("measured");
    let mut harness = paged_window(&file);
    click(&mut harness, IN_VIEW);
    until(&mut harness, |app| !app.is_busy());
    let place = app(&harness).picked.clone().expect("picked").place.expect("ground");
    assert!(place.height.ends_with("m (ground)"), "{place:?}");
    let state = harness.state_mut().as_mut().expect("shown");
    let (from, to) = (file.lattice.origin() + 505.0, file.lattice.origin() + DVec2::new(4_005.0, 705.0));
    let mut line = Measuring::new(MeasureKind::Line);
    line.click(from);
    line.click(to);
    let mut wanted = line.clone();
    wanted.measure(&sandtable_terrain::sight::ground::SightGround::new(Arc::new(file.lattice.clone())));
    state.take_tool(Some(ActiveTool::Measure(line)));
    state.measure_again();
    until(&mut harness, |app| !app.is_busy());
    let Some(ActiveTool::Measure(measured)) = &app(&harness).tool else { panic!("a line") };
    assert_eq!(measured.facts, wanted.facts);
    assert_eq!(measured.profile.len(), wanted.profile.len());
}
