"""The order of the rooms: a room imports only from rooms above it, and nothing imports Snakemake."""

import ast
import builtins
import dis
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from types import CodeType

import pytest

PACKAGE = Path(__file__).parent.parent / "tetgan"
ROOMS = [
    "errors",
    "options",
    "files",
    "progress",
    "code",
    "geometry",
    "shapes",
    "grids",
    "fields",
    "nn",
    "solids",
    "meshing",
    "rendering",
    "models",
    "training",
    "methods",
    "extractor",
    "evaluation",
    "tables",
    "mechanics",
    "studies",
    "report",
    "config",
    "cli",
]
MODULES = sorted(
    path
    for path in PACKAGE.rglob("*.py")
    if path.parent != PACKAGE or path.stem not in ("__init__", "__main__")
)


def imported_names(path: Path) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            names.add(node.module or "")
    return names


def room_of(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_a_module_imports_only_from_rooms_above_its_own(path):
    own = ROOMS.index(room_of(path))
    for name in imported_names(path):
        parts = name.split(".")
        assert parts[0] != "snakemake", f"{path} imports Snakemake"
        if parts[0] == "tetgan" and len(parts) > 1:
            assert ROOMS.index(parts[1]) <= own, f"{path} imports {name}, which is below it"


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_pymeshlab_is_imported_by_the_repair_worker_alone(path):
    """It is GPL, and crashes on some input: it lives in the child process and nowhere else."""
    if any(name.split(".")[0] == "pymeshlab" for name in imported_names(path)):
        assert path.relative_to(PACKAGE).as_posix() == "shapes/repair_worker.py"


def globals_read(code: CodeType) -> Iterator[str]:
    """Global names that a module's code reads, at any depth."""
    for instruction in dis.get_instructions(code):
        if instruction.opname == "LOAD_GLOBAL":
            yield instruction.argval
        elif isinstance(instruction.argval, CodeType):
            yield from globals_read(instruction.argval)


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_every_global_name_is_defined(path):
    """The linter cannot say so: jaxtyping's shapes look like undefined names to it."""
    name = ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")
    if name.endswith("backends.triton"):
        pytest.importorskip("triton")
    known = vars(import_module(name)).keys() | vars(builtins).keys()
    read = set(globals_read(compile(path.read_text(), str(path), "exec")))
    assert not read - known
