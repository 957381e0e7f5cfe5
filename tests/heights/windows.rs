//! Elevation that is read where queries need it answers as elevation in memory does, to the last bit.

use std::path::{Path, PathBuf};

use glam::{DAffine2, DMat2, DVec2};
use sandtable_base::message::chain::error_text;
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::hints::DemOptions;
use sandtable_dem::write;
use sandtable_geom::crs::Crs;
use sandtable_query::dataset::{Dataset, DatasetOptions};
use sandtable_query::dem::{OpenedDem, open_either};
use sandtable_query::ground::QueriedGround;
use sandtable_query::viewshed::ViewshedSummary;
use sandtable_query::windowed_elevation::GroundReach;
use sandtable_raster::raster::{Raster, Samples};
use sandtable_raster::stats::{RasterSurvey, Stats};
use sandtable_raster::void_counts::VoidCounts;
use sandtable_terrain::profile::{Sampling, sampled_profile};
use sandtable_terrain::query::Surface;
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::line::{SightEnd, line_of_sight};
use sandtable_terrain::sight::rise::{Raised, required_rise};
use sandtable_terrain::sight::viewshed::{Sector, ViewshedOptions, viewshed};

use crate::common::data::{data, files_below};
use crate::common::scratch::Scratch;
use crate::heights::{ALL, bits, numbers};

/// The same elevation in memory and in windows.
struct Pair {
    path: PathBuf,
    name: String,
    kept: Dataset,
    windows: Dataset,
}

impl Pair {
    /// `None` where the file has no windows, or is none of elevation.
    fn open(path: &Path) -> Option<Self> {
        let open =
            |most_kept| Dataset::open(path, &DatasetOptions { most_kept, ..DatasetOptions::default() });
        let name = path.display().to_string();
        match (open(u64::MAX), open(0)) {
            (Ok(kept), Ok(windows)) if windows.reads_windows() => {
                Some(Self { path: path.to_owned(), name, kept, windows })
            }
            (Ok(_), Err(error)) => panic!("{name}: {}", error_text(&error)),
            _ => None,
        }
    }

    /// Positions on and around the raster: anywhere, on samples, on its border.
    fn positions(&self, count: usize) -> Vec<DVec2> {
        let header = self.kept.header();
        let size = DVec2::new(header.width.into(), header.height.into());
        let mut random = numbers(count as u64);
        (0..count)
            .map(|index| {
                let part = DVec2::new(random(), random());
                let grid = match index % 4 {
                    0 => (part * 1.1 - 0.05) * size,
                    1 => (part * size).floor() + 0.5,
                    2 => DVec2::new((part.x * size.x).floor(), if part.y < 0.5 { 0.0 } else { size.y }),
                    _ => part * size,
                };
                header.map_from_grid.transform_point2(grid)
            })
            .collect()
    }

    fn assert_heights(&self) {
        let wgs84 = Crs::wgs84();
        let at = self.positions(200);
        let own = self.kept.crs();
        let elsewhere = at.iter().map(|&at| own.transform(&wgs84, at).unwrap_or(DVec2::NAN)).collect();
        for (from, at) in [(&own, at), (&wgs84, elsewhere)] {
            for surface in [Surface::Source, Surface::Ground, Surface::Scene, Surface::Displayed] {
                for interpolation in ALL {
                    let ask = |dataset: &Dataset| {
                        let answers = dataset.heights(surface, interpolation, from, &at);
                        answers
                            .map(|answers| answers.into_iter().map(bits).collect::<Vec<_>>())
                            .map_err(|error| error_text(&error))
                    };
                    let (kept, windows) = (ask(&self.kept), ask(&self.windows));
                    assert!(
                        kept == windows,
                        "{}: {surface:?} {interpolation:?} in {}",
                        self.name,
                        from.name()
                    );
                }
            }
        }
        assert_eq!(self.kept.ground_note(), self.windows.ground_note(), "{}", self.name);
    }

