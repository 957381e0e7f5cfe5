//! The height service over HTTP.
//!
//! ```text
//! listener      connections: their number and time limits
//!    └─ router  requests: their address, their limits, the thread that answers them
//!         ├─ host, clients, answers                        who may ask, and for how much at once
//!         ├─ parameters, coordinates, polyline, samples    reading
//!         ├─ heights, los, profile, viewshed, analyses,
//!         │  tiles                                         the queries (`query` is what they share)
//!         ├─ service, datasets                             the state of the service, and what it serves
//!         ├─ api ─► help, openapi                          what may be asked, as a table and as pages
//!         ├─ map_page                                      the page at `/`, a client of the queries
//!         └─ reply, health, ready, etag                    writing
//! ```
//!
//! Every answer comes from the [`Dataset`](sandtable_query::dataset::Dataset) that the commands query, and its numbers
//! read back to the same bits. Requests name no files and change no state: the datasets are fixed when the service
//! starts.

mod analyses;
mod answers;
mod api;
mod clients;
mod coordinates;
mod datasets;
mod etag;
mod health;
mod heights;
mod help;
mod host;
mod listener;
mod lookup;
mod los;
mod map_page;
mod openapi;
mod parameters;
mod polyline;
mod profile;
mod query;
mod ready;
mod reply;
mod router;
mod samples;
mod service;
mod tiles;
mod viewshed;

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use tokio::net::TcpListener;
use tokio::runtime::{Builder, Runtime};
use tokio::sync::{Semaphore, oneshot};

use crate::answers::{AnswerMemory, UNITS_OF_CLIENT};
use crate::clients::{ClientShares, Clients};
use crate::datasets::Datasets;
use crate::listener::{Gate, RequestConnection};
use crate::parameters::{LONG_BODIES, LONG_BODIES_OF_CLIENT};
use crate::ready::Readiness;
use crate::service::Service;
use sandtable_geom::crs::Crs;
use sandtable_geom::geoid::Geoid;
use sandtable_query::dataset::OpenError;
use sandtable_query::service::{ServiceLimits, ServiceOptions};

/// Why the service cannot start or continue.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum ServeError {
    #[error("threads cannot be started")]
    Threads(#[source] io::Error),
    #[error("{address}")]
    Listen { address: SocketAddr, source: io::Error },
    #[error(transparent)]
    Open(#[from] OpenError),
}

/// Serves until a signal ends it (SIGINT or SIGTERM).
///
/// # Errors
/// See [`ServeError`].
pub fn run(options: &ServiceOptions) -> Result<(), ServeError> {
    let at_address = |source| ServeError::Listen { address: options.listen, source };
    let runtime = runtime().map_err(ServeError::Threads)?;
    // First, so that an address in use is reported at once and not after minutes of reading.
    let listener = runtime.block_on(TcpListener::bind(options.listen)).map_err(at_address)?;
    let service = Arc::new(Service {
        datasets: Datasets::open(options)?,
        limits: options.limits,
        wgs84: Crs::wgs84(),
        hosts: options.hosts.clone(),
        prefix: options.prefix.clone(),
        readiness: Readiness::default(),
        clients: Clients::new(options.limits.max_connections as usize, shares(&options.limits)),
        answers: AnswerMemory::default(),
        geoid: Geoid::default(),
        long_bodies: Arc::new(Semaphore::new(LONG_BODIES)),
        heavy: Arc::new(Semaphore::new(cores())),
        expensive: Arc::new(Semaphore::new(expensive_at_once())),
        pictures: Arc::new(Semaphore::new(1)),
        log: options.log,
        write_line: options.write_line,
    });
    prepare(&service);
    let served = runtime.block_on(serve(listener, &service));
    runtime.shutdown_background();
    served.map_err(at_address)
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// A viewshed uses all cores; with several at once, a small one finishes before a large one.
fn expensive_at_once() -> usize {
    (cores() / 2).clamp(1, 4)
}

/// What one client may have at once. Alone it may use all cores, but begin only one expensive query at a time.
fn shares(limits: &ServiceLimits) -> ClientShares {
    ClientShares {
        connections: limits.max_connections.div_ceil(2) as usize,
        requests: limits.max_requests as usize,
        long_bodies: LONG_BODIES_OF_CLIENT,
        answers: UNITS_OF_CLIENT,
        heavy: cores(),
        expensive: 1,
    }
}

/// A runtime with a listening thread per core, and threads for all heavy and expensive queries that have their turn and
/// for reading as many more.
fn runtime() -> io::Result<Runtime> {
    let blocking = 2 * cores() + expensive_at_once();
    Builder::new_multi_thread().enable_all().max_blocking_threads(blocking).build()
}

/// Makes the ground of every dataset in the background, and answers a first height of each. Queries for elevations as read do not
/// wait for it.
fn prepare(service: &Arc<Service>) {
    let service = Arc::clone(service);
    let work = move || {
        let datasets = service.datasets.all();
        datasets.iter().for_each(|served| drop(served.dataset.prepare_ground()));
        service.readiness.try_all(datasets);
    };
    // If the thread does not start, the first query for the ground makes it.
    let _ = std::thread::Builder::new().name("ground".into()).spawn(work);
}

/// Serves until the first signal. Then accepts no more connections and waits for pending answers, until the grace time
/// ends or a second signal arrives.
async fn serve(listener: TcpListener, service: &Arc<Service>) -> io::Result<()> {
    let gate = Gate::new(listener, Arc::clone(&service.clients));
    let address = axum::serve::Listener::local_addr(&gate)?;
    let mut signals = StopSignals::listen()?;
    let (prefix, names) = (service.prefix.as_str(), service.datasets.names());
    (service.write_line)(&format!("listening at http://{address}{prefix}: {names}"));
    let (stop, stopped) = oneshot::channel::<()>();
    let router = router::router(Arc::clone(service));
    let router = router.into_make_service_with_connect_info::<RequestConnection>();
    let serving = axum::serve(gate, router).with_graceful_shutdown(async {
        let _ = stopped.await;
    });
    let grace = Duration::from_secs(service.limits.grace_s.into());
    let cut_short = async {
        signals.next().await;
        service.readiness.end();
        let _ = stop.send(());
        let _ = tokio::time::timeout(grace, signals.next()).await;
    };
    tokio::select! {
        ended = serving => ended,
        () = cut_short => Ok(()),
    }
}

/// Listens for the signals that end the program.
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

    #[cfg(unix)]
    async fn next(&mut self) {
        tokio::select! {
            _ = self.interrupt.recv() => {}
            _ = self.terminate.recv() => {}
        }
    }

    #[cfg(not(unix))]
    fn listen() -> io::Result<Self> {
        Ok(Self {})
    }

    #[cfg(not(unix))]
    async fn next(&mut self) {
        let _ = tokio::signal::ctrl_c().await;
    }
}
