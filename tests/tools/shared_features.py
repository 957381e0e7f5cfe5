#!/usr/bin/env python3
"""Compares the features of third-party crates between builds of this workspace, and fails where they differ.

Cargo compiles a crate once for each set of features. Where the program, the tests of one crate and the window ask for
different sets, a newcomer waits for the same crate twice, and for all that stands on it. `src/features` holds the sets.
"""

import subprocess
import sys

# The builds that share: the first is what `cargo test` builds, which has all that `cargo run` builds.
WHOLE = []
OTHERS = [["-p", "sandtable", "-e", "normal,build"], ["-p", "sandtable", "--features", "viewer"]]


def features(selection):
    """The sets of features of every third-party crate, by name and version, as (for targets, for the host) may differ."""
    edges = [] if "-e" in selection else ["-e", "normal,build,dev"]
    command = ["cargo", "tree", "--locked", "--prefix", "none", "--format", "{p}\t{f}", *edges, *selection]
    lines = subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
    found = {}
    for line in lines:
        package, _, sets = line.replace(" (*)", "").partition("\t")
        if package and "(/" not in package:
            found.setdefault(package, set()).add(sets)
    return found


def main():
    listing = ["cargo", "tree", "--locked", "--workspace", "--depth", "0", "--prefix", "none", "--format", "{p}"]
    names = subprocess.run(listing, check=True, capture_output=True, text=True).stdout.split()
    members = sorted(name for name in names if name.startswith("sandtable-") and not name.endswith("-python"))
    whole = features(WHOLE)
    different = []
    for selection in OTHERS + [["-p", member] for member in members]:
        for package, sets in features(selection).items():
            for unknown in sets - whole.get(package, sets):
                different.append(f"cargo test {' '.join(selection)}: {package} has {unknown or 'no features'}, "
                                 f"and {' or '.join(sorted(whole[package])) or 'no features'} in `cargo test`")
    if different:
        print("\n".join(different))
        sys.exit("Ask for the features in src/features/Cargo.toml.")


main()
