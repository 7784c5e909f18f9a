#!/bin/bash
#SBATCH --job-name=sweep-part
#SBATCH --array=0-9
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=16
#SBATCH --time=01:00:00
# Ten jobs, each with a tenth of the sweep. They share the folder "kept"; node.sh then makes one dataset of it.
set -e
eval "$(python -m granular_response.machine.floating_point)"  # the same rounding on every node
srun --cpus-per-task="$SLURM_CPUS_PER_TASK" python sweep.py --part
