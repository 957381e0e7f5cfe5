//! Little memory: a command ends well or says what it lacks, and no signal ends it.

use crate::cli::attacks::{run_within, sparse_tiff};
use crate::common::scratch::Scratch;

#[test]
fn what_memory_does_not_hold_is_refused_with_its_size() {
    let scratch = Scratch::new();
    scratch.write("large.tif", sparse_tiff(16_000));
    let (code, text) =
        run_within(300, &scratch, &["mesh", "large.tif", "--max-error", "1", "-o", "large.obj"]);
    assert_eq!(code, Some(1), "{text}");
    assert!(text.contains("the raster needs about 286 MB") && text.contains("cut or coarsen it"), "{text}");
    let scene = crate::cli::project("scenes/road.toml");
    let large = ["render", scene.as_str(), "--size", "16384x16384", "-o", "large.png"];
    let (code, text) = run_within(1000, &scratch, &large);
    assert_eq!(code, Some(1), "{text}");
    assert!(
        text.contains("the picture needs about 3")
            && text.contains(" MB of memory")
            && text.contains("draw a smaller one"),
        "{text}"
    );
    assert_eq!(scratch.names(), ["large.tif"]);
}

#[test]
fn small_questions_are_answered_in_little_memory() {
    let scratch = Scratch::new();
    let dem = crate::cli::project("assets/jacksboro/dem.tif");
    for arguments in [&["dem", "info", &dem][..], &["height", &dem, "--at", "-84.2,36.3"]] {
        let (code, text) = run_within(100, &scratch, arguments);
        assert_eq!((code, text.as_str()), (Some(0), ""), "{arguments:?}");
    }
}

/// Limits in megabytes: close together where a program only just starts, and far apart where everything fits.
fn ladder() -> impl Iterator<Item = u32> {
    (60..180).step_by(10).chain([200, 230, 260, 300, 400, 600])
}

#[test]
#[ignore = "slow: runs commands under many limits of memory"]
fn under_any_limit_a_command_succeeds_or_says_how_much_it_needs() {
    let scratch = Scratch::new();
    let [dem, scene, road] =
        ["assets/jacksboro/dem.tif", "scenes/jacksboro.toml", "scenes/road.toml"].map(crate::cli::project);
    let commands = [
        &["check", &scene][..],
        &["render", &scene, "--size", "320x180", "-o", "out.png"],
        &["render", &road, "--size", "320x180", "--threads", "64", "-o", "out.png"],
        &["height", &dem, "--at", "750000,4018000"],
        &["dem", "info", &dem],
    ];
    // The system itself ends a program that it cannot load.
    let starts = |megabytes: &u32| run_within(*megabytes, &scratch, &["--version"]).0 == Some(0);
    let limits: Vec<u32> = ladder().filter(starts).collect();
    assert!(limits.first().is_some_and(|&least| least <= 150), "{limits:?}");
    for command in commands {
        let mut least = None;
        for &megabytes in &limits {
            let (code, said) = run_within(megabytes, &scratch, command);
            match code {
                Some(0) => least = least.or(Some(megabytes)),
                _ => {
                    assert_eq!(code, Some(1), "{megabytes} MB: {command:?}: {said}");
                    assert!(
                        said.contains(" MB of ") || said.contains("no thread can be started"),
                        "{megabytes} MB: {said}"
                    );
                    assert_eq!(least, None, "{megabytes} MB: {command:?} succeeds with less: {said}");
                }
            }
        }
        assert!(least.is_some_and(|least| least <= 400), "{command:?}: {least:?}");
    }
    assert_eq!(scratch.names(), ["out.png"]);
}

/// A scene of so many roads over the demonstration's elevation, as `many.toml`.
fn write_many_roads(scratch: &Scratch, count: u32) {
    let dem = crate::cli::project("assets/jacksboro/dem.tif");
    std::fs::copy(dem, scratch.at("dem.tif")).expect("a copy");
    let road = |index: u32| {
        let corner = |step: u32| {
            let (east, north) = (index % 80, index / 80);
            let turn = f64::from(index * 7 + step * 5) % 3.0;
            let x = -84.40 + 0.0038 * f64::from(east) + 0.0004 * f64::from(step);
            format!("[{x:.6},{:.6}]", 36.17 + 0.0034 * f64::from(north) + 0.0004 * turn)
        };
        let corners = (0..8).map(corner).collect::<Vec<_>>().join(",");
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"name\":\"{index}\"}},\"geometry\":{{\"type\":\"LineString\",\
             \"coordinates\":[{corners}]}}}}"
        )
    };
    let roads = (0..count).map(road).collect::<Vec<_>>().join(",");
    scratch.write("roads.geojson", format!("{{\"type\":\"FeatureCollection\",\"features\":[{roads}]}}"));
    let scene = "[terrain]\ndem = \"dem.tif\"\n[[road]]\nfile = \"roads.geojson\"\nwidth = 4\n";
    scratch.write("many.toml", scene);
}

#[test]
#[ignore = "slow: runs commands under many limits of memory"]
fn a_scene_of_many_small_lists_is_never_ended_by_a_signal() {
    let scratch = Scratch::new();
    write_many_roads(&scratch, 6000);
    let mut ended_early = 0;
    for command in
        [&["check", "many.toml"][..], &["render", "many.toml", "--size", "320x180", "-o", "out.png"]]
    {
        for megabytes in [110, 120, 130, 140, 150, 160, 180, 220, 260, 500] {
            let (code, said) = run_within(megabytes, &scratch, command);
            assert!(matches!(code, Some(0 | 1)), "{megabytes} MB: {command:?}: {code:?}: {said}");
            assert_eq!(code == Some(1), said.contains("error: "), "{megabytes} MB: {said}");
            assert!(megabytes < 500 || code == Some(0), "{said}");
            ended_early += usize::from(said.contains("ended because it needs more than the"));
        }
    }
    assert!(ended_early > 0, "the lists were foreseen");
    assert!(scratch.names().iter().all(|name| !name.ends_with(".part")), "{:?}", scratch.names());
}

#[test]
fn few_threads_under_a_limit_draw_the_same_picture() {
    let scratch = Scratch::new();
    let scene = crate::cli::project("scenes/labels.toml");
    let draw = |name: &str| {
        let line = ["render", &scene, "--size", "320x180", "--threads", "64", "-o", name];
        line.map(str::to_owned)
    };
    crate::cli::run_in(scratch.folder(), &draw("free.png")).ok();
    let limited = draw("limited.png");
    let (code, said) = run_within(300, &scratch, &limited.each_ref().map(String::as_str));
    assert_eq!(code, Some(0), "{said}");
    let [free, limited] =
        ["free.png", "limited.png"].map(|name| std::fs::read(scratch.at(name)).expect("written"));
    assert!(free == limited);
}
