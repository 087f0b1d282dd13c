#!/bin/sh
# One would be sure that a library whose readers promise colours multiplied by alpha keeps that for each format with alpha.
# OpenImageIO does for Targa, as for PNG, TIFF and WebP; of a BMP of 32 bits it hands the colours over as they are in the file, whether
# they are to be multiplied or not, and nothing in the picture's description tells. The same bytes, blue, green, red of 60, 90, 220 at an
# alpha of 64, laid over black by oiiotool: 55, 22, 15 from Targa and 220, 90, 60 from BMP, opaque as if alpha were 255. Whoever
# divides by alpha, to have the file's colours, gets 255, 255, 239. So in 2.4.7 and in 2.5.18. For prints: what is half
# transparent in a BMP comes out too light, and clear where colour was meant; take its colours as they are.
#   findings/openimageio-bmp-alpha.sh     as root, with mmdebstrap; two minutes, 500 MB. 0: it is so; 1: it is not; 77: skipped
# With openimageio-tools 2.4.7.1+dfsg-2 (bookworm) and 2.5.18.0+dfsg-1+b1 (trixie), on amd64.
set -eu
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
pixel='\074\132\334\100'
pixels=$pixel$pixel$pixel$pixel
# 2 x 2, uncompressed: a BITMAPINFOHEADER without masks, and Targa with eight bits of alpha.
info='\050\0\0\0\002\0\0\0\002\0\0\0\001\0\040\0\0\0\0\0\020\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0'
printf 'BM\106\0\0\0\0\0\0\0\066\0\0\0'"$info$pixels" >"$work/a.bmp"
printf '\0\0\002\0\0\0\0\0\0\0\0\0\002\0\002\0\040\050'"$pixels" >"$work/a.tga"
for release in bookworm=2.4.7.1+dfsg-2 trixie=2.5.18.0+dfsg-1+b1; do
    mmdebstrap --quiet --variant=extract --include="openimageio-tools=${release#*=}" "${release%=*}" "$work/${release%=*}" \
        http://deb.debian.org/debian || { echo "skipped: no Debian (${release%=*}) to be had from here"; exit 77; }
    mkdir -p "$work/${release%=*}/tmp"
    for folder in lib lib64; do [ -e "$work/${release%=*}/$folder" ] || ln -s "usr/$folder" "$work/${release%=*}/$folder"; done
    cp "$work/a.bmp" "$work/a.tga" "$work/${release%=*}/tmp"
    # BLAS, LAPACK stand in folders of their own until a package's script has run.
    over_black() {
        LD_LIBRARY_PATH=/usr/lib/x86_64-linux-gnu/blas:/usr/lib/x86_64-linux-gnu/lapack chroot "$work/${release%=*}" \
            /usr/bin/oiiotool "/tmp/a.$1" --pattern constant:color=0,0,0,1 2x2 4 --over --printstats |
            awk '/Avg/ {printf "%.0f, %.0f, %.0f, %.0f\n", 255 * $3, 255 * $4, 255 * $5, 255 * $6}'
    }
    echo "${release%=*}: Targa $(over_black tga), BMP $(over_black bmp)" >>"$work/seen"
done
cat "$work/seen"
cat >"$work/wanted" <<'END'
bookworm: Targa 55, 22, 15, 255, BMP 220, 90, 60, 255
trixie: Targa 55, 22, 15, 255, BMP 220, 90, 60, 255
END
cmp -s "$work/seen" "$work/wanted" || { echo "OpenImageIO takes alpha of BMP otherwise than it did"; exit 1; }
