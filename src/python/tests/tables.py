"""Writes `_tables.py`: a method for each table of the scene file, from the schema that the program prints."""

import json
import keyword
import textwrap

# The keys that the source of a table is handed over by, as its first argument.
SOURCE_KEYS = ["file", "points"]
# Names of files, which may be paths.
FILE_KEYS = {"file", "font", "dem", "of", "include"}
# The width of the package's text.
WIDTH = 118

HEAD = '''"""The tables of the scene file as methods. Written by tests/test_tables.py from `sandtable schema`: do not edit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Literal, TypedDict, TypeVar

from ._toml import key as _quoted

#: A file, or text of one of the forms that a key has.
Path = str | PathLike[str]
#: (x, y), a position in words, or a point of shapely.
Point = Any
#: A GeoDataFrame, a GeoSeries, shapes of shapely, texts of WKT, a path, what has `__geo_interface__`, a table or positions.
Source = Any
#: "EPSG:32616", an EPSG code, a pyproj.CRS or a rasterio.crs.CRS.
Crs = Any
#: A color, "#rgb", "#rrggbb" or "#rrggbbaa".
Color = str
#: An expression over the properties of a feature, such as "lanes * 3.5 ?? 6".
Expression = str

_T = TypeVar("_T", bound="SceneTables")
'''


def module(schema):
    """The text of the module."""
    writer = Writer(schema)
    methods = [writer.settings()]
    for name, shape in sorted(schema["properties"].items()):
        if "$ref" in shape.get("items", {}):
            methods.append(writer.repeated(name, shape))
        elif shape.get("type") == "object" and "properties" in shape:
            methods.append(writer.single(name, shape))
        elif shape.get("type") == "object":
            methods.append(writer.named(name, shape))
    body = "\n".join(methods)
    base = '''

class SceneTables:
    """What a scene is made of, a method for each table of the scene file; each returns a new scene."""

    def _with(self: _T, table: str, head: str, source: Any, keys: dict[str, Any]) -> _T:
        raise NotImplementedError

'''
    return HEAD + "".join(writer.dicts.values()) + base + body


