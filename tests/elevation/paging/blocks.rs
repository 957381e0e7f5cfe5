//! A patch that is read alone is bit for bit the patch of the whole terrain in memory.

use std::sync::Arc;

use glam::{DAffine2, DMat2, DVec2};
use proptest::prelude::*;
use sandtable_geom::crs::Crs;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{Raster, Samples};
use sandtable_raster::windows::{RasterWindow, Windows};
use sandtable_roam::bintree::Triangle;
use sandtable_roam::block::{BlockSource, PatchBlock, WholeGround};
use sandtable_roam::culling::PatchHeights;
use sandtable_roam::errors::exact::triangle_error;
use sandtable_roam::graph::Vertex;
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::paging::ground::{PagedGround, PagingError, PagingOptions, exact_spheres};
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_terrain::lattice::{Lattice, Post};

use crate::paging::windows::Seeded;

/// Rough ground with holes and a sea in the west, in cells that no f32 can hold.
pub fn raster(width: u32, height: u32, seed: u64, holes: u32) -> Raster {
    let mut seeded = Seeded(seed);
    let sample = |index: u32| {
        let (x, y) = (f64::from(index % width), f64::from(index / width));
        let rough = f64::from(seeded.below(1 << 20)) * 1e-5;
        let hole = holes > 0 && (seeded.below(holes) == 0 || x * 5.0 < f64::from(width));
        if hole { f32::NAN } else { (libm::sin(x * 0.11) * 31.0 + libm::cos(y * 0.07) * 17.0 + rough) as f32 }
    };
    let axes = DMat2::from_diagonal(DVec2::new(10.3, -7.1));
    Raster {
        driver: "test",
        data_type: "Float32",
        width,
        height,
        samples: Samples::F32((0..width * height).map(sample).collect()),
        meters_per_z: 1.0,
        states_z_unit: false,
        map_from_grid: DAffine2 { matrix2: axes, translation: DVec2::new(5e5, 4e6) },
        georeferenced: true,
        crs: None,
        ..Raster::without_place(1, 1)
    }
}

