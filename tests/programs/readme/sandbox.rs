//! A folder with copies of what the commands read, in which they run.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Pictures are made this small unless a command says how large: what is tested is that they are made.
const SMALL: [&str; 2] = ["--size", "320x180"];

/// The folder.
pub struct Sandbox {
    folder: PathBuf,
}

impl Sandbox {
    /// A fresh folder called `name` with copies of `scenes/` and `assets/`.
    pub fn new(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let _ = fs::remove_dir_all(&folder);
        for part in ["scenes", "assets"] {
            copy(&Path::new(env!("SANDTABLE_ROOT")).join(part), &folder.join(part));
        }
        Self { folder }
    }

    /// Where commands run.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Runs the program and checks that the picture it is to write is there.
    ///
    /// # Errors
    /// What it printed, where it fails; or what is wrong with the picture.
    pub fn run(&self, arguments: &[String], input: Option<&str>) -> Result<(), String> {
        let mut all: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let renders = all.first() == Some(&"render");
        if renders && !all.contains(&SMALL[0]) {
            all.extend(SMALL);
        }
        let output = output_of(&all).map(|name| self.folder.join(name)).filter(|_| renders);
        if let Some(folder) = output.as_deref().and_then(Path::parent) {
            fs::create_dir_all(folder).map_err(|error| error.to_string())?;
        }
        if !self.succeeds(&all, input)? {
            return Ok(());
        }
        let is_pdf = |path: &Path| fs::read(path).is_ok_and(|bytes| bytes.starts_with(b"%PDF"));
        output.map_or(Ok(()), |path| match image::open(&path) {
            Ok(_) => Ok(()),
            Err(_) if is_pdf(&path) => Ok(()),
            Err(error) => Err(format!("{}: {error}", path.display())),
        })
    }

    /// Whether the program did its work; false where it needs a graphics adapter that is not there.
    fn succeeds(&self, arguments: &[&str], input: Option<&str>) -> Result<bool, String> {
        let mut child = Command::new(env!("CARGO_BIN_EXE_sandtable"))
            .args(arguments)
            .current_dir(&self.folder)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| error.to_string())?;
        let mut stdin = child.stdin.take().expect("it is piped");
        // A program that reads no input may be gone already: no fault of the command.
        let _ = stdin.write_all(input.unwrap_or_default().as_bytes());
        drop(stdin);
        let output = child.wait_with_output().map_err(|error| error.to_string())?;
        if output.status.success() {
            return Ok(true);
        }
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let excused = arguments.contains(&"gpu") && std::env::var_os("SANDTABLE_REQUIRE_GPU").is_none();
        if excused && said.contains("adapter") {
            crate::common::skip::skipped(&format!("no GPU adapter: {said}"));
            return Ok(false);
        }
        Err(format!("{}\n{said}", output.status))
    }
}

/// The picture a `render` command writes: what `-o` says, or the scene's name.
fn output_of(arguments: &[&str]) -> Option<PathBuf> {
    let after = |name: &str| arguments.iter().position(|argument| *argument == name).map(|at| at + 1);
    let stated = after("-o").or(after("--output")).and_then(|at| arguments.get(at));
    let scene = arguments.iter().find(|argument| argument.ends_with(".toml"));
    let by_default = || Some(PathBuf::from(Path::new(scene?).file_stem()?).with_extension("png"));
    stated.map(PathBuf::from).or_else(by_default)
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("the target folder is writable");
    for entry in fs::read_dir(from).expect("the folder is there").map(|entry| entry.expect("readable")) {
        let (from, to) = (entry.path(), to.join(entry.file_name()));
        if from.is_dir() {
            copy(&from, &to);
        } else {
            fs::copy(&from, &to).expect("the target folder is writable");
        }
    }
}
