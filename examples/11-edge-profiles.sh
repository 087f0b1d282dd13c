#!/bin/sh
# Resins from edge profiles, rehearsed without a bench: what has to be printed, the profiles that slabs of known resins would
# give on a bench that is not quite what setup.json says (a factor of 0.913 on all values, slabs 2 % too thick, other gel),
# the resins that are found in them, with a chart for their dark channels, and a slice with these.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/11-edge-profiles
here=$(dirname "$0")
mkdir -p "$out"

# 1. What is measured: slabs of every resin, and the sheet with the edges.
"$voxtone" calibrate edge samples --resins C,M,Y,K,W --allowance 0.05mm --overwrite -o "$out/slabs"

# 2. The profiles, here rendered (few paths: noisier than a photograph), by a renderer that the fit does not use.
cat > "$out/bench.json" <<END
{"format": "voxtone-edge-setup", "version": 1, "gel": {"above_mm": 0.045, "below_mm": 0.015}, "camera": {"blur_mm": 0.0276}}
END
"$voxtone" calibrate edge simulate --resins vero-opaque --setup "$out/bench.json" --bias 0.913 --thickness-off 0.02 \
    --paths 32768 --overwrite -o "$out/profiles.csv"

# 3. A chart of all equal mixtures, printed and photographed, for what edges do not tell (cyan in red, yellow in blue).
"$voxtone" calibrate edge chart --printer stratasys-j750-hm --resins C,M,Y,K,W --resin-set vero-opaque --overwrite -o "$out/chart"
"$voxtone" calibrate simulate "$out/chart/target.json" --resins vero-opaque --overwrite -o "$out/chart.tif"
"$voxtone" calibrate photo "$out/chart.tif" --target "$out/chart/target.json" --overwrite -o "$out/patches.csv"

# 4. The resins, with what is known of the bench. More --paths, or a dictionary, for less noise; look at resins.html.
cat > "$out/setup.json" <<END
{"format": "voxtone-edge-setup", "version": 1, "camera": {"blur_mm": 0.0276, "level_error": 0.01}}
END
"$voxtone" calibrate edge fit "$out/profiles.csv" --setup "$out/setup.json" --paths 16384 --report "$out/resins.html" \
    --chart "$out/patches.csv" --printer stratasys-j750-hm --overwrite -o "$out/resins.json"

# 5. Slicing with them.
"$voxtone" slice "$here/models/spot/spot_texture.png" --resins "$out/resins.json" --width 5mm --thickness 2mm \
    --no-report --iterations 0 --overwrite -o "$out/print"
"$voxtone" verify "$out/print"
