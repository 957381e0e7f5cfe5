#!/usr/bin/env python3
"""Makes assets/NOTICES.txt anew: what the program is made of and the licenses of it.

Every package of others that Cargo.lock reaches from [dependencies], whatever the features and the platform, with its version, the
license that it is used under and the lines of copyright in its files; then each license once.

usage: python3 tests/tools/notices.py, in the project's folder, where `cargo metadata` can reach every package
"""
import json
import pathlib
import re
import subprocess
import tomllib

# Where a package may be used under several licenses, the first of these; the texts follow in this order.
LICENSES = ["MIT", "Apache-2.0", "BSD-3-Clause", "BSD-2-Clause", "ISC", "Zlib", "0BSD", "BSL-1.0", "CC0-1.0",
            "Unicode-3.0", "OFL-1.1", "Ubuntu-font-1.0", "CDLA-Permissive-2.0"]

# How a license's own text begins, to find it among a package's files.
BEGINNINGS = {
    "MIT": "Permission is hereby granted, free of charge", "Apache-2.0": "Apache License",
    "BSD-3-Clause": "Redistribution and use in source", "BSD-2-Clause": "Redistribution and use in source",
    "ISC": "Permission to use, copy, modify, and", "Zlib": "This software is provided 'as-is'",
    "0BSD": "Permission to use, copy, modify, and", "BSL-1.0": "Boost Software License",
    "CC0-1.0": "Statement of Purpose", "Unicode-3.0": "UNICODE LICENSE V3", "OFL-1.1": "SIL OPEN FONT LICENSE",
    "Ubuntu-font-1.0": "UBUNTU FONT LICENCE", "CDLA-Permissive-2.0": "Community Data License Agreement - Permissive",
}


def dependencies(path):
    """The names in the tables of dependencies of a manifest, without those of tests."""
    manifest = tomllib.loads(pathlib.Path(path).read_text())
    tables = [manifest, *manifest.get("target", {}).values()]
    return {name for table in tables for name in table.get("dependencies", {})}


def reached(lock):
    """The packages of others in Cargo.lock that are reached from [dependencies]."""
    by_name = {}
    for package in lock:
        by_name.setdefault(package["name"], []).append(package)

    def find(reference):
        name, _, version = reference.partition(" ")
        return [package for package in by_name[name] if not version or package["version"] == version.split(" ")[0]]

    def needs(package):
        # The lock file does not tell what tests need from what all need; the manifests of the workspace do.
        names = package.get("dependencies", [])
        if not package["name"].startswith("sandtable"):
            return names
        own = package["name"].removeprefix("sandtable").removeprefix("-")
        direct = dependencies(f"src/{own}/Cargo.toml" if own else "Cargo.toml")
        return [name for name in names if name.split(" ")[0] in direct]

    waiting = needs(by_name["sandtable"][0])
    found = {}
    while waiting:
        for package in find(waiting.pop()):
            key = (package["name"], package["version"])
            if key not in found:
                found[key] = package
                waiting += needs(package)
    return sorted(key for key in found if not key[0].startswith("sandtable"))


def chosen(expression):
    """The licenses that an SPDX expression asks for, where the best of each choice is taken."""
    parts = [part.strip(" ()") for part in expression.split(" AND ")]
    best = []
    for part in parts:
        options = [o.split(" WITH ")[0].strip(" ()") for o in re.split(r" OR |/", part)]
        known = [license for license in LICENSES if license in options]
        if not known:
            raise SystemExit(f"no known license in {expression!r}")
        best.append(known[0])
    return sorted(set(best), key=LICENSES.index)


def texts(folder):
    """The texts of the files of a package that are named as licenses are."""
    names = re.compile(r"(licen[cs]e|copying|notice|ofl|ufl)[^/]*$", re.I)
    kinds = {"", ".md", ".txt", ".mit", ".apache", ".apache2", ".0"}
    files = [f for f in sorted(folder.rglob("*")) if names.search(f.name) and f.suffix.lower() in kinds and f.is_file()]
    return [f.read_text("utf-8", "replace").replace("\r\n", "\n") for f in files]


def copyrights(all_texts):
    line = re.compile(r"^[\s#/*>-]*((?:copyright|©)\b.*\d{4}.*|copyright \(c\).*)$", re.I)
    found = []
    for text in all_texts:
        # The Apache license speaks of copyright throughout, and names nobody's.
        for raw in text.splitlines():
            match = line.match(raw)
            words = match and " ".join(match.group(1).split())
            if words and "[yyyy]" not in words and "{yyyy}" not in words and "<year>" not in words and words not in found:
                found.append(words)
    return found[:12]


def is_of(license, text):
    """Whether a text that begins as the license does is it: some begin alike."""
    if license in ("ISC", "0BSD"):
        return ("provided that" in text) == (license == "ISC")
    if license in ("BSD-2-Clause", "BSD-3-Clause"):
        return ("neither the name" in text.lower()) == (license == "BSD-3-Clause")
    return True


def license_text(license, all_texts):
    """The license's own text in one of a package's files, without the lines above it."""
    for text in all_texts:
        at = text.find(BEGINNINGS[license])
        if at >= 0 and is_of(license, text):
            return text[text.rfind("\n", 0, at) + 1:].strip("\n")
    return None


def main():
    lock = tomllib.loads(pathlib.Path("Cargo.lock").read_text())["package"]
    command = ["cargo", "metadata", "--format-version", "1", "--locked", "--all-features"]
    metadata = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)["packages"]
    metadata = {(package["name"], package["version"]): package for package in metadata}
    lines, used = [], {}
    for key in reached(lock):
        package = metadata[key]
        folder = pathlib.Path(package["manifest_path"]).parent
        all_texts = texts(folder)
        licenses = chosen(package["license"])
        lines.append(f"{key[0]} {key[1]}: {' and '.join(licenses)}")
        lines += [f"    {line}" for line in copyrights(all_texts)]
        for license in licenses:
            used.setdefault(license, {})
            text = license_text(license, all_texts)
            if text:
                used[license][text] = used[license].get(text, 0) + 1
    fonts = pathlib.Path("assets/fonts/OFL.txt").read_text()
    lines.append("Noto Sans and Noto Sans Math (fonts): OFL-1.1")
    lines += [f"    {line}" for line in copyrights([fonts])]
    lines.append("Figures of military symbols (src/symbology), many measured from milsymbol 3.0.4: MIT")
    lines.append("    Copyright (c) 2017 Måns Beckman - www.spatialillusions.com")
    lines.append("SQLite (within libsqlite3-sys): in the public domain")
    used.setdefault("OFL-1.1", {})[fonts[fonts.find(BEGINNINGS["OFL-1.1"]):].strip("\n")] = 1 << 20
    out = ["What sandtable is made of, and the licenses under which it is used.", ""] + lines
    for license in LICENSES:
        if license not in used:
            continue
        if not used[license]:
            raise SystemExit(f"no package holds the text of {license}")
        text = max(used[license], key=lambda text: (used[license][text], text))
        out += ["", "=" * 80, license, "=" * 80, "", text.rstrip()]
    pathlib.Path("assets/NOTICES.txt").write_text("\n".join(line.rstrip() for line in "\n".join(out).splitlines()) + "\n")


main()
