//! A walk over terrain that is not in memory shows what it shows where all of it is.

use std::collections::BTreeSet;
use std::fs;
use std::io::Cursor;

use glam::Vec3;
use sandtable_dem::hints::DemHints;
use sandtable_dem::read::read;
use sandtable_dem::tiff::windows::GeoTiffWindows;
use sandtable_raster::raster::Raster;
use sandtable_raster::windows::Windows;
use sandtable_roam::active::ActiveSet;
use sandtable_roam::bintree::Triangle;
use sandtable_roam::block::{BlockSource, WholeGround};
use sandtable_roam::criterion::spheres::Spheres;
use sandtable_roam::paging::ground::{PagedGround, PagingOptions, exact_spheres, finest_that_fits};
use sandtable_roam::paging::walk::walk;
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_roam::refine::rebuild::rebuild;
use sandtable_roam::spheres::SphereMap;

use crate::common::data::data;
use crate::common::tiles::{Image, Packing, file};
use crate::paging::blocks::in_memory;

/// Cameras of a walk across the whole terrain.
const FRAMES: u8 = 9;

type Corners = [(i32, i32); 3];

fn corners(triangle: Triangle) -> Corners {
    triangle.corners().map(|vertex| (vertex.x, vertex.y))
}

/// The leaves of the mesh that `rebuild` makes of the whole.
fn rebuilt(whole: WholeGround<'_>, eye: Vec3) -> BTreeSet<Corners> {
    let layout = whole.ground.layout;
    let criterion = Spheres::new(whole.ground, whole.spheres, eye);
    let active: ActiveSet = rebuild(layout, &criterion, layout.patches());
    let mut leaves = BTreeSet::new();
    let mut stack: Vec<Triangle> =
        layout.patches().flat_map(|corner| Triangle::roots(corner, layout.patch())).collect();
    while let Some(triangle) = stack.pop() {
        if triangle.is_finest() || !active.is_active(triangle.split_vertex()) {
            leaves.insert(corners(triangle));
        } else {
            stack.extend(triangle.split());
        }
    }
    leaves
}

/// Walks with `capacity` patches beside the whole in memory; returns the most triangles of a frame.
fn assert_walks_agree(
    whole: &Raster,
    mut paged: PagedGround<impl Windows, impl Fn(PatchedGround<'_>) -> SphereMap>,
    (patch, reach, capacity): (u32, f32, usize),
) -> usize {
    let mut most = 0;
    in_memory(whole, patch, reach, |whole| {
        let size = whole.ground.lattice.extent().max.as_vec2();
        let (_, high) = whole.ground.lattice.height_range();
        for frame in 0..FRAMES {
            let along = f32::from(frame) / f32::from(FRAMES - 1);
            let eye = Vec3::new(size.x * along, size.y * (0.3 + 0.5 * along * along), high + 20.0);
            let mut found = Vec::new();
            let corners_of: Vec<_> = paged.layout().patches().collect();
            walk(&mut paged, eye, corners_of, &mut |triangle| found.push(corners(triangle))).expect("sound");
            let count = found.len();
            let found: BTreeSet<Corners> = found.into_iter().collect();
            assert_eq!(found.len(), count, "a triangle twice in frame {frame}");
            assert!(found == rebuilt(whole, eye), "frame {frame}");
            paged.check();
            assert!(paged.kept() <= capacity && paged.counts().peak <= capacity);
            most = most.max(count);
        }
    });
    let counts = paged.counts();
    assert!(counts.evictions > 0 && counts.loads > capacity as u64, "{counts:?}");
    most
}

fn hilly(column: u32, row: u32) -> f32 {
    let (x, y) = (f64::from(column), f64::from(row));
    let sea = column / 40 == 9 && row > 100;
    if sea { -9999.0 } else { (libm::sin(x * 0.031) * 90.0 + libm::cos(y * 0.017 + x * 0.002) * 70.0) as f32 }
}

#[test]
fn a_walk_over_a_tiled_file_is_the_walk_over_its_terrain_in_memory() {
    let bytes = file(&[Image::of(1537, 1025, hilly)], 256, Packing::Deflate);
    let whole = read("a.tif", &bytes, &DemHints::default()).expect("sound");
    let windows =
        GeoTiffWindows::open("a.tif", Cursor::new(bytes), &DemHints::default(), 1 << 21).expect("sound");
    let options = PagingOptions { patch: 64, capacity: 12 };
    let paged = PagedGround::open(windows, exact_spheres(25.0), &options).expect("sound");
    let most = assert_walks_agree(&whole, paged, (64, 25.0, 12));
    assert!(most > 1500, "{most}");
}

#[test]
fn walks_over_real_files_are_the_walks_over_their_terrain_in_memory() {
    for (name, reach, capacity) in
        [("dem/bigtujunga_utm11_i16_tiled.tif", 6.0, 5), ("dem_formats/cog_f32_overviews.tif", 2.0, 2)]
    {
        let Some(path) = data(name) else { return };
        let bytes = fs::read(&path).expect("readable");
        let whole = read(name, &bytes, &DemHints::default()).expect("sound");
        let source = fs::File::open(&path).expect("readable");
        let windows = GeoTiffWindows::open(name, source, &DemHints::default(), 1 << 20).expect("sound");
        let options = PagingOptions { patch: 16, capacity };
        let paged = PagedGround::open(windows, exact_spheres(reach), &options).expect("sound");
        assert_walks_agree(&whole, paged, (16, reach, capacity));
    }
}

#[test]
fn far_patches_are_shown_without_being_read() {
    let whole = crate::paging::blocks::raster(300, 300, 9, 0);
    let options = PagingOptions { patch: 32, capacity: 4 };
    let mut paged = PagedGround::open(whole, exact_spheres(2.0), &options).expect("sound");
    let patches: Vec<_> = paged.layout().patches().collect();
    let mut count = 0;
    walk(&mut paged, Vec3::new(0.0, 0.0, 1e6), patches, &mut |_| count += 1).expect("nothing to read");
    assert_eq!((count, paged.counts().loads), (2 * 100, 0));
}

#[test]
fn the_finest_overview_whose_patches_are_few_enough_is_taken() {
    let full = Image::of(3000, 3000, |column, _| (column % 7) as f32);
    let (half, quarter) = (full.halved(), full.halved().halved());
    let bytes = file(&[full, half, quarter], 512, Packing::Deflate);
    let open =
        || GeoTiffWindows::open("a.tif", Cursor::new(&bytes), &DemHints::default(), 1 << 22).expect("sound");
    assert_eq!(finest_that_fits(open(), 2).expect("an overview fits").size(), (1500, 1500));
    assert_eq!(finest_that_fits(open(), 4).expect("it fits itself").size(), (3000, 3000));
    let bytes = file(&[Image::of(3000, 3000, |_, _| 1.0)], 512, Packing::Deflate);
    let alone =
        GeoTiffWindows::open("a.tif", Cursor::new(&bytes), &DemHints::default(), 1 << 22).expect("sound");
    let said = finest_that_fits(alone, 2).err().expect("nothing fits").to_string();
    assert!(said.contains("3000 x 3000") && said.contains("gdaladdo"), "{said}");
}
