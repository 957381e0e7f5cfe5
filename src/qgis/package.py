"""Writes the plugin as a zip that QGIS installs ("Install from ZIP"): the same bytes from the same files.

    python3 src/qgis/package.py [sandtable-qgis.zip]
"""

import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PLUGIN = Path(__file__).parent / "sandtable_qgis"
LICENSES = ["LICENSE-MIT", "LICENSE-APACHE"]

# The earliest time that a zip can state: archives of the same files do not differ.
TIME = (1980, 1, 1, 0, 0, 0)


def write(path):
    """Writes the archive and returns the names in it."""
    files = {file.relative_to(PLUGIN.parent).as_posix(): file for file in sorted(PLUGIN.rglob("*")) if _is_part(file)}
    files.update({f"{PLUGIN.name}/{name}": ROOT / name for name in LICENSES})
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, file in files.items():
            entry = zipfile.ZipInfo(name, TIME)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, file.read_bytes())
    return list(files)


def _is_part(file):
    return file.is_file() and file.suffix in {".py", ".svg", ".txt"} and "__pycache__" not in file.parts


if __name__ == "__main__":
    output = sys.argv[1] if len(sys.argv) > 1 else "sandtable-qgis.zip"
    print(f"{output}: {len(write(output))} files")
