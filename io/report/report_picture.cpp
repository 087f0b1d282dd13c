// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/report/report_picture.h"

#include <algorithm>
#include <array>

#include "voxtone/io/files/base64.h"
#include "voxtone/io/pictures/picture_writer.h"
#include "voxtone/io/pictures/png_pixels.h"

namespace voxtone::io {

namespace {

/// What lies between the two marks from `at` on, which moves behind it; empty where they are not there.
std::string_view between(std::string_view text, std::string_view begin, std::string_view end, std::size_t& at) {
    const std::size_t first = text.find(begin, at);
    if (first == std::string_view::npos) return {};
    const std::size_t last = text.find(end, first + begin.size());
    if (last == std::string_view::npos) return {};
    at = last;
    return text.substr(first + begin.size(), last - first - begin.size());
}

/// The last picture of the first view: the target comes before what is predicted of it.
std::string_view picture_in(std::string_view html) {
    std::size_t at = 0;
    const std::string_view view = between(html, "<div class=\"view\"", "<div class=\"view\"", at);
    std::size_t end = 0;
    const std::string_view whole = view.empty() ? between(html, "<div class=\"view\"", "</section>", end) : view;
    std::string_view last;
    for (std::size_t i = 0;;) {
        const std::string_view picture = between(whole, "src=\"data:image/png;base64,", "\"", i);
        if (picture.empty()) return last;
        last = picture;
    }
}

/// Sums of the pixels that fall together; colour is weighed by its coverage.
struct SmallPicture {
    std::uint32_t width_px, height_px, step;
    std::vector<std::array<std::uint32_t, 4>> sums;

    SmallPicture(const PngHeader& large, std::uint32_t most_px)
        : step(std::max(1u, (std::max(large.width_px, large.height_px) + most_px - 1) / most_px)) {
        width_px = (large.width_px + step - 1) / step;
        height_px = (large.height_px + step - 1) / step;
        sums.resize(std::size_t{width_px} * height_px);
    }
    void add(std::uint32_t y, std::span<const std::uint8_t> rgba) {
        for (std::size_t x = 0; 4 * x < rgba.size(); ++x) {
            auto& sum = sums[std::size_t{y / step} * width_px + x / step];
            const std::uint32_t alpha = rgba[4 * x + 3];
            for (std::size_t c = 0; c < 3; ++c) sum[c] += rgba[4 * x + c] * alpha / 255;
            sum[3] += alpha;
        }
    }
    [[nodiscard]] Picture8 picture() const {
        Picture8 small{width_px, height_px, 4, {}};
        small.codes.reserve(4 * sums.size());
        for (const auto& sum : sums) {
            for (std::size_t c = 0; c < 3; ++c)
                small.codes.push_back(static_cast<std::uint8_t>(sum[3] ? std::min(255u, sum[c] * 255 / sum[3]) : 0));
            small.codes.push_back(static_cast<std::uint8_t>(std::min(255u, sum[3] / (step * step))));
        }
        return small;
    }
};

}  // namespace

std::vector<std::uint8_t> small_report_picture(std::string_view html, std::uint32_t most_px) {
    const std::vector<std::byte> bytes = base64_bytes(picture_in(html));
    if (bytes.empty()) return {};
    const std::span png(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    const std::string source = "the picture of a report";
    SmallPicture small(read_png_header(png, source), most_px);
    read_png(png, source, [&](std::uint32_t y, std::span<const std::uint8_t> rgba) { small.add(y, rgba); });
    return png_bytes(small.picture());
}

}  // namespace voxtone::io
