#!/bin/sh
# A textured mesh as a GCVF container, mirrored along x for a printer that would mirror it back.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/02-mesh-to-gcvf
here=$(dirname "$0")
"$voxtone" slice "$here/models/spot/spot.obj" --size 15mm --flip-x --formats png,gcvf --quality draft --overwrite -o "$out"
"$voxtone" verify "$out"
"$voxtone" verify "$out"/*.gcvf