    /// Both grounds; `None` where neither has one.
    fn grounds(&self, reach: &GroundReach) -> Option<[QueriedGround; 2]> {
        match (self.kept.ground(reach), self.windows.ground(reach)) {
            (Ok(kept), Ok(windows)) => {
                assert_eq!(kept.crs, windows.crs, "{}", self.name);
                assert_eq!(kept.vertical_datum, windows.vertical_datum, "{}", self.name);
                assert_eq!(kept.lattice.map_extent(), windows.lattice.map_extent(), "{}", self.name);
                Some([kept, windows])
            }
            (Err(kept), Err(windows)) => {
                assert_eq!(error_text(&kept), error_text(&windows), "{}", self.name);
                None
            }
            (kept, windows) => panic!("{}: {:?}, {:?}", self.name, kept.err(), windows.err()),
        }
    }

    /// Profiles and lines of sight along random lines, which may leave the elevation.
    fn assert_lines(&self) {
        let crs = self.kept.crs();
        for line in self.positions(20).chunks_exact(4) {
            let reach = GroundReach { crs: &crs, at: line, around_m: 0.0 };
            let Some([kept, windows]) = self.grounds(&reach) else { return };
            let to_ground = |&at: &DVec2| crs.transform(&kept.crs, at).unwrap_or(DVec2::NAN);
            let vertices: Vec<DVec2> = line.iter().map(to_ground).collect();
            for interpolation in ALL {
                let step_m = Some(vertices[0].distance(vertices[1]) / 7.0).filter(|step_m| *step_m > 0.0);
                let profile = |ground: &QueriedGround| {
                    let sampling = Sampling { interpolation, step_m };
                    let stations = sampled_profile(&ground.lattice, &vertices, sampling);
                    let bits_of = |at: DVec2| at.to_array().map(f64::to_bits);
                    let bits =
                        stations.iter().map(|at| (at.station_m.to_bits(), bits_of(at.at), bits(at.ground)));
                    bits.collect::<Vec<_>>()
                };
                assert!(profile(&kept) == profile(&windows), "{}: {interpolation:?} {line:?}", self.name);
            }
            let ends =
                [0, 1].map(|index| SightEnd { at: vertices[index], above_m: 2.0 + index as f64 * 30.0 });
            let sight = |ground: &QueriedGround| {
                let [observer, target] = ends;
                let curvature = Curvature::default();
                let rise = required_rise(&ground.lattice, observer, target, curvature, Raised::Target);
                format!("{:?} {rise:?}", line_of_sight(&ground.lattice, observer, target, curvature))
            };
            assert_eq!(sight(&kept), sight(&windows), "{}: {line:?}", self.name);
        }
    }

    fn assert_viewsheds(&self) {
        let (crs, mut random) = (self.kept.crs(), numbers(5));
        let positions = self.positions(4);
        let all = GroundReach { crs: &crs, at: &positions, around_m: f64::INFINITY };
        let Some([kept, windows]) = self.grounds(&all) else { return };
        let bits_of = |ground: &QueriedGround| -> Vec<u32> {
            let heights = ground.lattice.heights().iter();
            heights.map(|height| if height.is_nan() { u32::MAX } else { height.to_bits() }).collect()
        };
        assert!(bits_of(&kept) == bits_of(&windows), "{}: all of the ground", self.name);
        for &at in &positions {
            let cells = 3.0 + 40.0 * random();
            let range_m = cells * kept.lattice.cell().max_element();
            let Some([kept, windows]) = self.grounds(&GroundReach { at: &[at], around_m: range_m, ..all })
            else {
                return;
            };
            let Ok(observer_at) = crs.transform(&kept.crs, at) else { continue };
            let options = ViewshedOptions {
                range_m,
                sector: if random() < 0.3 { Sector::between(200.0, 40.0) } else { Sector::ALL },
                target_above_m: if random() < 0.5 { 0.0 } else { 3.0 },
                ..ViewshedOptions::new(SightEnd { at: observer_at, above_m: 5.0 })
            };
            let seen = [&kept, &windows].map(|ground| viewshed(&ground.lattice, &options));
            let [Ok(whole), Ok(part)] = &seen else {
                assert_eq!(seen[0].as_ref().err(), seen[1].as_ref().err(), "{}: {at}", self.name);
                continue;
            };
            let summary = |ground: &QueriedGround, seen| ViewshedSummary::new(&ground.lattice, seen);
            assert_eq!(summary(&kept, whole), summary(&windows, part), "{}: {at} {options:?}", self.name);
            for (post, visibility) in windows.lattice.held().posts().zip(&part.posts) {
                assert_eq!(whole.posts[kept.lattice.index(post)], *visibility, "{}: {post:?}", self.name);
            }
        }
    }

