#!/bin/sh
# Prints in which the wanted thing is how light spreads, not colour alone (Hasan et al. 2010): five slabs of one albedo and rising width, and
# a heterogeneous marble on a mesh. Resins: white, black, clear.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/08-layered-profiles
here=$(dirname "$0")
resins="--resins vero-opaque-clear"

# 1. Five targets, from how 4 mm of white spread light to how a thin white upon clear does; all scaled to one albedo.
"$voxtone" laminate targets "W 4" "W 0.2, T 0.8, W 3" $resins --count 5 --reach 15mm --paths 32768 --overwrite -o "$out/targets"

# 2. For each the layers that show it. More --paths and --rounds are better and slower.
"$voxtone" laminate search "$out"/targets/target-?.json --materials W,K,T $resins --thickness 4mm --edge-weights --clear-top T=0.1mm --layer 27um \
    --reach 15mm --rounds 1 --paths 8192 --overwrite -o "$out/found"

# 3. All five side by side, on 1 mm of black, ready to print; and what light does in one of them.
"$voxtone" laminate print "$out"/found/target-?.laminate.json --base K=1mm --overwrite -o "$out/slabs"
"$voxtone" verify "$out/slabs"
"$voxtone" laminate predict "$out/found/target-5.laminate.json" --check --paths 8192 --coefficients 64 --reach 15mm --overwrite -o "$out/widest.svg"

# 4. Marble: a data set of a heterogeneous slab (here traced; it may be measured), factored into four profiles and a map of them.
"$voxtone" laminate dataset marble --points 32 --paths 300 --overwrite -o "$out/marble.bssrdf"
"$voxtone" laminate factor "$out/marble.bssrdf" --clusters 4 --overwrite -o "$out/marble.json"

# 5. The marble wrapped around a mesh, as layers under each point of its surface. The laminates are by the layered model alone
# (--laminate-rounds 0): leave that out to have them corrected, in a second for each cluster.
"$voxtone" slice "$here/models/spot/spot.obj" --size 30mm --rotate x90,z180 --show layered-profile --profiles "$out/marble.json" \
    --profile-placement box $resins --load W,K,T --dc-weight 10 --laminate-thickness 2mm --laminate-rounds 0 --overwrite -o "$out/marble"
"$voxtone" verify "$out/marble"
