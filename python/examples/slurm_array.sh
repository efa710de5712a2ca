#!/usr/bin/env bash
#SBATCH --job-name=aquafuse
#SBATCH --array=1-16
#SBATCH --cpus-per-task=4
#SBATCH --time=02:00:00
#SBATCH --requeue
# A dataset multiplied by the tasks of a SLURM array, one part each; a task that is queued again continues.
#
#   sbatch slurm_array.sh DATASET OUTPUT WATERS...
#
# DATASET and OUTPUT lie on storage that all nodes share. Afterwards the last line, without --shard, joins the lists:
#
#   aquafuse augment DATASET WATERS... -o OUTPUT --per-image 2 --seed 7
set -euo pipefail
dataset=$1 output=$2
shift 2
aquafuse augment "$dataset" "$@" -o "$output" --per-image 2 --seed 7 \
  --threads "${SLURM_CPUS_PER_TASK:-1}" --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT"
