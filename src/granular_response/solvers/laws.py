"""Contact laws by their names, those from outside the package too, and those of a scene."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np

from ..contact import LAWS, Law, without_friction
from ..contact.consistent import contradiction
from ..contact.rolling import FREE, Rolling
from ..errors import GranularError, require
from ..machine.machine_code import tell_apart
from ..scene import Contact, Scene, SceneError
from ..scene.base import Description
from ..scene.material import KNOWN_LAWS, KnownLaw, NoParameters

#: What a law must have: the constants and the methods of the protocol.
FIELDS = tuple(name for name, part in vars(Law).items() if isinstance(part, property))
METHODS = tuple(name for name in vars(Law) if name not in FIELDS and not name.startswith("_"))

#: Reduced radius of two disks of mean radius, and of one at a wall.
DISKS, AT_WALL = 0.5, 1.0


class LawError(GranularError, ValueError):
    """A contact law that cannot be registered. The message is one line."""


def register_law(name: str, law: type[Law], parameters: type[Description] = NoParameters) -> None:
    """Let scenes name a contact law of one's own: ``contact.law: NAME``, with ``contact.parameters`` of its own.

    Registered where its module is imported, it is known wherever scenes with it are unpickled, in the processes of a
    sweep too.

    Parameters
    ----------
    name : what scene files call it.
    law : a named tuple in a module that can be imported, with the fields and methods of ``contact.law.Law``. Its ``of``
        takes its parameters by name after the constants that all laws have. A law with a text ``only_motion`` is
        solved by dynamics to the end, for that reason.
    parameters : a description of its parameters, each with a default and a meaning; unit and what is allowed are those
        of the fields. ``granular-response keys`` lists them.

    Raises
    ------
    LawError
        When another law has the name, the law lacks something or cannot be compiled, or its energy, force and stiffness
        are not derivatives of each other. They are compared again with the parameters of each scene.

    Examples
    --------
    >>> gr.register_law("cohesive", Cohesive, Cohesion)  # doctest: +SKIP
    >>> gr.Scene().updated({"contact.law": "cohesive", "contact.parameters": {"strength": 0.2}})  # doctest: +SKIP
    """
    rule = f"name = {name!r}: must be letters, digits and underscores"
    require(isinstance(name, str) and name.isidentifier(), rule, LawError)
    if name in KNOWN_LAWS and law_class(name) is not law:
        raise LawError(f"name = {name!r}: is the name of another law, {law_class(name).__qualname__}")
    lacks = [] if isinstance(law, type) else ["class"]
    lacks += [part for part in FIELDS if part not in getattr(law, "_fields", ())]
    lacks += [part for part in METHODS if not callable(getattr(law, part, None))]
    rule = f"law = {law!r}: has no {', '.join(lacks)}; must be a named tuple with the parts of a law"
    require(not lacks, rule, LawError)
    rule = f"parameters = {parameters!r}: must be a subclass of granular_response.scene.base.Description"
    require(isinstance(parameters, type) and issubclass(parameters, Description), rule, LawError)
    tell_apart(law)
    try:
        made = law.of(3000.0, 50.0, 2400.0, 50.0, 0.2, -math.inf, 0.5, **parameters().model_dump())
    except (SceneError, TypeError) as error:
        raise LawError(
            f"law = {law.__qualname__}: {error}; parameters must have defaults, and of() take them"
        ) from None
    require(isinstance(made, law), f"law = {law.__qualname__}: of() gave {made!r}, must give the law", LawError)
    try:
        said = contradiction(made)
    except Exception as error:  # of the compiler, which says first what it tried
        plain = re.sub(r"\x1b\[\d+m", "", str(error))
        cause = re.search(r"Error: (?:Failed in .*\n)?(.*(?:\n.* signature: .*)*)", plain)
        raise LawError(
            f"law = {law.__qualname__}: cannot be compiled, must be arithmetic and functions of machine/lanes.py: "
            + " ".join((cause[1] if cause else plain).split())
        ) from error
    if said:
        raise LawError(f"law = {law.__qualname__}: {said}")
    KNOWN_LAWS[name] = KnownLaw(parameters, law)


def check_parameters(name: str, *laws: Law) -> None:
    """Raise SceneError where laws from outside, made with the parameters of a scene, contradict themselves."""
    for law in laws if KNOWN_LAWS[name].law is not None else ():
        if said := contradiction(law):
            raise SceneError(f"contact.parameters: with these of law {name} {said}")


def law_class(name: str) -> type[Law]:
    """The class of the contact law that a scene names."""
    return KNOWN_LAWS[name].law or LAWS[name]


def laws_of(scene: Scene) -> tuple[tuple[Any, Any], ...]:
    """Between disks and at walls: the laws of a scene, then their rolling resistance where one of them has any."""
    least = -np.inf if scene.protocol.tensile_dashpot else 0.0

    def law(m: Contact, reduced_radius: float) -> Law:
        whole = law_class(scene.contact.law).of(
            m.normal_stiffness, m.normal_damping, m.tangential_stiffness, m.tangential_damping,
            m.friction, least, reduced_radius, **m.parameters.model_dump(),
        )  # fmt: skip
        return whole if m.rubs else without_friction(whole)

    pair, wall = law(scene.contact, DISKS), law(scene.resolved_wall, AT_WALL)
    check_parameters(scene.contact.law, pair, wall)
    kinds = scene.contact, scene.resolved_wall
    if not any(m.rolls for m in kinds):
        return ((pair, wall),)
    rolling = [Rolling(m.rolling_stiffness, m.rolling_damping, m.rolling_friction) if m.rolls else FREE for m in kinds]
    return (pair, wall), (rolling[0], rolling[1])
