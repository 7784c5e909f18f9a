#!/bin/bash
#SBATCH --job-name=sweep-dask
#SBATCH --ntasks=64
#SBATCH --time=01:00:00
# A sweep over 64 workers of Dask. Whoever reaches the port of a Dask scheduler or worker can run code as you: use it on
# a network of your own, or with certificates (distributed.Security). mpi.sh opens no port to others.
set -e
eval "$(python -m granular_response.machine.floating_point)"  # the same rounding on every node
file="$PWD/dask-$SLURM_JOB_ID.json"
trap 'kill $(jobs -p) 2>/dev/null || true; rm -f "$file"' EXIT
dask scheduler --port 0 --no-dashboard --scheduler-file "$file" &
until [ -e "$file" ]; do  # the job ends where the scheduler does not start, with its code
    kill -0 $! || { wait $!; exit 1; }
    sleep 1
done
srun dask worker --scheduler-file "$file" --nworkers 1 --nthreads 1 --no-dashboard &
python sweep.py --dask "$file"
