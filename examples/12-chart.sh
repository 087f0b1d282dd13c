#!/bin/sh
# From a printed chart of mixtures to the printer's own resins, rehearsed without a printer: prints a chart, fills its form as a
# spectrophotometer would have if it had been printed with inks that nobody told the fit (12-inks.json: more saturated than sRGB
# can say, droplets that run together), fits, checks with mixtures that took no part, and slices with the result.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/12-chart
here=$(dirname "$0")
mkdir -p "$out"

# 1. The chart: print its layers, polish it.
"$voxtone" calibrate chart --printer stratasys-j750-hm --resins C,M,Y,K,W --patches 60 --overwrite -o "$out/chart"
"$voxtone" verify "$out/chart"

# 2. Measured, here drawn: chart/chart.csv with L, a, b filled in, and a second chart of other mixtures to check with, which
#    is not printed.
"$voxtone" calibrate simulate "$out/chart/target.json" --resins "$here/12-inks.json" --overwrite -o "$out/measured.csv"
"$voxtone" calibrate chart --printer stratasys-j750-hm --resins C,M,Y,K,W --patches 90 --square 2mm --quiet --overwrite -o "$out/others"
"$voxtone" calibrate simulate "$out/others/target.json" --resins "$here/12-inks.json" --lab-noise 0 --overwrite -o "$out/others.csv"

# 3. The resins and their channels, with a page to look at, judged on the other chart.
"$voxtone" calibrate fit "$out/measured.csv" --name inks --overwrite -o "$out/inks.json" --report "$out/inks.html" --check "$out/others.csv"
"$voxtone" calibrate check "$out/inks.json" "$out/others.csv"

# 4. Slicing with them.
"$voxtone" slice "$here/models/spot/spot_texture.png" --resins "$out/inks.json" --width 3mm --thickness 2mm --iterations 2 --overwrite -o "$out/print"
"$voxtone" verify "$out/print"
