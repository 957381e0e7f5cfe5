//! Options of the height service: its datasets, its address and its limits.

use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use crate::dataset::DatasetOptions;
use sandtable_files::disk;

/// Names that are addresses of the service.
const RESERVED: [&str; 3] = ["los", "profile", "viewshed"];

/// The longest name, in bytes.
const LONGEST_NAME: usize = 100;

/// Options of the height service.
#[derive(Clone)]
pub struct ServiceOptions {
    /// The datasets; no two have the same name.
    pub datasets: Vec<NamedFile>,
    /// Options for opening them.
    pub dataset: DatasetOptions,
    /// The address to listen at; port 0 takes a free one.
    pub listen: SocketAddr,
    /// The names by which clients reach the service, besides `localhost` and IP addresses; requests for others are
    /// refused.
    pub hosts: Vec<String>,
    /// What the paths of all addresses begin with.
    pub prefix: PathPrefix,
    /// Limits of requests.
    pub limits: ServiceLimits,
    /// Whether each request is logged.
    pub log: RequestLog,
    /// Writes a line for the user: where the service listens, warnings, the log.
    pub write_line: fn(&str),
}

/// The beginning of all paths of a service that shares its host with others: empty, or `/` and names with `/` between.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PathPrefix(String);

/// A text that no path begins with.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("write a path of letters, digits and -._~ that begins with / and ends without, as in /terrain/v2")]
pub struct PathPrefixError;

impl PathPrefix {
    /// Parses a prefix that is not empty.
    ///
    /// # Errors
    /// It does not begin with `/`, ends with one, or holds a character that needs an escape in a path.
    pub fn parse(text: &str) -> Result<Self, PathPrefixError> {
        let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "-._~".contains(letter);
        // `.` and `..` are steps in a path, and no names.
        let is_name = |name: &str| !["", ".", ".."].contains(&name) && name.chars().all(is_plain);
        let names = text.strip_prefix('/').filter(|_| text.len() <= LONGEST_NAME).ok_or(PathPrefixError)?;
        if names.split('/').all(is_name) { Ok(Self(text.to_owned())) } else { Err(PathPrefixError) }
    }

    /// The prefix.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The path of an address, which begins with `/`.
    pub fn before(&self, path: &str) -> String {
        format!("{}{path}", self.0)
    }
}

/// Limits of requests and connections.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ServiceLimits {
    /// The most points of one request: locations, samples, vertices.
    pub max_points: u32,
    /// The most posts of one viewshed: those in the square around its range.
    pub max_posts: u32,
    /// The most requests of one client that are answered or wait for it at once.
    pub max_requests: u32,
    /// The most connections held open, of one client half of them.
    pub max_connections: u32,
    /// How long a request may take to arrive, and how long its answer may take, seconds.
    pub timeout_s: u16,
    /// How long the last answers may take when the service stops, seconds.
    pub grace_s: u16,
}

impl Default for ServiceLimits {
    fn default() -> Self {
        Self {
            max_points: 10_000,
            max_posts: 4_194_304,
            max_requests: 256,
            max_connections: 1024,
            timeout_s: 30,
            grace_s: 10,
        }
    }
}

/// Whether requests are logged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RequestLog {
    /// A line for each request.
    On,
    /// Nothing.
    Off,
}

/// A file and the name under which it is served.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedFile {
    name: String,
    path: PathBuf,
}

/// A name that a dataset cannot have.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the dataset name '{name}' {fault}: give it another, as in hills={}", path.display())]
pub struct DatasetNameError {
    /// The name.
    name: String,
    /// Its fault.
    fault: &'static str,
    /// The dataset's file.
    path: PathBuf,
}

impl NamedFile {
    /// Parses `NAME=FILE`, or `FILE`, which is named after the file without its extension. An `=` in the path of a file
    /// that exists separates nothing.
    ///
    /// # Errors
    /// The name cannot be part of an address.
    pub fn parse(text: &str) -> Result<Self, DatasetNameError> {
        let path = Path::new(text);
        let parts = text.split_once('=').filter(|(name, _)| !name.contains(['/', '\\']));
        let (name, path) = match parts {
            Some((name, file)) if !path.exists() => (name.to_owned(), Path::new(file)),
            _ => (disk::file_stem(path), path),
        };
        let path = path.to_owned();
        match name_fault(&name) {
            Some(fault) => Err(DatasetNameError { name, fault, path }),
            None => Ok(Self { name, path }),
        }
    }

    /// The name in addresses.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

fn name_fault(name: &str) -> Option<&'static str> {
    let is_unfit = |c: char| c.is_control() || matches!(c, ',' | '/' | '?' | '#' | '%' | '\\');
    match name {
        _ if RESERVED.contains(&name) => Some("is the address of a query"),
        "" => Some("is empty"),
        _ if name.len() > LONGEST_NAME => Some("is longer than 100 bytes"),
        _ if name.contains(is_unfit) => Some("holds a character that an address cannot"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dataset_has_the_name_that_is_given_or_its_files() {
        for (text, name, path) in [
            ("data/hills.tif", "hills", "data/hills.tif"),
            ("a=data/hills.tif", "a", "data/hills.tif"),
            ("data/x=1/hills.tif", "hills", "data/x=1/hills.tif"),
            ("a=b=c.tif", "a", "b=c.tif"),
        ] {
            let file = NamedFile::parse(text).expect(text);
            assert_eq!((file.name(), file.path()), (name, Path::new(path)));
        }
    }

    #[test]
    fn a_prefix_is_a_plain_path_without_an_end() {
        for right in ["/terrain", "/a/b-1/c.d_e~f"] {
            assert_eq!(
                PathPrefix::parse(right).map(|prefix| prefix.before("/v1")),
                Ok(format!("{right}/v1"))
            );
        }
        for wrong in ["", "/", "terrain", "/a/", "/a//b", "/a/../b", "/.", "/{a}", "/a b", "/a%20", "/ä"] {
            assert_eq!(PathPrefix::parse(wrong), Err(PathPrefixError), "{wrong}");
        }
        assert!(PathPrefix::parse(&format!("/{}", "x".repeat(100))).is_err());
        assert_eq!(PathPrefix::default().before("/"), "/");
    }

    #[test]
    fn names_that_an_address_cannot_hold_are_refused() {
        for wrong in ["", "los", "a,b", "a/b", "50%", "a\nb", &"x".repeat(101)] {
            assert!(name_fault(wrong).is_some(), "{wrong}");
        }
        for right in ["N43E007", "dem_srtm wgs84", "höhen", "a.b-c"] {
            assert_eq!(name_fault(right), None, "{right}");
        }
    }
}
