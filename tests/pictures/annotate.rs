//! Annotating whole pictures: promises about pixels.

use glam::Vec2;
use proptest::collection::vec;
use proptest::prelude::{ProptestConfig, any, prop_assert_eq, proptest};
use sandtable_annotate::annotation::{Annotations, PictureLabel};
use sandtable_annotate::legend::Legend;
use sandtable_annotate::north::{NorthArrow, NorthKind};
use sandtable_annotate::paint::annotate;
use sandtable_annotate::report::{AnnotationReport, FurnitureKind};
use sandtable_annotate::scale_bar::{ScaleBar, ScaleExtent};
use sandtable_description::words::LabelKind;
use sandtable_draw::color::Srgba;
use sandtable_draw::ground::ColorRamp;
use sandtable_draw::pixels::Pixels;

/// Colored grain, quickly made.
fn grain(width: u32, height: u32) -> Pixels {
    Pixels::from_fn(width, height, |x, y| {
        let [a, b, c, _] = (x.wrapping_mul(0x9E37_79B1) ^ y.wrapping_mul(0x85EB_CA6B)).to_le_bytes();
        Srgba::opaque(a / 2 + 60, b / 2 + 70, c / 2 + 50)
    })
}

fn label(text: &str, kind: LabelKind, x: f32, y: f32, depth_m: f32) -> PictureLabel {
    PictureLabel {
        text: text.to_owned(),
        anchor_px: Vec2::new(x, y),
        top_px: None,
        depth_m,
        visible: true,
        kind,
        rank: 0.0,
        size: 1.0,
    }
}

/// Labels as a scene of the southern Appalachians would have them, on a sheet of the given size.
fn labels(width: f32, height: f32) -> Vec<PictureLabel> {
    use LabelKind::{Place, Point, Summit, Water};
    let all = [
        ("Cross Mountain\n1062 m", Summit, 0.21, 0.26, 14e3),
        ("Frozen Head\n1012 m", Summit, 0.44, 0.27, 15e3),
        ("Bird Mountain\n951 m", Summit, 0.475, 0.285, 16e3),
        ("Windrock\n1010 m", Summit, 0.73, 0.30, 12e3),
        ("Walden Ridge\n873 m", Summit, 0.83, 0.40, 9e3),
        ("Lake City", Place, 0.36, 0.52, 7e3),
        ("Briceville", Place, 0.52, 0.47, 8e3),
        ("Fraterville", Place, 0.545, 0.475, 8.1e3),
        ("Clinton", Place, 0.67, 0.66, 4e3),
        ("Norris Lake", Water, 0.44, 0.68, 4e3),
        ("Coal Creek", Water, 0.30, 0.72, 3e3),
        ("Fire tower", Point, 0.60, 0.56, 5e3),
        ("Mine portal No. 3", Point, 0.25, 0.60, 5e3),
        ("Quarry", Point, 0.77, 0.59, 4.5e3),
    ];
    all.map(|(text, kind, x, y, depth)| label(text, kind, x * width, y * height, depth)).to_vec()
}

fn sheet(width: u32, height: u32) -> Annotations {
    let (w, h) = (width as f32, height as f32);
    let stops = [
        (250.0, [104, 138, 96]),
        (450.0, [164, 176, 116]),
        (700.0, [206, 186, 134]),
        (900.0, [172, 138, 104]),
        (1100.0, [236, 230, 222]),
    ];
    let stops = stops.map(|(at, [r, g, b])| (at, Srgba::opaque(r, g, b))).to_vec();
    Annotations {
        grid: None,
        classes: Vec::new(),
        margin: None,
        rim: Vec::new(),
        labels: labels(w, h),
        title: Some("Cross Mountain and the Coal Creek Valley".to_owned()),
        subtitle: Some("Anderson and Campbell Counties, Tennessee — view to the north-west".to_owned()),
        north: Some(NorthArrow {
            direction: Vec2::new(0.62, -0.50).normalize(),
            foreshortening: 0.45,
            kind: NorthKind::True,
        }),
        scale_bar: Some(ScaleBar { pixels_per_meter: h * 0.000_043, holds: ScaleExtent::Distance(12_400.0) }),
        legend: Some(Legend {
            ramp: ColorRamp::new(stops).expect("rising stops"),
            low_m: 252.0,
            high_m: 1071.0,
            vertical_exaggeration: 1.5,
            model_enlargement: None,
            has_inferred_cover: false,
            has_voids: false,
            contour_interval: Some(20.0),
            vertical_datum: Some("NAVD88".to_owned()),
        }),
        credit: Some("Elevation: USGS 3D Elevation Program".to_owned()),
        cover: None,
        ..Annotations::default()
    }
}

