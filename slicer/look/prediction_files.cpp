// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/prediction_files.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "base/contracts.h"
#include "slicer/look/cell_mesh.h"

namespace voxtone::slicer {

namespace {

std::vector<std::string> channel_names(const optics::Channels& channels, std::array<const char*, 3> rgb) {
    if (channels.is_rgb()) return {rgb.begin(), rgb.end()};
    std::vector<std::string> names;
    for (std::size_t c = 0; c < channels.size(); ++c) names.push_back(channel_word(channels, c));
    return names;
}

/// Pixel of a cell: the top row has the largest y.
class PixelOf {
public:
    PixelOf(const optics::ResinVolume& volume, const SurfacePrediction& prediction)
        : size_(picture_cells(volume, prediction.surface.cell_voxels)) {}
    [[nodiscard]] std::uint32_t width() const { return static_cast<std::uint32_t>(size_[0]); }
    [[nodiscard]] std::uint32_t height() const { return static_cast<std::uint32_t>(size_[1]); }
    [[nodiscard]] std::size_t pixels() const { return std::size_t{width()} * height(); }
    [[nodiscard]] std::size_t operator()(const optics::SurfaceCell& cell) const {
        return static_cast<std::size_t>(size_[1] - 1 - cell.cell[1]) * width() + static_cast<std::size_t>(cell.cell[0]);
    }

private:
    std::array<int, 2> size_;
};

}  // namespace

std::array<int, 2> picture_cells(const optics::ResinVolume& volume, const std::array<int, 3>& cell) {
    return {(volume.size()[0] + cell[0] - 1) / cell[0], (volume.size()[1] + cell[1] - 1) / cell[1]};
}

std::array<double, 2> picture_px_per_mm(const optics::ResinVolume& volume, const std::array<int, 3>& cell) {
    return {1 / (cell[0] * volume.pitch_mm()[0]), 1 / (cell[1] * volume.pitch_mm()[1])};
}

io::LinearPicture top_picture(const optics::ResinVolume& volume, const SurfacePrediction& prediction) {
    const PixelOf pixel_of(volume, prediction);
    io::LinearPicture picture{pixel_of.width(), pixel_of.height(), {}};
    picture.pixels.assign(pixel_of.pixels(), Eigen::Vector4f::Zero());
    for (std::size_t i = 0; i < prediction.rgb.size(); ++i)
        picture.pixels[pixel_of(prediction.surface.cells[i])] << prediction.rgb[i], 1.0f;
    return picture;
}

io::NumberPicture top_numbers(const optics::ResinVolume& volume, const optics::Channels& channels,
                              const SurfacePrediction& prediction) {
    const PixelOf pixel_of(volume, prediction);
    io::NumberPicture picture{pixel_of.width(), pixel_of.height(), {"R", "G", "B", "A"}, {}};
    const std::vector<std::string> names = channel_names(channels, {"R", "G", "B"});
    if (!channels.is_rgb()) picture.names.insert(picture.names.end(), names.begin(), names.end());
    const bool errors = !prediction.standard_error.empty();
    if (errors)
        for (const std::string& name : names) picture.names.push_back("error." + name);
    picture.values.assign(pixel_of.pixels() * picture.names.size(), 0.0f);
    for (std::size_t i = 0; i < prediction.rgb.size(); ++i) {
        float* to = picture.values.data() + pixel_of(prediction.surface.cells[i]) * picture.names.size();
        to = std::copy_n(prediction.rgb[i].data(), 3, to);
        *to++ = 1.0f;
        const auto of_cell = [&](const std::vector<float>& values) { return values.data() + i * prediction.channels; };
        if (!channels.is_rgb()) to = std::copy_n(of_cell(prediction.value), prediction.channels, to);
        if (errors) std::copy_n(of_cell(prediction.standard_error), prediction.channels, to);
    }
    return picture;
}

io::ColouredMesh body_mesh(const optics::ResinVolume& volume, const std::array<double, 3>& corner_mm,
                           const SurfacePrediction& prediction) {
    return body_mesh(cell_triangles(volume, prediction.surface), corner_mm, prediction);
}

io::ColouredMesh body_mesh(std::vector<std::array<std::uint32_t, 3>> triangles, const std::array<double, 3>& corner_mm,
                           const SurfacePrediction& prediction) {
    io::ColouredMesh mesh;
    const Eigen::Vector3d corner(corner_mm[0], corner_mm[1], corner_mm[2]);
    mesh.positions_mm.reserve(prediction.surface.cells.size());
    for (const optics::SurfaceCell& cell : prediction.surface.cells)
        mesh.positions_mm.push_back(
            (corner + Eigen::Vector3d(cell.centre_mm[0], cell.centre_mm[1], cell.centre_mm[2])).cast<float>());
    mesh.rgb = prediction.rgb;
    mesh.triangles = std::move(triangles);
    return mesh;
}

io::VertexNumbers body_numbers(const optics::Channels& channels, const SurfacePrediction& prediction) {
    const std::vector<std::string> names = channel_names(channels, {"r", "g", "b"});
    io::VertexNumbers numbers;
    for (const std::string& name : names) numbers.names.push_back("appearance_" + name);
    if (prediction.standard_error.empty()) {
        numbers.values = prediction.value;
        return numbers;
    }
    for (const std::string& name : names) numbers.names.push_back("error_" + name);
    numbers.values.reserve(2 * prediction.value.size());
    for (std::size_t i = 0; i < prediction.rgb.size(); ++i)
        for (const std::vector<float>* of : {&prediction.value, &prediction.standard_error}) {
            const auto first = of->begin() + static_cast<std::ptrdiff_t>(i * prediction.channels);
            numbers.values.insert(numbers.values.end(), first,
                                  first + static_cast<std::ptrdiff_t>(prediction.channels));
        }
    return numbers;
}

ColouredSurface mesh_surface(const io::ColouredMesh& mesh, std::vector<Eigen::Vector3d>& positions_mm) {
    positions_mm.clear();
    for (const Eigen::Vector3f& p : mesh.positions_mm) positions_mm.push_back(p.cast<double>());
    ColouredSurface surface;
    surface.positions_mm = positions_mm;
    surface.triangles = mesh.triangles;
    return recoloured(surface, mesh.rgb);
}

ColouredSurface recoloured(ColouredSurface surface, std::span<const Eigen::Vector3f> rgb) {
    surface.colour = [triangles = surface.triangles, rgb](std::uint32_t t, float u, float v) {
        const auto& [a, b, c] = triangles[t];
        return Eigen::Vector3f(((1 - u - v) * rgb[a] + u * rgb[b] + v * rgb[c]).cwiseMax(0.0f).cwiseMin(1.0f));
    };
    return surface;
}

io::LinearPicture side_by_side(std::span<const Preview> views) {
    constexpr std::uint32_t columns = 4, gap_px = views_gap_px;
    VOXTONE_EXPECT(!views.empty());
    std::uint32_t width = 0, height = 0;
    for (const Preview& view : views) {
        width = std::max(width, view.picture.width_px);
        height = std::max(height, view.picture.height_px);
    }
    const auto count = static_cast<std::uint32_t>(views.size()), across = std::min(count, columns),
               down = (count + columns - 1) / columns;
    io::LinearPicture sheet{across * (width + gap_px) - gap_px, down * (height + gap_px) - gap_px, {}};
    sheet.pixels.assign(std::size_t{sheet.width_px} * sheet.height_px, Eigen::Vector4f::Zero());
    for (std::uint32_t i = 0; i < count; ++i) {
        const io::LinearPicture& view = views[i].picture;
        const std::uint32_t left = i % columns * (width + gap_px) + (width - view.width_px) / 2;
        const std::uint32_t top = i / columns * (height + gap_px) + (height - view.height_px) / 2;
        for (std::uint32_t y = 0; y < view.height_px; ++y)
            std::copy_n(
                view.pixels.begin() + static_cast<std::ptrdiff_t>(std::size_t{y} * view.width_px), view.width_px,
                sheet.pixels.begin() + static_cast<std::ptrdiff_t>(std::size_t{top + y} * sheet.width_px + left));
    }
    return sheet;
}

}  // namespace voxtone::slicer
