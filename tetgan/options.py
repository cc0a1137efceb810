"""Base class of all options, and the report of an invalid one."""

import difflib
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from tetgan.errors import UserError

OptionsType = TypeVar("OptionsType", bound="Options")


class Options(BaseModel):
    """Immutable options; an unknown key is an error."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    @classmethod
    def parse(cls: type[OptionsType], values: dict[str, Any], where: str = "config") -> OptionsType:
        """Options from plain values, filling defaults; see `parse_options`."""
        return parse_options(cls, values, where)


def parse_options(kind: Any, values: dict[str, Any], where: str) -> Any:
    """Options of a class, or of a union of classes distinguished by a key, from plain values.

    Raises:
        UserError: the first bad key, what is wrong with it, and the nearest known key.
    """
    adapter = TypeAdapter(kind)
    try:
        return adapter.validate_python(values)
    except ValidationError as error:
        raise UserError(f"{where}: {_first_problem(error, adapter)}") from None


def _first_problem(error: ValidationError, adapter: TypeAdapter) -> str:
    problem = error.errors()[0]
    path = [str(part) for part in problem["loc"]]
    key = ".".join(path) or "(top level)"
    if problem["type"] != "extra_forbidden":
        return f"{key}: {problem['msg']} (got {problem['input']!r})"
    near = difflib.get_close_matches(path[-1], _known_keys(adapter.json_schema()), n=1)
    hint = f"; did you mean '{near[0]}'?" if near else "; remove it or check its spelling"
    return f"{key}: unknown key{hint}"


def _known_keys(schema: Any) -> set[str]:
    """Every key used anywhere in a JSON schema, for the spelling hint."""
    if isinstance(schema, list):
        return set().union(*map(_known_keys, schema))
    if not isinstance(schema, dict):
        return set()
    return set(schema.get("properties", {})).union(*map(_known_keys, schema.values()))
