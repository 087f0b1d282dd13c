#!/bin/sh
# One would be sure that a routine which finds by how much two pictures are shifted to parts of a pixel is right to some hundredths
# where there is no noise, and that pictures which it takes as const inputs are the same afterwards. phaseCorrelate of OpenCV 4.6.0
# (and 4.10.0) with the Hann window that its pages advise, on 128 x 128 pixels of 900 soft dots (a Gaussian of one pixel), moved
# exactly: 0.25 pixels are found as 0.04, 0.5 as 0.79, 0.75 as 0.96, at a response of 0.98, which says that all is well. It
# draws to whole pixels what is sharp; of dots of 1.5 pixels it finds 0.24 for 0.25, but 1.14 for 1. And where sides are of
# lengths that suit the transform (no border is needed), the window is laid onto the caller's own pictures: who asks twice asks
# of others. For prints: photographs laid on a prediction by it are off by a quarter of a pixel, which looks like blur or like
# resins that run; fit the shift to the pictures themselves, and give copies.
#   findings/opencv-phase-correlate.sh     as root, with mmdebstrap and g++; minutes, 300 MB. 0: it is so; 1: it is not; 77: skipped
# With libopencv-imgproc406 4.6.0+dfsg-12, on amd64.
set -eu
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
mmdebstrap --quiet --variant=extract --include=libopencv-imgproc406=4.6.0+dfsg-12,libopencv-imgproc-dev=4.6.0+dfsg-12 bookworm \
    "$work/root" http://deb.debian.org/debian || { echo "skipped: no Debian (bookworm) to be had from here"; exit 77; }
cat >"$work/shift.cpp" <<'END'
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <opencv2/imgproc.hpp>
constexpr int size = 128, dots = 900;
/// Dots at random, of a Gaussian's shape, moved to the right.
cv::Mat picture(double sigma_px, double right_px) {
    cv::Mat out = cv::Mat::zeros(size, size, CV_64F);
    std::uint64_t state = 1;
    const auto any = [&] {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return double(state >> 11) / 9007199254740992.0;
    };
    for (int k = 0; k < dots; ++k) {
        const double x = 168 * any() - 20 + right_px, y = 168 * any() - 20, height = any();
        for (int i = std::max(0, int(y - 6 * sigma_px)); i < std::min(size, int(y + 6 * sigma_px)); ++i)
            for (int j = std::max(0, int(x - 6 * sigma_px)); j < std::min(size, int(x + 6 * sigma_px)); ++j)
                out.at<double>(i, j) += height * std::exp(-((j - x) * (j - x) + (i - y) * (i - y)) / (2 * sigma_px * sigma_px));
    }
    return out;
}
int main() {
    cv::Mat window;
    cv::createHanningWindow(window, cv::Size(size, size), CV_64F);
    for (const double sigma : {1.0, 1.5}) {
        std::printf("dots of %.1f:", sigma);
        for (const double right : {0.25, 0.5, 0.75, 1.0}) {
            double response = 0;
            const cv::Point2d found = cv::phaseCorrelate(picture(sigma, 0), picture(sigma, right), window, &response);
            std::printf(" %.2f is %.2f (%.1f)", right, found.x, response);
        }
        std::printf("\n");
    }
    const cv::Mat before = picture(1, 0), taken = before.clone(), other = picture(1, 0.25);
    cv::phaseCorrelate(taken, other, window);
    std::printf("the picture is %s\n", cv::norm(before, taken, cv::NORM_INF) == 0 ? "as it was" : "another");
}
END
libraries=$work/root/usr/lib/x86_64-linux-gnu
g++ -O1 -I "$work/root/usr/include/opencv4" "$work/shift.cpp" -o "$work/root/shift" "$libraries/libopencv_imgproc.so.406" \
    "$libraries/libopencv_core.so.406" -Wl,--allow-shlib-undefined || { echo "skipped: no g++"; exit 77; }
# BLAS and LAPACK stand in folders of their own until a package's script has run.
LD_LIBRARY_PATH=/usr/lib/x86_64-linux-gnu/blas:/usr/lib/x86_64-linux-gnu/lapack chroot "$work/root" /shift | tee "$work/seen"
cat >"$work/wanted" <<'END'
dots of 1.0: 0.25 is 0.04 (1.0) 0.50 is 0.79 (1.0) 0.75 is 0.96 (1.0) 1.00 is 1.00 (1.0)
dots of 1.5: 0.25 is 0.24 (1.0) 0.50 is 0.48 (1.1) 0.75 is 0.83 (0.8) 1.00 is 1.14 (0.8)
the picture is another
END
cmp -s "$work/seen" "$work/wanted" || { echo "phaseCorrelate finds shifts otherwise than it did"; exit 1; }
