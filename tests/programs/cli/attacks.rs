//! Small files that would cost much: each is refused within a bound on memory.

use std::io::Write;
use std::process::Command;

use flate2::Compression;
use flate2::write::GzEncoder;
use sandtable_base::archive;

use crate::common::scratch::Scratch;

/// An elevation file of nine samples a kilometer apart.
const HILL: &str = "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1000\n1 2 3 4 5 6 7 8 9\n";

/// Runs the program where no more than `megabytes` of address space may be had, and returns its exit code and what it says.
#[cfg(target_os = "linux")]
pub(super) fn run_within(megabytes: u32, scratch: &Scratch, arguments: &[&str]) -> (Option<i32>, String) {
    let limited = format!("ulimit -v {} && exec \"$0\" \"$@\"", megabytes * 1024);
    let output = Command::new("sh")
        .args(["-c", &limited, env!("CARGO_BIN_EXE_sandtable")])
        .args(arguments)
        .current_dir(scratch.folder())
        .env("RAYON_NUM_THREADS", "2")
        .output()
        .expect("a shell");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

fn gzipped(head: &[u8], zeros: usize) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(head).expect("memory");
    let block = vec![b'0'; 1 << 20];
    (0..zeros >> 20).for_each(|_| encoder.write_all(&block).expect("memory"));
    encoder.finish().expect("memory")
}

#[test]
#[cfg(target_os = "linux")]
fn a_packed_file_is_unpacked_no_further_than_its_head_promises() {
    let scratch = Scratch::new();
    scratch.write("bomb.bt.gz", gzipped(b"", 600 << 20));
    let grid = "ncols 10\nnrows 10\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
    scratch.write("bomb.asc.gz", gzipped(grid.as_bytes(), 600 << 20));
    let mut member = grid.as_bytes().to_vec();
    member.resize(200 << 20, b' ');
    scratch.write("bomb.zip", archive::zip(&[("a.asc", &member)]).expect("memory"));
    scratch.write("bomb.hgt.gz", gzipped(b"", 600 << 20));
    let mut document = b"<?xml version=\"1.0\"?><kml><Document>".to_vec();
    document.resize(200 << 20, b' ');
    scratch.write("bomb.kmz", archive::zip(&[("doc.kml", &document)]).expect("memory"));
    scratch.write("hill.asc", HILL);
    scratch.write(
        "bomb.toml",
        "[terrain]\ndem = \"hill.asc\"\ncrs = \"EPSG:32616\"\n[[road]]\nfile = \"bomb.kmz\"\n",
    );
    let (code, text) = run_within(400, &scratch, &["check", "bomb.toml"]);
    assert_eq!(code, Some(1), "{text}");
    assert!(
        text.contains("bomb.toml:5:8: error[unreadable-file]") && text.contains("unpacks to more than"),
        "{text}"
    );
    for (name, said) in [
        ("bomb.bt.gz", "it does not start with 'binterr1.'"),
        ("bomb.asc.gz", "unpacks to more than"),
        ("bomb.zip", "unpacks to more than"),
        ("bomb.hgt.gz", "unpacks to more than"),
    ] {
        let (code, text) = run_within(400, &scratch, &["dem", "info", name]);
        assert_eq!(code, Some(1), "{name}: {text}");
        assert!(text.contains(name) && text.contains(said), "{name}: {text}");
    }
}

/// A little-endian TIFF with `data` before its only directory, of entries of tag, type, count and value.
fn tiff_of(data: &[u8], entries: &[(u16, u16, u32, u32)]) -> Vec<u8> {
    let mut file = b"II*\0".to_vec();
    file.extend((8 + data.len() as u32).to_le_bytes());
    file.extend(data);
    file.extend((entries.len() as u16).to_le_bytes());
    for (tag, kind, count, value) in entries {
        file.extend(tag.to_le_bytes());
        file.extend(kind.to_le_bytes());
        file.extend(count.to_le_bytes());
        file.extend(value.to_le_bytes());
    }
    file.extend([0; 4]);
    file
}

