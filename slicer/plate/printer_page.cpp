// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/printer_page.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/warning.h"
#include "io/printer/printer_folder.h"
#include "optics/colour/colour.h"
#include "slicer/surface/area_points.h"
#include "slicer/surface/surface_colour.h"

namespace voxtone::slicer {

namespace {

enum class Contact { none, support, elsewhere };  // elsewhere: in layers that are not of this stack

class Columns {
public:
    Columns(const io::StackDescription& stack, const io::TopmostLayers& topmost)
        : stack_(stack), topmost_(topmost.indices()), size_{int(stack.size_px[0]), int(stack.size_px[1])} {
        if (stack.orientation.swap_xy) std::swap(size_[0], size_[1]);
    }

    /// Of a face at this place of the print, in voxels from its corner.
    [[nodiscard]] Contact contact(const Eigen::Vector3d& at, const Eigen::Vector3d& normal) const {
        const double layer = at.z() - stack_.first_layer;
        if (layer < -0.5 || layer > stack_.layers + 0.5) return Contact::elsewhere;
        // The voxel before the face: a voxel and a half away, past what the staircase may still hold of the body.
        const Eigen::Vector3i voxel = (at + 1.5 * normal).array().floor().cast<int>();
        if (voxel.z() < 0) return Contact::support;  // the tray
        if (voxel.x() < 0 || voxel.x() >= size_[0] || voxel.y() < 0 || voxel.y() >= size_[1]) return Contact::none;
        const std::size_t pixel = pixel_of_column(stack_, std::uint32_t(voxel.x()), std::uint32_t(voxel.y()));
        return voxel.z() - int(stack_.first_layer) < int(topmost_[pixel]) ? Contact::support : Contact::none;
    }

private:
    const io::StackDescription& stack_;
    std::span<const std::uint16_t> topmost_;
    std::array<int, 2> size_;
};

class ColourFromAbove {
public:
    ColourFromAbove(const std::vector<PlacedBody>& bodies, const io::StackDescription& stack) : stack_(stack) {
        constexpr double spacing_mm = 0.2;
        for (const PlacedBody& placed : bodies)
            if (!placed.body.surface->triangles.empty())
                parts_.push_back({&placed, {placed.body.model.mesh, spacing_mm}});
    }

    [[nodiscard]] io::Rgb operator()(std::uint32_t i, std::uint32_t j, std::uint16_t top) const {
        const Eigen::Vector3d place(i + 0.5, j + 0.5, double(stack_.first_layer) + top);
        const double light = 0.8 + 0.2 * top / stack_.layers;
        for (const Part& part : parts_)
            for (const std::array<int, 3>& at : part.placed->at)
                if (const auto rgb = colour(part, place - Eigen::Vector3d(at[0], at[1], at[2]))) {
                    io::Rgb codes{};
                    for (Eigen::Index c = 0; c < 3; ++c)
                        codes[std::size_t(c)] = static_cast<std::uint8_t>(
                            std::lround(255 * light * optics::srgb_encode(std::clamp(double((*rgb)[c]), 0.0, 1.0))));
                    return codes;
                }
        const auto grey = static_cast<std::uint8_t>(std::lround(200 * light));
        return {grey, grey, grey};
    }

private:
    struct Part {
        const PlacedBody* placed;
        SurfaceColour colour;
    };
    /// Of the surface that is within four voxels of there, in voxels from the corner of the body's grid.
    [[nodiscard]] static std::optional<Eigen::Vector3f> colour(const Part& part, const Eigen::Vector3d& voxel) {
        constexpr double near = 4;
        const JobBody& body = part.placed->body;
        for (Eigen::Index a = 0; a < 3; ++a)
            if (voxel[a] < -near || voxel[a] > body.grid.size[std::size_t(a)] + near) return std::nullopt;
        const Eigen::Vector3d p = body.grid.origin_mm + voxel.cwiseProduct(body.grid.pitch_mm);
        const TriangleTree& tree = body.surface.tree();
        const auto found = tree.nearest(p, TriangleTree::none, near * body.grid.pitch_mm.maxCoeff());
        if (found.triangle == TriangleTree::none) return std::nullopt;
        const auto [a, b, c] = tree.corners(found.triangle);
        const Eigen::Vector3f weight = nearest_weights(found.point, a, b, c).cast<float>();
        const auto& uv = body.surface->source_uv[found.triangle];
        const Eigen::Vector2f at = weight[0] * uv[0] + weight[1] * uv[1] + weight[2] * uv[2];
        return part.colour.at(body.surface->source_triangle[found.triangle], at.x(), at.y());
    }

