#!/bin/sh
# One would be sure that a colour made of L*a*b* values keeps them, and that the difference of two such colours is that of their
# values. chroma-js 3.2.0 holds each colour as red, green and blue of sRGB, cut to 0 and 255, and says nothing: with white D50 the
# cyan of offset printing, 55, -37, -50, is 58.49, -15.67, -44.23 when asked for its lab(), 9.6 CIEDE2000 away, and deltaE finds it
# 1.91 from a cyan of 55, -25, -50, which is 4.82. Of the 34 pairs of Sharma, Wu and Dalal (Color Research and Application 30,
# 2005) it misses the 7 that lie outside sRGB (pair 3: 1.37 for 3.44); its formula is right, as the other 27 show. For prints:
# measured inks and resins, cyan and green first of all, are taken for others, and a tolerance that they break is passed.
#   findings/chroma-js-inks.sh     with npm and node; seconds, 1 MB. 0: it is so; 1: it is not; 77: skipped
# With chroma-js 3.2.0 of npm.
set -eu
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
npm --silent --prefix "$work" install chroma-js@3.2.0 >/dev/null 2>&1 || { echo "skipped: no chroma-js 3.2.0 to be had from here"; exit 77; }
cat >"$work/inks.mjs" <<'END'
import chroma from 'chroma-js';
const difference = (a, b) => chroma.deltaE(chroma.lab(...a), chroma.lab(...b)).toFixed(2), cyan = [55, -37, -50];
console.log('pair 3', difference([50, 2.8361, -74.02], [50, 0, -82.7485]), 'should be 3.44');
console.log('pair 9', difference([50, 2.49, -0.001], [50, -2.49, 0.0009]), 'should be 7.18');
chroma.setLabWhitePoint('d50');
console.log('cyan is', ...chroma.lab(...cyan).lab().map(value => value.toFixed(2)));
console.log('cyans', difference(cyan, [55, -25, -50]), 'should be 4.82');
END
node "$work/inks.mjs" | tee "$work/seen"
cat >"$work/wanted" <<'END'
pair 3 1.37 should be 3.44
pair 9 7.18 should be 7.18
cyan is 58.49 -15.67 -44.23
cyans 1.91 should be 4.82
END
cmp -s "$work/seen" "$work/wanted" || { echo "chroma-js takes L*a*b* outside sRGB otherwise than it did"; exit 1; }
