// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/predict/top_print.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"
#include "halftone/loop/eye_filter.h"
#include "optics/colour/observed_colour.h"
#include "optics/profiles/saunderson.h"
#include "slicer/look/prediction_files.h"

namespace voxtone::slicer {

namespace {

constexpr double mixture_depth_mm = 0.2;

/// Of an endless mixture, by channel.
class ThickMixture {
public:
    explicit ThickMixture(const optics::ResinSet& resins)
        : resins_(resins), inside_(optics::internal_diffuse_reflectance(resins.eta)) {}

    /// `share` of each resin; the extinction of `changed` is so many times its own.
    void reflectance(const std::vector<double>& share, std::size_t changed, double times, double* out) const {
        for (std::size_t c = 0; c < resins_.channels.size(); ++c) {
            double scattered = 0, lost = 0;
            for (std::size_t r = 0; r < share.size(); ++r) {
                const optics::Medium m = resins_.resins[r].medium(c);
                const double part = share[r] * (r == changed ? times : 1);
                scattered += part * m.sigma_s;
                lost += part * m.sigma_t();
            }
            const double albedo = lost > 0 ? scattered / lost : 1;
            const double s = std::sqrt(std::max(1 - albedo, 0.0) / (1 - resins_.g * albedo));
            const double below = (1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s);
            out[c] = optics::seen_through_surface(below, inside_);
        }
    }

private:
    const optics::ResinSet& resins_;
    double inside_;
};

/// Shares of resins below the uppermost faces of a cell.
std::vector<double> mixture_below(const optics::ResinVolume& volume, const optics::Surface& surface,
                                  const optics::SurfaceCell& cell, std::size_t resins) {
    const int depth = std::max(1, int(std::lround(5 * mixture_depth_mm / volume.pitch_mm()[2])));
    std::vector<double> share(resins, 0.0);
    double sum = 0;
    for (std::uint32_t f = cell.first_face; f < cell.first_face + cell.faces; ++f) {
        const auto& voxel = surface.faces[f].voxel;
        for (int k = 0; k < depth && int(voxel[2]) - k >= 0; ++k) {
            const optics::Material material = volume.at(voxel[0], voxel[1], voxel[2] - k);
            if (material == optics::air || material > resins) continue;
            const double weight = std::exp(-k * volume.pitch_mm()[2] / mixture_depth_mm);
            share[material - std::size_t{1}] += weight;
            sum += weight;
        }
    }
    for (double& part : share) part /= std::max(sum, 1e-12);
    return share;
}

void add_changes(const optics::ResinSet& set, const optics::ObservedColour<double>& observed,
                 const std::vector<double>& share, const double* white, Eigen::Vector3f* out) {
    constexpr double step = 0.02;
    const ThickMixture mixture(set);
    std::vector<double> value(set.channels.size());
    const auto colour = [&](std::size_t resin, double times) -> Eigen::Vector3d {
        mixture.reflectance(share, resin, times, value.data());
        return white ? observed.relative(value.data(), white) : observed.absolute(value.data());
    };
    for (std::size_t r = 0; r < share.size(); ++r) {
        const Eigen::Vector3d more = colour(r, 1 + step).cwiseMax(1e-4), less = colour(r, 1 - step).cwiseMax(1e-4);
        out[r] = ((more.array() / less.array()).log() / (2 * step)).matrix().cast<float>();
    }
}

void find_changes(const PredictedStack& predicted, TopPrint& top) {
    const optics::ResinSet& set = predicted.stack.resins;
    const std::size_t resins = set.resins.size();
    const optics::ObservedColour<double> observed(set.channels);
    std::vector<double> white(set.channels.size());
    const bool relative = predicted.stack.white >= 0;
    if (relative) {
        std::vector<double> all(resins, 0.0);
        all[std::size_t(predicted.stack.white)] = 1;
        ThickMixture(set).reflectance(all, resins, 1, white.data());
    }
    top.by_extinction.resize(top.rgb.size() * resins);
    parallel_for(0, top.rgb.size(), 64, [&](std::size_t i) {
        const std::vector<double> share =
            mixture_below(predicted.stack.volume, top.surface, top.surface.cells[top.cell_of[i]], resins);
        add_changes(set, observed, share, relative ? white.data() : nullptr, top.by_extinction.data() + i * resins);
    });
    for (const optics::Resin& resin : set.resins) top.resins.push_back(fmt::format("{} ({})", resin.name, resin.role));
}

}  // namespace

TopPrint predict_top_print(const PredictOptions& options, Progress& progress) {
    PredictedStack predicted = predict_from_above(options, progress);
    optics::Surface& surface = predicted.prediction.surface;
    const auto size = picture_cells(predicted.stack.volume, surface.cell_voxels);
    const auto px_per_mm = picture_px_per_mm(predicted.stack.volume, surface.cell_voxels);
    TopPrint top;
    top.columns = size[0], top.rows = size[1];
    top.cell_mm = {1 / px_per_mm[0], 1 / px_per_mm[1]};
    const std::size_t cells = std::size_t(size[0]) * std::size_t(size[1]);
    if (surface.cells.size() != cells)
        throw InputError(fmt::format(
            "{}: the slab has holes or no straight outline: {} of the {} cells of its box are there, and photographs "
            "are compared with slabs that fill theirs",
            options.stack, surface.cells.size(), cells));
    top.rgb.resize(cells);
    top.cell_of.resize(cells);
    for (std::size_t i = 0; i < cells; ++i) {
        const optics::SurfaceCell& cell = surface.cells[i];
        const std::size_t at =
            std::size_t(size[1] - 1 - cell.cell[1]) * std::size_t(size[0]) + std::size_t(cell.cell[0]);
        top.rgb[at] = predicted.prediction.rgb[i];
        top.cell_of[at] = i;
    }
    top.surface = std::move(surface);
    find_changes(predicted, top);
    return top;
}

SeenPicture eye_over(const TopPrint& top, double viewing_distance_mm) {
    const auto eye = std::make_shared<const halftone::EyeFilter>(top.surface, viewing_distance_mm);
    return [eye, cell_of = top.cell_of](std::span<const Eigen::Vector3f> rgb) {
        std::vector<Eigen::Vector3f> by_cell(rgb.size()), seen;
        for (std::size_t i = 0; i < rgb.size(); ++i) by_cell[cell_of[i]] = rgb[i];
        by_cell = eye->filter(by_cell);
        for (const std::size_t cell : cell_of) seen.push_back(by_cell[cell]);
        return seen;
    };
}

}  // namespace voxtone::slicer
