"""Kinds of model by name: those of this package, of installed packages, and of modules that a config names.

An installed package names its record in the entry-point group `tetgan.models`, under the name of the kind; it
is imported when a model of that kind is first met. Any other module is imported by `load_plugins`.
"""

import re
from collections.abc import Iterable
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from typing import Annotated, Any, Union

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, TypeAdapter, ValidationError
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, InitErrorDetails, PydanticCustomError, core_schema

from tetgan.errors import UserError
from tetgan.models.builtin import KINDS
from tetgan.models.kind import ModelKind
from tetgan.models.options import KindOptions

GROUP = "tetgan.models"

MODULE_NAME = r"^[A-Za-z_]\w*(\.[A-Za-z_]\w*)*$"
"""A dotted name, never a path: what is imported must be installed, or on `PYTHONPATH`."""

_loaded: dict[str, ModelKind] = {kind.name: kind for kind in KINDS}


def load_plugins(modules: Iterable[str]) -> None:
    """Import modules, which runs their code, and make the kinds of model known that they hold.

    Args:
        modules: dotted names; of each, every `ModelKind` at its top level counts.

    Raises:
        UserError: a module cannot be found, holds no kind, or one whose name is taken.
    """
    for name in modules:
        if not re.match(MODULE_NAME, name):
            raise UserError(f"plugins: '{name}' is no dotted name of a module, such as my_models.linear")
        try:
            held = vars(import_module(name)).values()
        except ModuleNotFoundError as error:
            raise UserError(f"plugins: {name}: {error}; install it, or set PYTHONPATH") from None
        kinds = [value for value in held if isinstance(value, ModelKind)]
        if not kinds:
            raise UserError(f"plugins: {name}: holds no ModelKind (docs/extending.md)")
        for kind in kinds:
            _add(kind, f"plugins: {name}")


def find_kind(name: str) -> ModelKind:
    """The record of a kind.

    Raises:
        UserError: no such kind; the message names those there are.
    """
    if name not in _loaded:
        installed = _installed()
        if name not in installed:
            raise UserError(
                f"'{name}' is no kind of model; there are {', '.join(sorted(_loaded.keys() | installed))}; "
                "one from elsewhere needs its module under `plugins`, or --plugin"
            )
        _add(_load_installed(installed[name]), f"entry point {name} of {GROUP}")
    return _loaded[name]


def kind_of(options: KindOptions) -> ModelKind:
    """The record of the kind that a model's options belong to."""
    return find_kind(options.kind)


def loaded_kinds() -> list[ModelKind]:
    """Every kind but those of installed packages that nothing has asked for yet."""
    return list(_loaded.values())


def _add(kind: ModelKind, source: str) -> None:
    if _loaded.setdefault(kind.name, kind) is not kind:
        raise UserError(f"{source}: there is a kind '{kind.name}' already; call this one otherwise")


def _installed() -> dict[str, EntryPoint]:
    return {point.name: point for point in entry_points(group=GROUP)}


def _load_installed(point: EntryPoint) -> ModelKind:
    try:
        kind = point.load()
    except (ImportError, AttributeError) as error:
        raise UserError(f"entry point {point.name} of {GROUP}: {error}; mend {point.value}") from None
    if not isinstance(kind, ModelKind) or kind.name != point.name:
        raise UserError(
            f"entry point {point.name} of {GROUP}: {point.value} is no ModelKind of that name; mend it"
        )
    return kind


class _OfKnownKind:
    """Makes a model's options of plain values, of whichever class goes with their `kind` at that moment."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(_validate)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        classes = tuple(kind.options for kind in loaded_kinds())
        union = Annotated[Union[classes], Field(discriminator="kind")]  # type: ignore[valid-type]  # noqa: UP007
        return handler(TypeAdapter[Any](union).core_schema)


def _validate(values: Any) -> KindOptions:
    if isinstance(values, KindOptions):
        return values
    name = values.get("kind") if isinstance(values, dict) else None
    try:
        if not isinstance(name, str):
            raise UserError("a model needs the name of its kind, as in {kind: tetgan, grid: LR}")
        options = find_kind(name).options
    except UserError as error:
        told = PydanticCustomError("kind", "{message}", {"message": str(error)})
        details = InitErrorDetails(type=told, loc=("kind",), input=name)
        raise ValidationError.from_exception_data("model", [details]) from None
    return options.model_validate(values)


ModelOptions = Annotated[KindOptions, _OfKnownKind()]
"""An entry of the config under `models`: options of any kind that is known."""