/// Assembles `raster` in memory and gives it with its patches to `work`.
pub fn in_memory<T>(raster: &Raster, patch: u32, reach: f32, work: impl FnOnce(WholeGround<'_>) -> T) -> T {
    let lattice = Lattice::from_raster(raster).expect("sound");
    let layout = PatchLayout::new(lattice.columns(), lattice.rows(), patch).expect("sound");
    let ground = PatchedGround { lattice: &lattice, layout: &layout };
    let spheres = exact_spheres(reach)(ground);
    work(WholeGround { ground, spheres: &spheres })
}

fn bits(block: &PatchBlock) -> [Vec<u32>; 4] {
    let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect();
    [bits(&block.plan[0]), bits(&block.plan[1]), bits(&block.z), bits(&block.radii)]
}

fn assert_all_patches_match(raster: &Raster, options: PagingOptions) {
    let mut paged = PagedGround::open(raster.clone(), exact_spheres(40.0), &options).expect("sound");
    let metric = Raster {
        samples: Samples::F32(raster.samples.iter().map(|z| (z * raster.meters_per_z) as f32).collect()),
        meters_per_z: 1.0,
        ..raster.clone()
    };
    in_memory(&metric, options.patch, 40.0, |mut whole| {
        let heights = PatchHeights::new(whole.ground);
        for corner in whole.ground.layout.patches() {
            let (found, wanted) =
                (paged.block(corner).expect("memory"), whole.block(corner).expect("memory"));
            assert!(bits(&found) == bits(&wanted), "{corner:?} of {options:?}");
            assert_eq!(paged.bounds(corner), heights.bounds(whole.ground, corner), "{corner:?}");
            let largest = wanted.radii.iter().fold(0f32, |a, &b| a.max(b));
            assert_eq!(paged.summary(corner).radius, largest, "{corner:?}");
            paged.check();
        }
    });
}

#[test]
fn every_patch_read_alone_is_that_of_the_whole_bit_for_bit() {
    for (width, height, holes) in [(161, 129, 0), (170, 140, 900), (33, 300, 50), (2, 40, 0)] {
        let raster = Raster { meters_per_z: 1.7, ..raster(width, height, 5, holes) };
        for patch in [2, 8, 16, 64] {
            assert_all_patches_match(&raster, PagingOptions { patch, capacity: 3 });
        }
    }
}

#[test]
fn rounding_does_not_depend_on_where_a_piece_begins() {
    // At the east border triangles are cut to 23 columns, a length that no division is exact by. Far east of the
    // first post, planes told from there would round otherwise than planes told from a piece's own first post.
    let (columns, skipped, rows, patch) = (4024, 3968, 33, 32);
    let part_columns = columns - skipped;
    let whole_layout = PatchLayout::new(columns, rows, patch).expect("sound");
    let part_layout = PatchLayout::new(part_columns, rows, patch).expect("sound");
    for seed in 0..20 {
        let mut seeded = Seeded(seed);
        let heights: Vec<f32> = (0..columns * rows)
            .map(|index| ((index % columns) as f32 - 4000.0) * 91.3 + seeded.below(1 << 16) as f32 * 1e-7)
            .collect();
        let kept = |(index, _): &(usize, &f32)| *index as u32 % columns >= skipped;
        let part: Vec<f32> = heights.iter().enumerate().filter(kept).map(|(_, height)| *height).collect();
        let place = (DVec2::ZERO, DVec2::ONE);
        let whole = Lattice::new(place.0, place.1, columns, heights).expect("sound");
        let part = Lattice::part(place, Post { column: skipped, row: 0 }, part_columns, part).expect("sound");
        let mut stack = Triangle::roots(Vertex::new(32, 0), 32).to_vec();
        while let Some(triangle) = stack.pop() {
            let [apex, left, right] = triangle.corners().map(|vertex| vertex.moved(skipped as i32, 0));
            let same = Triangle { apex, left, right };
            let (found, wanted) = (
                triangle_error(&part, &part_layout, &triangle),
                triangle_error(&whole, &whole_layout, &same),
            );
            assert_eq!(found.to_bits(), wanted.to_bits(), "{triangle:?} of seed {seed}: {found} {wanted}");
            if !triangle.is_finest() {
                stack.extend(triangle.split());
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn any_terrain_s_patches_are_those_of_the_whole(
        width in 2u32..120, height in 2u32..120, seed in any::<u64>(), holes in 0u32..400, exponent in 1u32..7,
    ) {
        let mut raster = raster(width, height, seed, holes);
        if let Samples::F32(samples) = &mut raster.samples {
            // A lattice holds some data.
            samples[0] = 1.0;
        }
        assert_all_patches_match(&raster, PagingOptions { patch: 1 << exponent, capacity: 4 });
    }
}

/// Fails whenever it is told to.
struct Failing {
    raster: Raster,
    fails: Arc<std::sync::atomic::AtomicBool>,
}

impl Windows for Failing {
    fn metadata(&self) -> &Raster {
        &self.raster
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        if self.fails.load(std::sync::atomic::Ordering::Relaxed) {
            return Err(DemErrorKind::Broken { format: "test", reason: "the disk is gone".into() });
        }
        self.raster.samples(window)
    }
}

#[test]
fn a_failing_read_names_the_patch_and_spoils_nothing() {
    let fails = Arc::new(std::sync::atomic::AtomicBool::new(false));
    let failing = Failing { raster: raster(100, 100, 1, 0), fails: Arc::clone(&fails) };
    let options = PagingOptions { patch: 16, capacity: 2 };
    let mut paged = PagedGround::open(failing, exact_spheres(3.0), &options).expect("sound");
    let kept = [Vertex::new(0, 0), Vertex::new(16, 0)].map(|corner| paged.block(corner).expect("sound"));
    fails.store(true, std::sync::atomic::Ordering::Relaxed);
    let error = paged.block(Vertex::new(48, 32)).expect_err("the disk is gone");
    assert_eq!((error.column, error.row), (48, 32));
    assert!(error.to_string().contains("the disk is gone"), "{error}");
    assert_eq!(paged.block(Vertex::new(0, 0)).expect("still kept"), kept[0]);
    paged.check();
    fails.store(false, std::sync::atomic::Ordering::Relaxed);
    assert!(paged.block(Vertex::new(48, 32)).is_ok());
    assert_eq!((paged.counts().loads, paged.counts().evictions), (3, 1));
    fails.store(true, std::sync::atomic::Ordering::Relaxed);
    let failing = Failing { raster: raster(100, 100, 1, 0), fails };
    assert!(matches!(PagedGround::open(failing, exact_spheres(3.0), &options), Err(PagingError::Block(_))));
}

#[test]
fn what_would_have_to_be_resampled_is_refused_with_the_words_for_whole_rasters() {
    let refused = |change: &dyn Fn(&mut Raster)| {
        let mut raster = raster(20, 20, 1, 0);
        change(&mut raster);
        let opened = PagedGround::open(raster, exact_spheres(1.0), &PagingOptions::default());
        opened.err().expect("refused").to_string()
    };
    let south_up = refused(&|raster| raster.map_from_grid.matrix2.y_axis.y = 7.1);
    assert!(south_up.contains("upside down"), "{south_up}");
    let rotated = refused(&|raster| raster.map_from_grid.matrix2.x_axis.y = 1.0);
    assert!(rotated.contains("rotated"), "{rotated}");
    let degrees = refused(&|raster| raster.crs = Some(Crs::wgs84()));
    assert!(degrees.contains("meters") && degrees.contains("gdalwarp"), "{degrees}");
    let nowhere = refused(&|raster| raster.georeferenced = false);
    assert!(nowhere.contains("how far apart"), "{nowhere}");
    let empty = refused(&|raster| raster.samples = Samples::F32(vec![f32::NAN; 400]));
    assert!(empty.contains("no data"), "{empty}");
    let high = refused(&|raster| raster.samples = Samples::F32(vec![3e38; 400]));
    assert!(high.contains("no-data value"), "{high}");
}

#[test]
fn patches_of_sizes_that_make_none_are_refused() {
    for patch in [0, 1, 3, 48, 2048, u32::MAX] {
        let options = PagingOptions { patch, ..PagingOptions::default() };
        let opened = PagedGround::open(raster(20, 20, 1, 0), exact_spheres(1.0), &options);
        assert!(matches!(opened, Err(PagingError::Patches { .. })), "{patch}");
    }
}
