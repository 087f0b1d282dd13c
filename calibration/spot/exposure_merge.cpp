// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/spot/exposure_merge.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "base/contracts.h"
#include "base/error.h"
#include "optics/numerics/median.h"

namespace voxtone::calibration {
namespace {

constexpr double merge_blur_px = 3;
constexpr double well_exposed = 0.02, well_above_noise = 100;  // parts of full scale, of the read noise
constexpr double far_from_saturation = 0.8;                    // so that noise saturates no sample that is compared

Eigen::Vector3d median(const io::Photograph& photograph) {
    Eigen::Vector3d result;
    for (int c = 0; c < 3; ++c) {
        std::vector<double> values;
        for (const Eigen::Vector3f& pixel : photograph.pixels) values.push_back(pixel[c]);
        result[c] = optics::median(std::move(values));
    }
    return result;
}

double share_of_zeros(const io::Photograph& photograph) {
    std::size_t zeros = 0;
    for (const Eigen::Vector3f& pixel : photograph.pixels)
        zeros += static_cast<std::size_t>((pixel.array() <= 0).count());
    return static_cast<double>(zeros) / (3 * static_cast<double>(photograph.pixels.size()));
}

}  // namespace

void ExposureMerge::add(const Exposure& lit, const Exposure& dark) {
    expect_dark_frame(lit, dark);
    const io::Photograph& photograph = lit.photograph;
    const std::size_t pixels = photograph.pixels.size();
    const bool first = seconds_.empty();
    if (first) {
        width_px_ = photograph.width_px, height_px_ = photograph.height_px;
        weighted_.assign(pixels, Eigen::Vector3f::Zero());
        weight_.assign(pixels, Eigen::Vector3f::Zero());
        exposures_.assign(pixels, 0);
        black_ = median(dark.photograph);
    } else if (photograph.width_px != width_px_ || photograph.height_px != height_px_) {
        throw InputError(
            fmt::format("{} is {} x {} pixels and the exposures before it are {} x {}; all must be cut alike",
                        photograph.name, photograph.width_px, photograph.height_px, width_px_, height_px_));
    } else if (!(lit.seconds > seconds_.back())) {
        throw InputError(
            fmt::format("{} was exposed for {}, the one before it for {}; give the exposures from short to long",
                        photograph.name, seconds_text(lit.seconds), seconds_text(seconds_.back())));
    }

    const float t = static_cast<float>(lit.seconds), limit = static_cast<float>(noise_.saturation);
    const auto light_of = [&](std::size_t i) -> Eigen::Vector3f {
        return (photograph.pixels[i] - dark.photograph.pixels[i]) / t;
    };
    std::vector<Eigen::Vector3f> known(pixels);  // light per second, as far as it is known without this exposure
    for (std::size_t i = 0; i < pixels; ++i)
        known[i] = first ? light_of(i) : weighted_[i].cwiseQuotient(weight_[i].cwiseMax(1e-30f)).eval();
    std::vector<Eigen::Vector3f> level(pixels);
    cv::Mat in(static_cast<int>(height_px_), static_cast<int>(width_px_), CV_32FC3, known.data()),
        out(static_cast<int>(height_px_), static_cast<int>(width_px_), CV_32FC3, level.data());
    cv::GaussianBlur(in, out, cv::Size(), merge_blur_px, merge_blur_px, cv::BORDER_REPLICATE);

    const Eigen::Vector3d stray = (median(dark.photograph) - black_).cwiseMax(0);
    const double read2 = 2 * noise_.read_noise * noise_.read_noise;
    const double clear = std::max(well_exposed, well_above_noise * noise_.read_noise);
    double seen = 0, expected = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        const Eigen::Vector3f light = light_of(i);
        bool all = true;
        for (int c = 0; c < 3; ++c) {
            if (!(photograph.pixels[i][c] < limit && dark.photograph.pixels[i][c] < limit) ||
                (!first && weight_[i][c] == 0)) {
                all = false;
                continue;
            }
            const double signal = std::max(0.0, static_cast<double>(level[i][c])) * lit.seconds;
            if (!first && signal > clear &&
                signal + dark.photograph.pixels[i][c] < far_from_saturation * noise_.saturation)
                seen += light[c], expected += known[i][c];
            const double variance = read2 + (2 * stray[c] + signal) / noise_.full_well;
            const float w = static_cast<float>(lit.seconds * lit.seconds / variance);
            weighted_[i][c] += w * light[c];
            weight_[i][c] += w;
        }
        if (all) exposures_[i] = static_cast<std::uint8_t>(std::min<std::size_t>(seconds_.size() + 1, 255));
    }
    cut_at_black_ = std::max(cut_at_black_, share_of_zeros(dark.photograph));
    seconds_.push_back(lit.seconds);
    if (!first) step_.push_back(expected > 0 ? seen / expected : 1);
}

MergedPicture ExposureMerge::merged() const {
    VOXTONE_EXPECT(!seconds_.empty());
    MergedPicture picture{width_px_, height_px_, weighted_, weight_, exposures_, seconds_, step_, cut_at_black_};
    for (std::size_t i = 0; i < weight_.size(); ++i)
        picture.light[i] = weighted_[i].cwiseQuotient(weight_[i].cwiseMax(1e-30f));
    return picture;
}

}  // namespace voxtone::calibration
