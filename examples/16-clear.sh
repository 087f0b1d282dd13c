#!/bin/sh
# Clear resin: a coat over a cow, a cow of jelly (the material's alpha), a picture in the middle of a clear slab, and a
# lithophane, a picture that is seen by light from behind it. All as they will look; the jelly by light from behind too,
# the lithophane by day, on black.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/16-clear
here=$(dirname "$0")
picture=$here/models/spot/spot_texture.png
mkdir -p "$out"
slice() { "$voxtone" slice "$@" --no-report --quality draft --overwrite; }
slice "$here/models/spot/spot.obj" --size 6mm --rotate x90,z180 --coat 0.3mm -o "$out/coated"
"$voxtone" proof "$out/coated" --spp 4 --size 160x120 --overwrite -o "$out/coated.png"
sed 's/^mtllib .*/mtllib jelly.mtl/' "$here/models/spot/spot.obj" > "$out/jelly.obj"
printf 'newmtl initialShadingGroup\nd 0.3\nmap_Kd spot_texture.png\n' > "$out/jelly.mtl"
cp "$picture" "$out"
slice "$out/jelly.obj" --size 6mm --rotate x90,z180 --alpha translucency -o "$out/jelly"
"$voxtone" proof "$out/jelly" --spp 4 --size 160x120 --light studio --light behind --overwrite -o "$out/jelly.png"
slice "$picture" --width 4mm --thickness 1mm --enclose 0.5mm -o "$out/enclosed"
"$voxtone" predict "$out/enclosed" --cell 0.17mm --overwrite -o "$out/enclosed.png"
slice "$picture" --width 4mm --thickness 3mm --view through -o "$out/lithophane"
"$voxtone" predict "$out/lithophane" --cell 0.17mm --overwrite -o "$out/by-night.png"
"$voxtone" predict "$out/lithophane" --cell 0.17mm --backing black --overwrite -o "$out/by-day.png"
