"""The reasons for which a mesh cannot be simulated."""

from tetgan.errors import UserError


class UnfitError(UserError):
    """A mesh that has no solution as it is.

    Attributes:
        kind: what is wrong with it, in words that are the same for every such mesh.
    """

    def __init__(self, kind: str, message: str) -> None:
        super().__init__(message)
        self.kind = kind
