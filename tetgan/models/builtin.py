"""The kinds of model that come with this package, one record each.

Networks and training are named, not imported: this module stays light, and training is a later room.
"""

from tetgan.models.kind import ModelKind
from tetgan.models.options import (
    DeftetOptions,
    OccNetOptions,
    PcaOptions,
    RepresentationOptions,
    ShapeGanOptions,
    ShapeGanVaeOptions,
    SimplifiedOptions,
    TetganOptions,
)

KINDS = (
    ModelKind(
        TetganOptions,
        build="tetgan.models.tetgan:TetganGenerator",
        train="tetgan.training.trainer:train_tetgan",
        training="tetgan.training.options:TrainingOptions",
        sizes="tetgan.models.sizes:of_tetgan",
        shares_batches=True,
    ),
    ModelKind(
        DeftetOptions,
        build="tetgan.models.baselines.deftet:DeftetGenerator",
        train="tetgan.training.deftet:train_deftet",
        training="tetgan.training.options:TrainingOptions",
        of=("tetgan",),
        one_mode=True,
    ),
    ModelKind(
        PcaOptions,
        build="tetgan.models.baselines.pca:PcaGenerator",
        train="tetgan.training.fitted:fit_model",
        one_mode=True,
        logged=False,
    ),
    ModelKind(
        RepresentationOptions,
        build="tetgan.models.baselines.representation:RepresentationGenerator",
        train="tetgan.training.fitted:fit_model",
        logged=False,
    ),
    ModelKind(
        OccNetOptions,
        build="tetgan.models.baselines.occnet:OccNetGenerator",
        learner="tetgan.training.baselines.occnet:OccNetLearner",
        training="tetgan.training.baselines.options:OccNetTraining",
        sampling={"kind": "points"},
        sizes="tetgan.models.sizes:of_occnet",
    ),
    ModelKind(
        ShapeGanOptions,
        build="tetgan.models.baselines.shapegan:ShapeGanGenerator",
        learner="tetgan.training.baselines.shapegan:ShapeGanLearner",
        training="tetgan.training.baselines.options:ShapeGanTraining",
        sampling={"kind": "voxels"},
        sizes="tetgan.models.sizes:of_shapegan",
    ),
    ModelKind(
        ShapeGanVaeOptions,
        build="tetgan.models.baselines.shapegan_vae:ShapeGanVae",
        learner="tetgan.training.baselines.shapegan_vae:ShapeGanVaeLearner",
        training="tetgan.training.baselines.options:ShapeGanVaeTraining",
        sampling={"kind": "voxels", "resolution": 32},
        sizes="tetgan.models.sizes:of_shapegan_vae",
    ),
    ModelKind(SimplifiedOptions, sizes="tetgan.models.sizes:of_simplified", logged=False),
)