class Writer:
    def __init__(self, schema):
        self.schema, self.dicts = schema, {}

    def settings(self):
        """The keys at the top of the file."""
        keys = {
            name: shape
            for name, shape in self.schema["properties"].items()
            if shape.get("type") != "object" and "$ref" not in shape.get("items", {})
        }
        return self.method("settings", "The keys at the top of the scene file.", "", keys)

    def repeated(self, name, shape):
        definition = self.schema["$defs"][name]
        keys = dict(definition["properties"])
        required = definition.get("required", [])
        is_many = "file" in keys and "name" not in required
        method = name + "s" if is_many else name
        return self.method(method, shape["description"], f"[[{name}]]", keys, required)

    def single(self, name, shape):
        return self.method(name, shape["description"].removesuffix(" Needed."), f"[{name}]", shape["properties"])

    def named(self, name, shape):
        """Tables under names that the user chooses."""
        inner = shape["additionalProperties"]
        doc = shape.get("description", "A named set of keys: a table takes those of the style that its key `style` names.")
        if "properties" in inner:
            return self.method(name, doc, f"[{name}.NAME]", {"name": {"type": "string", "description": "Its name. Needed."}} | inner["properties"], ["name"])
        text = f'    def {name}(self: _T, name: str, **keys: Any) -> _T:\n        """{doc}"""\n'
        return text + f'        return self._with("{name}", f"[{name}.{{_quoted(name)}}]", None, keys)\n'

    def method(self, name, doc, head, keys, required=()):
        has_source = "file" in keys and name != "models"
        keys = {key: shape for key, shape in keys.items() if not (has_source and key in SOURCE_KEYS)}
        first = ["name"] if "name" in required else []
        positional = [f"{key}: str" for key in first]
        if name == "models":
            positional.append("file: Path | bytes | None = None")
            keys.pop("file")
        if has_source:
            positional.append("source: Source | None = None")
        rest = {key: shape for key, shape in sorted(keys.items()) if key not in first}
        options = [f"{safe(key)}: {self.kind(name, key, shape)} | None = None" for key, shape in rest.items()]
        arguments = ["self: _T", *positional, "*", *options]
        lines = [f"    def {name}(", *(f"        {argument}," for argument in arguments), "    ) -> _T:"]
        lines += self.doc(doc, keys, first, has_source, name == "models", rest)
        table = head.strip("[]").split(".")[0]
        # No line ends between a key and its value.
        pairs = ", ".join(f'"{safe(key)}":\xa0{safe(key)}' for key in rest)
        stated_name = '"name": name, ' if first and ".NAME" not in head else ""
        file = '"file": file, ' if name == "models" else ""
        text = f'f"{head.replace("NAME", "{_quoted(name)}")}"' if ".NAME" in head else f'"{head}"'
        source = "source" if has_source else "None"
        keys_text = textwrap.fill(
            f"{{{stated_name}{file}{pairs}}}", WIDTH, initial_indent="            ", subsequent_indent="             ",
            break_long_words=False, break_on_hyphens=False,
        )
        keys_text = keys_text.replace("\xa0", " ")
        lines += [f'        return self._with(\n            "{table}", {text}, {source},\n{keys_text},\n        )', ""]
        return "\n".join(lines)

    def doc(self, doc, keys, first, has_source, is_models, rest):
        out = [f'        """{doc}', "", "        Parameters", "        ----------"]
        for key in first:
            out += entry(key, "str", keys[key].get("description", ""))
        if has_source:
            out += entry("source", "Source", "Where its features lie: data, the path of a file, or positions.")
        if is_models:
            text = self.schema["$defs"]["model"]["properties"]["file"]["description"]
            out += entry("file", "path or bytes", text)
        for key, shape in rest.items():
            out += entry(safe(key), bounds(shape), shape.get("description", ""))
        return [*out, '        """']

    def kind(self, table, key, shape):
        """The type of a key's values."""
        if key == "crs" or key == "points_crs":
            return "Crs"
        if "$ref" in shape:
            return {"color": "Color", "point": "Point", "expression": "Expression", "computed": "Expression",
                    "scalar": "str | float | bool"}[shape["$ref"].rsplit("/", 1)[1]]
        if "allOf" in shape:
            return self.kind(table, key, shape["allOf"][0])
        if "anyOf" in shape:
            kinds = [self.kind(table, key, part) for part in shape["anyOf"]]
            return " | ".join(dict.fromkeys(part for kind in kinds for part in split(kind)))
        if "enum" in shape:
            return f"Literal[{', '.join(json.dumps(word) for word in shape['enum'])}]"
        simple = {"number": "float", "integer": "int", "boolean": "bool"}
        if shape["type"] in simple:
            return simple[shape["type"]]
        if shape["type"] == "string":
            return "Path" if key in FILE_KEYS else "str"
        if shape["type"] == "array":
            return "Sequence[Any]" if "prefixItems" in shape else f"Sequence[{self.kind(table, key, shape['items'])}]"
        if "properties" in shape:
            return self.inner(table, key, shape)
        return "Mapping[str, Any]"

    def inner(self, table, key, shape):
        """A table in a table, as a type of dict; features of a source are data too."""
        name = "".join(part.title() for part in [table, *key.split("_")]) + "Keys"
        if name not in self.dicts:
            fields = "".join(
                f"    {inner}: {self.kind(table, inner, value)}\n" if not keyword.iskeyword(inner) else ""
                for inner, value in sorted(shape["properties"].items())
            )
            plain = shape.get("description", "An elevation file of several.").split(" Default:")[0]
            self.dicts[name] = f'\n\nclass {name}(TypedDict, total=False):\n    """{plain}"""\n\n{fields}'
        return f"{name} | Source" if "points" in shape["properties"] else name


def split(kind):
    """The alternatives of a type, at its top."""
    parts, depth, start = [], 0, 0
    for at, letter in enumerate(kind):
        depth += {"[": 1, "]": -1}.get(letter, 0)
        if letter == "|" and depth == 0:
            parts.append(kind[start:at].strip())
            start = at + 1
    return [*parts, kind[start:].strip()]


def bounds(shape):
    """The type and the range of a key in words."""
    for part in [shape, *shape.get("anyOf", [])]:
        if part.get("type") in ("number", "integer"):
            least = part.get("minimum", part.get("exclusiveMinimum"))
            sign = "above " if "exclusiveMinimum" in part else "from "
            words = f"{part['type']}, {sign}{least:g} to {part['maximum']:g}"
            return words + (", or expression" if part is not shape else "")
    return ""


def entry(key, kind, text):
    wrapped = textwrap.wrap(text.replace("\\", "\\\\"), WIDTH - 12, break_on_hyphens=False, break_long_words=False)
    head = f"        {key} : {kind}" if kind else f"        {key}"
    return [head, *(f"            {line}" for line in wrapped)]


def safe(key):
    return key + "_" if keyword.iskeyword(key) else key
