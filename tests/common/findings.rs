//! What a check finds in a scene.

use std::path::{Path, PathBuf};

use sandtable_description::finding::{Finding, Severity};
use sandtable_lint::opened::open_linted;
use sandtable_scene::scene_file::OpenSceneError;

/// The findings of a check of the scene file `path`, which may read files below the folders `allowed`; where it is not built,
/// the errors that keep it from that.
pub fn findings(path: &Path, allowed: &[PathBuf]) -> Vec<Finding> {
    match open_linted(path, allowed, &|_| ()) {
        Ok((_, findings)) => findings,
        Err(errors @ (OpenSceneError::Parse(_) | OpenSceneError::Build(_))) => errors.findings(),
        Err(other) => panic!("{}: {other}", path.display()),
    }
}

/// Errors and warnings.
pub fn grave(findings: &[Finding]) -> Vec<&Finding> {
    findings.iter().filter(|finding| finding.severity() != Severity::Note).collect()
}
