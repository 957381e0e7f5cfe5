//! `sandtable serve`: the arguments of the height service.

use std::net::SocketAddr;

use clap::Args;

use crate::ServeProgram;
use crate::error::CliError;
use crate::options::{AccessArguments, HeightArguments};
use crate::output::warn;
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_query::dataset::DatasetOptions;
use sandtable_query::service::{NamedFile, PathPrefix, RequestLog, ServiceLimits, ServiceOptions};

#[derive(Debug, Args)]
#[command(
    after_help = "Each file is a dataset, queried at /v1/NAME; without a name it is named after the file, less its extension.\n\
                  The page at / is a map to click in a browser; /help lists the queries. SIGINT or SIGTERM ends the service when its last answers are out.\n\
                  Example: sandtable serve hills=dem.tif valley.toml --listen 127.0.0.1:8080"
)]
pub struct ServeArguments {
    /// The elevation files and scenes
    #[arg(required = true, value_name = "[NAME=]FILE")]
    pub files: Vec<String>,
    /// Where to listen; port 0 takes a free one. Only this machine can reach 127.0.0.1, all can reach 0.0.0.0
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8080", value_parser = address)]
    pub listen: SocketAddr,
    /// A name by which clients reach the service, besides localhost and IP addresses; requests for other hosts are refused
    #[arg(long, value_name = "NAME")]
    pub host: Vec<String>,
    /// The prefix of all paths, behind a proxy that serves other programs too: /terrain puts /health at /terrain/health
    #[arg(long, value_name = "PATH", value_parser = PathPrefix::parse)]
    pub prefix: Option<PathPrefix>,
    /// Write a line for each request to standard error: method, path, status, milliseconds
    #[arg(long)]
    pub log: bool,
    /// The most points of one request: locations, samples, vertices
    #[arg(long, value_name = "N", default_value_t = ServiceLimits::default().max_points, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub max_points: u32,
    /// The most posts of one viewshed: those in the square around its range
    #[arg(long, value_name = "N", default_value_t = ServiceLimits::default().max_posts, value_parser = clap::value_parser!(u32).range(1..=268_435_456))]
    pub max_posts: u32,
    /// The most requests of one client that are answered or wait for it at once; more are refused with 503
    #[arg(long, value_name = "N", default_value_t = ServiceLimits::default().max_requests, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub max_requests: u32,
    /// The most connections held open; one client may hold half of them
    #[arg(long, value_name = "N", default_value_t = ServiceLimits::default().max_connections, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub max_connections: u32,
    /// How long a request may take to arrive, and how long its answer may take
    #[arg(long, value_name = "SECONDS", default_value_t = ServiceLimits::default().timeout_s, value_parser = clap::value_parser!(u16).range(1..=3600))]
    pub timeout: u16,
    /// How long the last answers may take when the service stops
    #[arg(long, value_name = "SECONDS", default_value_t = ServiceLimits::default().grace_s, value_parser = clap::value_parser!(u16).range(0..=3600))]
    pub grace: u16,
    #[command(flatten)]
    pub heights: HeightArguments,
    #[command(flatten)]
    pub access: AccessArguments,
}

pub fn run(arguments: &ServeArguments, serve: Option<ServeProgram>) -> Result<(), CliError> {
    let serve = serve.ok_or_else(|| {
        CliError::usage(
            "this build has no service; build it with the feature `serve`: cargo build --features serve",
        )
    })?;
    let options = ServiceOptions {
        datasets: datasets(&arguments.files)?,
        dataset: DatasetOptions {
            dem: arguments.heights.dem_options(),
            allowed: arguments.access.allow.clone(),
            most_kept: RASTER_SAMPLES.get(),
        },
        listen: arguments.listen,
        hosts: arguments.host.clone(),
        prefix: arguments.prefix.clone().unwrap_or_default(),
        limits: ServiceLimits {
            max_points: arguments.max_points,
            max_posts: arguments.max_posts,
            max_requests: arguments.max_requests,
            max_connections: arguments.max_connections,
            timeout_s: arguments.timeout,
            grace_s: arguments.grace,
        },
        log: if arguments.log { RequestLog::On } else { RequestLog::Off },
        write_line: warn,
    };
    serve(&options).map_err(|error| CliError::Input { error, hint: None })
}

fn datasets(arguments: &[String]) -> Result<Vec<NamedFile>, CliError> {
    let mut datasets: Vec<NamedFile> = Vec::with_capacity(arguments.len());
    for argument in arguments {
        let file = NamedFile::parse(argument).map_err(CliError::usage)?;
        if datasets.iter().any(|other| other.name() == file.name()) {
            return Err(CliError::usage(format!(
                "two datasets are named '{}': give one of them another name, as in other={argument}",
                file.name()
            )));
        }
        datasets.push(file);
    }
    Ok(datasets)
}

fn address(text: &str) -> Result<SocketAddr, &'static str> {
    let numeric = text.replace("localhost:", "127.0.0.1:");
    numeric.parse().map_err(|_| "write an address and a port, as in 127.0.0.1:8080")
}
