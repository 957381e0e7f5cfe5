//! The service over HTTP: a thousand points warm, large batches, and 64 connections that ask one point at a time.
//!
//! The program runs beside the generator of load, and both share the machine's cores. So next to the rates that were
//! reached stands what the program alone took, from the processor time that the system counts for it: points or requests
//! per second of *its* time are what one core would serve, whatever else runs. Nothing is read from a disk while it is
//! asked. Open Topo Data publishes 0.42 s for a thousand points and 0.8 k points/s at best.

use std::io::{self, BufRead, BufReader};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::Instant;

use tokio::net::TcpStream;

use crate::fields;
use crate::peers;
use crate::rounds::{median, quantile};

/// Posts a side of the elevation models.
const SIDE: usize = 2049;

/// Clients at once, each with a connection of its own.
const CLIENTS: usize = 64;

/// Requests of the bounded run.
const REQUESTS: usize = 200_000;

/// Ticks in a second of the processor time that `/proc` counts: Linux's USER_HZ, 100 on every architecture in use.
const TICKS_PER_S: f64 = 100.0;

/// Prints the section.
pub fn print() {
    let heights = fields::fractal(SIDE);
    let folder = peers::folder();
    // One in degrees, which needs no projection, and one in UTM, where every point is projected.
    let degrees = terrain(&heights, (0, 0), [10.0, 11.0, 50.0, 51.0]);
    let meters = terrain(&heights, (1, 32), [5e5, 5.7e5, 5.54e6, 5.64e6]);
    for (name, bytes) in [("degrees.bt", degrees), ("utm.bt", meters)] {
        std::fs::write(folder.join(name), bytes).expect("the target directory can be written");
    }
    let server = Server::start(&["degrees.bt", "utm.bt"]);
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    runtime.block_on(async {
        println!("{:<52} {:>9} {:>9} {:>14} {:>16}", "", "p50", "p99", "points/s", "points/s of its CPU");
        for dataset in ["degrees", "utm"] {
            batch(&server, dataset, 1_000, 400).await;
            batch(&server, dataset, 10_000, 60).await;
        }
        for dataset in ["degrees", "utm"] {
            load(&server, dataset).await;
        }
    });
}

/// A BT 1.3 terrain of `SIDE`² posts: the field in rows from the south, the file in columns.
fn terrain(heights: &[f32], (unit, zone): (i16, i16), extents: [f64; 4]) -> Vec<u8> {
    let mut bytes = b"binterr1.3".to_vec();
    bytes.extend((SIDE as i32).to_le_bytes().repeat(2));
    for short in [4, 1, unit, zone, 6326] {
        bytes.extend(i16::to_le_bytes(short));
    }
    bytes.extend(extents.iter().flat_map(|side| side.to_le_bytes()));
    bytes.extend(0i16.to_le_bytes());
    bytes.extend(1f32.to_le_bytes());
    bytes.resize(256, 0);
    for column in 0..SIDE {
        bytes.extend((0..SIDE).flat_map(|row| heights[row * SIDE + column].to_le_bytes()));
    }
    bytes
}

/// The program, serving.
struct Server {
    child: Child,
    address: SocketAddr,
}

impl Server {
    fn start(files: &[&str]) -> Self {
        let files: Vec<PathBuf> = files.iter().map(|file| peers::folder().join(file)).collect();
        let mut child = Command::new(env!("CARGO_BIN_EXE_sandtable"))
            .arg("serve")
            .args(files)
            .args(["--listen", "127.0.0.1:0"])
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut greeting = String::new();
        let stderr = child.stderr.take().expect("a pipe");
        BufReader::new(stderr).read_line(&mut greeting).expect("UTF-8");
        let address = greeting.split("http://").nth(1).and_then(|rest| rest.split(": ").next()?.parse().ok());
        Self { child, address: address.unwrap_or_else(|| panic!("no address in {greeting:?}")) }
    }

    /// Seconds of processor time that it has taken.
    fn cpu_s(&self) -> f64 {
        let text = std::fs::read_to_string(format!("/proc/{}/stat", self.child.id())).unwrap_or_default();
        // After the name in parentheses: state is field 3, user and system time 14 and 15 (proc(5)).
        let fields: Vec<&str> = text.rsplit(") ").next().unwrap_or_default().split(' ').collect();
        let ticks: f64 = fields.iter().skip(11).take(2).filter_map(|field| field.parse::<f64>().ok()).sum();
        ticks / TICKS_PER_S
    }

