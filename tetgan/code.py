"""Digests of the code behind a stage; Snakemake reruns a stage when its digest changes.

The code of a stage is a module or a few, and all that they import. So an edited module makes those stages run
again that need it, and no others.
"""

import ast
import hashlib
from collections.abc import Collection, Iterator
from functools import cache, lru_cache
from importlib.util import find_spec, resolve_name
from pathlib import Path

DECLARATIVE = "options"
"""Modules of this name are left out: what they declare reaches a stage as its parameters."""


def code_digest(*entry_points: str | Path) -> str:
    """SHA-256, shortened, of modules or scripts and of what they import, at the top or within functions.

    A string that is the whole name of a module counts as its import, as a child process is started by it.
    A string that names a folder of data beside its module counts as the files in it.

    Args:
        entry_points: `module`, `module:function`, or the path of a script. Nothing of packages other than
            theirs and this one counts.
    """
    digest = hashlib.sha256()
    for name in sorted(Path(entry).name if isinstance(entry, Path) else entry for entry in entry_points):
        digest.update(name.encode())
    for name, source in sorted(code_behind(*entry_points).items()):
        digest.update(name.encode() + source)
    return digest.hexdigest()[:12]


def code_behind(*entry_points: str | Path) -> dict[str, bytes]:
    """Source of each module that the entry points need, by name, and their data, by path in the package."""
    found = {entry.name: entry.read_bytes() for entry in entry_points if isinstance(entry, Path)}
    modules = [str(entry).partition(":")[0] for entry in entry_points if not isinstance(entry, Path)]
    packages = {"tetgan", *(name.partition(".")[0] for name in modules)}
    todo = modules + [name for script in found.values() for name in _mentioned(script, "")[0]]
    while todo:
        name = todo.pop()
        if name in found or name.partition(".")[0] not in packages or _is_declarative(name):
            continue
        path = _path_of(name)
        if path is not None:
            found[name] = path.read_bytes()
            package = name if path.name == "__init__.py" else name.rpartition(".")[0]
            imported, strings = _mentioned(found[name], package)
            todo += [package, *imported, *strings]
            found |= _data_beside(path, package, strings)
    return found


def _is_declarative(name: str) -> bool:
    parts = name.split(".")
    return parts[0] == "tetgan" and parts[-1] == DECLARATIVE


def _path_of(name: str) -> Path | None:
    """File of a module, which is not imported; None where there is none, as for a name in a module."""
    package, *parts = name.split(".")
    spec = find_spec(package)
    if spec is None:
        return None
    if not parts:
        return Path(spec.origin) if spec.origin and spec.origin.endswith(".py") else None
    found = (_file_in(root, tuple(parts)) for root in spec.submodule_search_locations or ())
    return next((path for path in found if path), None)


@cache
def _file_in(root: str, parts: tuple[str, ...]) -> Path | None:
    """The same in one folder; files may change while this runs, but do not come and go."""
    folder = Path(root, *parts)
    return next(
        (path for path in (folder / "__init__.py", folder.with_suffix(".py")) if path.is_file()), None
    )


def _data_beside(path: Path, package: str, names: Collection[str]) -> dict[str, bytes]:
    """Files in those folders beside a module that `names` hold."""
    return {
        f"{package}/{file.relative_to(path.parent).as_posix()}": file.read_bytes()
        for folder in _data_folders(path.parent)
        if folder.name in names
        for file in folder.rglob("*")
        if file.is_file()
    }


@cache
def _data_folders(parent: Path) -> list[Path]:
    """Folders that are no packages."""
    return [path for path in parent.iterdir() if path.is_dir() and not (path / "__init__.py").exists()]


@lru_cache(maxsize=4096)
def _mentioned(source: bytes, package: str) -> tuple[frozenset[str], frozenset[str]]:
    """Names that a module may import, and strings in it that may be names.

    Of `from a import b` both `a` and `a.b`. Of a name that is put together, as in `import_module(f"a.{b}")`,
    every module of `a`.
    """
    imported, strings = set[str](), set[str]()
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Import():
                imported.update(alias.name for alias in node.names)
            case ast.ImportFrom():
                module = resolve_name("." * node.level + (node.module or ""), package or None)
                imported |= {module, *(f"{module}.{alias.name}" for alias in node.names)}
            case ast.Call(args=[ast.JoinedStr(values=[ast.Constant(value=str(start)), *_]), *_]):
                if ast.unparse(node.func).endswith("import_module"):
                    imported.update(_modules_of(start.rpartition(".")[0]))
            case ast.Constant(value=str(text)) if text.replace(".", "").isidentifier():
                strings.add(text)
    return frozenset(imported), frozenset(strings)


def _modules_of(package: str) -> Iterator[str]:
    """Names of the modules right in a package."""
    path = _path_of(package)
    if path is not None:
        yield from (f"{package}.{module.stem}" for module in path.parent.glob("*.py"))
