"""Records of methods: fields refused, and those of this package."""

from typing import Literal

import pytest

from tetgan.models.method import Method, MethodOptions
from tetgan.models.registry import loaded_methods


class OnGrid(MethodOptions):
    kind: Literal["made-up"]
    grid: str


class Standing(OnGrid):
    of: str


class Vague(MethodOptions):
    grid: str


class Ambiguous(MethodOptions):
    kind: Literal["one", "other"]
    grid: str


@pytest.mark.parametrize(
    ("options", "further", "message"),
    [
        (OnGrid, {"sampling": {"kind": "points"}}, "OnGrid: a model of this kind needs an option 'sampling'"),
        (OnGrid, {"of": ("tetgan",)}, "OnGrid: a model of this kind needs an option 'of'"),
        (OnGrid, {"learner": None}, "OnGrid: name either a learner or, to fit at once, `train`"),
        (OnGrid, {"train": "made.up:fit"}, "OnGrid: name either a learner or"),
        (Standing, {"learner": None, "train": "made.up:fit", "of": ("tetgan",)}, "only a learner of fields"),
        (OnGrid, {"build": None}, "OnGrid: a model of this kind needs an option 'of'"),
        (Vague, {}, r"Vague\.kind: a Literal of one word"),
        (Ambiguous, {}, r"Ambiguous\.kind: a Literal of one word"),
    ],
)
def test_a_record_that_the_pipeline_could_not_use_is_refused(options, further, message):
    with pytest.raises(TypeError, match=message):
        Method(options, **({"build": "made.up:Model", "learner": "made.up:Learner"} | further))


def test_a_record_knows_its_name_and_where_its_code_begins():
    kind = Method(OnGrid, build="made.up:Model", learner=OnGrid)
    assert (kind.name, kind.trained) == ("made-up", True)
    here = f"{__name__}:OnGrid"
    assert kind.entry_points == [here, "made.up:Model", here]
    assert kind.logged


@pytest.mark.parametrize("method", loaded_methods(), ids=lambda method: method.name)
def test_everything_that_a_method_of_this_package_names_is_there(method):
    for part in ("build", "learner", "train", "training", "sizes"):
        if getattr(method, part) is not None:
            assert callable(method.load(part))


def test_names_differ():
    assert len({kind.name for kind in loaded_methods()}) == len(loaded_methods())
