//! Programs that are ended while they write: the old file stays, and nothing else is left.

use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::cli::{project, run_in};
use crate::common::scratch::Scratch;

/// A flight that is drawn for minutes into `flight.png`, which is there before with the text `old`.
struct LongFlight {
    scratch: Scratch,
    child: Child,
}

impl LongFlight {
    fn begin() -> Self {
        Self::begin_as(|scratch, arguments| {
            let mut command = heeding(env!("CARGO_BIN_EXE_sandtable"));
            command.args(arguments).current_dir(scratch.folder()).stdin(Stdio::null());
            command
        })
    }

    fn begin_as(command: impl Fn(&Scratch, &[&str]) -> Command) -> Self {
        let scratch = Scratch::new();
        scratch.write("flight.png", "old");
        let scene = project("scenes/river.toml");
        let arguments =
            ["fly", &scene, "--size", "320x180", "--seconds", "600", "--fps", "25", "-o", "flight.png"];
        let mut command = command(&scratch, &arguments);
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program starts");
        let mut flight = Self { scratch, child };
        let deadline = Instant::now() + Duration::from_secs(120);
        while flight.parts().is_empty() {
            assert!(flight.child.try_wait().expect("a child").is_none(), "it ended before it wrote");
            assert!(Instant::now() < deadline, "it writes nothing");
            sleep(Duration::from_millis(5));
        }
        flight
    }

    fn parts(&self) -> Vec<String> {
        self.scratch.names().into_iter().filter(|name| name.ends_with(".part")).collect()
    }

    fn signal(&self, name: &str) {
        let killed = Command::new("kill").args([&format!("-{name}"), &self.child.id().to_string()]).status();
        assert!(killed.expect("kill is there").success());
    }

    /// The signal that ended it.
    fn ended_by(&mut self) -> Option<i32> {
        self.child.wait().expect("a child").signal()
    }

    fn old_file_stands(&self) -> bool {
        std::fs::read_to_string(self.scratch.at("flight.png")).is_ok_and(|text| text == "old")
    }

    /// Draws another picture into the same folder.
    fn draw_another(&self) {
        let scene = project("scenes/road.toml");
        run_in(self.scratch.folder(), &["render", &scene, "--size", "64x48", "-o", "road.png"]).ok();
    }
}

impl Drop for LongFlight {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A command that heeds the signals, though whoever runs the tests ignores them, as a shell does for what it
/// starts in the background.
fn heeding(program: &str) -> Command {
    if cfg!(target_os = "linux") {
        let mut command = Command::new("env");
        command.args(["--default-signal=HUP,INT,TERM", program]);
        command
    } else {
        Command::new(program)
    }
}

#[test]
fn an_interrupted_program_leaves_the_old_file_and_nothing_else() {
    for (name, number) in [("INT", 2), ("TERM", 15), ("HUP", 1)] {
        let mut flight = LongFlight::begin();
        flight.signal(name);
        assert_eq!(flight.ended_by(), Some(number), "a shell sees the signal {name}");
        assert_eq!(flight.scratch.names(), ["flight.png"], "{name}");
        assert!(flight.old_file_stands(), "{name}");
    }
}

#[test]
fn an_interrupted_flight_says_that_its_frames_are_kept() {
    let scratch = Scratch::new();
    let scene = project("scenes/river.toml");
    let mut command = heeding(env!("CARGO_BIN_EXE_sandtable"));
    command.args(["fly", &scene, "--size", "320x180", "--seconds", "600", "--fps", "25", "-o", "frames"]);
    command.current_dir(scratch.folder()).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    let child = command.spawn().expect("the program starts");
    let deadline = Instant::now() + Duration::from_secs(120);
    let frames = || std::fs::read_dir(scratch.at("frames")).into_iter().flatten().flatten();
    while !frames().any(|frame| frame.file_name().to_string_lossy().ends_with(".png")) {
        assert!(Instant::now() < deadline, "it draws nothing");
        sleep(Duration::from_millis(5));
    }
    let interrupted = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(interrupted.expect("kill is there").success());
    let output = child.wait_with_output().expect("the program ends");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.signal(), Some(2), "a shell sees the signal: {said}");
    let wanted = "interrupted: frames that are drawn are kept; the same command goes on with the rest\n";
    assert_eq!(said, wanted);
    assert!(frames().count() > 0, "they are kept");
}

