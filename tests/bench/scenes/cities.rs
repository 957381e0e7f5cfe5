//! Real places, whole: from the scene file to the finished scene and to its picture.

use sandtable_render::RenderBackend;
use sandtable_scene::feature::FeatureKind;
use sandtable_sheet::picture::{PictureSize, render_view};

use crate::tests_common::places::{PLACES, text_of};
use crate::tests_common::scratch::Scratch;
use crate::{built, peak_mib, seconds};

const SIZE: PictureSize = PictureSize { width: 1920, height: 1080 };

/// Prints a row a place; places without data say so.
pub fn print() {
    println!(
        "{:<16}{:>8}{:>10}{:>11}{:>11}{:>11}{:>13}",
        "place", "roads", "buildings", "laying", "building", "+ picture", "peak memory"
    );
    for place in PLACES {
        let Some((text, allowed)) = text_of(place) else { continue };
        let folder = Scratch::new();
        let (scene, steps) = built(&folder, &text, &allowed);
        let building: f64 = steps.iter().map(|step| step.seconds).sum();
        let count = |wanted| scene.features.iter().filter(|feature| feature.kind == wanted).count();
        let view = scene.view(None).expect("a scene has a camera").clone();
        let start = std::time::Instant::now();
        render_view(&scene, &view, SIZE, RenderBackend::Cpu, &|_| ()).expect("the camera is sound");
        let picture = building + start.elapsed().as_secs_f64();
        println!(
            "{place:<16}{:>8}{:>10}{:>9.2} s{building:>9.2} s{picture:>9.2} s{:>9.0} MiB",
            count(FeatureKind::Road),
            count(FeatureKind::Building),
            seconds(&steps, "laying features"),
            peak_mib(&steps),
        );
    }
}
