//! What a scene may read and what it may not, on a real file system.

use crate::common::skip;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use sandtable_model::Companions;
use sandtable_scene::assets::{AssetError, Assets};

/// A folder of its own for each test, gone when it ends:
///
/// ```text
/// secret.txt
/// project/data/hill.tif
/// project/scenes/a.toml
/// project/scenes/models/barn.obj, Wood.JPG, Textures/roof.png
/// elsewhere/dem.tif
/// ```
struct Disk(PathBuf);

impl Disk {
    fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name =
            format!("sandtable-assets-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let root = std::env::temp_dir().join(name);
        for (file, text) in [
            ("secret.txt", "secret"),
            ("project/data/hill.tif", "hill"),
            ("project/scenes/a.toml", ""),
            ("project/scenes/models/barn.obj", "barn"),
            ("project/scenes/models/Wood.JPG", "wood"),
            ("project/scenes/models/Textures/roof.png", "roof"),
            ("elsewhere/dem.tif", "elsewhere"),
        ] {
            let path = root.join(file);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a writable temporary folder");
            fs::write(path, text).expect("a writable temporary folder");
        }
        Self(root.canonicalize().expect("it is there"))
    }

    fn at(&self, path: &str) -> PathBuf {
        self.0.join(path)
    }

    fn assets(&self, allowed: &[PathBuf]) -> Assets {
        Assets::new(&self.at("project/scenes/a.toml"), allowed).expect("the folders are there")
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn refusal(assets: &Assets, name: &str) -> String {
    assets.read(name).expect_err(name).to_string()
}

#[test]
fn files_beside_the_scene_and_beside_its_folder_are_read() {
    let disk = Disk::new();
    let assets = disk.assets(&[]);
    assert_eq!(assets.read("../data/hill.tif").expect("beside the folder"), b"hill");
    assert_eq!(assets.read("models/barn.obj").expect("below the scene"), b"barn");
    assert_eq!(assets.read("models\\barn.obj").expect("with backslashes"), b"barn");
    assert_eq!(assets.read("./models/../../data/./hill.tif").expect("with detours"), b"hill");
}

#[test]
fn paths_that_climb_higher_are_refused_whether_they_exist_or_not() {
    let disk = Disk::new();
    let assets = disk.assets(&[]);
    for name in
        ["../../secret.txt", "../../nothing.txt", "models/../../../secret.txt", "../../../../../etc/passwd"]
    {
        let error = refusal(&assets, name);
        assert!(error.contains("outside") && error.contains("--allow"), "{name}: {error}");
    }
    let error = refusal(&assets, "../../secret.txt");
    assert!(error.contains(&format!("--allow {}", disk.0.display())), "{error}");
}

#[test]
fn absolute_paths_need_to_be_allowed() {
    let disk = Disk::new();
    let outside = disk.at("elsewhere/dem.tif");
    let name = outside.to_str().expect("UTF-8");
    assert!(refusal(&disk.assets(&[]), name).contains("--allow"));
    let inside = disk.at("project/data/hill.tif");
    assert!(refusal(&disk.assets(&[]), inside.to_str().expect("UTF-8")).contains("--allow"));
    let assets = disk.assets(&[disk.at("elsewhere")]);
    assert_eq!(assets.read(name).expect("allowed"), b"elsewhere");
    assert_eq!(assets.read("../../elsewhere/dem.tif").expect("allowed"), b"elsewhere");
    assert!(refusal(&assets, "../../secret.txt").contains("outside"));
    assert!(
        refusal(&assets, disk.at("elsewhere/../secret.txt").to_str().expect("UTF-8")).contains("outside")
    );
}

#[test]
fn a_missing_file_is_told_with_its_place_and_the_name_that_is_there() {
    let disk = Disk::new();
    let assets = disk.assets(&[]);
    let error = refusal(&assets, "../data/hil.tif");
    let place = disk.at("project/data/hil.tif");
    assert!(error.contains(&place.display().to_string()), "{error}");
    assert!(error.ends_with("did you mean 'hill.tif'?"), "{error}");
    assert!(refusal(&assets, "nowhere/x.tif").starts_with("there is no file"));
    assert!(matches!(assets.read("models/elephant"), Err(AssetError::Missing { meant: None, .. })));
}

#[test]
fn folders_are_no_files() {
    let disk = Disk::new();
    assert!(refusal(&disk.assets(&[]), "models").contains("is a folder, not a file"));
    assert!(refusal(&disk.assets(&[]), ".").contains("is a folder"));
}

#[test]
fn missing_folders_are_told() {
    let disk = Disk::new();
    let gone = disk.at("gone");
    let error =
        Assets::new(&disk.at("project/scenes/a.toml"), std::slice::from_ref(&gone)).expect_err("not there");
    assert!(error.to_string().contains(&gone.display().to_string()), "{error}");
    assert!(Assets::new(&gone.join("a.toml"), &[]).is_err());
    assert!(Assets::new(Path::new("a.toml"), &[]).is_ok(), "the current folder");
}

#[test]
fn a_model_finds_its_companions_whatever_their_case_and_slashes() {
    let disk = Disk::new();
    let assets = disk.assets(&[]);
    let beside = assets.beside("models/barn.obj").expect("the model is there");
    for (name, bytes) in [
        ("Wood.JPG", "wood"),
        ("wood.jpg", "wood"),
        ("textures\\ROOF.PNG", "roof"),
        (".\\Textures\\roof.png", "roof"),
        ("C:\\Users\\me\\WOOD.jpg", "wood"),
        ("/home/me/wood.jpg", "wood"),
        ("maps/wood.jpg", "wood"),
        ("../../data/HILL.tif", "hill"),
    ] {
        assert_eq!(beside.load(name).expect(name), bytes.as_bytes());
    }
    for name in
        ["../../../secret.txt", "../../../SECRET.txt", "nothing.png", "", "..", "http://example.org/a.png"]
    {
        assert!(beside.load(name).is_err(), "{name}");
    }
    let error = |name: &str| beside.load(name).expect_err("refused").to_string();
    assert!(error("woood.jpg").contains("did you mean 'Wood.JPG'?"));
    assert!(error("../../../secret.txt").contains("--allow"));
}

#[cfg(unix)]
mod links {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn a_link_leads_nowhere_that_a_path_would_not() {
        let disk = Disk::new();
        symlink(disk.at("secret.txt"), disk.at("project/scenes/link.txt")).expect("a link");
        symlink(disk.at("elsewhere"), disk.at("project/scenes/folder")).expect("a link");
        symlink(disk.at("project/data"), disk.at("project/scenes/data")).expect("a link");
        let assets = disk.assets(&[]);
        assert!(refusal(&assets, "link.txt").contains("outside"));
        assert!(refusal(&assets, "folder/dem.tif").contains("outside"));
        assert!(refusal(&assets, "folder/../secret.txt").contains("outside"));
        assert_eq!(assets.read("data/hill.tif").expect("the link stays inside"), b"hill");
        assert_eq!(
            disk.assets(&[disk.at("elsewhere")]).read("folder/dem.tif").expect("allowed"),
            b"elsewhere"
        );
        let beside = assets.beside("models/barn.obj").expect("the model is there");
        assert!(beside.load("../FOLDER/dem.tif").is_err());
        assert!(beside.load("../LINK.txt").is_err());
    }

    #[test]
    fn a_folder_may_be_allowed_by_a_link_to_it() {
        let disk = Disk::new();
        symlink(disk.at("elsewhere"), disk.at("alias")).expect("a link");
        symlink(disk.at("secret.txt"), disk.at("elsewhere/out.txt")).expect("a link");
        let assets = disk.assets(&[disk.at("alias")]);
        for name in ["alias/dem.tif", "elsewhere/dem.tif"] {
            assert_eq!(assets.read(disk.at(name).to_str().expect("UTF-8")).expect("allowed"), b"elsewhere");
        }
        assert!(refusal(&assets, disk.at("alias/out.txt").to_str().expect("UTF-8")).contains("outside"));
    }

    #[test]
    fn a_missing_name_behind_a_link_tells_nothing_of_the_folder_there() {
        let disk = Disk::new();
        symlink(disk.at("elsewhere"), disk.at("project/scenes/folder")).expect("a link");
        let error = refusal(&disk.assets(&[]), "folder/den.tif");
        assert!(!error.contains("dem.tif"), "{error}");
    }

    #[test]
    fn links_in_a_circle_and_to_nothing_are_errors() {
        let disk = Disk::new();
        symlink(disk.at("project/scenes/b"), disk.at("project/scenes/a")).expect("a link");
        symlink(disk.at("project/scenes/a"), disk.at("project/scenes/b")).expect("a link");
        symlink(disk.at("gone"), disk.at("project/scenes/c")).expect("a link");
        let assets = disk.assets(&[]);
        assert!(refusal(&assets, "a").contains("cannot be read"));
        assert!(refusal(&assets, "c").contains("there is no file"));
    }

    #[test]
    fn devices_and_pipes_are_refused_without_waiting() {
        let disk = Disk::new();
        let assets = disk.assets(&[PathBuf::from("/dev")]);
        if Path::new("/dev/zero").exists() {
            assert!(refusal(&assets, "/dev/zero").contains("a pipe or a device"));
        }
        let pipe = disk.at("project/scenes/pipe");
        match std::process::Command::new("mkfifo").arg(&pipe).status() {
            Ok(status) if status.success() => {
                assert!(refusal(&assets, "pipe").contains("a pipe or a device"))
            }
            _ => super::skip::skipped("no mkfifo on this machine"),
        }
    }

    #[test]
    fn a_file_too_large_is_refused_before_it_is_read() {
        let disk = Disk::new();
        let file = fs::File::create(disk.at("project/scenes/huge.tif")).expect("writable");
        if file.set_len(3 << 30).is_err() {
            super::skip::skipped("this file system holds no sparse file of 3 GiB");
            return;
        }
        assert!(refusal(&disk.assets(&[]), "huge.tif").contains("3221225472 bytes, more than can be read"));
    }
}
