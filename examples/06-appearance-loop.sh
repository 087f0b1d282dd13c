#!/bin/sh
# The same small slab without and with the appearance loop, once for colour and once for contrast. Open the reports side by side:
# out/06-appearance-loop/*/report.html.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/06-appearance-loop
here=$(dirname "$0")
slab="$here/models/spot/spot_texture.png --width 3mm --thickness 2mm --overwrite --predict none"
"$voxtone" slice $slab --iterations 0 -o "$out/open"
"$voxtone" slice $slab --iterations 6 -o "$out/loop"
"$voxtone" slice $slab --iterations 6 --intent contrast -o "$out/contrast"
"$voxtone" verify "$out/loop"
