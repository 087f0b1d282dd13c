#!/bin/sh
# One would be sure that a decoder that is told to try hard finds a clean, black, upright code on a white page wherever it
# lies. In ZXing-C++ 1.4.0 that is so of QR alone: of 49 places on a page of 800 x 600 pixels a QR code is read at 49, a Data
# Matrix of 12 x 12 modules of 2 to 10 pixels at 7, those half way up the page, an Aztec code of 8 pixels a
# module at 1, the middle. Cut into strips of which one has it half way up, the page gives the same Data Matrix up. For prints:
# a label's Data Matrix that "cannot be read" in a picture of the whole part may be as it should; cut the picture before it is asked.
#   findings/zxing-data-matrix-place.sh     as root, with mmdebstrap and g++; a minute, 10 MB. 0: it is so; 1: it is not; 77: skipped
# With libzxing2 1.4.0-3+b1, on amd64.
set -eu
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
mmdebstrap --quiet --variant=extract --include=libzxing2=1.4.0-3+b1,libzxing-dev=1.4.0-3+b1 bookworm "$work/root" \
    http://deb.debian.org/debian || { echo "skipped: no Debian (bookworm) to be had from here"; exit 77; }
cat >"$work/places.cpp" <<'END'
#define ZX_USE_UTF8 1
#include <ZXing/BitMatrix.h>
#include <ZXing/MultiFormatWriter.h>
#include <ZXing/ReadBarcode.h>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>
using ZXing::BarcodeFormat;
constexpr int width = 800, height = 600, margin = 40, steps = 7;
static bool is_read(const unsigned char* page, int rows, BarcodeFormat format) {
    ZXing::DecodeHints hints;
    hints.setFormats(format).setTryHarder(true).setMaxNumberOfSymbols(8);
    for (const auto& result : ZXing::ReadBarcodes({page, width, rows, ZXing::ImageFormat::Lum}, hints))
        if (result.isValid() && result.text() == "VX-100") return true;
    return false;
}
int main() {
    for (const auto& [format, name] : {std::pair(BarcodeFormat::QRCode, "QR"), std::pair(BarcodeFormat::DataMatrix, "DataMatrix"),
                                       std::pair(BarcodeFormat::Aztec, "Aztec")})
        for (const int module : {2, 4, 8, 10}) {
            ZXing::MultiFormatWriter writer(format);
            writer.setMargin(0);
            const auto code = writer.encode(std::string("VX-100"), 0, 0);
            const int edge = module * code.width();
            int whole = 0, in_middle = 0, strips = 0;
            for (int n = 0; n < steps * steps; ++n) {
                const int column = n % steps, row = n / steps, left = margin + (width - 2 * margin - edge) * column / (steps - 1),
                          top = margin + (height - 2 * margin - edge) * row / (steps - 1);
                std::vector<unsigned char> page(width * height, 255);
                for (int y = 0; y < edge; ++y)
                    for (int x = 0; x < edge; ++x)
                        if (code.get(x / module, y / module)) page[(top + y) * width + left + x] = 0;
                if (is_read(page.data(), height, format)) ++whole, in_middle += column == steps / 2 || row == steps / 2;
                const int from = top - margin / 2;
                strips += is_read(page.data() + from * width, edge + margin, format);
            }
            std::printf("%s %d: %d of 49, %d of them in the middle row or column; in a strip of its own %d\n", name, module, whole,
                        in_middle, strips);
        }
}
END
g++ -std=c++17 -O2 -I"$work/root/usr/include" "$work/places.cpp" -o "$work/places" -L"$work/root/usr/lib/x86_64-linux-gnu" -lZXing
seen=$(LD_LIBRARY_PATH="$work/root/usr/lib/x86_64-linux-gnu" "$work/places")
echo "$seen"
for line in 'QR 2: 49 of 49' 'QR 8: 49 of 49' 'DataMatrix 2: 7 of 49, 7 of them' 'DataMatrix 4: 7 of 49, 7 of them' \
    'DataMatrix 8: 7 of 49, 7 of them' 'DataMatrix 10: 7 of 49, 7 of them' 'Aztec 8: 1 of 49, 1 of them'; do
    echo "$seen" | grep -q "^$line" || { echo "not so: $line"; exit 1; }
done
echo "$seen" | grep -q '^DataMatrix 8: .* in a strip of its own 49$' || { echo "not so: strips"; exit 1; }
