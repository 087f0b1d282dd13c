#!/bin/sh
# From a printed target to the printer's own resins, rehearsed without a printer: makes a target, draws two photographs of
# it as if it had been printed with resins that nobody told the fit (07-resins.json), measures them, recovers the resins,
# compares what they predict with the truth, and slices with them.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/07-calibrate
here=$(dirname "$0")
mkdir -p "$out"

# 1. The target: print it (layers or stack.gcvf) and photograph it beside a ColorChecker on a black sheet.
"$voxtone" calibrate target --printer stratasys-j750-hm --resins C,M,Y,K,W --layout B --gcvf --overwrite -o "$out/target"
"$voxtone" verify "$out/target"

# 2. The photographs, here drawn, and small: the second from another side and in other light.
camera="--width 1500 --height 1000"
"$voxtone" calibrate simulate "$out/target/target.json" --resins "$here/07-resins.json" $camera --overwrite \
    --truth "$out/truth.csv" -o "$out/photo-1.tif"
"$voxtone" calibrate simulate "$out/target/target.json" --resins "$here/07-resins.json" $camera --overwrite \
    --tilt-x 8 --turn 20 --lamp 1500 --lamp-azimuth 200 --vignetting 0.25 --exposure 0.8 --dust 150 --scratches 12 --seed 2 -o "$out/photo-2.tif"

# 3. What the squares reflect; look at patches-overlay.png to see what was sampled. straight.png is the target alone.
"$voxtone" calibrate photo "$out/photo-1.tif" "$out/photo-2.tif" --target "$out/target/target.json" \
    --picture "$out/straight.png" --overwrite -o "$out/patches.csv"

# 4. The resins, with a page to look at, and how well they predict what the squares truly reflect. Mixtures are dithers of the printer's voxels.
"$voxtone" calibrate fit "$out/patches.csv" --printer stratasys-j750-hm --name recovered --overwrite -o "$out/resins.json" \
    --report "$out/resins.html" --target "$out/target/target.json" --picture "$out/straight.png"
"$voxtone" calibrate check "$out/resins.json" "$out/truth.csv" --printer stratasys-j750-hm

# 5. Slicing with them.
"$voxtone" slice "$here/models/spot/spot_texture.png" --resins "$out/resins.json" --width 5mm --thickness 2mm \
    --no-report --iterations 0 --overwrite -o "$out/print"
"$voxtone" verify "$out/print"
