//! `fly`: frames in a folder, taken up again where a run ended, and one animated picture.

use crate::cli::{Ran, project, run_in};
use crate::common::scratch::Scratch;

fn fly(scratch: &Scratch, more: &[&str]) -> Ran {
    let scene = project("scenes/river.toml");
    let arguments = ["fly", &scene, "--size", "160x90", "--seconds", "0.5", "--fps", "8"];
    run_in(scratch.folder(), &[&arguments, more].concat())
}

#[test]
fn frames_that_are_there_are_kept_and_others_are_drawn() {
    let scratch = Scratch::new();
    let out = fly(&scratch, &["-o", "frames"]).ok();
    assert!(out.contains("downstream: 8.") && out.contains("4, 0 of them there before"), "{out}");
    let frame = |number: u32| scratch.at(&format!("frames/frame-{number:05}.png"));
    let bytes: Vec<Vec<u8>> = (1..=4).map(|number| std::fs::read(frame(number)).expect("drawn")).collect();
    assert!(bytes.windows(2).all(|pair| pair[0] != pair[1]), "each shows another place");
    std::fs::remove_file(frame(3)).expect("there");
    std::fs::write(frame(1), b"kept").expect("there");
    let out = fly(&scratch, &["-o", "frames"]).ok();
    assert!(out.contains("4, 3 of them there before"), "{out}");
    assert!(std::fs::read(frame(3)).expect("drawn again") == bytes[2]);
    assert_eq!(std::fs::read(frame(1)).expect("there"), b"kept");
    let scene = project("scenes/river.toml");
    let other = ["fly", &scene, "-o", "frames", "--size", "160x90", "--seconds", "0.25", "--fps", "8"];
    let said = run_in(scratch.folder(), &other).failed(1);
    assert!(said.contains("frames of something else"), "{said}");
}

#[test]
fn an_animated_picture_has_every_frame() {
    let scratch = Scratch::new();
    fly(&scratch, &["-o", "flight.png"]).ok();
    assert_eq!(scratch.names(), ["flight.png"]);
    let file = std::io::BufReader::new(std::fs::File::open(scratch.at("flight.png")).expect("written"));
    let mut reader = png::Decoder::new(file).read_info().expect("a picture");
    let control = reader.info().animation_control.expect("animated");
    assert_eq!((control.num_frames, control.num_plays), (4, 0));
    let mut buffer = vec![0; reader.output_buffer_size().expect("small")];
    let frames: Vec<Vec<u8>> = (0..4)
        .map(|_| {
            reader.next_frame(&mut buffer).expect("a frame");
            buffer.clone()
        })
        .collect();
    assert!(frames.windows(2).all(|pair| pair[0] != pair[1]));
    let delay = reader.info().frame_control.expect("animated");
    assert_eq!((delay.delay_num, delay.delay_den), (1, 8));
}

#[test]
fn a_scene_without_a_flight_and_a_flight_of_too_many_frames_are_refused() {
    let scratch = Scratch::new();
    let road = project("scenes/road.toml");
    let said = run_in(scratch.folder(), &["fly", &road, "-o", "frames"]).failed(1);
    assert!(said.contains("the scene has no [[flight]]"), "{said}");
    let said = fly(&scratch, &["-o", "frames", "--flight", "upstream"]).failed(1);
    assert!(said.contains("no flight 'upstream'") && said.contains("downstream"), "{said}");
    let scene = project("scenes/river.toml");
    let long = ["fly", scene.as_str(), "-o", "frames", "--seconds", "3600", "--fps", "240"];
    assert!(run_in(scratch.folder(), &long).failed(2).contains("more than the 90000"));
    assert_eq!(scratch.names(), Vec::<String>::new());
}
