"""The base of all descriptions, and the number types that their fields share."""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    ValidationError,
    WrapValidator,
    model_serializer,
    model_validator,
)
from pydantic.fields import FieldInfo

from .errors import MISSING, NotAllowed, SceneError, describe, must, show_key, suggestion
from .given import plain, unordered

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass
else:
    ModelMetaclass = type(BaseModel)

#: Units of keys; those of other keys are plain numbers.
UNITS = {
    key: unit
    for unit, keys in {
        "any": ("sizes", "mass"),
        "length": ("x",),
        "that of x": ("z", "radius", "origin"),
        "mean radius, or that of x": ("width",),
        "mean radius": ("lattice_constant", "displacement"),
        "mg / mean radius": ("normal_stiffness",),
        "mg": ("force",),
        "mg × mean radius": ("torque", "stop_kinetic_energy"),
        "sqrt(gR)": ("vx", "vz"),
        "1 / sqrt(R/g)": ("spin",),
        "sqrt(R/g)": ("time_step", "ramp_time", "duration"),
        "g": ("amplitude",),
    }.items()
    for key in keys
}


def unit_of(name: str, info: FieldInfo) -> str:
    """The unit of a key; a law says those of its parameters itself (``json_schema_extra``)."""
    extra = info.json_schema_extra if isinstance(info.json_schema_extra, dict) else {}
    return str(extra.get("unit", UNITS.get(name, "")))


def refused(error: ValidationError) -> SceneError:
    """The first mistake that pydantic found, with the number of further ones."""
    found = error.errors(include_url=False)
    first = found[0]
    found_at = first["loc"]
    kinds = {k for k, part in enumerate(found_at) if k and found_at[k - 1] == "packing" and part in packing_kinds()}
    path = tuple(part for k, part in enumerate(found_at) if k not in kinds)  # tags of pydantic, which no file has
    value = first["input"]
    problem = first.get("ctx", {}).get("error")
    if first["type"] == "missing":
        message = f"{show_key(path)}: missing, must be given"
    elif isinstance(problem, NotAllowed):
        value = value if problem.value is MISSING else problem.value
        message = describe(path + problem.key, value, problem.allowed)
    elif first["type"] == "literal_error":
        choices = re.findall(r"'([^']*)'", first["ctx"]["expected"])
        message = describe(path, value, f"must be {' or '.join(choices)}{suggestion(value, choices)}")
    else:
        said = first["msg"].replace("Input should be", "must be")
        message = describe(path, value, said.replace("valid tuple", "list").replace("valid dictionary", "mapping"))
    unit = UNITS.get(str(path[-1]) if path else "", "")
    if unit and isinstance(value, str) and re.match(r"\s*[-+]?(?!0x)\.?\d[\d.]*(e[-+]?\d+)?\s*[a-zµ]", value, re.I):
        message += f"; the unit is {unit}, gr.LaboratoryUnits converts"
    more = len(found) - 1
    return SceneError(message + (f" (and {more} more mistake{'s' * (more > 1)})" if more else ""))


class _Public(ModelMetaclass):
    """Has ``help`` and ``dir`` list what a description adds, and nothing of pydantic."""

    def __dir__(cls) -> list[str]:
        return sorted({name for name in super().__dir__() if not name.startswith("_")} - _OF_PYDANTIC)


_OF_PYDANTIC = frozenset(ModelMetaclass.__dir__(BaseModel))


