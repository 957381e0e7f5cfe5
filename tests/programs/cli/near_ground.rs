//! `render` of large elevation from near by: windows of all samples in the ground of their means.

use image::RgbImage;
use serde_json::Value;

use crate::cli::run_in;
use crate::common::scratch::Scratch;

/// A limit by which the ground below is large: its outer ground has an eighth of the posts a side.
pub const LARGE: [&str; 2] = ["--limit", "pictured-samples=400k"];

/// Samples along a side of the ground.
pub const SIDE: u32 = 900;

/// Hills of several sizes with a road, a river, a house, a hedge and a name, and cameras that see them.
const SCENE: &str = r#"
[terrain]
dem = "hill.tif"
[style.contours]
interval = 20
[[road]]
name = "valley"
points = [[500500, 4000500], [502500, 4001500], [504000, 4003800], [506500, 4005000], [508500, 4008500]]
width = 20
[[river]]
name = "brook"
points = [[507000, 4001000], [504500, 4002500], [503000, 4005000], [501000, 4008000]]
width = 15
[[building]]
name = "barn"
points = [[503250, 4002900], [503310, 4002900], [503310, 4002940], [503250, 4002940]]
height = 18
[[fence]]
name = "hedge"
points = [[501500, 4001200], [503500, 4002500], [505500, 4006500]]
[[label]]
at = [503280, 4002920]
text = "Barn"
[[camera]]
name = "near"
eye = [502200, 4001300]
eye_height = 60
look_at = [504200, 4004200]
[[camera]]
name = "high"
eye = [501000, 4000800]
eye_elevation = 1500
look_at = [504000, 4004000]
[[camera]]
name = "part"
projection = "plan"
shows = [[503000, 4002500], [504500, 4003500]]
"#;

/// The height of a sample, counted from the south-west.
pub fn height(column: u32, row: u32) -> f64 {
    let (x, y) = (f64::from(column), f64::from(row));
    let hills = 120.0 * libm::sin(x * 0.011) * libm::cos(y * 0.013) + 25.0 * libm::sin(x * 0.07 + y * 0.05);
    300.0 + hills + 2.0 * libm::sin(x * 0.9) * libm::sin(y * 1.1)
}

/// A folder with a scene on the ground.
pub fn scene(text: &str) -> Scratch {
    let scratch = Scratch::new();
    let row = |row: u32| {
        let heights = (0..SIDE).map(|column| format!("{:.2}", height(column, SIDE - 1 - row)));
        heights.collect::<Vec<_>>().join(" ")
    };
    let rows: Vec<String> = (0..SIDE).map(row).collect();
    let head = format!("ncols {SIDE}\nnrows {SIDE}\nxllcorner 500000\nyllcorner 4000000\ncellsize 10\n");
    scratch.write("hill.asc", head + &rows.join("\n"));
    run_in(scratch.folder(), &["dem", "convert", "hill.asc", "hill.tif", "--source-crs", "EPSG:32616"]).ok();
    scratch.write("s.toml", text);
    scratch
}

/// A picture, and what the program says of it.
struct NearPicture {
    pixels: RgbImage,
    said: Value,
}

impl NearPicture {
    fn of(scratch: &Scratch, camera: &str, more: &[&str]) -> Self {
        let command =
            ["render", "s.toml", "--json", "--size", "480x270", "--camera", camera, "-o", "out.png"];
        let said = run_in(scratch.folder(), &[&command[..], more].concat()).ok();
        let pixels = image::open(scratch.at("out.png")).expect("a picture").into_rgb8();
        Self { pixels, said: serde_json::from_str(&said).expect("JSON") }
    }

    fn number(&self, of: &str) -> f64 {
        self.said.pointer(of).and_then(Value::as_f64).expect("a number")
    }

    /// The share of pixels that differ from those of another by no more than `levels`.
    fn share_within(&self, other: &Self, levels: u8) -> f64 {
        let pairs = self.pixels.pixels().zip(other.pixels.pixels());
        let is_near = |(a, b): &(&image::Rgb<u8>, &image::Rgb<u8>)| {
            a.0.iter().zip(b.0).all(|(a, b)| a.abs_diff(b) <= levels)
        };
        pairs.filter(is_near).count() as f64 / self.pixels.pixels().len() as f64
    }
}

#[test]
fn from_near_by_large_ground_looks_as_with_all_of_its_samples() {
    let scratch = scene(SCENE);
    // The ground that is far from a high eye has fewer posts than pixels.
    for (camera, least) in [("near", 0.99), ("high", 0.90), ("part", 0.99)] {
        let whole = NearPicture::of(&scratch, camera, &[]);
        let nested = NearPicture::of(&scratch, camera, &LARGE);
        assert!(nested.said["notes"].to_string().contains("the mean of up to 8 x 8"), "{}", nested.said);
        assert!(!whole.said["notes"].to_string().contains("the mean of"));
        let share = nested.share_within(&whole, 12);
        assert!(share > least, "{camera}: {share} of the pixels");
        // Nowhere does the background show through; means make the horizon lower by a part of a pixel.
        let [own, of_whole] = [&nested, &whole].map(|picture| picture.number("/filled_fraction"));
        assert!((own - of_whole).abs() < 2e-3, "{camera}: {own} {of_whole}");
        let [own, of_whole] = [&nested, &whole].map(|picture| picture.number("/ground_fraction"));
        assert!((own - of_whole).abs() < 5e-3, "{camera}: {own} {of_whole}");
    }
}

#[test]
fn each_thing_on_nested_ground_is_drawn_once() {
    let scratch = scene(SCENE);
    let [whole, nested] = [&[][..], &LARGE].map(|more| NearPicture::of(&scratch, "near", more));
    assert_eq!(whole.number("/triangles/buildings"), nested.number("/triangles/buildings"));
    for kind in ["lines", "roads"] {
        let [own, of_whole] = [&nested, &whole].map(|picture| picture.number(&format!("/triangles/{kind}")));
        assert!((0.9..1.1).contains(&(own / of_whole)), "{own} {of_whole} triangles of {kind}");
    }
    let labels = |picture: &NearPicture| picture.said["labels"].to_string();
    assert_eq!(labels(&whole), labels(&nested));
}

#[test]
fn pictures_of_all_cameras_are_those_of_each_alone() {
    let scratch = scene(SCENE);
    let size = ["--size", "240x135"];
    let all = [&["render", "s.toml", "--all-cameras", "-o", "all.png"], &size[..], &LARGE].concat();
    run_in(scratch.folder(), &all).ok();
    for camera in ["near", "part"] {
        let one = [&["render", "s.toml", "--camera", camera, "-o", "one.png"], &size[..], &LARGE].concat();
        run_in(scratch.folder(), &one).ok();
        let [one, of_all] = ["one.png".to_owned(), format!("all-{camera}.png")]
            .map(|name| std::fs::read(scratch.at(&name)).expect("a picture"));
        assert!(one == of_all, "{camera}");
    }
}
