"""Options of evaluation: points, shapes, pairs, resamples."""

from typing import Literal

from pydantic import Field, model_validator

from tetgan.extractor.options import ExtractorOptions
from tetgan.options import Options

__all__ = [
    "BootstrapOptions",
    "EvaluationOptions",
    "ExtractorOptions",
    "KernelOptions",
    "SetOptions",
    "VarietyOptions",
]


class VarietyOptions(Options):
    """Options of variety, the distance of the most similar generated shapes."""

    definition: Literal["text", "appendix"] = Field(
        default="text",
        description="text: closest of random pairs; appendix: closest of all pairs of a random set",
    )
    pairs: int = Field(default=250, ge=1, description="pairs drawn (text), or shapes in the set (appendix)")
    closest: int = Field(default=25, ge=1, description="how many of the smallest distances are averaged")
    repeats: int = Field(
        default=5, ge=1, description="independent draws; their mean and standard deviation are reported"
    )

    @model_validator(mode="after")
    def _enough_pairs(self) -> "VarietyOptions":
        drawn = self.pairs if self.definition == "text" else self.pairs * (self.pairs - 1) // 2
        if self.closest > drawn:
            raise ValueError(f"closest ({self.closest}) exceeds the {drawn} pairs of a draw")
        return self


class KernelOptions(Options):
    """Blocks of the kernel distance (KID)."""

    block: int = Field(
        default=100, ge=2, description="features of each side in a block; at most the samples are used"
    )
    blocks: int = Field(
        default=100, ge=1, description="random blocks; their mean and standard deviation are reported"
    )


class SetOptions(Options):
    """Generated shapes as a set beside real ones (MMD, COV, 1-NNA, JSD) and training shapes (novelty)."""

    shapes: int = Field(
        default=128, ge=2, description="most shapes on each side; fewer where fewer are held out"
    )
    points: int = Field(
        default=512, ge=16, le=100_000, description="points a shape for the distances between all shapes"
    )


class BootstrapOptions(Options):
    """Intervals on every figure."""

    resamples: int = Field(
        default=1000,
        ge=20,
        le=100_000,
        description="resamples of a mean, of the kernel distance, and of shares of sets",
    )
    frechet_resamples: int = Field(
        default=100,
        ge=20,
        le=10_000,
        description="resamples of the Fréchet distance and of the JSD",
    )
    level: float = Field(default=0.95, gt=0, lt=1, description="coverage of the interval")


class EvaluationOptions(Options):
    """Conventions of the metrics; docs/metrics.md says what each figure means."""

    points: int = Field(
        default=10_000, ge=100, le=1_000_000, description="points sampled on each surface for distances"
    )
    fscore_threshold: float = Field(
        default=0.01,
        gt=0,
        le=1,
        description="distance within which a point counts as found, as a fraction of the unit cube",
    )
    samples: int = Field(
        default=256,
        ge=2,
        description="most surfaces on each side of the feature metrics (FID, KID, precision, recall); fewer "
        "where fewer are held out",
    )
    volume_points: int = Field(
        default=20_000, ge=1000, le=10_000_000, description="points for the volumetric overlap of two shapes"
    )
    sets: SetOptions = SetOptions()
    variety: VarietyOptions = VarietyOptions()
    kernel: KernelOptions = KernelOptions()
    bootstrap: BootstrapOptions = BootstrapOptions()
    seed: int = Field(default=0, ge=0, description="of every random choice of the evaluation")

    def at_most(self, shapes: int) -> "EvaluationOptions":
        """These options, asking for no more shapes on a side than there are: all rows have as many."""
        sets = self.sets.model_copy(update={"shapes": max(2, min(self.sets.shapes, shapes))})
        return self.model_copy(update={"samples": max(2, min(self.samples, shapes)), "sets": sets})
