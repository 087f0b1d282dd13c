// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/photo/finder_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace voxtone::calibration {

std::vector<std::uint8_t> finder_bgr(const io::Photograph& photograph) {
    constexpr std::size_t most_looked_at = 200000;
    const std::size_t step = std::max<std::size_t>(1, photograph.pixels.size() / most_looked_at);
    std::array<float, 3> white{};
    for (int channel = 0; channel < 3; ++channel) {
        std::vector<float> values;
        for (std::size_t i = 0; i < photograph.pixels.size(); i += step)
            values.push_back(photograph.pixels[i][channel]);
        const auto high = values.begin() + std::ptrdiff_t(double(values.size() - 1) * 0.995);
        std::nth_element(values.begin(), high, values.end());
        white[std::size_t(channel)] = std::max(*high, 1e-6f);
    }
    const bool linear = photograph.coding != io::SampleCoding::srgb;
    std::vector<std::uint8_t> codes;
    codes.reserve(3 * photograph.pixels.size());
    for (const Eigen::Vector3f& pixel : photograph.pixels)
        for (const int channel : {2, 1, 0}) {
            const float value = std::clamp(0.9f * pixel[channel] / white[std::size_t(channel)], 0.0f, 1.0f);
            codes.push_back(static_cast<std::uint8_t>(255 * (linear ? std::sqrt(value) : value) + 0.5f));
        }
    return codes;
}

std::vector<std::uint8_t> finder_grey(const io::Photograph& photograph) {
    const std::vector<std::uint8_t> bgr = finder_bgr(photograph);
    std::vector<std::uint8_t> grey(bgr.size() / 3);
    for (std::size_t i = 0; i < grey.size(); ++i)
        grey[i] = static_cast<std::uint8_t>((bgr[3 * i] + bgr[3 * i + 1] + bgr[3 * i + 2]) / 3);
    return grey;
}

}  // namespace voxtone::calibration