    fn assert_statistics(&self) {
        let open = |most_kept| open_either(&self.path, &DemOptions::default(), most_kept);
        let (Ok(OpenedDem::Kept(kept)), Ok(OpenedDem::Windows(mut windows))) = (open(u64::MAX), open(0))
        else {
            panic!("{}: not opened again", self.name)
        };
        let RasterSurvey { stats, voids, .. } = Stats::of_windows(&mut *windows).expect("readable");
        let bits = |stats: Stats| [stats.min, stats.max, stats.mean, stats.std].map(f64::to_bits);
        let whole = Stats::new(&kept.raster);
        assert_eq!((stats.valid, bits(stats)), (whole.valid, bits(whole)), "{}", self.name);
        assert_eq!(voids, VoidCounts::of(&kept.raster), "{}", self.name);
    }

    fn assert_alike(&self) {
        self.assert_statistics();
        self.assert_heights();
        self.assert_lines();
        self.assert_viewsheds();
    }
}

/// Stores heights as samples of a type.
type MakeSamples = fn(Vec<f64>) -> Samples;

/// Hills with holes, 420 by 330 samples: two tiles by two.
fn hills(samples: MakeSamples) -> Raster {
    let (width, height) = (420u32, 330u32);
    let value = |at: u32| {
        let (column, row) = (f64::from(at % width), f64::from(at / width));
        let is_hole = (column - 250.0).hypot(row - 240.0) < 20.0 || at.is_multiple_of(1009);
        let hill = 300.0
            + 200.0 * libm::sin(column * 0.021) * libm::cos(row * 0.017)
            + 9.0 * libm::sin(column * row);
        if is_hole { f64::NAN } else { hill }
    };
    Raster::new(width, samples((0..width * height).map(value).collect()))
}

fn narrow(values: Vec<f64>) -> Samples {
    Samples::F32(values.into_iter().map(|value| value as f32).collect())
}

fn whole_meters(values: Vec<f64>) -> Samples {
    Samples::F32(values.into_iter().map(|value| value.round() as f32).collect())
}

fn written(scratch: &Scratch, name: &str, raster: &Raster) -> Pair {
    let format = DemFormat::to_write("tif").expect("written");
    let file = write::write(raster, format, name).expect("it has a place");
    let path = scratch.folder().join(format!("{name}.tif"));
    std::fs::write(&path, file.bytes).expect("a scratch folder");
    Pair::open(&path).expect("a GeoTIFF has windows")
}

