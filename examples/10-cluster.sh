#!/bin/sh
# A batch on a cluster: the same plan as 09-batch.sh, handed to Slurm, two shards of the layers for each job. Where no Slurm
# answers the scripts are printed and nothing is handed over; OUT must lie on a disk that the nodes share.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/10-cluster
here=$(dirname "$0")
run() { "$voxtone" batch "$here/09-plan.csv" --preset "$here/09-preset.json" --name '{name}-{size}' -o "$out" --slurm --shards 2 --threads 2 "$@"; }

if ! scontrol show config >/dev/null 2>&1; then
    echo "no Slurm answers here, so this is what it would be given:"
    run --dry-run
    exit 0
fi
run --dry-run
run
while squeue --noheader --name=voxtone:last --user="$(id -un)" | grep -q .; do sleep 2; done
"$voxtone" status "$out"
for stack in "$out"/cow*; do "$voxtone" verify "$stack"; done
