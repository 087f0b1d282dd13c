#!/bin/sh
# Resins from edge profiles, rehearsed without a bench: what has to be printed, the photographs that a bench would take of
# slabs of known resins (and it is not quite the bench that setup.json says: a factor of 0.913 on all values, slabs 2 % too
# thick, gel between 10 and 50 um, uneven light, the sheet turned by 2 degrees, a blurred and noisy camera), the profiles in
# these photographs, the resins that are found in them, and a slice with these. RESINS=C,K,W does with fewer, PATHS=4096 with
# more noise, in less time.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/11-edge-profiles
resins=${RESINS:-C,M,Y,K,W} paths=${PATHS:-32768}
here=$(dirname "$0")
mkdir -p "$out"

# 1. What is measured: slabs of every resin, and the sheet with the edges.
"$voxtone" calibrate edge samples --resins "$resins" --allowance 0.05mm --overwrite -o "$out/slabs"

# 2. The photographs, here rendered (small, and with few light paths: noisier than a camera): a colour checker, white paper,
#    the bare sheet, and two of each slab, with their list.
cat > "$out/bench.json" <<END
{"format": "voxtone-edge-setup", "version": 1, "camera": {"pitch_mm": 0.08, "blur_mm": 0.08, "level_error": 0.01}}
END
"$voxtone" calibrate edge simulate --resins vero-opaque --roles "$resins" --setup "$out/bench.json" --bias 0.913 \
    --thickness-off 0.02 --gel 0.01,0.05 --paths "$paths" --field 96,72 --photos "$out/photographs" --overwrite

# 3. The profiles, and what the photographs say of sheet and camera; look at the pictures in profiles-overlays.
"$voxtone" calibrate edge photo "$out/photographs/photographs.csv" --write-setup "$out/setup.json" \
    --overwrite -o "$out/profiles.csv"

# 4. A chart of all equal mixtures, printed and photographed, for what edges do not tell (cyan in red, yellow in blue).
"$voxtone" calibrate edge chart --printer stratasys-j750-hm --resins "$resins" --resin-set vero-opaque --overwrite -o "$out/chart"
"$voxtone" calibrate simulate "$out/chart/target.json" --resins vero-opaque --width 1500 --height 1000 --overwrite \
    -o "$out/chart.tif"
"$voxtone" calibrate photo "$out/chart.tif" --target "$out/chart/target.json" --overwrite -o "$out/patches.csv"

# 5. The resins. More --paths, or a dictionary, for less noise; look at resins.html.
"$voxtone" calibrate edge fit "$out/profiles.csv" --setup "$out/setup.json" --paths $((paths / 2)) --report "$out/resins.html" \
    --chart "$out/patches.csv" --printer stratasys-j750-hm --overwrite -o "$out/resins.json"

# 6. Slicing with them.
"$voxtone" slice "$here/models/spot/spot_texture.png" --resins "$out/resins.json" --width 5mm --thickness 2mm \
    --no-report --iterations 0 --overwrite -o "$out/print"
"$voxtone" verify "$out/print"
