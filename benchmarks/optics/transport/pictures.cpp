// SPDX-License-Identifier: GPL-3.0-or-later
#include "pictures.h"

#include <cmath>

#include "io/files/whole_file.h"
#include "io/pictures/picture_writer.h"

namespace voxtone::accuracy {
namespace {

constexpr double largest_shown = 5;

/// Which cell is seen at every pixel, or -1; rows from the top.
struct View {
    std::uint32_t width = 0, height = 0;
    std::vector<int> cell;
};

/// Slab from above: one pixel per viewing cell. The cells are square within 0.01 %.
View from_above(const optics::Surface& surface) {
    View view;
    for (const auto& cell : surface.cells) {
        view.width = std::max(view.width, static_cast<std::uint32_t>(cell.cell[0] + 1));
        view.height = std::max(view.height, static_cast<std::uint32_t>(cell.cell[1] + 1));
    }
    view.cell.assign(std::size_t{view.width} * view.height, -1);
    for (std::size_t i = 0; i < surface.cells.size(); ++i)
        view.cell[(view.height - 1 - static_cast<std::size_t>(surface.cells[i].cell[1])) * view.width +
                  static_cast<std::size_t>(surface.cells[i].cell[0])] = static_cast<int>(i);
    return view;
}

/// Body seen from 25 degrees beside -y and 20 degrees above: the frontmost cell whose centre is nearest to the pixel.
View from_the_front(const optics::Surface& surface) {
    constexpr double px = 0.045, reach = 0.075;  // mm
    const double around = 25 * M_PI / 180, up = 20 * M_PI / 180;
    const std::array<double, 3> right{std::cos(around), std::sin(around), 0},
        eye{std::sin(around) * std::cos(up), -std::cos(around) * std::cos(up), std::sin(up)},
        above{-std::sin(around) * std::sin(up), std::cos(around) * std::sin(up), std::cos(up)};
    const auto dot = [](const std::array<double, 3>& a, const std::array<float, 3>& b) {
        return a[0] * static_cast<double>(b[0]) + a[1] * static_cast<double>(b[1]) + a[2] * static_cast<double>(b[2]);
    };
    double left = 1e9, most = -1e9, low = 1e9, high = -1e9;
    for (const auto& cell : surface.cells) {
        left = std::min(left, dot(right, cell.centre_mm) - 0.1);
        most = std::max(most, dot(right, cell.centre_mm) + 0.1);
        low = std::min(low, dot(above, cell.centre_mm) - 0.1);
        high = std::max(high, dot(above, cell.centre_mm) + 0.1);
    }
    View view;
    view.width = static_cast<std::uint32_t>((most - left) / px);
    view.height = static_cast<std::uint32_t>((high - low) / px);
    view.cell.assign(std::size_t{view.width} * view.height, -1);
    std::vector<double> score(view.cell.size(), -1e9);
    for (std::size_t i = 0; i < surface.cells.size(); ++i) {
        const auto& cell = surface.cells[i];
        if (dot(eye, cell.normal) <= 0.05) continue;
        const double u = (dot(right, cell.centre_mm) - left) / px, v = (high - dot(above, cell.centre_mm)) / px;
        const double depth = dot(eye, cell.centre_mm);
        for (int y = static_cast<int>(v - reach / px); y <= static_cast<int>(v + reach / px); ++y)
            for (int x = static_cast<int>(u - reach / px); x <= static_cast<int>(u + reach / px); ++x) {
                if (x < 0 || y < 0 || x >= static_cast<int>(view.width) || y >= static_cast<int>(view.height)) continue;
                const double away = std::hypot(x + 0.5 - u, y + 0.5 - v) * px;
                if (away > reach) continue;
                const std::size_t at = static_cast<std::size_t>(y) * view.width + static_cast<std::size_t>(x);
                // In front by more than a cell wins; else the nearer centre.
                const double s = std::floor(depth / 0.25) * 10 - away;
                if (s > score[at]) {
                    score[at] = s;
                    view.cell[at] = static_cast<int>(i);
                }
            }
    }
    return view;
}

}  // namespace

void write_side_by_side(const std::filesystem::path& file, const Reference& reference, const Comparison& comparison,
                        const std::vector<Rgb>& target) {
    const bool flat = reference.of.part == optics::SurfacePart::top;
    const View view = flat ? from_above(comparison.surface) : from_the_front(comparison.surface);
    std::vector<Rgb> difference;
    for (const float e : comparison.error) {
        const auto grey = static_cast<float>(std::pow(std::min(1.0, static_cast<double>(e) / largest_shown), 2.2));
        difference.push_back({grey, grey, grey});
    }
    std::vector<const std::vector<Rgb>*> panels{&comparison.reference, &comparison.predicted, &difference};
    if (!target.empty()) panels.insert(panels.begin(), &target);
    const std::uint32_t zoom = flat ? std::max(1u, 360 / view.width) : 4u, gap = 6;
    io::LinearPicture picture;
    picture.width_px = static_cast<std::uint32_t>(panels.size()) * (view.width * zoom + gap) - gap;
    picture.height_px = view.height * zoom;
    picture.pixels.assign(std::size_t{picture.width_px} * picture.height_px, Eigen::Vector4f::Zero());
    for (std::size_t p = 0; p < panels.size(); ++p)
        for (std::uint32_t y = 0; y < picture.height_px; ++y)
            for (std::uint32_t x = 0; x < view.width * zoom; ++x) {
                const int cell = view.cell[std::size_t{y / zoom} * view.width + x / zoom];
                if (cell < 0) continue;
                const Rgb& rgb = (*panels[p])[static_cast<std::size_t>(cell)];
                const auto clamp = [](float v) { return std::min(1.0f, std::max(0.0f, v)); };
                picture.pixels[std::size_t{y} * picture.width_px + p * (view.width * zoom + gap) + x] = {
                    clamp(rgb[0]), clamp(rgb[1]), clamp(rgb[2]), 1.0f};
            }
    io::write_whole_file(file, io::png_bytes(io::encode_over(picture, Eigen::Vector3f::Constant(0.9f))));
}

}  // namespace voxtone::accuracy
