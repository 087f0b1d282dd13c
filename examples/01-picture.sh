#!/bin/sh
# A picture as a flat print: 6 mm wide, 2 mm thick, then checked as the printer's software would check it.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/01-picture
here=$(dirname "$0")
"$voxtone" slice "$here/models/spot/spot_texture.png" --width 6mm --thickness 2mm --overwrite -o "$out"
"$voxtone" verify "$out"
