"""Models of a config that inherit the settings of another (`like`)."""

from typing import Any

from tetgan.errors import UserError


def resolve_inheritance(models: dict[str, Any]) -> dict[str, Any]:
    """Entries with every `inherit` replaced by the settings that it names, and without those that are empty.

    It happens after Snakemake has laid one config over the other, so what a later file says of a model
    holds for its heirs too. Of `training` and `meshing`, keys are taken over one by one.

    Raises:
        UserError: an `inherit` names no model, or goes round in a circle; or it has its old name, `like`.
    """
    return {name: _resolved(name, models, ()) for name, part in models.items() if part is not None}


def _resolved(name: str, models: dict[str, Any], path: tuple[str, ...]) -> Any:
    part, path = models[name], (*path, name)
    if isinstance(part, dict) and "like" in part:
        raise UserError(f"config: models.{name}.like: this key is now called 'inherit'")
    if not isinstance(part, dict) or "inherit" not in part:
        return part
    parent = part["inherit"]
    if parent in path:
        circle = " -> ".join([*path, parent])
        raise UserError(f"config: models.{path[0]}.inherit: {circle} goes round in a circle")
    if not isinstance(parent, str) or not isinstance(models.get(parent), dict):
        known = ", ".join(sorted(other for other in models if other != name))
        raise UserError(f"config: models.{name}.inherit: '{parent}' is no model; there are {known}")
    taken = _resolved(parent, models, path)
    own = {key: value for key, value in part.items() if key != "inherit"}
    joined = {
        key: taken[key] | value
        for key, value in own.items()
        if isinstance(value, dict) and isinstance(taken.get(key), dict)
    }
    return taken | own | joined


def allow_inherit(schema: dict[str, Any]) -> None:
    """Let the JSON schema of `models` know such entries; when they are parsed they are resolved already."""
    parent = {"type": "string", "description": "model whose settings this one takes over"}
    heir = {"type": "object", "required": ["inherit"], "properties": {"inherit": parent}}
    for pattern, entry in schema["patternProperties"].items():
        schema["patternProperties"][pattern] = {"anyOf": [entry, heir, {"type": "null"}]}
