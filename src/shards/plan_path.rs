//! Paths in a plan: relative to its folder where they were stated relative, so that a tree may be mounted elsewhere. Addresses
//! stay as they are.

use std::path::{Component, Path, PathBuf};

use sandtable_remote::address::is_address_path;

/// The path to a file as it is written into a plan in `folder`, which must exist. A relative one is so to `folder` then,
/// with `/` between its parts.
pub fn written(path: &Path, folder: &Path) -> PathBuf {
    if path.is_absolute() { path.to_owned() } else { relative(path, folder) }
}

/// The path of the file that a plan in `folder` calls `written`.
pub fn place(written: &Path, folder: &Path) -> PathBuf {
    if is_address_path(written) { written.to_owned() } else { folder.join(written) }
}

/// The relative path from `folder`, which must exist, to a file; the file's own path where there is none, and an
/// address.
pub fn relative(path: &Path, folder: &Path) -> PathBuf {
    if is_address_path(path) {
        return path.to_owned();
    }
    let (Some(folder), Some(path)) = (folder.canonicalize().ok(), resolved(path)) else {
        return path.to_owned();
    };
    let (from, to): (Vec<Component>, Vec<Component>) =
        (folder.components().collect(), path.components().collect());
    let shared = from.iter().zip(&to).take_while(|(from, to)| from == to).count();
    // Another drive has no path from here.
    if shared == 0 {
        return path;
    }
    let up = from[shared..].iter().map(|_| "..".to_owned());
    let down = to[shared..].iter().map(|part| part.as_os_str().to_string_lossy().into_owned());
    let parts: Vec<String> = up.chain(down).collect();
    if parts.is_empty() { PathBuf::from(".") } else { PathBuf::from(parts.join("/")) }
}

/// Where a file is; its own name stays, so that a link keeps the companions beside it.
fn resolved(path: &Path) -> Option<PathBuf> {
    let Some(name) = path.file_name() else { return path.canonicalize().ok() };
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    Some(parent.canonicalize().ok()?.join(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_relative_to_the_plan_where_they_were_stated_relative() {
        assert_eq!(written(Path::new("tiles/plan.rs"), Path::new("tiles/meshes")), Path::new("../plan.rs"));
        assert_eq!(written(Path::new("tiles/plan.rs"), Path::new(".")), Path::new("tiles/plan.rs"));
        assert_eq!(written(Path::new("tiles/../atlas"), Path::new("tiles")), Path::new("../atlas"));
        assert_eq!(written(Path::new("tiles"), Path::new("tiles")), Path::new("."));
        assert_eq!(written(Path::new("/a/b.tif"), Path::new("src")), Path::new("/a/b.tif"));
    }

    #[test]
    fn an_address_is_the_same_in_every_folder() {
        let address = Path::new("https://example.org/a/b.tif");
        assert_eq!(written(address, Path::new("src")), address);
        assert_eq!(place(address, Path::new("src")), address);
        assert_eq!(place(Path::new("../lib.rs"), Path::new("src/cli")), Path::new("src/cli/../lib.rs"));
    }
}
