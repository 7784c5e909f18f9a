#!/bin/bash
#SBATCH --job-name=sweep-mpi
#SBATCH --ntasks=65
#SBATCH --time=01:00:00
# A sweep over 64 ranks of MPI and one that hands out the work. Needs mpi4py.
set -e
eval "$(python -m granular_response.machine.floating_point)"  # the same rounding on every node
srun python -m mpi4py.futures sweep.py --mpi
