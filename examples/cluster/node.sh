#!/bin/bash
#SBATCH --job-name=sweep
#SBATCH --nodes=1
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=32
#SBATCH --time=04:00:00
# A sweep on all cores of one node. What is in the folder "kept" is not solved again.
set -e
eval "$(python -m granular_response.machine.floating_point)"  # the same rounding on every node
srun --cpus-per-task="$SLURM_CPUS_PER_TASK" python sweep.py
