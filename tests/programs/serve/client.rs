//! A running program, and requests to it.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

/// The program, serving on a port of its own; killed when dropped.
pub struct Server {
    child: Child,
    pub address: SocketAddr,
    /// What it said when it was ready.
    pub greeting: String,
    stderr: BufReader<std::process::ChildStderr>,
}

/// An answer.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub head: String,
    /// Empty where the body is no text.
    pub body: String,
    pub bytes: Vec<u8>,
}

impl Answer {
    /// The body as JSON.
    #[track_caller]
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.body).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }

    /// The value of a header, empty where there is none.
    pub fn header(&self, name: &str) -> &str {
        let lines = self.head.lines().filter_map(|line| line.split_once(": "));
        lines
            .filter(|(known, _)| known.eq_ignore_ascii_case(name))
            .map(|(_, value)| value)
            .next()
            .unwrap_or("")
    }

    /// The body as JSON, of a request that must have been answered.
    #[track_caller]
    pub fn ok(&self) -> Value {
        assert_eq!(self.status, 200, "{self:?}");
        self.json()
    }

    /// Why a request was refused, with a status that it must have.
    #[track_caller]
    pub fn refused(&self, status: u16) -> String {
        assert_eq!(self.status, status, "{self:?}");
        assert_eq!(self.header("content-type"), "application/json", "{self:?}");
        let json = self.json();
        let word = if status < 500 { "INVALID_REQUEST" } else { "SERVER_ERROR" };
        assert_eq!(json["status"], word, "{self:?}");
        json["error"].as_str().expect("a reason").to_owned()
    }
}

impl Server {
    /// Starts the program in `folder` with these arguments after `serve`, on a free port, and waits until it listens.
    pub fn start(folder: &Path, arguments: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_sandtable"))
            .current_dir(folder)
            .arg("serve")
            .args(arguments)
            .args(["--listen", "127.0.0.1:0"])
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut stderr = BufReader::new(child.stderr.take().expect("a pipe"));
        let mut greeting = String::new();
        stderr.read_line(&mut greeting).expect("UTF-8");
        let address = greeting
            .split("http://")
            .nth(1)
            .and_then(|rest| rest.split(['/', ' ']).next()?.trim_end_matches(':').parse().ok());
        let address = address.unwrap_or_else(|| panic!("no address in {greeting:?}"));
        Self { child, address, greeting, stderr }
    }

    pub fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.address).expect("it listens");
        stream.set_read_timeout(Some(Duration::from_secs(60))).expect("a timeout");
        stream
    }

    /// Sends bytes as they are and reads one answer.
    pub fn raw(&self, request: &[u8]) -> Answer {
        let mut stream = self.connect();
        // A server that refuses early closes the pipe.
        let _ = stream.write_all(request);
        let answer = read_answer(&mut BufReader::new(&mut stream), !request.starts_with(b"HEAD"));
        let _ = stream.shutdown(Shutdown::Both);
        answer
    }

    pub fn get(&self, path: &str) -> Answer {
        self.raw(format!("GET {path} HTTP/1.1\r\nhost: localhost\r\n\r\n").as_bytes())
    }

    pub fn post(&self, path: &str, content_type: &str, body: &str) -> Answer {
        let length = body.len();
        let head = format!(
            "POST {path} HTTP/1.1\r\nhost: localhost\r\ncontent-type: {content_type}\r\ncontent-length: {length}\r\n\r\n"
        );
        self.raw((head + body).as_bytes())
    }

    /// Asks the program to end, as `kill` does.
    pub fn signal(&self, name: &str) {
        let killed = Command::new("kill").args([&format!("-{name}"), &self.child.id().to_string()]).status();
        assert!(killed.expect("kill is there").success());
    }

    /// Waits for the program to end; its exit code (−1 where a signal ended it), and what it wrote meanwhile.
    pub fn ended(mut self) -> (i32, String) {
        let deadline = Instant::now() + Duration::from_secs(60);
        let status = loop {
            if let Some(status) = self.child.try_wait().expect("a child") {
                break status;
            }
            assert!(Instant::now() < deadline, "it does not end");
            std::thread::sleep(Duration::from_millis(10));
        };
        let mut rest = String::new();
        self.stderr.read_to_string(&mut rest).expect("UTF-8");
        (status.code().unwrap_or(-1), rest)
    }

    /// The number of its process.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Resident memory in KiB.
    pub fn resident_kib(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap_or("0");
        line.trim().trim_end_matches(" kB").parse().unwrap_or(0)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Reads one answer off a connection.
pub fn read_answer(from: &mut impl BufRead, with_body: bool) -> Answer {
    let mut head = String::new();
    loop {
        let mut line = String::new();
        let read = from.read_line(&mut line).unwrap_or(0);
        if read == 0 || line == "\r\n" {
            break;
        }
        head.push_str(line.trim_end());
        head.push('\n');
    }
    let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0);
    let mut answer = Answer { status, head, body: String::new(), bytes: Vec::new() };
    let length = answer.header("content-length").parse().unwrap_or(0);
    if with_body {
        let mut body = vec![0; length];
        from.read_exact(&mut body).expect("as long as it says");
        if !answer.header("content-type").starts_with("image/") {
            answer.body = String::from_utf8(body.clone()).expect("UTF-8");
        }
        answer.bytes = body;
    }
    answer
}

/// The texts of all numbers (or `null`) that follow `"name":` in a JSON text, in order: read without a JSON reader, whose
/// numbers might not keep every bit.
pub fn numbers(json: &str, name: &str) -> Vec<Option<f64>> {
    let key = format!("\"{name}\":");
    json.match_indices(&key)
        .map(|(at, _)| {
            let rest = &json[at + key.len()..];
            let text = rest.split([',', '}', ']']).next().expect("a value");
            (text != "null").then(|| text.parse().expect("a number"))
        })
        .collect()
}

/// The texts of all strings that follow `"name":` in a JSON text, in order.
pub fn strings<'a>(json: &'a str, name: &str) -> Vec<&'a str> {
    let key = format!("\"{name}\":\"");
    json.match_indices(&key)
        .map(|(at, _)| json[at + key.len()..].split('"').next().expect("a value"))
        .collect()
}
