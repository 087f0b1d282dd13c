// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/profile_map_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>

#include "io/pictures/srgb_code.h"
#include "optics/colour/channels.h"

namespace voxtone::scattering {
namespace {

constexpr std::uint32_t least_panel_px = 240, gap_px = 10;
constexpr double decades = 5;

using Code = std::array<std::uint8_t, 3>;

/// One of the pictures.
struct Panel {
    std::uint32_t width = 0, height = 0;
    std::vector<Code> pixels;
};

/// Black, red, yellow, white; t in [0, 1], clamped.
Code heat(double t) {
    const double u = 3 * std::clamp(t, 0.0, 1.0);
    const auto part = [&](double from) {
        return static_cast<std::uint8_t>(std::lround(255 * std::clamp(u - from, 0.0, 1.0)));
    };
    return {part(0), part(1), part(2)};
}

/// What is left of a grid when the margin is cut.
struct Cut {
    std::uint32_t width, height, margin, full_width;
    Cut(std::uint32_t w, std::uint32_t h, std::uint32_t radius) : full_width(w) {
        margin = unjudged_margin({w, h}, radius);
        width = w - 2 * margin;
        height = h - 2 * margin;
    }
    template <class Paint>
    [[nodiscard]] Panel panel(Paint paint) const {
        Panel panel{width, height, {}};
        for (std::size_t y = margin; y < std::size_t{height} + margin; ++y)
            for (std::size_t x = margin; x < std::size_t{width} + margin; ++x)
                panel.pixels.push_back(paint(y * full_width + x));
        return panel;
    }
};

/// Panels side by side, so many in a row, pixels enlarged by whole numbers, on white.
io::Picture8 lay_out(const std::vector<Panel>& panels, std::uint32_t columns) {
    std::uint32_t scale_px = 0, wide = 0;
    for (const Panel& panel : panels) wide = std::max(wide, panel.width);
    scale_px = std::max(least_panel_px, wide);
    const auto scale = [&](const Panel& panel) { return std::max(1u, scale_px / std::max(panel.width, panel.height)); };
    std::uint32_t column = 0, height = gap_px;
    std::vector<std::uint32_t> top;
    for (std::size_t row = 0; row < panels.size(); row += columns) {
        top.push_back(height);
        column = std::max(column, panels[row].width * scale(panels[row]));
        height += panels[row].height * scale(panels[row]) + gap_px;
    }
    io::Picture8 picture{columns * column + (columns + 1) * gap_px, height, 3, {}};
    picture.codes.assign(std::size_t{3} * picture.width_px * picture.height_px, 255);
    for (std::size_t i = 0; i < panels.size(); ++i) {
        const Panel& panel = panels[i];
        const std::uint32_t s = scale(panel),
                            left = gap_px + static_cast<std::uint32_t>(i % columns) * (column + gap_px);
        for (std::uint32_t y = 0; y < panel.height * s; ++y)
            for (std::uint32_t x = 0; x < panel.width * s; ++x) {
                const Code& code = panel.pixels[std::size_t{y / s} * panel.width + x / s];
                std::copy(
                    code.begin(), code.end(),
                    picture.codes.begin() + static_cast<std::ptrdiff_t>(
                                                3 * (std::size_t{top[i / columns] + y} * picture.width_px + left + x)));
            }
    }
    return picture;
}

using Spreads = std::vector<SpreadImages>;  // by channel

/// Albedo as colours of D65.
Panel albedo_panel(const Cut& cut, const Spreads& spreads, const Eigen::Matrix3Xd& to_srgb) {
    return cut.panel([&](std::size_t i) {
        Eigen::VectorXd albedo(static_cast<Eigen::Index>(spreads.size()));
        for (std::size_t c = 0; c < spreads.size(); ++c) albedo[static_cast<Eigen::Index>(c)] = spreads[c].albedo[i];
        const Eigen::Vector3d colour = to_srgb * albedo;
        Code code{};
        for (std::size_t k = 0; k < 3; ++k)
            code[k] =
                io::linear_to_srgb8(static_cast<float>(std::clamp(colour[static_cast<Eigen::Index>(k)], 0.0, 1.0)));
        return code;
    });
}

/// Least and most mean distance, mm, of all but the outermost hundredth of the points.
std::array<double, 2> width_limits(const Cut& cut, const SpreadImages& spread) {
    std::vector<double> widths;
    (void)cut.panel([&](std::size_t i) { return widths.push_back(spread.width_mm[i]), Code{}; });
    std::sort(widths.begin(), widths.end());
    return {widths[widths.size() / 100], widths[widths.size() - 1 - widths.size() / 100]};
}

/// How far light goes, from black to white between two limits, mm.
Panel width_panel(const Cut& cut, const SpreadImages& spread, double least, double most) {
    const double range = std::max(1e-12, most - least);
    return cut.panel([&](std::size_t i) { return heat((spread.width_mm[i] - least) / range); });
}

/// A window of light per mm^2, on a logarithmic scale that ends at `most`.
Panel response_panel(const std::vector<double>& window, std::uint32_t side, double most) {
    Panel panel{side, side, {}};
    for (const double light : window)
        panel.pixels.push_back(heat(light > 0 ? 1 + std::log10(light / most) / decades : 0));
    return panel;
}

}  // namespace

std::uint32_t unjudged_margin(const PointGrid& grid, std::uint32_t radius) {
    return std::min(grid.width, grid.height) >= 3 * radius ? radius : 0;
}

std::size_t middle_point(const PointGrid& grid) { return std::size_t{grid.height / 2} * grid.width + grid.width / 2; }

ComparisonPicture draw_columns(const optics::Channels& channels, const PointGrid& grid, std::uint32_t radius,
                               std::size_t point, const std::vector<PictureColumn>& columns) {
    ComparisonPicture drawn;
    drawn.channel = channels.size() / 2;
    drawn.point = point;
    const Cut cut(grid.width, grid.height, radius);
    const auto [least_mm, most_mm] = width_limits(cut, columns[0].spreads[drawn.channel]);
    drawn.least_mm = least_mm;
    drawn.most_mm = most_mm;
    drawn.most_per_mm2 = *std::max_element(columns[0].window.begin(), columns[0].window.end());
    drawn.least_per_mm2 = drawn.most_per_mm2 * std::pow(10, -decades);

    std::vector<Panel> panels;
    const Eigen::Matrix3Xd to_srgb = optics::linear_srgb_weights(channels);
    for (const PictureColumn& column : columns) panels.push_back(albedo_panel(cut, column.spreads, to_srgb));
    for (const PictureColumn& column : columns)
        panels.push_back(width_panel(cut, column.spreads[drawn.channel], drawn.least_mm, drawn.most_mm));
    for (const PictureColumn& column : columns)
        panels.push_back(response_panel(column.window, 2 * radius + 1, drawn.most_per_mm2));
    drawn.picture = lay_out(panels, static_cast<std::uint32_t>(columns.size()));
    return drawn;
}

ComparisonPicture draw_comparison(const io::BssrdfFile& data, const ProfileMapResult& result,
                                  std::optional<std::size_t> chosen) {
    const optics::SampledBssrdf& responses = data.responses;
    const std::size_t channels = responses.channels.size();
    const PointGrid grid{responses.width, responses.height};
    const std::size_t point = chosen.value_or(middle_point(grid));
    return draw_columns(data.channels, grid, responses.radius, point,
                        {picture_column(responses, channels, point), picture_column(result.factored, channels, point),
                         picture_column(result.clustered, channels, point)});
}

}  // namespace voxtone::scattering
