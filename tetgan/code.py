"""Digests of the code behind a stage; Snakemake reruns a stage when its digest changes.

The code of a stage is a few modules and whatever they import, so that editing one kind of model leaves the
results of the others alone.
"""

import ast
import hashlib
from collections.abc import Collection, Iterable, Iterator
from importlib.util import find_spec, resolve_name
from pathlib import Path

DECLARATIVE = ("options", "tetgan.models.builtin")
"""Endings of names of modules left out: what they say reaches a stage as its parameters."""


def code_digest(modules: Iterable[str], rooms: Collection[str]) -> str:
    """SHA-256, shortened, of modules and what they import, at the top or within functions.

    Args:
        modules: dotted names; of other packages than this one everything imported counts that is theirs.
        rooms: of this package, only modules of these rooms count.
    """
    digest = hashlib.sha256()
    for name, source in sorted(_imported(modules, set(rooms)).items()):
        digest.update(name.encode() + source)
    return digest.hexdigest()[:12]


def _imported(modules: Iterable[str], rooms: set[str]) -> dict[str, bytes]:
    """Source of each module, by name."""
    todo, found = list(modules), dict[str, bytes]()
    packages = {name.partition(".")[0] for name in todo}
    while todo:
        name = todo.pop()
        parts = name.split(".")
        ours = parts[0] == "tetgan"
        if name in found or parts[0] not in packages or (ours and not rooms.intersection(parts[1:2])):
            continue
        path = _path_of(parts)
        if path is not None and not (ours and name.endswith(DECLARATIVE)):
            found[name] = path.read_bytes()
            package = name if path.name == "__init__.py" else ".".join(parts[:-1])
            todo += _imports(found[name], package)
    return found


def _path_of(parts: list[str]) -> Path | None:
    """File of a module, which is not imported; None where there is none, as for a name in a module."""
    spec = find_spec(parts[0])
    if spec is None:
        return None
    roots = [Path(root).joinpath(*parts[1:]) for root in spec.submodule_search_locations or ()]
    paths = [path for root in roots for path in (root / "__init__.py", root.with_suffix(".py"))]
    if len(parts) == 1 and spec.origin is not None:
        paths = [Path(spec.origin)]
    return next((path for path in paths if path.suffix == ".py" and path.is_file()), None)


def _modules_of(package: str) -> Iterator[str]:
    """Names of the modules right in a package."""
    path = _path_of(package.split("."))
    if path is not None:
        yield from (f"{package}.{module.stem}" for module in path.parent.glob("*.py"))


def _imports(source: bytes, package: str) -> Iterator[str]:
    """Names that a module may import: of `from a import b`, both `a` and `a.b`.

    Of a name that is put together, as in `import_module(f"a.{b}")`, every module of `a`.
    """
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("import_module"):
            match node.args[0]:
                case ast.JoinedStr(values=[ast.Constant(value=start), *_]):
                    yield from _modules_of(str(start).rpartition(".")[0])
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            module = resolve_name("." * node.level + (node.module or ""), package or None)
            yield module
            yield from (f"{module}.{alias.name}" for alias in node.names)
