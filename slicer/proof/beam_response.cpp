// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/proof/beam_response.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "optics/camera/sky.h"
#include "slicer/proof/proof_colours.h"

namespace voxtone::slicer {

namespace {

using optics::BeamPlane, optics::BeamShape, optics::Point;

constexpr std::size_t blocks = 8;
constexpr auto no_block = blocks;

struct FacePixel {
    double along = 0, across = 0;  ///< from the plane's place
    double outside = 0;
    double luminance = 0;
};

std::vector<FacePixel> face_pixels(const ProofScene& scene, const optics::Beam& beam, const BeamPlane& plane,
                                   const SeenPiece& piece, const std::vector<Eigen::Vector3f>& colours) {
    const optics::Camera camera(scene.camera.view);
    std::vector<FacePixel> pixels;
    for (const std::size_t p : piece.pixels) {
        const auto seen = seen_print(scene, camera, p);
        if (!seen || optics::dot(seen->normals.geometric, plane.normal) < 0.999) continue;
        const Point at = optics::along(seen->place_mm, scene.camera.prints[seen->print].corner_mm, 1),
                    off = optics::along(at, plane.place, -1);
        const Eigen::Vector3f& rgb = colours[p];
        pixels.push_back({optics::dot(off, plane.along), optics::dot(off, optics::cross(plane.normal, plane.along)),
                          beam.outside_mm(plane, at), optics::luminance({rgb.x(), rgb.y(), rgb.z()})});
    }
    return pixels;
}

struct FaceExtent {
    double low = std::numeric_limits<double>::infinity(), high = -low;
};
FaceExtent extent(const std::vector<FacePixel>& pixels, double FacePixel::*of) {
    FaceExtent e;
    for (const FacePixel& pixel : pixels) e = {std::min(e.low, pixel.*of), std::max(e.high, pixel.*of)};
    return e;
}

/// Pixels that lie as far from the border, to half a pixel, by block.
struct PixelRow {
    std::array<double, blocks> luminance{}, outside{}, count{};

