"""Base class of every set of options, and how a bad one is reported."""

import difflib
from typing import Any, Self

from pydantic import BaseModel, ConfigDict, ValidationError

from tetgan.errors import UserError


class Options(BaseModel):
    """Immutable options; an unknown key is an error."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    @classmethod
    def parse(cls, values: dict[str, Any], where: str = "config") -> Self:
        """Options from plain values, filling defaults.

        Raises:
            UserError: the first bad key, what is wrong with it, and the nearest known key.
        """
        try:
            return cls.model_validate(values)
        except ValidationError as error:
            raise UserError(f"{where}: {_first_problem(error, cls)}") from None


def _first_problem(error: ValidationError, model: type[BaseModel]) -> str:
    problem = error.errors()[0]
    path = [str(part) for part in problem["loc"]]
    key = ".".join(path) or "(top level)"
    if problem["type"] != "extra_forbidden":
        return f"{key}: {problem['msg']} (got {problem['input']!r})"
    near = difflib.get_close_matches(path[-1], _known_keys(model), n=1)
    hint = f"; did you mean '{near[0]}'?" if near else "; remove it or check its spelling"
    return f"{key}: unknown key{hint}"


def _known_keys(model: type[BaseModel]) -> set[str]:
    """Every key used anywhere below `model`, for the spelling hint."""

    def collect(schema: Any) -> set[str]:
        if isinstance(schema, list):
            return set().union(*map(collect, schema), set())
        if not isinstance(schema, dict):
            return set()
        keys = set(schema.get("properties", {}))
        return keys.union(*map(collect, schema.values()), set())

    return collect(model.model_json_schema())
