#!/bin/sh
# From somebody's arrays of measured scattering to a picture of the print under a sharp border of light (Hasan et al. 2010, Figs. 6 to 8).
# Wants numpy. The arrays are made up here: a surface whose left half keeps light near and whose right half lets it spread.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/17-translucency
here=$(dirname "$0")
python=${PYTHON:-python3}
"$python" -c 'import numpy' 2>/dev/null || { echo "17-translucency: $python has no numpy, which the arrays are made with" >&2; exit 77; }
mkdir -p "$out"

# 1. light[channel, y, x, r + dy, r + dx] per mm2, points 0.5 mm apart, of one grey channel: R = sqrt(P(from, r) P(to, r)), by which both
# ways between two points are alike.
PYTHONPATH="$here/../python" "$python" - "$out/jade.bssrdf" <<'END'
import sys
import numpy, voxtone
width, height, radius, pitch = 32, 16, 6, 0.5
x, y = numpy.meshgrid(numpy.arange(-radius, width + radius), numpy.arange(-radius, height + radius))
fall = numpy.where(x < width // 2, 0.35, 1.2)  # mm; the albedo is 0.4 everywhere
offsets = [(dx, dy) for dy in range(-radius, radius + 1) for dx in range(-radius, radius + 1) if dx * dx + dy * dy <= radius * radius]
profile = lambda r: numpy.exp(-r / fall)
albedo = sum(profile(pitch * numpy.hypot(*offset)) for offset in offsets) * pitch ** 2
light = numpy.zeros((1, height, width, 2 * radius + 1, 2 * radius + 1))
for dx, dy in offsets:
    P = 0.4 / albedo * profile(pitch * numpy.hypot(dx, dy))
    both = numpy.sqrt(P * numpy.roll(P, (-dy, -dx), (0, 1)))
    light[0, :, :, radius + dy, radius + dx] = both[radius:-radius, radius:-radius]
voxtone.write_bssrdf(sys.argv[1], light, pitch, channels="luminance", source="examples/17-translucency.sh")
END

# 2. Which few profiles it asks for and where; the layers of white, black and clear that show them (the layered model alone: --laminate-rounds 0).
"$voxtone" laminate factor "$out/jade.bssrdf" --clusters 4 --overwrite -o "$out/jade.json"
"$voxtone" slice "$out/jade.png" --show layered-profile --profiles "$out/jade.json" --resins vero-opaque-clear --load W,K,T --dc-weight 10 \
    --thickness 4mm --laminate-thickness 3mm --laminate-rounds 0 --overwrite -o "$out/print"

# 3. What its voxels do: R(r) beside what was asked, and the slab in soft light and below it half in the shadow of an edge.
"$voxtone" laminate trace "$out/print" --dataset "$out/jade.bssrdf" --paths 200 --overwrite -o "$out/traced.png"
"$voxtone" proof "$out/print" --light overcast --light edge --size "${SIZE:-160x84}" --spp "${SPP:-32}" --overwrite -o "$out/proof.png"
