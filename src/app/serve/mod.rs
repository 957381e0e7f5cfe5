//! `sandtable serve`: the height query service over HTTP.
//!
//! ```text
//! listener      connections, and how long a silent one is held
//!    └─ routes  requests: which address is which question, and where it is answered
//!         ├─ params, places, encoded, path        reading: parameters, locations
//!         ├─ heights, los, profile, viewshed      the questions (`question` is what they have in common)
//!         ├─ datasets, ground                     what is asked
//!         └─ json, reply, help, health            writing
//! ```
//!
//! Every answer comes from the [`Dataset`](crate::app::dataset::Dataset) that the commands ask, and is written so that
//! it reads back to the same bits: library, command line and service cannot but say the same.
//!
//! No request names a file, and none makes the service remember anything: what is served is chosen when the program
//! starts, and every request is answered from that alone.

mod datasets;
mod encoded;
mod ground;
mod health;
mod heights;
mod help;
mod json;
mod limits;
mod listener;
mod los;
mod params;
mod path;
mod places;
mod profile;
mod question;
mod reply;
mod routes;
mod viewshed;

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use clap::Args;
use tokio::net::TcpListener;
use tokio::runtime::{Builder, Runtime};

use crate::app::arguments::{Access, StatedHeights};
use crate::app::failure::CliError;
use crate::app::output;
use crate::app::serve::datasets::Datasets;
use crate::app::serve::limits::{ServeLimits, Turnstile};
use crate::app::serve::listener::Gate;
use crate::app::serve::question::{Log, Service};
use crate::geom::crs::Crs;

/// `serve`.
#[derive(Debug, Args)]
#[command(
    after_help = "Each file is a dataset, asked at /v1/NAME; without a name it has the file's, less its ending.\n\
                  The page at / says what can be asked. SIGINT or SIGTERM ends the service when its last answers are out.\n\
                  Example: sandtable serve hills=dem.tif valley.toml --listen 127.0.0.1:8080"
)]
pub struct ServeOptions {
    /// The elevation files and scenes
    #[arg(required = true, value_name = "[NAME=]FILE")]
    pub files: Vec<String>,
    /// Where to listen; port 0 takes one that is free. Only this machine can reach 127.0.0.1, all can 0.0.0.0
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8080", value_parser = address)]
    pub listen: SocketAddr,
    /// Write a line for each request to standard error: method, path, status, milliseconds
    #[arg(long)]
    pub log: bool,
    /// What may be asked.
    #[command(flatten)]
    pub limits: ServeLimits,
    /// What gray values mean.
    #[command(flatten)]
    pub heights: StatedHeights,
    /// What may be read.
    #[command(flatten)]
    pub access: Access,
}

/// Serves until a signal ends it.
///
/// # Errors
/// A file cannot be had or read, two have the same name, or the address cannot be listened at.
pub fn run(options: &ServeOptions) -> Result<(), CliError> {
    let runtime = runtime()?;
    // First of all, so that an address in use is told at once and not after minutes of reading.
    let listener = runtime.block_on(TcpListener::bind(options.listen));
    let listener = listener.map_err(|error| CliError::input(format!("{}: {error}", options.listen)))?;
    let datasets = Datasets::open(&options.files, options.heights, &options.access)?;
    let service = Arc::new(service(datasets, options));
    prepare(&service);
    let served = runtime.block_on(serve(listener, &service));
    runtime.shutdown_background();
    served.map_err(|error| CliError::input(format!("{}: {error}", options.listen)))
}

fn service(datasets: Datasets, options: &ServeOptions) -> Service {
    Service {
        datasets,
        limits: options.limits.clone(),
        wgs84: Crs::wgs84(),
        requests: Turnstile::new(options.limits.max_requests as usize),
        viewsheds: Turnstile::new(viewsheds_at_once()),
        log: if options.log { Log::Requests } else { Log::Silent },
    }
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// One viewshed is spread over all cores; a few at once let a small one pass a large one.
fn viewsheds_at_once() -> usize {
    (cores() / 2).clamp(1, 4)
}

/// Threads that listen, one a core, and threads for what takes its time: so many that all viewsheds leave one a core.
fn runtime() -> Result<Runtime, CliError> {
    Builder::new_multi_thread()
        .enable_all()
        .max_blocking_threads(cores() + viewsheds_at_once())
        .build()
        .map_err(|error| CliError::input(format!("no threads to be had: {error}")))
}

/// Makes the ground of every dataset, while questions about elevations as read are answered already.
fn prepare(service: &Arc<Service>) {
    let service = Arc::clone(service);
    let work = move || service.datasets.all().iter().for_each(|served| served.prepare());
    // Without a thread for it, whoever asks first makes it.
    let _ = std::thread::Builder::new().name("ground".into()).spawn(work);
}

/// Serves until the first signal; then takes no more connections and waits for the last answers, at most as long as the
/// grace time, or until a second signal.
async fn serve(listener: TcpListener, service: &Arc<Service>) -> io::Result<()> {
    let gate = Gate::new(listener, service.limits.max_connections as usize);
    let address = axum::serve::Listener::local_addr(&gate)?;
    let (mut first, mut both) = (StopSignals::listen()?, StopSignals::listen()?);
    output::warn(&format!("listening at http://{address}: {}", service.datasets.names()));
    let serving = axum::serve(gate, routes::router(Arc::clone(service)))
        .with_graceful_shutdown(async move { first.asked().await });
    let grace = Duration::from_secs(service.limits.grace.into());
    let cut_short = async {
        both.asked().await;
        let _ = tokio::time::timeout(grace, both.asked()).await;
    };
    tokio::select! {
        ended = serving => ended,
        () = cut_short => Ok(()),
    }
}

/// The signals that ask the program to end, from when it was made on.
struct StopSignals {
    #[cfg(unix)]
    interrupt: tokio::signal::unix::Signal,
    #[cfg(unix)]
    terminate: tokio::signal::unix::Signal,
}

impl StopSignals {
    #[cfg(unix)]
    fn listen() -> io::Result<Self> {
        use tokio::signal::unix::{SignalKind, signal};
        let (interrupt, terminate) = (signal(SignalKind::interrupt())?, signal(SignalKind::terminate())?);
        Ok(Self { interrupt, terminate })
    }

    /// Ends at the next signal.
    #[cfg(unix)]
    async fn asked(&mut self) {
        tokio::select! {
            _ = self.interrupt.recv() => {}
            _ = self.terminate.recv() => {}
        }
    }

    #[cfg(not(unix))]
    fn listen() -> io::Result<Self> {
        Ok(Self {})
    }

    /// Ends at the next signal.
    #[cfg(not(unix))]
    async fn asked(&mut self) {
        let _ = tokio::signal::ctrl_c().await;
    }
}

fn address(text: &str) -> Result<SocketAddr, String> {
    let numeric = text.replace("localhost:", "127.0.0.1:");
    numeric.parse().map_err(|_| "write an address and a port, as in 127.0.0.1:8080".into())
}
