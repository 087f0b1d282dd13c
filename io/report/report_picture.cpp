// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/report/report_picture.h"

#include <algorithm>
#include <array>
#include <utility>

#include "io/pictures/picture_writer.h"
#include "io/pictures/png_pixels.h"
#include "io/pictures/webp.h"

namespace voxtone::io {

namespace {

/// Sums of the pixels that fall together; colour is weighed by its coverage.
struct SmallPicture {
    std::uint32_t width_px, height_px, step;
    std::vector<std::array<std::uint32_t, 4>> sums;

    SmallPicture(std::uint32_t large_width_px, std::uint32_t large_height_px, std::uint32_t most_px)
        : step(std::max(1u, (std::max(large_width_px, large_height_px) + most_px - 1) / most_px)) {
        width_px = (large_width_px + step - 1) / step;
        height_px = (large_height_px + step - 1) / step;
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

constexpr const char* source = "the picture of a report";

Picture8 small_webp(std::span<const std::uint8_t> file, std::uint32_t most_px) {
    const Picture8 large = read_webp(file, source);
    const std::span<const std::uint8_t> codes = large.codes;
    SmallPicture small(large.width_px, large.height_px, most_px);
    const std::size_t row_bytes = std::size_t{4} * large.width_px;
    for (std::uint32_t y = 0; y < large.height_px; ++y) small.add(y, codes.subspan(y * row_bytes, row_bytes));
    return small.picture();
}

Picture8 small_png(std::span<const std::uint8_t> file, std::uint32_t most_px) {
    const PngHeader header = read_png_header(file, source);
    SmallPicture small(header.width_px, header.height_px, most_px);
    read_png(file, source, [&](std::uint32_t y, std::span<const std::uint8_t> rgba) { small.add(y, rgba); });
    return small.picture();
}

Picture8 small_picture(std::span<const std::uint8_t> file, std::uint32_t most_px) {
    return is_webp(file) ? small_webp(file, most_px) : small_png(file, most_px);
}

}  // namespace

const ReportPicture* shown_picture(const Report& report) {
    if (report.views.empty() || report.views[0].pictures.empty()) return nullptr;
    const std::vector<ReportPicture>& pictures = report.views[0].pictures;
    return &pictures[std::min<std::size_t>(1, pictures.size() - 1)];
}

ReportPicture report_picture(std::string caption, const Picture8& picture, double px_per_mm) {
    return {std::move(caption), webp_bytes(picture), picture.width_px, picture.height_px, px_per_mm};
}

ReportPicture small_report_picture(const ReportPicture& picture, std::uint32_t most_px) {
    return report_picture(picture.caption, small_picture(picture.file, most_px), 0);
}

std::vector<std::uint8_t> small_picture_png(std::span<const std::uint8_t> file, std::uint32_t most_px) {
    return png_bytes(small_picture(file, most_px));
}

}  // namespace voxtone::io
