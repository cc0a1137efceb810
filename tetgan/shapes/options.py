"""Options of sources, repair and split."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from tetgan.options import Options


class BuiltinSource(Options):
    """The parametric generators of this package: any number of shapes, no download."""

    kind: Literal["builtin"]
    count: int = Field(400, ge=2, description="shapes to repair, train on and validate with")
    holdout: int = Field(256, ge=0, description="further shapes used only as surfaces, for FID and KID")
    seed: int = Field(0, ge=0, description="seed of the generators")


class FolderSource(Options):
    """Base of every source made of files."""

    path: Path = Field(description="root folder")
    limit: int | None = Field(
        None, ge=2, description="use at most this many shapes, the same draw every time"
    )
    up: Literal["y", "z"] = Field("y", description="the axis that points up in the files")


class DirectorySource(FolderSource):
    """Any folder of .obj .off .ply .stl .glb files, nested or not."""

    kind: Literal["directory"]
    include: str = Field("*", description="glob on the path below the root, such as '*/chair/*'")


class ShapeNetSource(FolderSource):
    """ShapeNetCore, version 1 or 2, as it is unpacked."""

    kind: Literal["shapenet"]
    synset: str | None = Field(
        None, pattern=r"^\d{8}$", description="folder of the category; by default the category's own synset"
    )
    split: Literal["official", "seeded"] = Field(
        "official", description="official: from all.csv in the root, seeded where there is none"
    )


class CosegSource(FolderSource):
    """COSEG: a folder per category with its meshes in shapes/."""

    kind: Literal["coseg"]


class ModelNetSource(FolderSource):
    """ModelNet10 or ModelNet40: <category>/{train,test}/*.off with the official split."""

    kind: Literal["modelnet"]
    up: Literal["y", "z"] = Field("z", description="the axis that points up in the files")


class SweetHome3DSource(FolderSource):
    """The furniture of Debian's package sweethome3d-furniture (.sh3f libraries)."""

    kind: Literal["sweethome3d"]
    path: Path = Field(Path("/usr/share/sweethome3d/furniture"), description="folder of .sh3f libraries")


SourceOptions = Annotated[
    BuiltinSource | DirectorySource | ShapeNetSource | CosegSource | ModelNetSource | SweetHome3DSource,
    Field(discriminator="kind"),
]


class RepairOptions(Options):
    """Options of repair, from triangle soup to watertight solid; docs/repair.md gives the reasons."""

    method: Literal["manifold", "alpha_wrap"] = Field(
        "alpha_wrap",
        description="manifold: Huang et al. 2018, as the paper; alpha_wrap: Portaneri et al. 2022",
    )
    resolution: int = Field(20_000, ge=1_000, le=1_000_000, description="manifold: leaves of the octree")
    alpha: float = Field(
        0.02,
        gt=0,
        le=0.5,
        description="alpha_wrap: gaps narrower than twice this fraction of the longest side close",
    )
    offset: float = Field(
        0.001, gt=0, le=0.1, description="alpha_wrap: outward offset, fraction of the longest side"
    )
    fill_hollow: bool = Field(True, description="fill insides that open sheets left hollow")
    sheet_thickness: float = Field(
        0.01, gt=0, le=0.1, description="walls thinner than this fraction of the longest side are sheets"
    )
    timeout_seconds: float = Field(60.0, gt=0, description="processor time after which a mesh is rejected")


class SimplifyOptions(Options):
    """Quadric edge collapse (Garland and Heckbert 1997)."""

    method: Literal["quadric_collapse"] = Field("quadric_collapse", description="there is no other")
    faces: int = Field(5500, ge=4, description="most faces of a mesh; the paper's are 5,500")
    timeout_seconds: float = Field(60.0, gt=0, description="processor time after which a mesh is given up")


class SplitOptions(Options):
    """The seeded split of a category, for shapes without an official one."""

    validation: int = Field(
        6, ge=2, description="one shape in this many is for validation (6: the paper's 5/1)"
    )
    seed: int = Field(0, ge=0, description="seed of the permutation")
