"""A step on a GPU beside the same step on the CPU; `pytest -m gpu` where there is one."""

import pytest
import torch

from tetgan.fields.field import vertex_operator
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.methods.tetgan.learner import TetganLearner
from tetgan.methods.tetgan.options import TetganOptions, TetganTraining
from tetgan.training.loop import step_draws

HIERARCHY = build_hierarchy(1, 1)
MODEL = {"grid": "smoke", "width": 4, "code": 6, "local_critic_width": 2, "global_critic_width": 4}

pytestmark = [
    pytest.mark.gpu,
    pytest.mark.skipif(not torch.cuda.is_available(), reason="no CUDA device"),
]


def losses(device: str, **training) -> dict[str, float]:
    """Of a step of the autoencoder, of the critics and against them, from the same weights and draws."""
    where = torch.device(device)
    options = TetganTraining.parse(training)
    operator = vertex_operator(HIERARCHY.finest)
    learner = TetganLearner(
        TetganOptions.parse(MODEL), options, HIERARCHY, operator, mu=0.02, seed=0, device=where
    )
    field = torch.rand(4, len(HIERARCHY.finest.tets), 4, generator=torch.Generator().manual_seed(0))
    field[..., 0] = (field[..., 0] > 0.7).float()
    field = field.to(where)
    steps = [learner.autoencoder_step(field, 0.1, step_draws(0, 0))]
    steps += [learner.critic_step(field, step_draws(0, 1)), learner.adversarial_step(4, step_draws(0, 2))]
    return {name: float(value) for step in steps for name, value in step.items()}


@pytest.mark.parametrize("switch", [{}, {"checkpointing": True}, {"accumulate": 2}])
def test_a_step_is_the_same_on_both_devices(switch):
    ours, wanted = losses("cuda", **switch), losses("cpu")
    assert ours == pytest.approx(wanted, rel=1e-3, abs=1e-4)


def test_half_precision_stays_near():
    assert losses("cuda", precision="bf16") == pytest.approx(losses("cpu"), rel=0.1, abs=0.02)
