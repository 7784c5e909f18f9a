"""Runs blocks of the survey: python run.py BLOCK [BLOCK ...], all of them if none is named.

A block is one of ``params.yaml``, or a figure group with packings that ``../../extensions/params.yaml`` leaves to the
survey.

``--scheduler`` sends the tasks to a Dask cluster. What is finished is kept in ``.realizations.checkpoint``.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from granular_response.machine import floating_point

HERE = Path(__file__).resolve().parent


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("blocks", nargs="*", metavar="BLOCK")
    parser.add_argument("--workers", type=int, help="processes; all cores if not given")
    parser.add_argument("--scheduler", help="address of a Dask scheduler, whose workers run the tasks")
    parser.add_argument("--realizations", type=int, help="at most so many of each case of an ensemble")
    given = parser.parse_args()
    floating_point.pin()
    from granular_response.scene import SceneError
    from granular_response.store.files import StoreError
    from granular_response.sweeps.errors import SweepError
    from granular_response.sweeps.resources import using
    from granular_response_extensions.surveyed import block as packings
    from granular_response_extensions.surveyed import surveyed_groups
    from granular_response_paper.checkout import CheckoutError, unchanged
    from granular_response_paper.registry import GroupError, collections
    from granular_response_paper.survey.simulate import SurveyError, ensemble, read_parameters, run

    own, executor = HERE / "params.yaml", None
    if given.scheduler:
        from distributed import Client

        executor = Client(given.scheduler).get_executor()
    try:
        groups = surveyed_groups()
        for name in given.blocks or [*read_parameters(own).blocks, *groups]:
            if name in groups:
                block = packings(name, HERE.parents[1] / "extensions" / "params.yaml")
            else:
                block = ensemble(name, own, given.realizations)
            with using(executor=executor), unchanged(collections()[-1], HERE):
                print(f"\n{run(block, HERE, workers=given.workers, progress=progress)}")
    except (CheckoutError, GroupError, SceneError, StoreError, SurveyError, SweepError) as error:
        sys.exit(f"error: {error}")


def progress(done: float, total: float, what: str = "", /) -> None:
    print(f"\r{what}: {done:g} of {total:g}", end="", flush=True)


if __name__ == "__main__":
    main()
