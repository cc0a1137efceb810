"""Registry of generative methods: installed ones, and those of modules that a config names.

A package names its records in the entry-point group `tetgan.methods`, under the name of the method; this
package's own are there too (pyproject.toml). Another package's is imported when a model of that method is
first met, a module under `plugins` by `load_plugins`.
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
from tetgan.models.method import Method, MethodOptions

GROUP = "tetgan.methods"

MODULE_NAME = r"^[A-Za-z_]\w*(\.[A-Za-z_]\w*)*$"
"""A dotted name, never a path: what is imported must be installed, or on `PYTHONPATH`."""

_loaded: dict[str, Method] = {}


def load_plugins(modules: Iterable[str]) -> None:
    """Import modules, which runs their code, and make the methods known that they hold.

    Args:
        modules: dotted names; of each, every `Method` at its top level counts.

    Raises:
        UserError: a module cannot be found, holds no method, or one whose name is taken.
    """
    for name in modules:
        if not re.match(MODULE_NAME, name):
            raise UserError(f"plugins: '{name}' is no dotted name of a module, such as my_models.linear")
        try:
            held = vars(import_module(name)).values()
        except ModuleNotFoundError as error:
            raise UserError(f"plugins: {name}: {error}; install it, or set PYTHONPATH") from None
        methods = [value for value in held if isinstance(value, Method)]
        if not methods:
            raise UserError(f"plugins: {name}: holds no Method (docs/extending.md)")
        for method in methods:
            _add(method, f"plugins: {name}")


def find_method(name: str) -> Method:
    """The record of a method.

    Raises:
        UserError: no such method; the message names those there are.
    """
    if name not in _loaded:
        installed = _installed()
        if name not in installed:
            raise UserError(
                f"'{name}' is no method; there are {', '.join(sorted(_loaded.keys() | installed))}; "
                "one from elsewhere needs its module under `plugins`, or --plugin"
            )
        _add(_load_installed(installed[name]), f"entry point {name} of {GROUP}")
    return _loaded[name]


def method_of(options: MethodOptions) -> Method:
    """The record of the method that a model's options belong to."""
    return find_method(options.kind)


def loaded_methods() -> list[Method]:
    """Every method but those of installed packages that were not needed yet."""
    return list(_loaded.values())


def _add(method: Method, source: str) -> None:
    if _loaded.setdefault(method.name, method) is not method:
        raise UserError(f"{source}: there is a method '{method.name}' already; call this one otherwise")


def _installed() -> dict[str, EntryPoint]:
    return {point.name: point for point in entry_points(group=GROUP)}


def _load_own() -> None:
    """This package's methods, in the order of their names."""
    for name, point in sorted(_installed().items()):
        if point.value.startswith("tetgan."):
            _add(_load_installed(point), f"entry point {name} of {GROUP}")


def _load_installed(point: EntryPoint) -> Method:
    try:
        method = point.load()
    except (ImportError, AttributeError) as error:
        raise UserError(f"entry point {point.name} of {GROUP}: {error}; mend {point.value}") from None
    if not isinstance(method, Method) or method.name != point.name:
        raise UserError(
            f"entry point {point.name} of {GROUP}: {point.value} is no Method of that name; mend it"
        )
    return method


class _OfKnownMethod:
    """Makes a model's options of plain values, of whichever class goes with their `kind` at that moment."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(_validate)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        classes = tuple(method.options for method in loaded_methods())
        union = Annotated[Union[classes], Field(discriminator="kind")]  # type: ignore[valid-type]  # noqa: UP007
        return handler(TypeAdapter[Any](union).core_schema)


def _validate(values: Any) -> MethodOptions:
    if isinstance(values, MethodOptions):
        return values
    name = values.get("kind") if isinstance(values, dict) else None
    try:
        if not isinstance(name, str):
            raise UserError("a model needs the name of its method as `kind`, as in {kind: tetgan, grid: LR}")
        options = find_method(name).options
    except UserError as error:
        told = PydanticCustomError("kind", "{message}", {"message": str(error)})
        details = InitErrorDetails(type=told, loc=("kind",), input=name)
        raise ValidationError.from_exception_data("model", [details]) from None
    return options.model_validate(values)


ModelOptions = Annotated[MethodOptions, _OfKnownMethod()]
"""An entry of the config under `models`: options of any method that is known."""

_load_own()