    const io::StackDescription& stack_;
    std::vector<Part> parts_;
};

/// What of the print has an outside. Of a picture the face alone takes colour, and its slab has other sides, too.
VisibleSurface outside_of(const JobBody& body) {
    if (!body.is_picture) return *body.surface;
    VisibleSurface sides;
    sides.positions_mm = body.model.mesh.positions;
    sides.triangles = body.model.mesh.triangles;
    for (std::uint32_t t = 0; t < sides.triangles.size(); ++t) {
        sides.source_triangle.push_back(t);
        sides.source_uv.push_back({Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)});
    }
    return sides;
}

/// The middle nine tenths.
std::array<double, 2> range_of(std::vector<double>& values) {
    if (values.empty()) return {0, 0};
    std::sort(values.begin(), values.end());
    return {values[values.size() / 20], values[values.size() - 1 - values.size() / 20]};
}

}  // namespace

ColourOfColumn colour_from_above(const std::vector<PlacedBody>& bodies, const io::StackDescription& stack) {
    return ColourFromAbove(bodies, stack);
}

PartFinish finish_of(const PlacedBody& placed, const io::StackDescription& stack, const io::TopmostLayers& topmost) {
    const JobBody& body = placed.body;
    const VisibleSurface outside = outside_of(body);
    const std::vector<AreaPoint> pieces = area_points(outside, body.model.mesh);
    PartFinish finish;
    finish.name = placed.name;
    finish.copies = int(placed.at.size());
    if (pieces.empty() || placed.at.empty()) return finish;
    const Columns columns(stack, topmost);
    // Of many copies each is looked at in fewer places.
    constexpr std::size_t most = 1'000'000;
    const std::size_t stride = (pieces.size() * placed.at.size() + most - 1) / most;
    const double of_copy_mm2 =
        coloured_area_mm2(outside) / double((pieces.size() + stride - 1) / stride) / double(placed.at.size());
    std::vector<double> heights_mm;
    for (const std::array<int, 3>& at : placed.at)
        for (std::size_t p = 0; p < pieces.size(); p += stride) {
            const AreaPoint& piece = pieces[p];
            const Eigen::Vector3d voxel = (piece.at_mm - body.grid.origin_mm).cwiseQuotient(body.grid.pitch_mm) +
                                          Eigen::Vector3d(at[0], at[1], at[2]);
            const Contact contact = columns.contact(voxel, piece.normal);
            if (contact == Contact::elsewhere) continue;
            finish.surface_mm2 += of_copy_mm2;
            if (!piece.white) finish.coloured_mm2 += of_copy_mm2;
            if (contact == Contact::none) continue;
            finish.matt_mm2 += of_copy_mm2;
            if (piece.white) continue;
            finish.coloured_matt_mm2 += of_copy_mm2;
            if (piece.normal.z() < -0.5) finish.coloured_down_mm2 += of_copy_mm2;
            heights_mm.push_back(std::max(0.0, voxel.z() * body.grid.pitch_mm.z()));
        }
    finish.coloured_matt_height_mm = range_of(heights_mm);
    return finish;
}

io::PageOfStack printer_page(const OpenedJob& job, std::string title, std::vector<PlacedBody> bodies,
                             std::vector<std::string> missing) {
    return [&job, title = std::move(title), bodies = std::move(bodies), missing = std::move(missing)](
               const io::StackDescription& stack, const io::TopmostLayers& topmost) {
        PictureFromAbove from_above =
            picture_from_above(stack, topmost, colour_from_above(bodies, stack), "in the colours that were asked for");
        HowToPrint what{title, job.outputs(), {}, std::move(from_above), {}, missing, {}};
        std::map<std::string, std::vector<std::string>> fragile;  // copies and parts alike are told together
        for (const PlacedBody& placed : bodies) {
            what.parts.push_back(finish_of(placed, stack, topmost));
            for (const std::string& warning : placed.body.warnings)
                if (message_name(warning) == fragile_warning)  // what would help stands behind the places
                    fragile[warning.substr(0, warning.find(". "))].push_back(placed.name);
        }
        for (const auto& [walls, names] : fragile)
            what.fragile.push_back(fmt::format("{}: {}", fmt::join(names, ", "), walls));
        return how_to_print_page(stack, job.printer, what);
    };
}

void hand_over(const std::filesystem::path& out, const std::filesystem::path& target, bool overwrite,
               Progress& progress) {
    if (target.empty()) return;
    const bool made = io::hand_to_printer(out, target, overwrite, &progress);
    const bool alone = target.extension() == ".gcvf";
    const std::string with =
        alone ? fmt::format("; how to print it: {}", (out / io::printer_folder_name / io::how_to_print_name).string())
              : ", and how to print it";
    progress.note(
        fmt::format("{}: {}", target.string(),
                    made ? "what the printer's computer takes" + with : "holds this print for the printer already"));
}

}  // namespace voxtone::slicer
