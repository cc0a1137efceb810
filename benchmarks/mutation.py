"""Mutation testing: one operator, constant or statement of a module is changed at a time, and its tests run.

    python benchmarks/mutation.py tetgan/evaluation/fid.py tetgan/nn/conv.py:tests/nn/test_conv.py --sample 30

A module's tests are `tests/…/test_NAME.py` at the same place, or those after colons. Each mutant is written
into a copy, so the working tree is left alone. Shapes are not checked: only values can fail a test. Exit
status 1 where a module fails its tests unchanged.
"""

import argparse
import ast
import copy
import importlib
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

HEAVY = ("torch", "torch._dynamo", "torch.utils.tensorboard", "scipy.sparse", "pandas", "trimesh", "zarr")

ROOT = Path(__file__).resolve().parent.parent

PAIRS: list[tuple[type, type]] = [
    *((ast.Add, ast.Sub), (ast.Mult, ast.Div), (ast.BitAnd, ast.BitOr), (ast.And, ast.Or)),
    *((ast.Lt, ast.LtE), (ast.Gt, ast.GtE), (ast.Eq, ast.NotEq), (ast.Is, ast.IsNot), (ast.In, ast.NotIn)),
]
SWAPPED = {ast.Pow: ast.Mult, ast.FloorDiv: ast.Mult} | dict(PAIRS) | {b: a for a, b in PAIRS}
RENAMED = {"mean": "sum", "sum": "mean", "min": "max", "max": "min", "zeros": "ones", "ones": "zeros"}


def mutate(node: ast.AST) -> bool:
    """Change a node in place; whether it is one that can be changed."""
    match node:
        case ast.BinOp(op=op) | ast.BoolOp(op=op) | ast.AugAssign(op=op) if type(op) in SWAPPED:
            node.op = SWAPPED[type(op)]()
        case ast.Compare(ops=[op, *_]) if type(op) in SWAPPED:
            node.ops[0] = SWAPPED[type(op)]()
        case ast.UnaryOp(op=ast.USub()):
            node.op = ast.UAdd()
        case ast.If() | ast.IfExp():
            node.test = ast.UnaryOp(ast.Not(), node.test)
        case ast.Constant(value=bool(value)):
            node.value = not value
        case ast.Constant(value=int(value) | float(value)):
            node.value = value + 1
        case ast.Attribute(attr=name) if name in RENAMED:
            node.attr = RENAMED[name]
        case ast.Expr(value=ast.Call()):
            node.value = ast.Constant(None)
        case _:
            return False
    return True


def places(tree: ast.Module) -> list[int]:
    """Numbers, in the order of `ast.walk`, of the nodes that can be changed; annotations are left out."""
    notes: list[ast.AST | None] = []
    for node in ast.walk(tree):
        notes += [getattr(node, "annotation", None), getattr(node, "returns", None)]
    skipped = {id(part) for note in notes if note is not None for part in ast.walk(note)}
    nodes = enumerate(ast.walk(tree))
    return [number for number, node in nodes if id(node) not in skipped and mutate(copy.deepcopy(node))]


def mutant(tree: ast.Module, place: int) -> tuple[str, str]:
    """The source with one node changed, and a line that says which."""
    changed = copy.deepcopy(tree)
    node = next(node for number, node in enumerate(ast.walk(changed)) if number == place)
    before = ast.unparse(node).split("\n")[0]
    mutate(node)
    after = ast.unparse(node).split("\n")[0]
    return ast.unparse(ast.fix_missing_locations(changed)), f"line {node.lineno}: `{before}` → `{after}`"


def passes(folder: Path, tests: list[str], limit: float) -> bool:
    """Whether the tests pass in a copy of the repository, in a child that has the large libraries already."""
    child = os.fork()
    if child == 0:
        os.setpgid(0, 0)
        os.chdir(folder)
        silence = os.open(os.devnull, os.O_WRONLY)
        os.dup2(silence, 1)
        os.dup2(silence, 2)
        sys.path[:0] = [str(folder)]
        options = [
            "-x",
            "-q",
            "-o",
            "addopts=--import-mode=importlib",
            "-m",
            "not slow",
            "-p",
            "no:cacheprovider",
        ]
        os._exit(pytest.main([*options, *tests]))
    until = time.monotonic() + limit
    while time.monotonic() < until:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return status == 0
        time.sleep(0.05)
    os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return False


def survivors(folder: Path, module: str, tests: list[str], chosen: list[int]) -> Iterator[str | None]:
    """For each place the line of a mutant that no test noticed, or None."""
    file = folder / module
    text, start = file.read_text(), time.monotonic()
    tree = ast.parse(text)
    if not passes(folder, tests, 600):
        sys.exit(f"{module}: its tests fail as it is: {' '.join(tests)}")
    limit = 20 + 3 * (time.monotonic() - start)
    for place in chosen:
        source, line = mutant(tree, place)
        file.write_text(source)
        yield line if passes(folder, tests, limit) else None
    file.write_text(text)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("modules", nargs="+", help="MODULE or MODULE:TESTS[:TESTS…], paths from the root")
    parser.add_argument("--sample", type=int, help="mutants of each module; all by default")
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    sys.dont_write_bytecode = True  # a mutant as long and as old as the one before would pass for it
    for library in HEAVY:  # once, not in every child
        importlib.import_module(library)
    with tempfile.TemporaryDirectory() as name:
        for part in ("tetgan", "tests", "pyproject.toml"):
            copied = shutil.copytree if (ROOT / part).is_dir() else shutil.copy
            copied(ROOT / part, Path(name) / part)
        for entry in chosen.modules:
            module, *tests = entry.split(":")
            own = Path("tests", *Path(module).parts[1:]).with_name(f"test_{Path(module).name}")
            found = places(ast.parse((ROOT / module).read_text()))
            count = min(chosen.sample or len(found), len(found))
            some = sorted(random.Random(chosen.seed).sample(found, count))
            killed = 0
            for line in survivors(Path(name), module, tests or [str(own)], some):
                killed += line is None
                print(f"- {line}" if line else ".", flush=True)
            print(
                f"| {module} | {len(found)} | {count} | {killed} | {killed / max(count, 1):.0%} |", flush=True
            )


if __name__ == "__main__":
    main()