    [[nodiscard]] bool whole() const {
        return std::all_of(count.begin(), count.end(), [](double n) { return n > 0; });
    }
    [[nodiscard]] double mean(const std::array<double, blocks>& of, std::size_t without = no_block) const {
        double all = 0, n = 0;
        for (std::size_t b = 0; b < blocks; ++b)
            if (b != without) all += of[b], n += count[b];
        return all / n;
    }
    /// Of the mean luminance.
    [[nodiscard]] double error() const {
        double all = 0, squares = 0;
        for (std::size_t b = 0; b < blocks; ++b) {
            const double x = luminance[b] / count[b];
            all += x / blocks, squares += x * x / blocks;
        }
        return std::sqrt(std::max(0.0, squares - all * all) / (blocks - 1));
    }
};

/// From within the beam outward; of each a pixel in every block.
std::vector<PixelRow> rows_of(const std::vector<FacePixel>& pixels, BeamShape shape, double row_mm) {
    const FaceExtent along = extent(pixels, &FacePixel::along), across = extent(pixels, &FacePixel::across),
                     outside = extent(pixels, &FacePixel::outside);
    const double inscribed = std::min({-along.low, along.high, -across.low, across.high}),
                 length = along.high - along.low;
    const auto number = [&](double of) { return static_cast<int>(std::lround(of / row_mm)); };
    const int first = number(outside.low);
    std::vector<PixelRow> rows(static_cast<std::size_t>(number(outside.high) - first + 1));
    for (const FacePixel& pixel : pixels) {
        double share = 0;  // through the blocks
        if (shape == BeamShape::spot) {
            if (std::hypot(pixel.along, pixel.across) > inscribed) continue;
            share = std::atan2(pixel.across, pixel.along) / (2 * std::numbers::pi) + 0.5;
        } else {
            share = 2 * ((pixel.along - along.low) / length - 0.25);
            if (share < 0 || share > 1) continue;
        }
        PixelRow& row = rows[static_cast<std::size_t>(number(pixel.outside) - first)];
        const std::size_t block = std::min(static_cast<std::size_t>(share * blocks), blocks - 1);
        row.luminance[block] += pixel.luminance;
        row.outside[block] += pixel.outside;
        row.count[block] += 1;
    }
    std::erase_if(rows, [](const PixelRow& row) { return !row.whole(); });
    return rows;
}

/// Where it first falls to a share of what it is at the border; nothing also where the border is not within the rows.
std::optional<double> falls_to(const std::vector<PixelRow>& rows, double share, std::size_t without = no_block) {
    const auto distance = [&](const PixelRow& row) { return row.mean(row.outside, without); };
    const auto luminance = [&](const PixelRow& row) { return row.mean(row.luminance, without); };
    auto row = std::find_if(rows.begin(), rows.end(), [](const PixelRow& r) { return r.mean(r.outside) >= 0; });
    if (row == rows.begin() || row == rows.end()) return std::nullopt;
    const double within = distance(row[-1]), beyond = distance(*row);
    double at = 0, before = luminance(*row) + beyond / (beyond - within) * (luminance(row[-1]) - luminance(*row));
    const double wanted = share * before;
    for (; row != rows.end(); ++row) {
        const double next = distance(*row), value = luminance(*row);
        if (value <= wanted) return at + (next - at) * (before - wanted) / (before - value);
        at = next, before = value;
    }
    return std::nullopt;
}

std::optional<FallDistance> fall_of(const std::vector<PixelRow>& rows, double share) {
    const auto mm = falls_to(rows, share);
    if (!mm) return std::nullopt;
    double all = 0, squares = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
        const auto one = falls_to(rows, share, b);
        if (!one) return std::nullopt;
        all += *one / blocks, squares += *one * *one / blocks;
    }
    return FallDistance{*mm, std::sqrt((blocks - 1) * std::max(0.0, squares - all * all))};
}

/// Edge of a pixel where the beam falls.
double pixel_mm(const optics::CameraView& view, const Point& at) {
    const Eigen::Vector3d ahead = (vector_of(view.target) - vector_of(view.position)).normalized();
    return (vector_of(at) - vector_of(view.position)).dot(ahead) * optics::film_width_mm / view.focal_mm /
           view.width_px;
}

std::optional<BeamResponse> response_of(const std::vector<FacePixel>& pixels, const SeenPiece& piece, BeamShape shape,
                                        double row_mm) {
    if (pixels.empty()) return std::nullopt;
    const std::vector<PixelRow> rows = rows_of(pixels, shape, row_mm);
    if (rows.empty()) return std::nullopt;
    BeamResponse response{piece.print, piece.slab, {}, {}, {}, {}, {}};
    for (const PixelRow& row : rows) {
        response.distance_mm.push_back(row.mean(row.outside));
        response.luminance.push_back(row.mean(row.luminance));
        response.standard_error.push_back(row.error());
    }
    response.half = fall_of(rows, 0.5);
    response.tenth = fall_of(rows, 0.1);
    return response;
}

}  // namespace

std::vector<BeamResponse> beam_responses(const ProofScene& scene, const optics::Beam& beam,
                                         const std::vector<SeenPiece>& pieces,
                                         const std::vector<Eigen::Vector3f>& colours) {
    std::vector<BeamResponse> responses;
    for (const SeenPiece& piece : pieces) {
        if (piece.slab < 0) continue;
        for (const BeamPlane& plane : beam.planes()) {
            const auto pixels = face_pixels(scene, beam, plane, piece, colours);
            auto response = response_of(pixels, piece, beam.kind().shape, pixel_mm(scene.camera.view, plane.place));
            if (response) responses.push_back(std::move(*response));
        }
    }
    return responses;
}

}  // namespace voxtone::slicer