/// A sheet of everything that goes wrong: crowds, scripts the fonts lack, slanted leaders, odd figures.
fn trouble(width: u32, height: u32) -> Annotations {
    let (w, h) = (width as f32, height as f32);
    let kinds = [LabelKind::Summit, LabelKind::Place, LabelKind::Water, LabelKind::Point];
    let mut labels: Vec<PictureLabel> = (0..90u32)
        .map(|n| {
            let spread = |salt: u32| {
                f64::from((n * 7919 + salt).wrapping_mul(2_654_435_761) >> 8) / f64::from(1u32 << 24)
            };
            let (x, y) = (spread(1) as f32, spread(77) as f32);
            let anchor_px = Vec2::new(x * w, (0.2 + 0.7 * y) * h);
            let lean = (anchor_px.x - 0.5 * w) * 0.06;
            PictureLabel {
                text: format!("Hill {n}\n{} m", 300 + n * 7),
                anchor_px,
                top_px: (n % 2 == 0).then_some(anchor_px + Vec2::new(lean, -0.06 * h)),
                depth_m: 1000.0 + n as f32,
                visible: n % 9 != 0,
                kind: kinds[n as usize % 4],
                rank: 0.0,
                size: 1.0,
            }
        })
        .collect();
    labels.push(label("富士山\n3776 m", LabelKind::Summit, 0.5 * w, 0.3 * h, 1.0));
    labels.push(label("Эльбрус · Ἐρύμανθος\nהר חרמון", LabelKind::Summit, 0.3 * w, 0.3 * h, 1.0));
    Annotations {
        grid: None,
        classes: Vec::new(),
        margin: None,
        rim: Vec::new(),
        labels,
        title: Some("Great Smoky Mountains ".repeat(9)),
        subtitle: Some("one\ntwo\nthree".to_owned()),
        north: Some(NorthArrow {
            direction: Vec2::new(-0.9, 0.2),
            foreshortening: 0.1,
            kind: NorthKind::Grid,
        }),
        scale_bar: Some(ScaleBar { pixels_per_meter: h * 0.13, holds: ScaleExtent::Distance(4.2) }),
        legend: Some(Legend {
            low_m: -12.5,
            high_m: 31.0,
            vertical_exaggeration: 1.0,
            contour_interval: Some(0.5),
            vertical_datum: None,
            ..sheet(width, height).legend.expect("a legend")
        }),
        credit: Some("Elevation: nobody knows; ".repeat(20)),
        cover: None,
        ..Annotations::default()
    }
}

fn annotated(width: u32, height: u32, annotations: &Annotations) -> (Pixels, AnnotationReport) {
    let mut pixels = grain(width, height);
    let report = annotate(&mut pixels, annotations);
    (pixels, report)
}

#[test]
fn without_annotations_the_picture_is_unchanged() {
    let (pixels, report) = annotated(320, 180, &Annotations::default());
    assert_eq!(pixels, grain(320, 180));
    assert_eq!(report, AnnotationReport::default());
}

#[test]
fn the_same_annotations_give_the_same_bytes_and_the_same_report() {
    let once = annotated(960, 540, &trouble(960, 540));
    assert_eq!(once, annotated(960, 540, &trouble(960, 540)));
}

#[test]
fn hidden_labels_leave_no_pixel() {
    let hidden =
        labels(640.0, 360.0).into_iter().map(|label| PictureLabel { visible: false, ..label }).collect();
    let (pixels, report) = annotated(640, 360, &Annotations { labels: hidden, ..Annotations::default() });
    assert_eq!(pixels, grain(640, 360));
    assert_eq!((report.hidden.len(), report.placed.len()), (14, 0));
    assert_eq!(report.hidden[0], "Cross Mountain\n1062 m");
}

#[test]
fn labels_left_out_leave_no_pixel_and_do_not_disturb_the_others() {
    let lone = Annotations { labels: labels(640.0, 360.0)[..1].to_vec(), ..Annotations::default() };
    let mut crowd = lone.clone();
    let twin = PictureLabel { depth_m: 1e6, ..crowd.labels[0].clone() };
    crowd.labels.extend([twin.clone(), PictureLabel { anchor_px: Vec2::new(-3.0, 9.0), ..twin }]);
    let (pixels, report) = annotated(640, 360, &crowd);
    assert_eq!(pixels, annotated(640, 360, &lone).0);
    assert_eq!((report.placed.len(), report.crowded_out.len(), report.outside.len()), (1, 1, 1));
}

