#!/bin/sh
# Several prints at once, from a table. The same command again does what is left: nothing here.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/09-batch
here=$(dirname "$0")
"$voxtone" batch "$here/09-plan.csv" --preset "$here/09-preset.json" --name '{name}-{size}' -o "$out"
"$voxtone" batch "$here/09-plan.csv" --preset "$here/09-preset.json" --name '{name}-{size}' -o "$out" --quiet
"$voxtone" status "$out"
for stack in "$out"/cow*; do "$voxtone" verify "$stack"; done
# The commands themselves, for whatever else is to run them.
"$voxtone" batch "$here/09-plan.csv" --preset "$here/09-preset.json" --name '{name}-{size}' -o "$out" --print-commands
