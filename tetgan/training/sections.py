"""Training options of a model, from those of a config: of every method, of one, of the model alone."""

from collections.abc import Mapping
from contextlib import suppress
from typing import Annotated, Any

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, TypeAdapter, create_model
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from tetgan.errors import UserError
from tetgan.models.method import MethodOptions
from tetgan.models.registry import find_method, loaded_methods, method_of
from tetgan.options import Options
from tetgan.training.options import CommonTraining


def training_class(model: MethodOptions) -> type[Options]:
    """The class of training options of a model."""
    found: type[Options] = method_of(model).load("training")
    return found


def training_options(model: MethodOptions, sections: Mapping[str, Mapping[str, Any]]) -> Options:
    """Training options of a model: the common ones, then those of its method, then its own.

    Args:
        sections: options by name of a method, and under `common` those of all.

    Raises:
        UserError: the model's own options have a key that its method does not know, or a bad value.
    """
    kind = training_class(model)
    common = {key: value for key, value in sections.get("common", {}).items() if key in kind.model_fields}
    own = getattr(model, "training", {})
    return kind.parse(common | dict(sections.get(model.kind, {})) | own, "training")


class _ByMethod:
    """Checks options by name of a method, and keeps those that are given."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(_checked)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return handler(TypeAdapter(_sections()).core_schema)


def _sections() -> type[Options]:
    """The class of the section, for the methods that are known at this moment and trained in steps."""
    classes = {method.name: method.load("training") for method in loaded_methods() if method.learner}
    fields: dict[str, Any] = {
        name: (kind, Field(kind(), description=kind.__doc__)) for name, kind in classes.items()
    }
    common = (CommonTraining, Field(CommonTraining(), description="of every method"))
    return create_model("TrainingSection", __base__=Options, common=common, **fields)


def _checked(values: Any) -> dict[str, dict[str, Any]]:
    for name in values if isinstance(values, dict) else ():
        with suppress(UserError):  # an unknown name is an error below
            find_method(str(name))
    return _sections().model_validate(values).model_dump(mode="json", exclude_unset=True)


TrainingSections = Annotated[dict[str, dict[str, Any]], _ByMethod()]
"""The section `training` of a config."""