#[test]
fn what_a_killed_program_leaves_the_next_removes_and_a_living_one_keeps() {
    let mut flight = LongFlight::begin();
    let part = flight.parts();
    assert!(part[0].contains(&format!("-{}-", flight.child.id())), "the writer is named: {part:?}");
    flight.draw_another();
    assert_eq!(flight.parts(), part, "the writer lives");
    flight.signal("KILL");
    assert_eq!(flight.ended_by(), Some(9));
    assert!(flight.old_file_stands());
    assert_eq!(flight.parts(), part);
    // A file of somebody else that is named much the same.
    flight.scratch.write("sandtable-7.part", "mine");
    flight.draw_another();
    assert_eq!(flight.scratch.names(), ["flight.png", "road.png", "sandtable-7.part"]);
}

#[test]
fn a_signal_that_the_parent_ignores_is_ignored() {
    let ignoring = |scratch: &Scratch, arguments: &[&str]| {
        let mut command = heeding("sh");
        command.args(["-c", "trap '' HUP; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_sandtable")]);
        command.args(arguments).current_dir(scratch.folder()).stdin(Stdio::null());
        command
    };
    let mut flight = LongFlight::begin_as(ignoring);
    flight.signal("HUP");
    sleep(Duration::from_millis(500));
    assert!(flight.child.try_wait().expect("a child").is_none(), "it goes on");
    flight.signal("TERM");
    assert_eq!(flight.ended_by(), Some(15));
    assert_eq!(flight.scratch.names(), ["flight.png"]);
}

#[test]
#[ignore = "slow: runs commands under many limits of memory"]
#[cfg(target_os = "linux")]
fn under_a_limit_of_memory_signals_reach_the_command() {
    let limited = |scratch: &Scratch, arguments: &[&str]| {
        let mut command = heeding("sh");
        command.args(["-c", "ulimit -v 4000000; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_sandtable")]);
        command.args(arguments).current_dir(scratch.folder()).stdin(Stdio::null());
        command
    };
    for (name, number) in [("INT", 2), ("TERM", 15)] {
        let mut flight = LongFlight::begin_as(limited);
        flight.signal(name);
        assert_eq!(flight.ended_by(), Some(number), "a shell sees the signal {name}");
        assert_eq!(flight.scratch.names(), ["flight.png"], "{name}");
        assert!(flight.old_file_stands(), "{name}");
    }
}

#[test]
fn several_pictures_appear_together_or_not_at_all() {
    let scratch = Scratch::new();
    let scene = project("scenes/areas.toml");
    let arguments = ["render", &scene, "--all-cameras", "--sidecar", "--size", "2400x1600", "-o", "all.png"];
    let mut command = heeding(env!("CARGO_BIN_EXE_sandtable"));
    command.args(arguments).current_dir(scratch.folder()).stdin(Stdio::null()).stdout(Stdio::null());
    let mut child = command.spawn().expect("it starts");
    let begun = Instant::now();
    // The first picture and its sidecar are whole when the second is begun.
    while scratch.names().len() < 2 {
        assert!(child.try_wait().expect("a child").is_none(), "{:?}", scratch.names());
        assert!(begun.elapsed() < Duration::from_secs(120), "{:?}", scratch.names());
        sleep(Duration::from_millis(5));
    }
    assert!(scratch.names().iter().all(|name| name.ends_with(".part")), "{:?}", scratch.names());
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(killed.expect("kill is there").success());
    assert_eq!(child.wait().expect("a child").signal(), Some(2));
    assert_eq!(scratch.names(), [""; 0]);
}
