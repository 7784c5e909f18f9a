"""Parameters of what the paper says about its numerics; all by dynamics."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import Scene
from granular_response.scene.base import Count, Description, Positive, Ratio
from granular_response.scene.protocol import Integrator
from granular_response_paper.parameters import Checked, Checks, Coefficients, Positives, Several, over


class Damping(Description):
    """Relaxation under gravity, by velocity Verlet."""

    ratios: Positives
    time_step: Positive
    stop_kinetic_energy: Positive


class Swing(Checked):
    """What a run that has stopped would do next, with friction ``friction``."""

    steps: Count = Field(description="Time steps of the paper's size after the stop, about one slow oscillation.")
    read_every: Count = Field(description="Time steps between two readings.")

    def checks(self) -> Checks:
        yield "read_every", self.read_every <= self.steps, f"must be at most steps = {self.steps}"


class Disorder(Description):
    """Responses of disordered slabs whose runs stop early, and after a static finish of the same runs."""

    scene: Annotated[
        Scene, over(Scene(), "loads", "packing.realization", "protocol.method", "protocol.static_finish")
    ] = Scene()
    realizations: Count
    width: Positive = Field(description="w of the smoothing Gaussian, in radii.")
    reach: Positive = Field(description="Of the x axis, in radii.")
    spacing: Positive = Field(description="Of the x axis, in radii.")


class Parameters(Description):
    scene: Annotated[Scene, over(Scene(), "contact.friction", "loads")] = Scene()
    force: Positive = Field(description="In mean disk weights.")
    frictions: Coefficients = Field(description="Of stop_energies.")
    stop_energies: Positives = Field(description="Kinetic energies per disk at which the dynamics stops.")
    friction: Ratio = Field(description="Of what follows.")
    time_steps: Several[Positive] = Field(description="The first one is the paper's.")
    integrators: Several[Integrator]
    integrator_time_step: Positive
    damping: Damping
    swing: Swing
    disorder: Disorder
