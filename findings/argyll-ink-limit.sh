#!/bin/sh
# One would be sure that a chart made under a limit of ink keeps it. targen -l100 of ArgyllCMS 2.3.1 makes 120 patches of at
# most 100 %, and so does printtarg's PostScript and 16-bit TIFF; the 8-bit TIFF (printtarg -t) rounds each ink by itself to
# 1/255 and writes what it rounded into the .ti2, from which the measured table has its inks: 3 patches have more than the
# limit, up to 100.392 %. The colour that is expected of them is left as it was. For prints: where the inks of a place are
# shares of its volume, as in jetted resins, a reader that holds a table's sums to 100 % refuses a chart that is printed and
# measured; four inks may be over by 4 x 0.196 %, and should be scaled down to 100 %, not sent back.
#   findings/argyll-ink-limit.sh     as root, with mmdebstrap; a minute, 60 MB. 0: it is so; 1: it is not; 77: skipped
# With argyll 2.3.1+repack-1.1+b1, on amd64.
set -eu
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
mmdebstrap --quiet --variant=extract --include=argyll=2.3.1+repack-1.1+b1 bookworm "$work/root" http://deb.debian.org/debian ||
    { echo "skipped: no Debian (bookworm) to be had from here"; exit 77; }
argyll() {
    program=$1
    shift
    chroot "$work/root" "/usr/bin/$program" "$@" >"$work/log" 2>&1 || { cat "$work/log"; echo "$program does not do it any more"; exit 1; }
}
# How many patches of a table there are, the largest sum of their inks, and how many sums are above 100 %.
sums() {
    awk '
        /^BEGIN_DATA_FORMAT/ {getline; for (i = 1; i <= NF; ++i) if ($i ~ /^CMYK_/) ink[i] = 1}
        /^END_DATA[^_]*$/ {if (inside) exit}
        inside {sum = 0; for (i in ink) sum += $i; if (sum > largest) largest = sum; if (sum > 100.001) ++above; ++patches}
        /^BEGIN_DATA[^_]*$/ {inside = 1}
        END {printf "%d patches, at most %.3f %%, above 100 %%: %d\n", patches, largest, above}' "$work/root/$1"
}
argyll targen -d4 -l100 -f120 /limit
echo "targen: $(sums limit.ti1)" >"$work/seen"
for kind in -t300 -T300; do
    cp "$work/root/limit.ti1" "$work/root/chart.ti1"
    argyll printtarg -iSS $kind -pA4 /chart
    echo "printtarg $kind: $(sums chart.ti2)" >>"$work/seen"
done
cat "$work/seen"
cat >"$work/wanted" <<'END'
targen: 120 patches, at most 100.000 %, above 100 %: 0
printtarg -t300: 120 patches, at most 100.392 %, above 100 %: 3
printtarg -T300: 120 patches, at most 100.000 %, above 100 %: 0
END
cmp -s "$work/seen" "$work/wanted" || { echo "Argyll's charts keep the limit of ink otherwise than they did"; exit 1; }
