"""The plugin of QGIS: 3D pictures of maps and terrain analyses, by the program `sandtable`.

`plugin` is what QGIS loads; `dialog` makes a picture of the map; `provider` and `algorithms` are in the Processing toolbox.
`scene`, `symbols` and `program` know nothing of windows: they write scenes of layers, and run the program.
"""


def classFactory(iface):  # noqa: N802 (the name that QGIS calls)
    """The plugin, for QGIS."""
    from .plugin import SandtablePlugin

    return SandtablePlugin(iface)
