#!/bin/sh
# A card with a text, a code and a picture on it, told by the job's name; then copies that are numbered.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/14-labels
here=$(dirname "$0")
"$voxtone" slice "$here/models/card.obj" --iterations 0 --overwrite -o "$out/card" \
    --label '{part} 17; place=top; at=-4,4' --label 'datamatrix={job}-17; size=6mm; place=top; at=-5,-2' \
    --decal "$here/models/spot/spot_texture.png; place=top; size=7mm; at=4,0; turn=15"
"$voxtone" verify "$out/card"
"$voxtone" tray "$here/14-labels.csv" --iterations 0 --predict none --overwrite -o "$out/tray"
