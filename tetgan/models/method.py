"""Record of a generative method: options, network, learner, training."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any, NamedTuple, get_args

from tetgan.fields.options import Sampling
from tetgan.grids.options import GridOptions
from tetgan.options import Options


class MethodOptions(Options):
    """Base of the options of every model; each class allows one word for `kind`."""

    kind: str


Reference = str | Callable[..., Any]
"""A class or function, or `module:name` of one, which is imported when it is first needed."""


@dataclass(frozen=True)
class Method:
    """A kind of model. `docs/extending.md` shows one of fields from its options to the table.

    Raises:
        TypeError: the options lack a field that the pipeline reads, or parts do not go together.
    """

    options: type[MethodOptions]
    """An entry of the config under `models`. Its `kind` is a `Literal` of one word, the name."""

    build: Reference | None = None
    """From options and grid hierarchy, and the model that it is built on if there is one, an untrained
    `FieldGenerator`; from options alone a `SurfaceModel`, for kinds that learn from a sampling. None: nothing
    is trained, as samples are made from another model's."""

    learner: Reference | None = None
    """From options, training options, store and seed a `Learner`, which the training loop trains; it gets the
    trained model that it is built on, if there is one, as `of`."""

    train: Reference | None = None
    """In place of a learner, for what is fitted at once: from index, options, training options, seed and
    folder a trained model in the folder."""

    training: Reference = "tetgan.training.options:FieldTraining"
    """Class of the training options, derived from `CommonTraining`."""

    sampling: Mapping[str, Any] | None = None
    """Options that a sampling must have to be learned from. None: the kind learns fields on a grid."""

    of: tuple[str, ...] = ()
    """Kinds of which it needs a trained model on the same grid, which the option `of` names. For learners of
    fields alone."""

    sizes: Reference = "tetgan.models.method:of_data"
    """From options, those of grid or sampling, and training options what `Config.reductions` compares;
    the last two are None for a kind that is not trained."""

    one_mode: bool = False
    """Whether its fields are meshed in the first mode alone, as those of a yardstick."""

    shares_batches: bool = False
    """Whether several processes can train one model together."""

    def __post_init__(self) -> None:
        needed = {"kind"} | ({"of"} if self.of or not self.trained else set())
        if self.trained:
            needed.add("grid" if self.sampling is None else "sampling")
        for name in sorted(needed - set(self.options.model_fields)):
            raise TypeError(f"{self.options.__name__}: a model of this kind needs an option '{name}'")
        if self.trained and (self.learner is None) == (self.train is None):
            raise TypeError(f"{self.options.__name__}: name either a learner or, to fit at once, `train`")
        if self.of and (self.learner is None or self.sampling is not None):
            raise TypeError(
                f"{self.options.__name__}: only a learner of fields can be built on another model"
            )
        if len(get_args(self.options.model_fields["kind"].annotation)) != 1:
            raise TypeError(f"{self.options.__name__}.kind: a Literal of one word says the name of the kind")

    @property
    def name(self) -> str:
        """The word for it in a config."""
        return str(get_args(self.options.model_fields["kind"].annotation)[0])

    @property
    def trained(self) -> bool:
        """Whether there are weights."""
        return self.build is not None

    @property
    def has_fields(self) -> bool:
        """Whether its shapes are fields on a grid, with interiors to show and latents to encode."""
        return self.trained and self.sampling is None

    @property
    def logged(self) -> bool:
        """Whether its training writes a log, of which there is a curve to draw."""
        return self.learner is not None

    @property
    def entry_points(self) -> list[str]:
        """Its options, network and training as `module:name`: where its code begins."""
        references = (self.options, self.build, self.learner, self.train)
        return [_in_words(reference) for reference in references if reference is not None]

    def load(self, part: str) -> Any:
        """The class or function behind one of the references."""
        reference = getattr(self, part)
        if not isinstance(reference, str):
            return reference
        module, _, name = reference.partition(":")
        return getattr(import_module(module), name)


def _in_words(reference: Reference) -> str:
    return reference if isinstance(reference, str) else f"{reference.__module__}:{reference.__qualname__}"


class Size(NamedTuple):
    """One of ours, and what it is in full: the paper's, or, where no source states it, our own."""

    ours: int | float
    full: int | float
    stated: bool = True

    @property
    def differs(self) -> bool:
        """Larger is no reduction."""
        return self.ours < self.full

    def __str__(self) -> str:
        return f"{self.ours:g} ({'paper' if self.stated else 'our full run'} {self.full:g})"


class Choice(NamedTuple):
    """One of ours that is no number, and the paper's."""

    ours: str
    full: str

    @property
    def differs(self) -> bool:
        return self.ours != self.full

    def __str__(self) -> str:
        return f"{self.ours} (paper {self.full})"


Sizes = dict[str, Size | Choice]


def of_data(options: MethodOptions, data: GridOptions | Sampling, training: Any) -> Sizes:
    """Of a model of which the paper says nothing, the grid's alone."""
    return {"depth": Size(data.depth, 3)} if isinstance(data, GridOptions) else {}
