//! A window that follows a script instead of a user, for tests, and says what it did.
//!
//! A command a line; lines that begin with `#` are left out. Each begins when the one before is done: a file is open, a
//! picture is drawn, an edit is shown. Places are map coordinates.
//!
//! | line | what it does |
//! |---|---|
//! | `wait N` | lets N frames pass |
//! | `key NAME` | presses a key of the table, such as `key Ctrl+Z` |
//! | `fly X,Y,Z X,Y,Z N` | flies to an eye that looks at a place in N frames, heights as elevations |
//! | `camera NAME` | goes to a camera of the scene |
//! | `phase NAME` | shows a phase of the scene |
//! | `pick X,Y` | says what the picture shows at a pixel |
//! | `sun AZIMUTH,ALTITUDE` | moves the sun, degrees |
//! | `heights FACTOR` | draws heights so many times as high |
//! | `hide KIND`, `show KIND` | hides or shows features of a kind, such as `roads` |
//! | `viewshed X,Y` | tints what is seen from a place |
//! | `edit crater X,Y RADIUS` | digs |
//! | `analyze KIND KEY=VALUE …` | makes an analysis and shows it; a value may have spaces |
//! | `keep`, `discard` | writes that analysis into the scene, or takes it away |
//! | `undo`, `redo`, `save`, `snapshot` | as the keys do |
//! | `snapshot FILE.png` | writes a frame as it is shown; without a window alone |
//! | `quit` | closes the window, without edits that are not saved: a moved sun is one |
//! | `resize WxH` | gives the window a size in pixels |

use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};

use crate::commands::{KEYS, KeyAction, ViewCommand, shortcut_text};

/// The most lines of a script.
const MOST_LINES: usize = 10_000;
/// The most frames of one command: ten minutes of sixty a second.
const MOST_FRAMES: u32 = 36_000;

/// A line of a script.
#[derive(Clone, Debug, PartialEq)]
pub enum ScriptCommand {
    /// Lets frames pass.
    Wait(u32),
    /// A command of the keys.
    Run(ViewCommand),
    /// Flies.
    Fly {
        /// Map coordinates and elevation of the eye.
        eye: DVec3,
        /// Map coordinates and elevation of what it looks at.
        target: DVec3,
        /// How many frames it takes.
        frames: u32,
    },
    /// Goes to a camera by its name.
    Camera(String),
    /// Shows a phase by its name.
    Phase(String),
    /// Picks at a pixel.
    Pick(DVec2),
    /// Digs a crater.
    Crater {
        /// Map coordinates.
        at: DVec2,
        /// Meters.
        radius_m: f64,
    },
    /// Moves the sun: degrees clockwise from north and above the horizon.
    Sun(DVec2),
    /// Tints what is seen from a place.
    Viewshed(DVec2),
    /// Exaggerates heights.
    Heights(f64),
    /// Hides or shows features of a kind, by its plural.
    Visibility {
        /// The plural.
        kind: String,
        /// Whether they are shown.
        shown: bool,
    },
    /// Makes an analysis and shows it.
    Analyze {
        /// Its kind.
        kind: String,
        /// Arguments by their names.
        arguments: Vec<(String, String)>,
    },
    /// Writes the analysis that is shown into the scene.
    KeepAnalysis,
    /// Takes it away.
    DiscardAnalysis,
    /// Gives the window a size.
    Resize(u32, u32),
    /// Writes a frame into a file.
    Picture(PathBuf),
}

/// A line of a script that says nothing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: '{text}' is not a command; write {expected}")]
pub struct ScriptError {
    line: usize,
    text: String,
    expected: &'static str,
}

const EXPECTED: &str = "wait N, key NAME, fly X,Y,Z X,Y,Z N, camera NAME, phase NAME, pick X,Y, sun AZIMUTH,ALTITUDE, heights FACTOR, \
                        hide KIND, show KIND, viewshed X,Y, edit crater X,Y RADIUS, analyze KIND KEY=VALUE, keep, discard, undo, redo, save, snapshot, snapshot FILE.png, resize WxH or quit";

/// The commands of a script, each with its line as it is written.
///
/// # Errors
/// The first line that is not a command.
pub fn parse_script(text: &str) -> Result<Vec<(String, ScriptCommand)>, ScriptError> {
    let lines = text.lines().enumerate().take(MOST_LINES);
    let lines = lines.map(|(index, line)| (index + 1, line.trim()));
    lines
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
        .map(|(line, text)| {
            let words: Vec<&str> = text.split_whitespace().collect();
            let wrong = || ScriptError { line, text: text.chars().take(80).collect(), expected: EXPECTED };
            Ok((text.to_owned(), command(&words).ok_or_else(wrong)?))
        })
        .collect()
}

