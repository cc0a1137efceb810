"""Models of a config that inherit the settings of another (`like`)."""

from typing import Any

from tetgan.errors import UserError


def resolve_inheritance(models: dict[str, Any]) -> dict[str, Any]:
    """Entries with every `like` replaced by the settings that it names, and without those that are empty.

    It happens after Snakemake has laid one config over the other, so what a later file says of a model
    holds for those like it too. Of `training` and `meshing`, keys are taken over one by one.

    Raises:
        UserError: a `like` names no model, or goes round in a circle.
    """
    return {name: _resolved(name, models, ()) for name, part in models.items() if part is not None}


def _resolved(name: str, models: dict[str, Any], path: tuple[str, ...]) -> Any:
    part, path = models[name], (*path, name)
    if not isinstance(part, dict) or "like" not in part:
        return part
    like = part["like"]
    if like in path:
        raise UserError(f"config: models.{path[0]}.like: {' -> '.join([*path, like])} goes round in a circle")
    if not isinstance(like, str) or not isinstance(models.get(like), dict):
        known = ", ".join(sorted(other for other in models if other != name))
        raise UserError(f"config: models.{name}.like: '{like}' is no model; there are {known}")
    taken = _resolved(like, models, path)
    own = {key: value for key, value in part.items() if key != "like"}
    joined = {
        key: taken[key] | value
        for key, value in own.items()
        if isinstance(value, dict) and isinstance(taken.get(key), dict)
    }
    return taken | own | joined


def allow_inherit(schema: dict[str, Any]) -> None:
    """Let the JSON schema of `models` know such entries; when they are parsed they are resolved already."""
    like = {
        "type": "object",
        "required": ["like"],
        "properties": {"like": {"type": "string", "description": "model whose settings this one takes over"}},
    }
    for pattern, entry in schema["patternProperties"].items():
        schema["patternProperties"][pattern] = {"anyOf": [entry, like, {"type": "null"}]}
