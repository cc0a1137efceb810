"""Records of kinds: what they refuse, and what those of this package name."""

from typing import Literal

import pytest

from tetgan.models.builtin import KINDS
from tetgan.models.kind import ModelKind
from tetgan.models.options import KindOptions


class OnGrid(KindOptions):
    kind: Literal["made-up"]
    grid: str


class Vague(KindOptions):
    grid: str


class Ambiguous(KindOptions):
    kind: Literal["one", "other"]
    grid: str


@pytest.mark.parametrize(
    ("options", "further", "message"),
    [
        (OnGrid, {"sampling": {"kind": "points"}}, "OnGrid: a model of this kind needs an option 'sampling'"),
        (OnGrid, {"of": ("tetgan",)}, "OnGrid: a model of this kind needs an option 'of'"),
        (OnGrid, {"build": None}, "OnGrid: a model of this kind needs an option 'of'"),
        (Vague, {}, r"Vague\.kind: a Literal of one word"),
        (Ambiguous, {}, r"Ambiguous\.kind: a Literal of one word"),
    ],
)
def test_a_record_that_the_pipeline_could_not_use_is_refused(options, further, message):
    with pytest.raises(TypeError, match=message):
        ModelKind(options, **({"build": "made.up:Model"} | further))


def test_a_record_knows_its_name_and_its_modules():
    kind = ModelKind(OnGrid, build="made.up:Model", learner=OnGrid)
    assert (kind.name, kind.trained) == ("made-up", True)
    assert kind.modules == {"made.up", __name__, "tetgan.training.kind_trainer"}


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_everything_that_a_kind_of_this_package_names_is_there(kind):
    for part in ("build", "learner", "train", "training", "sizes"):
        if getattr(kind, part) is not None:
            assert callable(kind.load(part))


def test_names_differ():
    assert len({kind.name for kind in KINDS}) == len(KINDS)