class Description(BaseModel, metaclass=_Public):
    """Frozen, validated data; a value that is not allowed or a key that does not exist is a SceneError."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    #: Keys that are written only where they are not the default: a scene without them is written as if they did not
    #: exist.
    sparse: ClassVar[tuple[str, ...]] = ()

    def __init__(self, /, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise refused(error) from None

    # Without this mark pydantic would call __init__ for nested descriptions too and lose the path of the key.
    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        """Keys, defaults, units and meanings go into the docstring, and no types of validators into the signature."""
        parameters, lines = [], []
        for name, info in cls.model_fields.items():
            default = inspect.Parameter.empty if info.is_required() else info.get_default(call_default_factory=True)
            parameters.append(inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default))
            shown = "must be given" if info.is_required() else f"default {default!r}"
            unit = f" [{unit_of(name, info)}]" if unit_of(name, info) else ""
            lines += [f"{name} : {shown}{unit}", textwrap.indent(textwrap.fill(info.description or "", 112), "    ")]
        cls.__signature__ = inspect.Signature(parameters)
        text, title, examples = inspect.cleandoc(cls.__doc__ or "").partition("\n\nExamples\n")
        cls.__doc__ = "\n".join([text, "", "Parameters", "----------", *lines]) + title + examples

    def __dir__(self) -> Iterable[str]:
        return sorted({*dir(type(self)), *type(self).model_fields})

    def __str__(self) -> str:
        return repr(self)

    def __repr_args__(self) -> Iterable[tuple[str | None, Any]]:
        """What differs from its default."""
        for name, value in super().__repr_args__():
            info = type(self).model_fields.get(name or "")
            if info is None or value != info.get_default(call_default_factory=True):
                yield name, value

    @model_serializer(mode="wrap")
    def _written(self, written: SerializerFunctionWrapHandler) -> dict[str, Any]:
        data: dict[str, Any] = written(self)
        fields = {key: info for key, info in type(self).model_fields.items() if key in self.sparse}
        defaults = {key: info.get_default(call_default_factory=True) for key, info in fields.items()}
        usual = {key for key, default in defaults.items() if getattr(self, key) == default}
        return {key: value for key, value in data.items() if key not in usual}

    @model_validator(mode="before")
    @classmethod
    def _check_keys(cls, data: Any) -> Any:
        if isinstance(data, cls):
            return data
        keys = ", ".join(cls.model_fields)
        must(isinstance(data, Mapping), f"must be a mapping with keys among {keys}" if keys else "must be {}")
        for key, value in data.items():
            if key not in cls.model_fields:
                meant = cls._elsewhere(key) or suggestion(key, cls.model_fields)
                raise NotAllowed(f"unknown key{meant} (allowed: {keys or 'none'})", key=(str(key),), value=value)
        return {key: plain(value) for key, value in data.items()}

    @classmethod
    def _elsewhere(cls, key: Any) -> str:
        """', did you mean ...?' for the other parts of a scene that have the key, or nothing."""
        others = {part: models for part, models in PLACES.items() if cls not in models}
        found = [f"{part}.{key}" for part, models in others.items() if any(key in one.model_fields for one in models)]
        return f", did you mean {' or '.join(found)}?" if found else ""


#: The parts of a scene by their place in it, for keys that stand in another one; ``scene.scene`` names them.
PLACES: dict[str, tuple[type[Description], ...]] = {}


def packing_kinds() -> list[str]:
    """The kinds of packings."""
    return [one.model_fields["kind"].default for one in PLACES["packing"]]


def allowed(phrase: str) -> WrapValidator:
    """Say ``phrase`` whatever is wrong with a value, in place of one message per rule or union member."""

    def check(value: Any, inner: Callable[[Any], Any]) -> Any:
        must(not unordered(value), phrase)
        try:
            return inner(value)
        except (ValidationError, OverflowError):
            raise NotAllowed(phrase) from None

    return WrapValidator(check)


Finite = Annotated[float, Field(strict=True), allowed("must be a finite number")]
Vector = Annotated[tuple[Finite, Finite], allowed("must be two finite numbers [x, z]")]
Positive = Annotated[float, Field(strict=True, gt=0), allowed("must be a number greater than 0")]
NonNegative = Annotated[float, Field(strict=True, ge=0), allowed("must be a number, 0 or greater")]
#: A dimensionless parameter. The limit keeps products of parameters finite.
Ratio = Annotated[float, Field(strict=True, ge=0, le=1e6), allowed("must be a number from 0 to 1e6")]
MOST_STIFFNESS = 1e12
#: Beyond 1e12 an overlap of one disk weight is lost in the rounding of a position.
Stiffness = Annotated[
    float, Field(strict=True, gt=0, le=MOST_STIFFNESS), allowed("must be a number greater than 0, at most 1e12")
]
Fraction = Annotated[float, Field(strict=True, ge=0, lt=1), allowed("must be a number, 0 or greater and less than 1")]
Part = Annotated[float, Field(strict=True, gt=0, le=1), allowed("must be a number above 0, at most 1")]
Count = Annotated[int, Field(strict=True, ge=1), allowed("must be a whole number, 1 or greater")]
Index = Annotated[
    int, Field(strict=True, ge=0, lt=2**63), allowed("must be a whole number, 0 or greater and less than 2^63")
]
Flag = Annotated[bool, Field(strict=True), allowed("must be true or false")]
Sides = Annotated[Literal["walls", "periodic"], Field(description="Side walls, or periodic sides.")]

Overlaps = Annotated[
    Literal["kept", "removed"],
    Field(
        description="Overlaps of the given disks. kept: they are compressed contacts; removed: overlapping disks, as "
        "measured ones may be, are pushed apart before gravity acts."
    ),
]


class PackingDescription(Description):
    """What all descriptions of packings share."""

    @property
    def periodic(self) -> bool:
        """Whether the sides are periodic."""
        return getattr(self, "sides", "walls") == "periodic"

    @property
    def disk_count(self) -> int:
        """Number of disks; 0 where only a file knows it."""
        return 0
