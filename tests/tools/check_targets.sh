#!/usr/bin/env bash
# Compiles the program for Windows and macOS as far as that goes without these systems: types, borrows and `cfg`, by `cargo check`.
#
# usage: tests/tools/check_targets.sh TARGET...
#
# Nothing is linked. The C of dependencies (SQLite) is compiled for Windows by mingw-w64, where there is one; for macOS nothing here
# compiles C, so a stand-in leaves empty objects, which a check never looks into. What does not install is skipped, loudly.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

stand_in=target/c-stand-in
mkdir -p "$stand_in"
cat >"$stand_in/cc" <<'EOF'
#!/bin/sh
# Writes an empty object for each -o; says that it is clang where it is asked.
case "$*" in *-E*) echo clang ;; esac
while [ $# -gt 0 ]; do
    [ "$1" = -o ] && : >"$2"
    shift
done
EOF
printf '#!/bin/sh\nfor last; do case "$last" in *.a) : >"$last" ;; esac; done\n' >"$stand_in/ar"
chmod +x "$stand_in/cc" "$stand_in/ar"
stand_in=$PWD/$stand_in

skip() { echo "SKIPPED: $*" >&2; }

for target in "$@"; do
    if ! rustup target list --installed 2>/dev/null | grep -qx "$target" && ! rustup target add "$target" >/dev/null 2>&1; then
        skip "the standard library of $target is not to be had here, so the program is NOT CHECKED for it."
        continue
    fi
    name=${target//-/_}
    settings=("SDKROOT=$PWD/target" "CC_$name=$stand_in/cc" "AR_$name=$stand_in/ar")
    if [[ $target == *-windows-gnu ]] && command -v "${target%%-*}-w64-mingw32-gcc" >/dev/null; then
        settings=("WITH=mingw")
    fi
    began=$SECONDS
    # As the lints of the workflows do there.
    env "${settings[@]}" RUSTFLAGS=-Dwarnings cargo check --quiet --locked --target "$target" -p sandtable --lib --bins
    echo "$target: checked in $((SECONDS - began)) s"
done
