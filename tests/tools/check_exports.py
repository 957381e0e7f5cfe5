"""Reads exported files with GDAL, compares their layers with each other and checks their shapes.

    pip install pyogrio shapely
    python3 tests/tools/check_exports.py PROGRAM SCENE [SCENE ...]

Of each scene a GeoPackage, a GeoJSON and a KMZ are exported to a temporary folder. Every layer has to have the features that the
program tells, in the same places in all of them (to 1e-8 degrees); the area of polygons has to be beyond doubt, and the
GeoPackage has to have a style for each of its layers.
"""

import json
import re
import sqlite3
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import pyogrio
import shapely


def exported(program, scene, out):
    system = ["--crs", "EPSG:4326"] if out.suffix == ".gpkg" else []
    run = subprocess.run([program, "export", scene, "-o", out, *system], capture_output=True, text=True)
    if run.returncode != 0:
        raise SystemExit(f"{scene}: {run.stderr}")
    return {m[1]: int(m[2]) for m in re.finditer(r"^  ([a-z_]+) +(\d+)$", run.stdout, re.M)}


def shapes(file, layer=None, where=None):
    _, _, geometry, _ = pyogrio.raw.read(file, layer=layer, where=where, force_2d=True)
    return shapely.from_wkb(geometry)


def check(program, scene, folder):
    stem = folder / Path(scene).stem
    package, text, archive = (stem.with_suffix(s) for s in (".gpkg", ".geojson", ".kmz"))
    told = exported(program, scene, package)
    assert told == exported(program, scene, text) == exported(program, scene, archive), scene
    names = {name for name, _ in pyogrio.list_layers(package)} - {"layer_styles"}
    assert names == set(told), (scene, names, told)
    with sqlite3.connect(package) as base:
        styles = dict(base.execute("SELECT f_table_name, styleQML FROM layer_styles"))
        assert set(styles) == names, scene
        assert base.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    document = zipfile.ZipFile(archive).read("doc.kml").decode()
    assert document.count("<Placemark>") == sum(told.values()), scene
    for name, count in told.items():
        one, other = shapes(package, name), shapes(text, where=f"layer = '{name}'")
        assert len(one) == len(other) == count, (scene, name)
        invalid = [s for s in one if not s.is_valid]
        # Where an outline touches itself nothing of its area is in doubt.
        doubt = sum(abs(shapely.make_valid(s).area - s.area) for s in invalid)
        assert doubt <= 1e-5 * shapely.area(one).sum(), (scene, name, doubt)
        for a, b in zip(one, other):
            same = len(shapely.get_coordinates(a)) == len(shapely.get_coordinates(b))
            assert same and shapely.hausdorff_distance(a, b) < 1e-8, (scene, name)
    return sum(told.values())


def main():
    program, *scenes = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        counts = {scene: check(program, scene, Path(folder)) for scene in scenes}
    print(json.dumps(counts, indent=1))


main()
