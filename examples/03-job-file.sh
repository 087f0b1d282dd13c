#!/bin/sh
# A job kept in a file; the command line wins. Three resins in High Speed, one TIFF per resin and layer.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/03-job-file
here=$(dirname "$0")
"$voxtone" slice --job "$here/03-job.json" --size 12mm --quality draft --overwrite -o "$out"
"$voxtone" verify "$out"
