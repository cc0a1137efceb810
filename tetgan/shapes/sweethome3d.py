"""Furniture libraries of Sweet Home 3D: Debian's package sweethome3d-furniture, or any other .sh3f file.

A library is a zip of OBJ models with a Java properties file that names them.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import Float

from tetgan.shapes.cleaning import ShapeError
from tetgan.shapes.loading import read_zip_member
from tetgan.shapes.options import SweetHome3DSource

_CATALOGUE = "PluginFurnitureCatalog.properties"


@dataclass(frozen=True)
class _Words:
    """A category by the words of an item's name, and the part of the library it is in, if that matters."""

    any_of: frozenset[str]
    none_of: frozenset[str] = field(default=frozenset())
    section: str | None = None


_CATEGORIES = {
    "chair": _Words(frozenset({"chair", "armchair", "stool", "seat"}), frozenset({"leon"})),
    "sofa": _Words(frozenset({"sofa", "couch"})),
    "bench": _Words(frozenset({"bench"}), frozenset({"abdominal"})),
    "table": _Words(
        frozenset({"table", "desk"}),
        frozenset({"bat", "bedside", "changing", "dressing", "fan", "football", "lamp", "tennis"}),
    ),
    "car": _Words(
        frozenset(
            {"beetle", "car", "chevrolet", "focus", "leon", "peugeot", "scenic", "sedan", "suv", "van"}
        ),
        section="Vehicles",
    ),
    "vase": _Words(frozenset({"jar", "vase"}), frozenset({"lamp"})),
}


@dataclass(frozen=True)
class _Item:
    name: str
    section: str
    model: str
    rotation: tuple[float, ...]


def list_sweethome3d(source: SweetHome3DSource, category: str) -> Iterator[tuple[str, str, None]]:
    """Items of every library whose name has a word of the category; a model listed twice comes once.

    A category without words of its own is looked up by its name.
    """
    words = _CATEGORIES.get(category, _Words(frozenset({category})))
    for library in sorted(source.path.glob("*.sh3f")):
        for model, item in _read_library(library).items():
            if _belongs(item, words):
                yield f"{library.stem}-{Path(model).stem}", f"{library.name}/{model}", None


def read_model(source: SweetHome3DSource, path: str) -> bytes:
    """The OBJ of an entry.

    Raises:
        ShapeError: its library or member cannot be read.
    """
    library, _, model = path.partition("/")
    return read_zip_member(
        source.path / Path(library).name, _read_library(source.path / library)[model].model
    )


def model_rotation(source: SweetHome3DSource, path: str) -> Float[np.ndarray, "3 3"]:
    """The turn that stands the model upright, front to +z."""
    library, _, model = path.partition("/")
    return np.array(_read_library(source.path / library)[model].rotation).reshape(3, 3)


def _belongs(item: _Item, words: _Words) -> bool:
    found = set(re.findall(r"[a-z]+", item.name.lower()))
    section_fits = words.section is None or item.section == words.section
    return section_fits and bool(found & words.any_of) and not found & words.none_of


@lru_cache(maxsize=32)
def _read_library(library: Path) -> dict[str, _Item]:
    """Model (member name) to item, the first of those that share a model."""
    try:
        lines = read_zip_member(library, _CATALOGUE).decode("latin-1").splitlines()
    except ShapeError:
        return {}
    values: dict[str, dict[str, str]] = {}
    for line in lines:
        match = re.fullmatch(r"\s*(\w+)#(\d+)\s*=\s*(.*?)\s*", line)
        if match:
            values.setdefault(match[2], {})[match[1]] = match[3]
    items: dict[str, _Item] = {}
    for properties in values.values():
        model = properties.get("model", "").lstrip("/")
        if model.lower().endswith(".obj"):
            items.setdefault(model, _item(model, properties))
    return items


def _item(model: str, properties: dict[str, str]) -> _Item:
    numbers = [float(number) for number in re.findall(r"[-+.\deE]+", properties.get("modelRotation", ""))]
    rotation = tuple(numbers) if len(numbers) == 9 else tuple(np.eye(3).ravel())
    return _Item(properties.get("name", ""), properties.get("category", ""), model, rotation)
