"""Options of the simplified rows, without torch."""

from typing import Literal

from pydantic import Field

from tetgan.models.method import Method, MethodOptions, Size, Sizes


class SimplifiedOptions(MethodOptions):
    """The samples of another model with fewer faces; nothing is trained. The paper's rows with a star."""

    kind: Literal["simplified"]
    of: str = Field(description="name of the model, a key of `models`")
    faces: int = Field(
        5500, ge=4, description="faces that quadric edge collapse leaves; the paper's are 5,500"
    )


def sizes(options: SimplifiedOptions, data: None, training: None) -> Sizes:
    """Beside those of the model that it is made from."""
    return {"faces": Size(options.faces, 5500)}


METHOD = Method(SimplifiedOptions, sizes=sizes)