#[test]
fn windows_answer_as_memory_does_in_every_type_system_and_direction() {
    let scratch = Scratch::new();
    let place = |axes: DMat2| DAffine2 { matrix2: axes, translation: DVec2::new(512_345.3, 4_012_345.7) };
    let north_up = place(DMat2::from_diagonal(DVec2::new(9.7, -9.7)));
    let degrees = DAffine2 {
        matrix2: DMat2::from_diagonal(DVec2::new(1.0 / 3600.0, -1.0 / 3600.0)),
        translation: DVec2::new(-111.3, 37.25),
    };
    let mercator = DAffine2 { translation: DVec2::new(-12_381_000.0, 4_470_000.0), ..north_up };
    let cases: [(&str, MakeSamples, DAffine2, Option<u32>); 9] = [
        ("float", narrow, north_up, Some(32612)),
        ("double", Samples::F64, north_up, Some(32612)),
        ("whole", whole_meters, north_up, Some(32612)),
        ("south-up", narrow, place(DMat2::from_diagonal(DVec2::new(9.7, 9.7))), Some(32612)),
        ("west", narrow, place(DMat2::from_diagonal(DVec2::new(-9.7, -5.1))), None),
        (
            "turned",
            narrow,
            place(DMat2::from_angle(0.3) * DMat2::from_diagonal(DVec2::new(9.7, -9.7))),
            Some(32612),
        ),
        ("degrees", whole_meters, degrees, Some(4326)),
        ("degrees-double", Samples::F64, degrees, Some(4326)),
        ("mercator", narrow, mercator, Some(3857)),
    ];
    for (name, samples, map_from_grid, code) in cases {
        let crs = code.map(|code| Crs::from_epsg(code).expect("known"));
        let raster = Raster { map_from_grid, georeferenced: true, crs, ..hills(samples) };
        written(&scratch, name, &raster).assert_alike();
    }
}

#[test]
fn a_collar_without_data_moves_the_warped_ground_alike() {
    let scratch = Scratch::new();
    let mut raster = hills(narrow);
    let Samples::F32(samples) = &mut raster.samples else { panic!("narrow") };
    for (index, sample) in samples.iter_mut().enumerate() {
        let (column, row) = (index % 420, index / 420);
        if !((41..=390).contains(&column) && (7..=310).contains(&row)) {
            *sample = f32::NAN;
        }
    }
    let map_from_grid = DAffine2 {
        matrix2: DMat2::from_diagonal(DVec2::new(1.0 / 1200.0, -1.0 / 1200.0)),
        translation: DVec2::new(7.0, 46.0),
    };
    let crs = Some(Crs::wgs84());
    let raster = Raster { map_from_grid, georeferenced: true, crs, ..raster };
    written(&scratch, "collar", &raster).assert_alike();
    let none = Raster { samples: Samples::F32(vec![f32::NAN; 420 * 330]), ..raster };
    written(&scratch, "none", &none).assert_heights();
}

#[test]
fn unpacked_formats_answer_from_windows_as_from_memory() {
    let scratch = Scratch::new();
    let folder = scratch.folder();
    let north_up = DAffine2 {
        matrix2: DMat2::from_diagonal(DVec2::new(12.5, -12.5)),
        translation: DVec2::new(412_345.5, 4_612_345.5),
    };
    let crs = Some(Crs::from_epsg(32612).expect("known"));
    let raster = Raster { map_from_grid: north_up, georeferenced: true, crs, ..hills(whole_meters) };
    let save = |name: &str, bytes: &[u8]| std::fs::write(folder.join(name), bytes).expect("a scratch folder");
    let bt = write::write(&raster, DemFormat::to_write("bt").expect("written"), "a").expect("north up");
    save("a.bt", &bt.bytes);
    let values: Vec<f64> =
        raster.samples.iter().map(|value| if value.is_nan() { -9999.0 } else { value }).collect();
    let floats: Vec<u8> = values.iter().flat_map(|&value| (value as f32).to_le_bytes()).collect();
    save("b.flt", &floats);
    let place = "xllcorner 412345\nyllcorner 4612345\ncellsize 12.5\nNODATA_value -9999\n";
    save("b.hdr", format!("ncols 420\nnrows 330\n{place}byteorder LSBFIRST\n").as_bytes());
    // Two bands side by side in each pixel, of which the first is read, after 7 bytes of something else.
    let pixels = values.iter().flat_map(|&value| [value as i16, 77]).flat_map(i16::to_be_bytes);
    save("c.bip", &std::iter::repeat_n(9, 7).chain(pixels).collect::<Vec<u8>>());
    let layout = "NBITS 16\nNBANDS 2\nLAYOUT BIP\nSKIPBYTES 7\nPIXELTYPE SIGNEDINT\nBYTEORDER M\n";
    save("c.hdr", format!("NROWS 330\nNCOLS 420\n{place}{layout}").as_bytes());
    let doubles: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    save("d.img", &doubles);
    let envi = "ENVI\nsamples = 420\nlines = 330\nbands = 1\ndata type = 5\ninterleave = bsq\nbyte order = 0\n\
                data ignore value = -9999\ndata gain values = {0.5}\ndata offset values = {20}\n\
                map info = {UTM, 1, 1, 412345, 4612345, 12.5, 12.5, 12, North, WGS-84}\n";
    save("d.img.hdr", envi.as_bytes());
    let degree = |at: u32| if at % 997 == 5 { i16::MIN } else { (at * 31 % 2003) as i16 };
    save("N43E007.hgt", &(0..1201 * 1201).map(degree).flat_map(i16::to_be_bytes).collect::<Vec<u8>>());
    for name in ["a.bt", "b.flt", "c.bip", "d.img", "N43E007.hgt"] {
        Pair::open(&folder.join(name)).unwrap_or_else(|| panic!("{name} has windows")).assert_alike();
    }
    // A file cut short is refused before anything is read.
    save("b.flt", &floats[..floats.len() - 1]);
    let options = DatasetOptions { most_kept: 0, ..DatasetOptions::default() };
    let refused = error_text(&Dataset::open(&folder.join("b.flt"), &options).err().expect("cut short"));
    assert!(refused.contains("420 x 330"), "{refused}");
}