/// A TIFF of so many 32-bit floats a side in tiles of 512, none of which was ever written.
pub(super) fn sparse_tiff(side: u32) -> Vec<u8> {
    let tiles = side.div_ceil(512).pow(2);
    let after = 8 + 11 * 12 + 6;
    let entries = [
        (256, 4, 1, side),
        (257, 4, 1, side),
        (258, 3, 1, 32),
        (259, 3, 1, 1),
        (262, 3, 1, 1),
        (277, 3, 1, 1),
        (322, 3, 1, 512),
        (323, 3, 1, 512),
        (324, 4, tiles, after),
        (325, 4, tiles, after),
        (339, 3, 1, 3),
    ];
    let mut file = tiff_of(b"", &entries);
    file.resize(after as usize + 4 * tiles as usize, 0);
    file
}

/// A TIFF of two by two bytes whose GeoKey directory claims `count` numbers.
fn tiff(count: u32) -> Vec<u8> {
    let entries = [
        (256, 3, 1, 2),
        (257, 3, 1, 2),
        (258, 3, 1, 8),
        (259, 3, 1, 1),
        (262, 3, 1, 1),
        (273, 4, 1, 8),
        (278, 3, 1, 2),
        (279, 4, 1, 4),
        (34735, 3, count, 8),
    ];
    tiff_of(b"\x01\x02\x03\x04", &entries)
}

#[test]
#[cfg(target_os = "linux")]
fn a_tag_that_claims_more_than_the_file_reserves_nothing() {
    let scratch = Scratch::new();
    scratch.write("claim.tif", tiff(0x03ff_ffff));
    let (code, text) = run_within(600, &scratch, &["dem", "info", "claim.tif"]);
    assert!(code.is_some(), "aborted: {text}");
    scratch.write("sound.tif", tiff(2));
    let (code, text) = run_within(600, &scratch, &["dem", "info", "sound.tif"]);
    assert_eq!(code, Some(0), "{text}");
}

#[test]
fn a_road_thinner_than_any_is_refused_at_its_place() {
    let scratch = Scratch::new();
    scratch.write("hill.asc", HILL);
    let scene = "[terrain]\ndem = \"hill.asc\"\ncrs = \"EPSG:32616\"\n[[road]]\nwidth = 1e-9\nprofile = \"conform\"\n\
                 points = [[100, 1500], [2900, 1500]]\n";
    scratch.write("thin.toml", scene);
    let said = crate::cli::run_in(scratch.folder(), &["check", "thin.toml"]).failed(1);
    assert!(said.contains("thin.toml:5") && said.contains("0.01"), "{said}");
}

#[test]
#[cfg(target_os = "linux")]
fn a_ring_that_crosses_itself_a_million_times_is_refused_by_name() {
    let scratch = Scratch::new();
    scratch.write("hill.asc", HILL);
    let count = 2001;
    let vertex = |index: usize| {
        let angle = (index * 1000 % count) as f64 / count as f64 * std::f64::consts::TAU;
        format!("[{},{}]", 1500.0 + 900.0 * angle.cos(), 1500.0 + 900.0 * angle.sin())
    };
    let ring: Vec<String> = (0..=count).map(|index| vertex(index % count)).collect();
    let feature = format!(
        "{{\"type\":\"Feature\",\"properties\":{{\"name\":\"star\"}},\"geometry\":{{\"type\":\"Polygon\",\"coordinates\":[[{}]]}}}}",
        ring.join(",")
    );
    scratch.write("star.geojson", feature);
    for (table, keys) in [("building", "height = 10"), ("area", "cover = \"forest\""), ("lake", "level = 3")]
    {
        let scene = format!(
            "[terrain]\ndem = \"hill.asc\"\ncrs = \"EPSG:32616\"\n[[{table}]]\nfile = \"star.geojson\"\ncrs = \"EPSG:32616\"\n{keys}\n"
        );
        scratch.write("star.toml", scene);
        let (code, text) = run_within(600, &scratch, &["check", "star.toml"]);
        assert_eq!(code, Some(1), "{table}: {text}");
        assert!(text.contains("star.toml:5") && text.contains("polygon 'star' of 2001 vertices"), "{text}");
    }
}