#[test]
fn a_good_sheet_is_drawn_whole() {
    let (pixels, report) = annotated(1920, 1080, &sheet(1920, 1080));
    assert_eq!(report.placed.len(), 14);
    let whole = AnnotationReport { placed: vec![], boxes: vec![], moved: vec![], ..report };
    assert_eq!(whole, AnnotationReport::default());
    assert!(pixels.data().iter().all(|color| color.0[3] == 255), "an opaque picture stays opaque");
}

#[test]
fn glyphs_that_the_fonts_lack_are_counted_with_their_text() {
    let fuji = label("富士山\n3776 m", LabelKind::Summit, 300.0, 200.0, 1.0);
    let title = Some("Вид на 富士".to_owned());
    let with = Annotations { labels: vec![fuji.clone()], title, ..Annotations::default() };
    let (_, report) = annotated(640, 360, &with);
    let boxes: usize = report.missing_glyphs.iter().map(|missing| missing.count).sum();
    assert_eq!(boxes, 5);
    assert_eq!(report.missing_glyphs[1].text, fuji.text);
    let hidden =
        Annotations { labels: vec![PictureLabel { visible: false, ..fuji }], ..Annotations::default() };
    assert!(annotated(640, 360, &hidden).1.missing_glyphs.is_empty(), "what is not drawn lacks nothing");
}

#[test]
fn furniture_that_does_not_fit_is_left_out_and_reported() {
    let (_, report) = annotated(300, 200, &sheet(300, 200));
    assert_eq!(report.left_out, [FurnitureKind::Legend]);
    let (pixels, report) = annotated(40, 30, &sheet(40, 30));
    assert_eq!(report.left_out.len(), 5);
    assert_eq!(pixels, grain(40, 30));
}

#[test]
fn furniture_whose_figures_make_no_sense_is_left_out_and_reported() {
    let mut odd = Annotations { labels: vec![], ..sheet(960, 540) };
    odd.title = Some("\u{7}\n".to_owned());
    odd.subtitle = None;
    odd.scale_bar = Some(ScaleBar { pixels_per_meter: f32::NAN, holds: ScaleExtent::Distance(1.0) });
    odd.north = Some(NorthArrow { direction: Vec2::ZERO, foreshortening: 0.5, kind: NorthKind::True });
    odd.legend = odd.legend.map(|legend| Legend { low_m: 9.0, high_m: 9.0, ..legend });
    odd.credit = Some(String::new());
    let (pixels, report) = annotated(960, 540, &odd);
    assert_eq!(report.left_out.len(), 5, "{report:?}");
    assert_eq!(pixels, grain(960, 540));
}

#[test]
fn pictures_of_any_size_can_be_annotated() {
    for (width, height) in [(0, 0), (1, 1), (7, 900), (900, 7), (64, 64), (9000, 12)] {
        let (pixels, _) = annotated(width, height, &trouble(width.max(2), height.max(2)));
        assert_eq!((pixels.width(), pixels.height()), (width, height));
    }
}

#[test]
fn thousands_of_labels_are_placed_in_reasonable_time() {
    let crowd = (0..6000u32).map(|n| {
        let (x, y) = ((n * 37 % 960) as f32, (n * 101 % 540) as f32);
        label(&format!("No. {n}"), LabelKind::Point, x, y, n as f32)
    });
    let (_, report) = annotated(960, 540, &Annotations { labels: crowd.collect(), ..Annotations::default() });
    assert_eq!(report.placed.len() + report.crowded_out.len() + report.outside.len(), 6000);
    assert!(report.placed.len() > 50);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn whatever_the_labels_each_has_one_fate_and_nothing_panics(
        texts in vec((".{0,40}", -50.0..450.0f32, -50.0..300.0f32, any::<f32>(), any::<bool>()), 0..25),
        title in ".{0,60}",
        tops in vec((any::<f32>(), any::<f32>()), 25),
    ) {
        let labels: Vec<PictureLabel> = texts.iter().zip(&tops).map(|((text, x, y, depth_m, visible), top)| PictureLabel {
            text: text.clone(),
            anchor_px: Vec2::new(*x, *y),
            top_px: Some(Vec2::new(top.0, top.1)),
            depth_m: *depth_m,
            visible: *visible,
            kind: [LabelKind::Summit, LabelKind::Place, LabelKind::Water, LabelKind::Point][text.len() % 4],
            rank: top.0.into(),
            size: 1.0,
        }).collect();
        let all = Annotations { labels, title: Some(title), ..Annotations::default() };
        let (_, report) = annotated(400, 250, &all);
        let fates = report.placed.len() + report.hidden.len() + report.outside.len()
            + report.crowded_out.len() + report.empty;
        prop_assert_eq!(fates, texts.len());
    }
}
