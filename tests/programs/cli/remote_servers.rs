//! Servers of elevation by address, for tests: scripts in `tests/tools`, and the program that reads from them.

use std::ffi::OsString;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::cli::{Ran, program, ran};
use crate::common::scratch::Scratch;
use crate::common::skip::skipped;

/// A server that a script runs, until its input ends.
pub struct TestServer {
    child: Child,
    /// Its host and port.
    pub host: String,
    /// The variables of the program that reads from it.
    pub variables: Vec<(&'static str, OsString)>,
    pub scratch: Scratch,
}

impl Drop for TestServer {
    fn drop(&mut self) {
        // It ends what it has started itself.
        drop(self.child.stdin.take());
        for _ in 0..1000 {
            if !matches!(self.child.try_wait(), Ok(None)) {
                return;
            }
            sleep(Duration::from_millis(10));
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl TestServer {
    /// A server that speaks S3, with a bucket `terrain`; `None` where `SANDTABLE_MOTO` names no Python that has `moto`.
    pub fn s3() -> Option<Self> {
        let mut server = Self::start(moto()?, "s3_server.py", |_| Vec::new());
        server.variables = vec![
            ("AWS_ENDPOINT_URL", format!("http://{}", server.host).into()),
            ("AWS_ALLOW_HTTP", "true".into()),
            ("AWS_ACCESS_KEY_ID", "testing".into()),
            ("AWS_SECRET_ACCESS_KEY", "testing".into()),
            ("AWS_REGION", "us-east-1".into()),
        ];
        Some(server)
    }

    /// A server that speaks the XML interface of Google Cloud Storage, which is that of S3.
    pub fn google() -> Option<Self> {
        let mut server = Self::s3()?;
        server.variables = vec![
            ("GOOGLE_BASE_URL", format!("http://{}", server.host).into()),
            ("GOOGLE_ALLOW_HTTP", "true".into()),
        ];
        Some(server)
    }

    /// A server that speaks Azure's blobs, with a container `terrain`; `None` where `SANDTABLE_AZURITE` names no folder of it.
    pub fn azure() -> Option<Self> {
        let folder = variable("SANDTABLE_AZURITE", "Azure")?;
        let mut server = Self::start("python3".into(), "azure_server.py", |_| vec![folder]);
        server.variables = vec![
            ("AZURE_STORAGE_USE_EMULATOR", "true".into()),
            ("AZURITE_BLOB_STORAGE_URL", format!("http://{}", server.host).into()),
        ];
        Some(server)
    }

    /// An encrypted web server of the files in a folder, which writes the certificates of authorities into its scratch folder;
    /// `None` where `SANDTABLE_MOTO` names no Python, which makes certificates too.
    pub fn encrypted(files: &str) -> Option<Self> {
        let arguments = |scratch: &Scratch| vec![files.into(), scratch.folder().into()];
        Some(Self::start(moto()?, "range_server.py", arguments))
    }

    fn start(python: OsString, script: &str, arguments: impl FnOnce(&Scratch) -> Vec<OsString>) -> Self {
        let scratch = Scratch::new();
        let mut child = Command::new(python)
            .arg(Path::new(env!("SANDTABLE_ROOT")).join("tests/tools").join(script))
            .args(arguments(&scratch))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("Python starts");
        let mut line = String::new();
        let out = child.stdout.take().expect("a pipe");
        BufReader::new(out).read_line(&mut line).expect("the server says its host");
        let host = line.trim().to_owned();
        assert!(host.starts_with("127.0.0.1:"), "{host}");
        Self { child, host, variables: Vec::new(), scratch }
    }

    /// Puts a file into the bucket or container.
    pub fn put(&mut self, path: &Path, key: &str) {
        let pipe = self.child.stdin.as_mut().expect("a pipe");
        writeln!(pipe, "{}\t{key}", path.display()).and_then(|()| pipe.flush()).expect("the server listens");
        let done = self.scratch.at("put");
        let _ = std::fs::remove_file(&done);
        writeln!(pipe, "done\t{}", done.display()).and_then(|()| pipe.flush()).expect("the server listens");
        while !done.exists() {
            assert!(matches!(self.child.try_wait(), Ok(None)), "the server ended: it could not put {key}");
            sleep(Duration::from_millis(10));
        }
    }

    /// The program with the server's variables, blocks in a folder `cache`, and its host allowed.
    pub fn command(&self, cache: &str, arguments: &[&str]) -> Command {
        let mut command = program(self.scratch.folder(), arguments);
        command
            .args(["--allow-remote", &self.host])
            .envs(self.variables.iter().map(|(name, value)| (name, value)))
            .env("XDG_CACHE_HOME", self.scratch.at(cache));
        command
    }

    pub fn run(&self, cache: &str, arguments: &[&str]) -> Ran {
        ran(self.command(cache, arguments).output().expect("the program starts"))
    }

    /// What a run prints that must have succeeded, and the bytes that it says it fetched.
    #[track_caller]
    pub fn fetched(&self, cache: &str, arguments: &[&str]) -> (String, u64) {
        let ran = self.run(cache, arguments);
        assert_eq!(ran.code, 0, "{ran:?}");
        let note = ran.err.lines().find(|line| line.starts_with("note:") && line.contains("fetched"));
        let bytes = note.and_then(|line| line.split_whitespace().rev().nth(1)?.parse().ok());
        (ran.out, bytes.unwrap_or_else(|| panic!("no note of what was fetched: {}", ran.err)))
    }
}

fn moto() -> Option<OsString> {
    variable("SANDTABLE_MOTO", "S3 and no TLS")
}

/// A variable that names what a server needs; without it, the test is skipped, or fails where it is required.
fn variable(name: &str, what: &str) -> Option<OsString> {
    let found = std::env::var_os(name);
    if found.is_none() {
        skipped(&format!("no {what} server: {name} is not set"));
        let is_required = std::env::var_os("SANDTABLE_REQUIRE_VALIDATOR").is_some();
        assert!(!is_required, "SANDTABLE_REQUIRE_VALIDATOR is set");
    }
    found
}
