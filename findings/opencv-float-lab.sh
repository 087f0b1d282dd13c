#!/bin/sh
# One would be sure that a conversion of 32-bit floats is as exact as floats, and that bytes of 8 bits which go to L*a*b* and
# back are off by one or two. cvtColor of OpenCV 4.6 looks floats of sRGB up in a coarse table of whole numbers: against its own
# documented formula it is off by 0.16 (CIELAB) on average and 0.55 at (0, 36, 12); grey 120 is L* 50.24 for 50.43. Cyans cannot
# go there and back: (0, 220, 232) returns as (24, 220, 232) in bytes, and 2.8 % of all values are off by more than 3. For
# prints: a patch or photograph that is judged by it has that error on top, and what goes there and back loses cyan; from linear
# light (COLOR_LRGB2Lab) the error is at most 0.03.
#   findings/opencv-float-lab.sh     as root, with mmdebstrap and g++; minutes, 300 MB. 0: it is so; 1: it is not; 77: skipped
# With libopencv-imgproc406 4.6.0+dfsg-12, on amd64.
set -eu
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
mmdebstrap --quiet --variant=extract --include=libopencv-imgproc406=4.6.0+dfsg-12,libopencv-imgproc-dev=4.6.0+dfsg-12 bookworm \
    "$work/root" http://deb.debian.org/debian || { echo "skipped: no Debian (bookworm) to be had from here"; exit 77; }
cat >"$work/lab.cpp" <<'END'
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
double linear(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }
double root(double t) { return t > 216 / 24389.0 ? std::cbrt(t) : (24389 / 27.0 * t + 16) / 116; }
/// By the matrix and white of OpenCV's manual.
cv::Vec3d lab(double r, double g, double b) {
    const double x = root((0.412453 * r + 0.357580 * g + 0.180423 * b) / 0.950456),
                 y = root(0.212671 * r + 0.715160 * g + 0.072169 * b),
                 z = root((0.019334 * r + 0.119193 * g + 0.950227 * b) / 1.088754);
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}
int main() {
    constexpr int count = 64 * 64 * 64;
    cv::Mat bytes(1, count, CV_8UC3), codes, light(1, count, CV_32FC3), by_codes, by_light, there, back;
    for (int i = 0; i < count; ++i) {
        cv::Vec3b& code = bytes.at<cv::Vec3b>(0, i) = cv::Vec3b(i / 4096 * 4, i / 64 % 64 * 4, i % 64 * 4);
        for (int k = 0; k < 3; ++k) light.at<cv::Vec3f>(0, i)[k] = static_cast<float>(linear(code[k] / 255.0));
    }
    bytes.convertTo(codes, CV_32F, 1 / 255.0);
    cv::cvtColor(codes, by_codes, cv::COLOR_RGB2Lab);
    cv::cvtColor(light, by_light, cv::COLOR_LRGB2Lab);
    cv::cvtColor(bytes, there, cv::COLOR_RGB2Lab);
    cv::cvtColor(there, back, cv::COLOR_Lab2RGB);
    double largest = 0, sum = 0, largest_by_light = 0;
    int astray = 0;
    for (int i = 0; i < count; ++i) {
        const cv::Vec3b code = bytes.at<cv::Vec3b>(0, i), again = back.at<cv::Vec3b>(0, i);
        const cv::Vec3d wanted = lab(linear(code[0] / 255.0), linear(code[1] / 255.0), linear(code[2] / 255.0));
        const double error = cv::norm(cv::Vec3d(by_codes.at<cv::Vec3f>(0, i)) - wanted);
        largest = std::max(largest, error), sum += error;
        largest_by_light = std::max(largest_by_light, cv::norm(cv::Vec3d(by_light.at<cv::Vec3f>(0, i)) - wanted));
        for (int k = 0; k < 3; ++k) astray += std::abs(code[k] - again[k]) > 3;
    }
    const cv::Vec3b cyan = back.at<cv::Vec3b>(0, 55 * 64 + 58);
    std::printf("floats: mean %.2f, largest %.2f, grey 120 L* %.2f; of light: largest %.2f\n", sum / count, largest,
                by_codes.at<cv::Vec3f>(0, 30 * (4096 + 64 + 1))[0], largest_by_light);
    std::printf("bytes: 0 220 232 back as %d %d %d, %.1f %% off by more than 3\n", cyan[0], cyan[1], cyan[2], astray / (0.03 * count));
}
END
libraries=/usr/lib/x86_64-linux-gnu
g++ -O1 -I "$work/root/usr/include/opencv4" "$work/lab.cpp" -o "$work/root/lab" "$work/root$libraries/libopencv_imgproc.so.406" \
    "$work/root$libraries/libopencv_core.so.406" -Wl,--allow-shlib-undefined || { echo "skipped: no g++"; exit 77; }
LD_LIBRARY_PATH=$libraries/blas:$libraries/lapack chroot "$work/root" /lab >"$work/seen"
cat "$work/seen"
cat >"$work/wanted" <<'END'
floats: mean 0.16, largest 0.55, grey 120 L* 50.24; of light: largest 0.03
bytes: 0 220 232 back as 24 220 232, 2.8 % off by more than 3
END
cmp -s "$work/seen" "$work/wanted" || { echo "OpenCV's L*a*b* is others than it was"; exit 1; }
