"""Parameters of the contact law, between disks and between disks and walls."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, NamedTuple

from pydantic import BeforeValidator, Field, SerializeAsAny, ValidationInfo, field_validator

from .base import Description, Ratio, Stiffness
from .errors import NotAllowed, suggestion


class NoParameters(Description):
    """A contact law without parameters of its own."""


class KnownLaw(NamedTuple):
    """What scenes know of a contact law."""

    parameters: type[Description] = NoParameters  #: of its own
    law: type | None = None  #: of a law from outside the package, its class


#: Contact laws by the name that a scene file has for them; those of the package are in ``contact.LAWS``.
KNOWN_LAWS = {"linear": KnownLaw(), "hertz": KnownLaw()}


def _check_law(value: Any) -> Any:
    if not isinstance(value, str) or value not in KNOWN_LAWS:
        own = ", or a law of gr.register_law whose module is imported (--import MODULE)"
        raise NotAllowed(f"must be {' or '.join(KNOWN_LAWS)}{own}{suggestion(value, KNOWN_LAWS)}")
    return value


_SPARSE = ("rolling_friction", "rolling_stiffness_ratio", "parameters")


class Contact(Description):
    """Spring and dashpot along the normal, spring and dashpot with a limit along the tangent and along the rolling.

    Sec. III.A and III.B of the paper, with its values as defaults. Reduced units: stiffness in mg
    per mean radius. The damping coefficients are absolute: they do not depend on the masses of
    the two bodies, and ``damping_ratio`` 0.5 gives the paper's ``sqrt(k)``.

    Examples
    --------
    >>> gr.Contact(friction=0.5, normal_stiffness=1000.0).tangential_stiffness
    800.0
    """

    sparse: ClassVar[tuple[str, ...]] = _SPARSE

    law: Annotated[str, BeforeValidator(_check_law)] = Field(
        default="linear",
        description="linear: normal force proportional to the overlap, as in the paper; hertz: to its power 3/2, with "
        "normal_stiffness as the stiffness at a normal force of mg between two mean disks, or a mean disk and the "
        "wall. The walls follow the same law.",
    )
    normal_stiffness: Stiffness = Field(default=3000.0, description="k_N, stiffness of the normal spring.")
    stiffness_ratio: Ratio = Field(default=0.8, description="k_T / k_N, tangential over normal stiffness.")
    friction: Ratio = Field(default=0.2, description="Coefficient of friction, static and dynamic.")
    damping_ratio: Ratio = Field(
        default=0.5, description="Damping over critical damping 2 sqrt(k) of one contact, for both dashpots."
    )
    rolling_friction: Ratio = Field(
        default=0.0,
        description="Coefficient of rolling friction, for rolling resistance; needs friction and a "
        "rolling_stiffness_ratio.",
    )
    rolling_stiffness_ratio: Ratio = Field(default=0.0, description="k_R / k_N, rolling over normal stiffness.")
    parameters: SerializeAsAny[Description] = Field(
        default=NoParameters(), validate_default=True, description="Parameters of a user-defined law, by name."
    )

    @field_validator("parameters", mode="plain")
    @classmethod
    def _check_parameters(cls, value: Any, info: ValidationInfo) -> Description:
        if "law" not in info.data:  # it was refused, and nobody knows its parameters
            return NoParameters()
        known = KNOWN_LAWS[info.data["law"]]
        return known.parameters.model_validate(value.model_dump() if isinstance(value, Description) else value)

    def __getstate__(self) -> dict[Any, Any]:
        """With the class of the law: its module, which registers it, is imported where this is unpickled."""
        return {**super().__getstate__(), "law": KNOWN_LAWS[self.law].law}

    @property
    def rolls(self) -> bool:
        """Whether there is a rolling resistance."""
        return self.rolling_friction > 0

    @property
    def rolling_stiffness(self) -> float:
        """k_R."""
        return self.rolling_stiffness_ratio * self.normal_stiffness

    @property
    def rolling_damping(self) -> float:
        """Coefficient nu_R of the rolling dashpot."""
        return 2.0 * self.damping_ratio * math.sqrt(self.rolling_stiffness)

    @property
    def rubs(self) -> bool:
        """Whether there are forces along the tangent: friction, and a spring that carries it."""
        return self.friction > 0 and self.stiffness_ratio > 0

    @property
    def tangential_stiffness(self) -> float:
        """k_T."""
        return self.stiffness_ratio * self.normal_stiffness

    @property
    def normal_damping(self) -> float:
        """Coefficient nu_N of the normal dashpot."""
        return 2.0 * self.damping_ratio * math.sqrt(self.normal_stiffness)

    @property
    def tangential_damping(self) -> float:
        """Coefficient nu_T of the tangential dashpot."""
        return 2.0 * self.damping_ratio * math.sqrt(self.tangential_stiffness)


class Wall(Description):
    """The contact law at the floor and the side walls; what is null follows the contacts between disks.

    Examples
    --------
    >>> gr.Scene(wall=gr.Wall(friction=0.3)).resolved_wall.normal_stiffness  # twice that between disks
    6000.0
    """

    sparse: ClassVar[tuple[str, ...]] = _SPARSE

    normal_stiffness: Stiffness | None = Field(
        default=None, description="Stiffness of the normal spring; null: twice contact.normal_stiffness."
    )
    stiffness_ratio: Ratio | None = Field(
        default=None, description="Tangential over normal stiffness; null: as contact."
    )
    friction: Ratio = Field(default=0.0, description="Coefficient of friction at floor and side walls.")
    damping_ratio: Ratio | None = Field(default=None, description="Damping over critical damping; null: as contact.")
    rolling_friction: Ratio = Field(default=0.0, description="Coefficient of rolling friction at floor and side walls.")
    rolling_stiffness_ratio: Ratio | None = Field(
        default=None, description="Rolling over normal stiffness; null: as contact."
    )

    def resolved(self, contact: Contact) -> Contact:
        """The parameters of disk-wall contacts beside disk-disk contacts with ``contact``."""
        own = {name: value for name, value in self if value is not None}
        return Contact(**{**dict(contact), "normal_stiffness": 2.0 * contact.normal_stiffness, **own})
