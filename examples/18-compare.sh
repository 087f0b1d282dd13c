#!/bin/sh
# From prints to a better set of resins, rehearsed without a printer: two pictures are sliced, "printed" with resins that nobody
# told the prediction (18-resins.json: magenta and cyan of another strength, a yellower white), photographed by light paths
# through a tilted camera, and compared; what they say of the resins makes a better set.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/18-compare
here=$(dirname "$0")
mkdir -p "$out"
camera="--no-checker --matrix 0 --white-balance 0.9,1,0.8 --dust 0 --scratches 0 --width 900 --height 700 --tilt-x 10 --sheet 0.12 --margin 0.12 --exposure 0.8"

# 1. What is printed: flat, with many colours.
slice() { "$voxtone" slice "$1" --width 8mm --thickness 1.5mm --iterations 0 --predict none --no-report --overwrite -o "$2"; }
slice "$here/18-colours-1.png" "$out/one"
slice "$here/18-colours-2.png" "$out/two"

# 2. Photographs, here drawn; yours lie on grey card, tilted at will.
for print in one two; do
    "$voxtone" calibrate simulate "$out/$print" --resins "$here/18-resins.json" $camera --overwrite -o "$out/$print.tif"
done

# 3. Each against what it was predicted to look like: open one-compared/compare.html. Its regions are kept.
for print in one two; do
    "$voxtone" compare "$out/$print.tif" "$out/$print" --coding linear --refit --overwrite -o "$out/$print-compared"
done

# 4. The better set, and the same photograph compared with what that predicts.
"$voxtone" calibrate fit "$out/one-compared/regions.json" "$out/two-compared/regions.json" --prior j750-vivid \
    --overwrite -o "$out/better.json"
"$voxtone" compare "$out/one.tif" "$out/one" --coding linear --resins "$out/better.json" --overwrite -o "$out/again"
