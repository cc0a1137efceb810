"""The flow of codes: its loss by hand, the way it takes, and its start."""

import math

import pytest
import torch
from torch import nn

from tetgan.methods.tetflow.flow import CodeFlow, flow_loss


def small(seed: int = 0) -> CodeFlow:
    torch.manual_seed(seed)
    return CodeFlow(tets=6, code=3, channels=16, layers=2, heads=2)


class Known(CodeFlow):
    """A flow whose velocity is a function of place and time."""

    def __init__(self, velocity) -> None:
        nn.Module.__init__(self)
        self.velocity = velocity

    def forward(self, x, time):
        return self.velocity(x, time[:, None, None])


def test_the_loss_of_a_flow_that_stands_still():
    # Nothing moves: the squared length of the way from 1 to 3.
    still = Known(lambda x, time: torch.zeros_like(x))
    ones = torch.ones(2, 1, 1)
    assert float(flow_loss(still, 3 * ones, ones, torch.tensor([0.2, 0.9]))) == pytest.approx(4)


def test_the_loss_is_taken_on_the_straight_way():
    # At a quarter of the way from 1 to 3, which is 1.5; the true velocity is 2.
    found = flow_loss(
        Known(lambda x, time: x + time), torch.full((1, 1, 1), 3.0), torch.ones(1, 1, 1), torch.tensor([0.25])
    )
    assert float(found) == pytest.approx((1.5 + 0.25 - 2) ** 2)


@pytest.mark.parametrize("steps", [1, 4])
def test_a_constant_velocity_is_followed_exactly(steps):
    noise = torch.randn(2, 6, 3)
    torch.testing.assert_close(Known(lambda x, time: torch.full_like(x, 2.0)).carry(noise, steps), noise + 2)


def test_the_way_is_of_second_order():
    # x' = x from 1 ends at e; half the step, a quarter of the error.
    flow, one = Known(lambda x, time: x), torch.ones(1, 1, 1, dtype=torch.float64)
    errors = [abs(float(flow.carry(one, steps)) - math.e) for steps in (20, 40, 80)]
    rates = [math.log2(errors[0] / errors[1]), math.log2(errors[1] / errors[2])]
    assert rates == pytest.approx([2, 2], abs=0.1)


def test_at_the_start_noise_stays_noise():
    noise = torch.randn(2, 6, 3)
    assert torch.equal(small().carry(noise, 3), noise)


def test_each_code_goes_its_own_way():
    flow = small()
    nn.init.normal_(flow.leave.weight)
    for layer in flow.layers:
        nn.init.normal_(layer.modulate.weight, std=0.1)
    noise = torch.randn(3, 6, 3)
    together = flow.carry(noise, 2)
    for number in range(3):
        torch.testing.assert_close(
            flow.carry(noise[number : number + 1], 2)[0], together[number], rtol=1e-4, atol=1e-4
        )


def test_a_flow_learns_two_points():
    # Codes are all 1 or all -1 with even odds: draws end near either.
    flow, draws = small(), torch.Generator().manual_seed(0)
    optimizer = torch.optim.Adam(flow.parameters(), 3e-3)
    for _ in range(150):
        sides = 2.0 * torch.randint(2, (32, 1, 1), generator=draws) - 1
        code = sides.expand(32, 6, 3)
        noise, time = torch.randn(32, 6, 3, generator=draws), torch.rand(32, generator=draws)
        loss = flow_loss(flow, code, noise, time)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
    with torch.no_grad():
        found = flow.carry(torch.randn(64, 6, 3, generator=draws), 20).mean(dim=(1, 2))
    assert (found.abs() > 0.7).float().mean() > 0.8
    assert 0.2 < (found > 0).float().mean() < 0.8
