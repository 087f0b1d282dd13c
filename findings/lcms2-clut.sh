#!/bin/sh
# One would be sure that pixels of 16 bits go through a colour transform more exactly than pixels of 8, and that a flag called
# "pre-linearization" helps. With Little CMS 2.14 and flags that ask for neither, sRGB to Adobe RGB (two matrices, no table in
# either profile) is off by up to 1.52 CIEDE2000 from 16 bits, at (10, 5, 0), and by 0.12 from 8: only 8 bits have a path by
# matrices, 16 are looked up in a table of 33 points an edge that the library makes itself. sRGB to Lab is off by 0.39, and with
# cmsFLAGS_CLUT_PRE_LINEARIZATION by 5.5, at (50, 30, 0): the table is laid out in linear light, where Lab is steepest in the dark.
# cmsFLAGS_NOOPTIMIZE gives 0.004 in all. For prints: the dark browns of a 16-bit texture shift by a step that is seen; no warning.
#   findings/lcms2-clut.sh     as root, with mmdebstrap and gcc; a minute, 30 MB. 0: it is so; 1: it is not; 77: skipped
# With liblcms2-2 2.14-2+deb12u1, on amd64; the reference is the same library's transform of doubles.
set -eu
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
cat >"$work/clut.c" <<'END'
#include <lcms2.h>
#include <stdio.h>
/* The largest CIEDE2000 over every fifth code of sRGB between a transform of integers and one of doubles. */
static double worst(cmsHPROFILE out, int bits, cmsUInt32Number flags) {
    const int is_lab = cmsGetColorSpace(out) == cmsSigLabData, intent = INTENT_RELATIVE_COLORIMETRIC;
    cmsHPROFILE srgb = cmsCreate_sRGBProfile(), lab = cmsCreateLab4Profile(NULL);
    cmsHTRANSFORM exact = cmsCreateTransform(srgb, TYPE_RGB_DBL, lab, TYPE_Lab_DBL, intent, 0);
    cmsHTRANSFORM back = is_lab ? NULL : cmsCreateTransform(out, TYPE_RGB_DBL, lab, TYPE_Lab_DBL, intent, 0);
    cmsHTRANSFORM tried = cmsCreateTransform(srgb, bits == 8 ? TYPE_RGB_8 : TYPE_RGB_16, out,
                                             is_lab ? TYPE_Lab_16 : TYPE_RGB_16, intent, flags);
    double largest = 0;
    for (int code = 0; code < 52 * 52 * 52; ++code) {
        const int rgb[3] = {code / 52 / 52 * 5, code / 52 % 52 * 5, code % 52 * 5};
        unsigned char bytes[3];
        cmsUInt16Number words[3], got[3];
        double numbers[3];
        cmsCIELab wanted, seen;
        for (int c = 0; c < 3; ++c) bytes[c] = (unsigned char)rgb[c], words[c] = rgb[c] * 257, numbers[c] = rgb[c] / 255.0;
        cmsDoTransform(exact, numbers, &wanted, 1);
        cmsDoTransform(tried, bits == 8 ? (void*)bytes : (void*)words, got, 1);
        for (int c = 0; c < 3; ++c) numbers[c] = got[c] / 65535.0;
        if (is_lab) cmsLabEncoded2Float(&seen, got);
        else cmsDoTransform(back, numbers, &seen, 1);
        const double difference = cmsCIE2000DeltaE(&wanted, &seen, 1, 1, 1);
        if (difference > largest) largest = difference;
    }
    return largest;
}
int main(void) {
    const cmsCIExyY white = {0.3127, 0.3290, 1};
    const cmsCIExyYTRIPLE primaries = {{0.64, 0.33, 1}, {0.21, 0.71, 1}, {0.15, 0.06, 1}};
    cmsToneCurve* gamma = cmsBuildGamma(NULL, 563 / 256.0);
    cmsToneCurve* curves[3] = {gamma, gamma, gamma};
    cmsHPROFILE adobe = cmsCreateRGBProfile(&white, &primaries, curves), lab = cmsCreateLab4Profile(NULL);
    const double d8 = worst(adobe, 8, 0), d16 = worst(adobe, 16, 0), exact = worst(adobe, 16, cmsFLAGS_NOOPTIMIZE),
                 plain = worst(lab, 16, 0), flag = worst(lab, 16, cmsFLAGS_CLUT_PRE_LINEARIZATION),
                 exact_lab = worst(lab, 16, cmsFLAGS_NOOPTIMIZE);
    printf("Adobe RGB: from 8 bits %.3f, from 16 bits %.3f, not optimised %.3f\n", d8, d16, exact);
    printf("Lab: %.3f, with the flag of pre-linearization %.3f, not optimised %.3f\n", plain, flag, exact_lab);
    return !(d16 > 1.4 && d16 > 10 * d8 && exact < 0.01 && flag > 5 && flag > 10 * plain && exact_lab < 0.01);
}
END
mmdebstrap --quiet --variant=extract --include=liblcms2-2=2.14-2+deb12u1,liblcms2-dev=2.14-2+deb12u1 bookworm "$work/root" \
    http://deb.debian.org/debian || { echo "skipped: no Debian (bookworm) to be had from here"; exit 77; }
libraries=$(dirname "$(find "$work/root" -name libc.so.6 | head -n 1)")
lcms=$(dirname "$(find "$work/root" -name liblcms2.so.2 | head -n 1)")
gcc -O1 -I "$work/root/usr/include" "$work/clut.c" -o "$work/clut" "$lcms/liblcms2.so.2" -lm || { echo "skipped: no gcc"; exit 77; }
"$libraries/ld-linux-x86-64.so.2" --library-path "$libraries:$lcms" "$work/clut" ||
    { echo "Little CMS does not look 16 bits up in its own table any more, or the flag no longer harms"; exit 1; }