    fn resident_mib(&self) -> f64 {
        let text = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap_or("0");
        line.trim().trim_end_matches(" kB").parse::<f64>().unwrap_or(f64::NAN) / 1024.0
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The `index`th of a row of places all over the models, latitude first.
fn place(index: usize) -> String {
    let part = |step: f64| (index as f64 * step).fract();
    // The golden ratio and the square root of two: never twice the same, nowhere dense.
    format!("{:.6},{:.6}", 50.05 + 0.8 * part(0.618_033_988_75), 10.05 + 0.8 * part(0.414_213_562_37))
}

fn post(dataset: &str, points: usize) -> Vec<u8> {
    let locations = (0..points).map(place).collect::<Vec<_>>().join("|");
    let body = format!("locations={locations}");
    let length = body.len();
    format!("POST /v1/{dataset} HTTP/1.1\r\nhost: localhost\r\ncontent-length: {length}\r\n\r\n{body}")
        .into_bytes()
}

/// Asks one batch after the other over one connection.
async fn batch(server: &Server, dataset: &str, points: usize, rounds: usize) {
    let mut client = Client::connect(server.address).await;
    let request = post(dataset, points);
    for _ in 0..rounds / 10 {
        client.ask(&request).await;
    }
    let (cpu, begun) = (server.cpu_s(), Instant::now());
    let mut times_ms = Vec::with_capacity(rounds);
    for _ in 0..rounds {
        let begun = Instant::now();
        client.ask(&request).await;
        times_ms.push(begun.elapsed().as_secs_f64() * 1e3);
    }
    let (cpu, took) = (server.cpu_s() - cpu, begun.elapsed().as_secs_f64());
    let asked = (points * rounds) as f64;
    println!(
        "{:<52} {:>6.2} ms {:>6.2} ms {:>12.2} M {:>14.2} M",
        format!("{points} points a request, {dataset}, {rounds} requests"),
        median(&times_ms),
        quantile(&times_ms, 0.99),
        asked / took / 1e6,
        asked / cpu / 1e6
    );
}

/// Asks one point at a time over all connections at once: a bounded run, twice, of which the second counts.
async fn load(server: &Server, dataset: &str) {
    let run = async || {
        let mut tasks = Vec::new();
        for client in 0..CLIENTS {
            let (address, dataset) = (server.address, dataset.to_owned());
            tasks.push(tokio::spawn(async move {
                let mut connection = Client::connect(address).await;
                let mut times_ms = Vec::with_capacity(REQUESTS / CLIENTS);
                for index in 0..REQUESTS / CLIENTS {
                    let at = place(index * CLIENTS + client);
                    let request =
                        format!("GET /v1/{dataset}?locations={at} HTTP/1.1\r\nhost: localhost\r\n\r\n");
                    let begun = Instant::now();
                    connection.ask(request.as_bytes()).await;
                    times_ms.push(begun.elapsed().as_secs_f64() * 1e3);
                }
                (times_ms, connection.errors)
            }));
        }
        let (mut times_ms, mut errors) = (Vec::new(), 0);
        for task in tasks {
            let (times, wrong) = task.await.expect("a client that does not panic");
            times_ms.extend(times);
            errors += wrong;
        }
        (times_ms, errors)
    };
    run().await;
    let (cpu, before, begun) = (server.cpu_s(), server.resident_mib(), Instant::now());
    let (times_ms, errors) = run().await;
    let (took, cpu, after) = (begun.elapsed().as_secs_f64(), server.cpu_s() - cpu, server.resident_mib());
    let asked = times_ms.len() as f64;
    println!(
        "\n{asked} requests of one point, {dataset}, {CLIENTS} connections: {:.1} k/s beside the generator, {:.1} k per \
         second of its CPU;\np50 {:.2} ms, p99 {:.2} ms, longest {:.1} ms; {errors} errors; resident {before:.1} MiB \
         before, {after:.1} MiB after",
        asked / took / 1e3,
        asked / cpu / 1e3,
        median(&times_ms),
        quantile(&times_ms, 0.99),
        quantile(&times_ms, 1.0),
    );
}

/// A connection that asks and reads the whole answer.
struct Client {
    stream: TcpStream,
    buffer: Vec<u8>,
    errors: usize,
}

impl Client {
    async fn connect(address: SocketAddr) -> Self {
        let stream = TcpStream::connect(address).await.expect("it listens");
        stream.set_nodelay(true).expect("a socket");
        Self { stream, buffer: vec![0; 1 << 16], errors: 0 }
    }

    async fn ask(&mut self, request: &[u8]) {
        let mut sent = 0;
        while sent < request.len() {
            self.stream.writable().await.expect("connected");
            match self.stream.try_write(&request[sent..]) {
                Ok(count) => sent += count,
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                Err(error) => panic!("{error}"),
            }
        }
        let (mut read, mut whole) = (0, None);
        while whole.is_none_or(|whole| read < whole) {
            if read == self.buffer.len() {
                self.buffer.resize(read * 2, 0);
            }
            self.stream.readable().await.expect("connected");
            match self.stream.try_read(&mut self.buffer[read..]) {
                Ok(0) => panic!("the connection ended"),
                Ok(count) => read += count,
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                Err(error) => panic!("{error}"),
            }
            whole = whole.or_else(|| length(&self.buffer[..read]));
        }
        if !self.buffer.starts_with(b"HTTP/1.1 200") || !self.buffer[..read].ends_with(b"\"status\":\"OK\"}")
        {
            self.errors += 1;
        }
    }
}

/// How long an answer is with its head, as far as the head has come.
fn length(bytes: &[u8]) -> Option<usize> {
    let head = bytes.windows(4).position(|four| four == b"\r\n\r\n")?;
    let text = std::str::from_utf8(&bytes[..head]).ok()?;
    let stated = text.lines().find_map(|line| line.strip_prefix("content-length: "))?;
    Some(head + 4 + stated.parse::<usize>().ok()?)
}
