#!/bin/sh
# One would be sure that a colour difference with a published table of tests passes it. dE00 of libvips 8.14.1 misses 4 of the 34
# pairs of Sharma, Wu and Dalal (Color Research and Application 30, 2005): where two hues lie more than half a turn apart and
# their degrees sum to less than 360, it takes the mean hue on the wrong side. Pair 19 is 27.23 for 31.90; an orange (60, 30, 30)
# and a violet blue (60, 0, -30) are 44.42 apart for 37.83, by Little CMS, which passes the table; across grey, (60, 3, 1) and
# (60, -2, -2), 7.78 for 7.88. Pairs of like hue are right, so that a test of small differences shows nothing. For prints: largest
# and mean differences of a proof out of gamut, and of what searches for the nearest of few resins, are wrong by a sixth.
#   findings/libvips-ciede2000.sh     as root, with mmdebstrap; minutes, 400 MB. 0: it is so; 1: it is not; 77: skipped
# With libvips-tools 8.14.1-3+deb12u3 and, for the values that ought to be, liblcms2-2 2.14-2+deb12u1, on amd64.
set -eu
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
mmdebstrap --quiet --variant=extract --include=libvips-tools=8.14.1-3+deb12u3,libvips42=8.14.1-3+deb12u3 bookworm "$work/root" \
    http://deb.debian.org/debian || { echo "skipped: no Debian (bookworm) to be had from here"; exit 77; }
vips() { LD_LIBRARY_PATH=/usr/lib/x86_64-linux-gnu/blas:/usr/lib/x86_64-linux-gnu/lapack chroot "$work/root" /usr/bin/vips "$@"; }
# The table's pairs 1, 9, 17, 19, 21 and 25, then those of above; behind each what it should be.
cat >"$work/pairs" <<'END'
50,2.6772,-79.7751,50,0,-82.7485,2.0425
50,2.49,-0.001,50,-2.49,0.0009,7.1792
50,2.5,0,73,25,-18,27.1492
50,2.5,0,56,-27,-3,31.9030
50,2.5,0,50,3.1736,0.5854,1.0000
60.2574,-34.0099,36.2677,60.4626,-34.1751,39.4387,1.2644
60,30,30,60,0,-30,37.8297
60,3,1,60,-2,-2,7.8797
END
for column in 1 2 3 4 5 6; do
    cut -d, -f$column "$work/pairs" >"$work/root/column.csv"
    vips csvload /column.csv /$column.v
done
for colour in '1 2 3' '4 5 6'; do
    first=${colour%% *}
    vips bandjoin "$(for column in $colour; do echo "/$column.v"; done)" /joined.v
    vips copy /joined.v "/lab$first.v" --interpretation lab
done
vips dE00 /lab1.v /lab4.v /differences.v
vips csvsave /differences.v /differences.csv
paste -d, "$work/pairs" "$work/root/differences.csv" | awk -F, '{printf "%.4f should be %.4f\n", $8, $7}' >"$work/seen"
cat "$work/seen"
cat >"$work/wanted" <<'END'
2.0425 should be 2.0425
7.1792 should be 7.1792
27.1980 should be 27.1492
27.2312 should be 31.9030
1.0000 should be 1.0000
1.2644 should be 1.2644
44.4220 should be 37.8297
7.7772 should be 7.8797
END
cmp -s "$work/seen" "$work/wanted" || { echo "dE00 of libvips gives other differences than it did"; exit 1; }
