#!/bin/sh
# What a print will look like before it is printed: a small slab as a picture (PNG for the eye, EXR for numbers) and a
# small body as a mesh with vertex colours; the slab once more by following light paths; last its layers as anybody's
# stack of PNG files.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/05-predict
here=$(dirname "$0")
mkdir -p "$out"
"$voxtone" slice "$here/models/spot/spot_texture.png" --width 5mm --thickness 2mm --no-report --quality draft --overwrite -o "$out/slab"
"$voxtone" predict "$out/slab" --overwrite --cell 0.17mm -o "$out/slab.png" -o "$out/slab.exr"
"$voxtone" slice "$here/models/spot/spot.obj" --size 6mm --rotate x90,z180 --no-report --quality draft --overwrite -o "$out/cow"
"$voxtone" predict "$out/cow" --overwrite --cell 0.25mm -o "$out/cow.glb" -o "$out/cow.ply" -o "$out/cow.png"
"$voxtone" predict "$out/slab" --overwrite --predict monte-carlo --spp 16 --cell 0.17mm -o "$out/slab-reference.exr"
"$voxtone" predict "$out/slab/layers" --overwrite --printer stratasys-j750-hm \
    --assign "#0096c8=C,#cd196e=M,#fad71e=Y,#1e1e1e=K,#dcded8=W" --cell 0.25mm -o "$out/foreign.png"
