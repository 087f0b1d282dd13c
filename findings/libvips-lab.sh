#!/bin/sh
# One would be sure that libvips, which marks a picture's pixels "lab", means one thing by it. In 8.14.1 two conversions of one sRGB
# picture, both marked lab, differ: colourspace gives L*a*b* under D65, icc_import under D50, and icc_import is off besides, for it
# takes the words of Little CMS for those of ICC version 2: white is L* 100.39, a* 0.5, b* 0.5, and each grey is reddish by as
# much, 0.9 CIEDE2000. Blue (0, 0, 255) is 32.3, 79.2, -107.9 by one and 29.7, 69.1, -112.0 by the other, 5.5 CIEDE2000 apart. A
# picture that goes in by one and out by the other comes back as (0, 33, 254) or (86, 0, 253), its white as (253, 254, 254). For
# prints: colours of pictures that are held against measured ones (D50) belong into neither; there and back hides both.
#   findings/libvips-lab.sh     as root, with mmdebstrap; minutes, 400 MB. 0: it is so; 1: it is not; 77: skipped
# With libvips-tools 8.14.1-3+deb12u3, on amd64.
set -eu
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
mmdebstrap --quiet --variant=extract --include=libvips-tools=8.14.1-3+deb12u3,libvips42=8.14.1-3+deb12u3 bookworm "$work/root" \
    http://deb.debian.org/debian || { echo "skipped: no Debian (bookworm) to be had from here"; exit 77; }
vips() { LD_LIBRARY_PATH=/usr/lib/x86_64-linux-gnu/blas:/usr/lib/x86_64-linux-gnu/lapack chroot "$work/root" /usr/bin/vips "$@"; }
numbers() { vips getpoint "$1" "$2" 0 | awk '{for (i = 1; i <= 3; ++i) printf "%s%.1f", (i > 1 ? " " : ""), $i}'; }
echo 'P3 2 1 255 255 255 255 0 0 255' >"$work/root/in.ppm" # white, blue
vips colourspace /in.ppm /space.v lab
vips icc_import /in.ppm /icc.v --input-profile srgb
vips colourspace /icc.v /icc-space.v srgb
vips icc_export /space.v /space-icc.v --output-profile srgb
for picture in space icc icc-space space-icc; do
    echo "$picture: white $(numbers /$picture.v 0), blue $(numbers /$picture.v 1)"
done >"$work/seen"
cat "$work/seen"
cat >"$work/wanted" <<'END'
space: white 100.0 0.0 -0.0, blue 32.3 79.2 -107.9
icc: white 100.4 0.5 0.5, blue 29.7 69.1 -112.0
icc-space: white 255.0 255.0 255.0, blue 0.0 33.0 254.0
space-icc: white 253.0 254.0 254.0, blue 86.0 0.0 253.0
END
cmp -s "$work/seen" "$work/wanted" || { echo "libvips's two ways to L*a*b* give other values than they did"; exit 1; }