#[test]
fn tiles_in_a_folder_answer_from_windows_as_joined() {
    let scratch = Scratch::new();
    let folder = scratch.folder().join("tiles");
    std::fs::create_dir(&folder).expect("a scratch folder");
    let whole = hills(narrow);
    let format = DemFormat::to_write("tif").expect("written");
    // Tiles share two rows and columns; where they do, those further south-east hold other heights. One is missing.
    for (number, (column, row)) in [(0, 0), (148, 0), (296, 0), (0, 168), (296, 168)].into_iter().enumerate()
    {
        let (width, height) = (150.min(420 - column), 170.min(330 - row));
        let value =
            |at: u32| whole.at(column + at % width, row + at / width) as f32 + (row + column) as f32 / 900.0;
        let samples = Samples::F32((0..width * height).map(value).collect());
        let corner = DVec2::new(600_000.0 + 10.0 * f64::from(column), 5_100_000.0 - 10.0 * f64::from(row));
        let map_from_grid =
            DAffine2 { matrix2: DMat2::from_diagonal(DVec2::new(10.0, -10.0)), translation: corner };
        let crs = Some(Crs::from_epsg(32612).expect("known"));
        let tile = Raster { map_from_grid, georeferenced: true, crs, ..Raster::new(width, samples) };
        let bytes = write::write(&tile, format, "tile").expect("it has a place").bytes;
        std::fs::write(folder.join(format!("{number}.tif")), bytes).expect("a scratch folder");
    }
    let pair = Pair::open(&folder).expect("tiles have windows");
    pair.assert_alike();
    // A tile that is lost before a query meets it is an error that names it.
    let options = DatasetOptions { most_kept: 0, ..DatasetOptions::default() };
    let opened = Dataset::open(&folder, &options).expect("tiles have windows");
    std::fs::remove_file(folder.join("1.tif")).expect("it is there");
    let at = [DVec2::new(602_100.0, 5_099_500.0)];
    let lost = opened.heights(Surface::Source, ALL[1], &opened.crs(), &at);
    let fault = lost.map_err(|error| error_text(&error));
    assert!(fault.as_ref().is_err_and(|fault| fault.contains("1.tif")), "{fault:?}");
}

#[test]
fn windows_of_real_files_answer_as_memory_does() {
    let Some(folder) = data("dem") else { return };
    let formats = folder.with_file_name("dem_formats");
    let files = files_below(&folder).into_iter().chain(files_below(&formats));
    let pairs: Vec<Pair> = files.filter_map(|path| Pair::open(&path)).collect();
    assert!(pairs.len() >= 40, "{} files have windows", pairs.len());
    for pair in &pairs {
        pair.assert_alike();
    }
}
