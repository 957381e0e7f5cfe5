"""Says which of the mesh files named hold anything but closed solids with their normals outward, and fails if one does."""

import sys

import trimesh

failed = False
for path in sys.argv[1:]:
    loaded = trimesh.load(path)
    solids = list(loaded.geometry.values()) if hasattr(loaded, "geometry") else [loaded]
    for solid in solids:
        sound = solid.is_watertight and solid.is_winding_consistent and solid.is_volume and solid.volume > 0
        if not sound:
            print(f"{path}: watertight {solid.is_watertight}, volume {solid.volume}")
            failed = True
    if not solids:
        print(f"{path}: no solid")
        failed = True
sys.exit(failed)
