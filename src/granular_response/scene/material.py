"""Parameters of the contact law, between disks and between disks and walls."""

from __future__ import annotations

import math
from typing import Literal

from pydantic import Field

from .base import Description, Ratio, Stiffness


class Contact(Description):
    """Spring and dashpot along the normal, spring and dashpot with a Coulomb limit along the tangent.

    Sec. III.A and III.B of the paper, with its values as defaults. Reduced units: stiffness in mean disk
    weights per mean radius. The damping coefficients are absolute: they do not depend on the masses of
    the two bodies, and ``damping_ratio`` 0.5 gives the paper's ``sqrt(k)``.

    Examples
    --------
    >>> gr.Contact(friction=0.5, normal_stiffness=1000.0).tangential_stiffness
    800.0
    """

    law: Literal["linear", "hertz"] = Field(
        default="linear",
        description="linear: normal force in proportion to the overlap, as in the paper; hertz: normal force by the "
        "power 3/2 of the overlap, with normal_stiffness as its stiffness at a normal force of one mean disk weight "
        "between two mean disks, or a mean disk and the wall. The walls follow the same law.",
    )
    normal_stiffness: Stiffness = Field(
        default=3000.0,
        description="Stiffness k_N of the normal spring, in mean disk weights per mean radius.",
    )
    stiffness_ratio: Ratio = Field(
        default=0.8, description="k_T / k_N, stiffness of the tangential spring over that of the normal one."
    )
    friction: Ratio = Field(
        default=0.2, description="Coefficient of friction, the same for a sticking and a sliding contact."
    )
    damping_ratio: Ratio = Field(
        default=0.5,
        description="Damping over critical damping 2 sqrt(k) of one contact, for both dashpots, "
        "each with the stiffness of its own spring.",
    )

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

    normal_stiffness: Stiffness | None = Field(
        default=None, description="Stiffness of the normal spring; null means twice contact.normal_stiffness."
    )
    stiffness_ratio: Ratio | None = Field(
        default=None, description="Tangential over normal stiffness; null means contact.stiffness_ratio."
    )
    friction: Ratio = Field(
        default=0.0, description="Coefficient of friction between a disk and the floor or a side wall."
    )
    damping_ratio: Ratio | None = Field(
        default=None, description="Damping over critical damping; null means contact.damping_ratio."
    )

    def resolved(self, contact: Contact) -> Contact:
        """The parameters of disk-wall contacts beside disk-disk contacts with ``contact``."""

        def either(own: float | None, otherwise: float) -> float:
            return otherwise if own is None else own

        return Contact(
            law=contact.law,
            normal_stiffness=either(self.normal_stiffness, 2.0 * contact.normal_stiffness),
            stiffness_ratio=either(self.stiffness_ratio, contact.stiffness_ratio),
            friction=self.friction,
            damping_ratio=either(self.damping_ratio, contact.damping_ratio),
        )