fn command(words: &[&str]) -> Option<ScriptCommand> {
    Some(match *words {
        ["wait", count] => ScriptCommand::Wait(frames(count)?),
        ["key", name] => ScriptCommand::Run(command_of_key(name)?),
        ["fly", eye, target, count] => {
            ScriptCommand::Fly { eye: point(eye)?, target: point(target)?, frames: frames(count)? }
        }
        ["camera", _, ..] => ScriptCommand::Camera(words[1..].join(" ")),
        ["phase", _, ..] => ScriptCommand::Phase(words[1..].join(" ")),
        ["pick", at] => ScriptCommand::Pick(place(at)?),
        ["sun", angles] => ScriptCommand::Sun(place(angles)?),
        ["viewshed", at] => ScriptCommand::Viewshed(place(at)?),
        ["heights", factor] => ScriptCommand::Heights(positive(factor)?),
        ["hide", _, ..] => ScriptCommand::Visibility { kind: words[1..].join(" "), shown: false },
        ["show", _, ..] => ScriptCommand::Visibility { kind: words[1..].join(" "), shown: true },
        ["edit", "crater", at, radius] => {
            ScriptCommand::Crater { at: place(at)?, radius_m: positive(radius)? }
        }
        ["resize", size] => {
            let (width, height) = size.split_once('x')?;
            let side = |text: &str| text.parse().ok().filter(|side| (1..=16_384).contains(side));
            ScriptCommand::Resize(side(width)?, side(height)?)
        }
        ["analyze", kind, ..] => {
            ScriptCommand::Analyze { kind: (*kind).to_owned(), arguments: arguments(&words[2..])? }
        }
        ["keep"] => ScriptCommand::KeepAnalysis,
        ["discard"] => ScriptCommand::DiscardAnalysis,
        ["undo"] => ScriptCommand::Run(ViewCommand::Undo),
        ["redo"] => ScriptCommand::Run(ViewCommand::Redo),
        ["save"] => ScriptCommand::Run(ViewCommand::Save),
        ["snapshot"] => ScriptCommand::Run(ViewCommand::Snapshot),
        ["snapshot", _, ..] => {
            let path = PathBuf::from(words[1..].join(" "));
            ScriptCommand::Picture(Some(path).filter(|path| is_png(path))?)
        }
        ["quit"] => ScriptCommand::Run(ViewCommand::Quit),
        _ => return None,
    })
}

/// Arguments by their names; a word without `=` goes on with the value before.
fn arguments(words: &[&str]) -> Option<Vec<(String, String)>> {
    let mut arguments: Vec<(String, String)> = Vec::new();
    for word in words {
        match word.split_once('=') {
            Some((name, value)) if !name.is_empty() => arguments.push((name.to_owned(), value.to_owned())),
            _ => {
                let (_, value) = arguments.last_mut()?;
                value.push(' ');
                value.push_str(word);
            }
        }
    }
    Some(arguments)
}

fn is_png(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"))
}

fn frames(text: &str) -> Option<u32> {
    text.parse().ok().filter(|count| *count <= MOST_FRAMES)
}

fn positive(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0)
}

fn numbers<const COUNT: usize>(text: &str) -> Option<[f64; COUNT]> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.parse().ok()).collect();
    numbers?.try_into().ok().filter(|numbers: &[f64; COUNT]| numbers.iter().all(|number| number.is_finite()))
}

fn place(text: &str) -> Option<DVec2> {
    numbers(text).map(DVec2::from_array)
}

fn point(text: &str) -> Option<DVec3> {
    numbers(text).map(DVec3::from_array)
}

fn command_of_key(name: &str) -> Option<ViewCommand> {
    let binding = KEYS.iter().find(|binding| shortcut_text(&binding.key).eq_ignore_ascii_case(name))?;
    match binding.action {
        KeyAction::Press(command) => Some(command),
        KeyAction::Hold(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_is_read() {
        let text = "# a comment\n\nwait 3\nkey Ctrl+Shift+Z\nfly 1,2,3 4,5,6 60\ncamera from the south\npick 10,20\n\
                    edit crater 7,8 30\nresize 640x480\nundo\nsun 120,30\nheights 2\nhide tactical graphics\nshow roads\nquit\n\
                    analyze time from=16S GF 49000 17500 vehicle=foot\nkeep\ndiscard\nsnapshot a frame.png\n";
        let commands: Vec<ScriptCommand> =
            parse_script(text).expect("sound").into_iter().map(|(_, command)| command).collect();
        assert_eq!(commands.len(), 17);
        let argument = |name: &str, text: &str| (name.to_owned(), text.to_owned());
        let arguments = vec![argument("from", "16S GF 49000 17500"), argument("vehicle", "foot")];
        assert_eq!(commands[13], ScriptCommand::Analyze { kind: "time".to_owned(), arguments });
        assert_eq!(commands[14..16], [ScriptCommand::KeepAnalysis, ScriptCommand::DiscardAnalysis]);
        assert_eq!(commands[16], ScriptCommand::Picture("a frame.png".into()));
        assert_eq!(commands[1], ScriptCommand::Run(ViewCommand::Redo));
        let (eye, target) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0));
        assert_eq!(commands[2], ScriptCommand::Fly { eye, target, frames: 60 });
        assert_eq!(commands[3], ScriptCommand::Camera("from the south".to_owned()));
        assert_eq!(commands[5], ScriptCommand::Crater { at: DVec2::new(7.0, 8.0), radius_m: 30.0 });
        assert_eq!(commands[8], ScriptCommand::Sun(DVec2::new(120.0, 30.0)));
        let kind = "tactical graphics".to_owned();
        assert_eq!(commands[10], ScriptCommand::Visibility { kind, shown: false });
    }

    #[test]
    fn a_line_that_is_no_command_is_named() {
        for line in [
            "wait",
            "wait -1",
            "fly 1,2 3,4 5",
            "edit crater 1,2 0",
            "sun 120",
            "heights -1",
            "hide",
            "resize 0x5",
            "pick nan,1",
            "key W",
            "jump",
            "analyze",
            "analyze slope degrees",
            "keep all",
            "snapshot frame.jpg",
        ] {
            let error = parse_script(&format!("wait 1\n{line}\n")).expect_err(line).to_string();
            assert!(error.starts_with(&format!("line 2: '{line}' is not a command")), "{error}");
        }
    }
}
