// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/predict/parts_in_sight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "base/contracts.h"
#include "base/parallel.h"
#include "base/random.h"
#include "optics/profiles/saunderson.h"
#include "slicer/look/cell_mesh.h"
#include "slicer/mesh/mesh_boundary.h"

namespace voxtone::slicer {

namespace {

constexpr std::size_t cells_at_once = 256;

Eigen::Vector3d three(const std::array<float, 3>& v) {
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

/// Direction k of a cell, by the cosine law about its normal.
optics::Point sight_line(const Eigen::Vector3d& normal, std::size_t k, double turned) {
    const double golden = std::numbers::phi - 1,
                 u = (static_cast<double>(k) + 0.5) / static_cast<double>(PartsInSight::directions),
                 turn = 2 * std::numbers::pi * (golden * static_cast<double>(k) + turned);
    const Eigen::Vector3d across = normal.unitOrthogonal(), along = normal.cross(across);
    const Eigen::Vector3d d =
        std::sqrt(1 - u) * normal + std::sqrt(u) * (std::cos(turn) * across + std::sin(turn) * along);
    return {d[0], d[1], d[2]};
}

/// Diffuse light in air that the surface mirrors.
double mirrored_from_outside(double eta) { return 1 - eta * eta * (1 - optics::internal_diffuse_reflectance(eta)); }

class ShadedModel final : public optics::AppearanceModel {
public:
    ShadedModel(std::unique_ptr<const optics::AppearanceModel> model, const PartsInSight& parts)
        : model_(std::move(model)), parts_(parts) {}
    [[nodiscard]] optics::Appearance predict(const optics::Scene& scene, const optics::Surface& surface,
                                             const Progress* progress) const override {
        return shaded(model_->predict(scene, surface, progress), *scene.resins);
    }
    [[nodiscard]] optics::TwinAppearances predict_with_twin(const optics::Scene& scene, const optics::Surface& surface,
                                                            const optics::ResinVolume& twin,
                                                            const Progress* progress) const override {
        auto seen = model_->predict_with_twin(scene, surface, twin, progress);
        return {shaded(std::move(seen.body), *scene.resins), shaded(std::move(seen.twin), *scene.resins)};
    }

private:
    [[nodiscard]] optics::Appearance shaded(optics::Appearance seen, const optics::ResinSet& resins) const {
        VOXTONE_EXPECT(seen.standard_error.empty());
        parts_.shade(seen.value, seen.channels, resins.eta);
        return seen;
    }

    std::unique_ptr<const optics::AppearanceModel> model_;
    const PartsInSight& parts_;
};

}  // namespace

PartsInSight::PartsInSight(const optics::ResinVolume& volume, const optics::Surface& surface,
                           const Progress* progress) {
    const std::size_t n = surface.cells.size();
    first_.assign(n + 1, 0);
    const std::vector<std::array<std::uint32_t, 3>> triangles = cell_triangles(volume, surface);
    if (triangles.empty()) return;
    std::vector<Eigen::Vector3d> positions;
    for (const optics::SurfaceCell& cell : surface.cells) positions.push_back(three(cell.centre_mm));
    const MeshBoundary mesh(positions, triangles, Eigen::Vector3d::Zero());
    double above_mm = 0;
    for (std::size_t a = 0; a < 3; ++a)
        above_mm = std::max(above_mm, 0.5 * surface.cell_voxels[a] * volume.pitch_mm()[a]);

    std::vector<std::vector<std::uint32_t>> met((n + cells_at_once - 1) / cells_at_once);
    std::vector<std::uint8_t> count(n);
    static_assert(directions <= 255);
    parallel_for(
        0, met.size(), 1,
        [&](std::size_t part) {
            for (std::size_t i = part * cells_at_once; i < std::min(n, (part + 1) * cells_at_once); ++i) {
                const Eigen::Vector3d normal = three(surface.cells[i].normal), from = positions[i] + above_mm * normal;
                const double turned = RandomStream(0, i).uniform();
                for (std::size_t k = 0; k < directions; ++k)
                    if (const auto cell = mesh.corner_met({from[0], from[1], from[2]}, sight_line(normal, k, turned))) {
                        met[part].push_back(*cell);
                        ++count[i];
                    }
            }
        },
        progress);
    for (std::size_t i = 0; i < n; ++i) first_[i + 1] = first_[i] + count[i];
    met_.reserve(first_[n]);
    for (std::vector<std::uint32_t>& of_part : met) {
        met_.insert(met_.end(), of_part.begin(), of_part.end());
        of_part = {};
    }
}

std::vector<float> PartsInSight::open_sky() const {
    std::vector<float> open;
    for (std::size_t i = 0; i + 1 < first_.size(); ++i)
        open.push_back(1 - static_cast<float>(first_[i + 1] - first_[i]) / static_cast<float>(directions));
    return open;
}

void PartsInSight::shade(std::span<float> value, std::size_t channels, double eta) const {
    const std::size_t n = first_.size() - 1;
    VOXTONE_EXPECT(value.size() == n * channels);
    if (met_.empty()) return;
    // Each bounce keeps what a fold does not send to the sky: in the deepest and whitest some hundred are needed.
    constexpr int most_bounces = 500;
    constexpr float settled = 1e-4f;
    const auto mirrored = static_cast<float>(mirrored_from_outside(eta));
    std::vector<float> light(value.size(), 1.0f), next(value.size());
    std::vector<float> change(n);
    for (int bounce = 0; bounce < most_bounces; ++bounce) {
        parallel_for(0, n, 1024, [&](std::size_t i) {
            const std::size_t begin = first_[i], end = first_[i + 1];
            change[i] = 0;
            for (std::size_t c = 0; c < channels; ++c) {
                float from_parts = 0;
                for (std::size_t k = begin; k < end; ++k) {
                    const std::size_t j = met_[k] * channels + c;
                    from_parts += (mirrored + (1 - mirrored) * std::clamp(value[j], 0.0f, 1.0f)) * light[j];
                }
                const float open = static_cast<float>(directions) - static_cast<float>(end - begin);
                const std::size_t at = i * channels + c;
                next[at] = (open + from_parts) / static_cast<float>(directions);
                change[i] = std::max(change[i], std::abs(next[at] - light[at]));
            }
        });
        std::swap(light, next);
        if (*std::max_element(change.begin(), change.end()) < settled) break;
    }
    for (std::size_t i = 0; i < value.size(); ++i) value[i] *= light[i];
}

std::size_t PartsInSight::memory_bytes() const {
    return first_.size() * sizeof first_[0] + met_.size() * sizeof met_[0];
}

std::unique_ptr<const optics::AppearanceModel> with_light_between_parts(
    std::unique_ptr<const optics::AppearanceModel> model, const PartsInSight& parts) {
    return std::make_unique<const ShadedModel>(std::move(model), parts);
}

}  // namespace voxtone::slicer
