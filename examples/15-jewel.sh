#!/bin/sh
# A jewel in a clear block: a model of one resin, and another in its middle that has the voxels where both are (its priority is higher). A picture of
# the print shows it through the block.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/15-jewel
here=$(dirname "$0")
"$voxtone" tray "$here/15-jewel.json" --overwrite -o "$out"
"$voxtone" verify "$out"
"$voxtone" proof "$out" --spp 4 --size 160x120 --overwrite -o "$out-proof.png"
