// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/separation/separation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"
#include "halftone/separation/invert_appearance.h"
#include "optics/colour/colour.h"

namespace voxtone::halftone {

namespace {

void validate(const SeparationOptions& options) {
    const auto need = [](bool good, const char* name, double value, const char* rule) {
        if (!good) throw UsageError(fmt::format("separation: {} = {}: {}", name, value, rule));
    };
    need(options.nodes >= 2 && options.nodes <= 65, "nodes", options.nodes, "must be 2 to 65");
    need(options.ink_penalty > 0, "ink_penalty", options.ink_penalty, "must be above 0");
    need(options.clear_penalty > 0, "clear_penalty", options.clear_penalty, "must be above 0");
    need(options.lightness_weight > 0 && options.chroma_weight > 0 && options.hue_weight > 0, "weights",
         options.hue_weight, "must be above 0");
}

/// A resin that changes nothing: through a shell of it the core shows as it is.
bool is_clear(const optics::ShellAppearance& appearance, std::size_t resin) {
    std::vector<double> alone(appearance.resins(), 0.0);
    if (resin == std::size_t(appearance.geometry().white())) return false;
    alone[resin] = 1;
    const std::vector<double> seen = appearance.media_relative(alone);
    // Through a clear shell the core is seen, dimmed by nothing but the light that the shell lets past.
    return *std::min_element(seen.begin(), seen.end()) > 0.9;
}

}  // namespace

Separation::Separation(const optics::ShellAppearance& appearance, const SeparationOptions& options,
                       const Progress* progress, const std::vector<float>& lattice)
    : colour_(appearance, options.channels), resins_(appearance.resins()), nodes_(options.nodes) {
    validate(options);
    VOXTONE_EXPECT(resins_ >= 1 && resins_ <= std::size_t(max_resins));
    if (!take(lattice)) solve(options, progress);
}

bool Separation::take(const std::vector<float>& lattice) {
    const auto size = std::size_t(nodes_);
    if (lattice.size() != size * size * size * max_resins) return false;
    lattice_.resize(size * size * size);
    for (std::size_t i = 0; i < lattice.size(); ++i) lattice_[i / max_resins].root[i % max_resins] = lattice[i];
    return true;
}

std::vector<float> Separation::lattice() const {
    std::vector<float> lattice;
    lattice.reserve(lattice_.size() * max_resins);
    for (const Node& node : lattice_) lattice.insert(lattice.end(), node.root.begin(), node.root.end());
    return lattice;
}

void Separation::solve(const SeparationOptions& options, const Progress* progress) {
    const auto n = static_cast<Eigen::Index>(resins_);
    const auto white = static_cast<Eigen::Index>(colour_.appearance().geometry().white());
    Unknowns penalty = Unknowns::Constant(n, options.ink_penalty);
    penalty[white] = 0;
    for (Eigen::Index r = 0; r < n; ++r)
        if (is_clear(colour_.appearance(), std::size_t(r))) penalty[r] = options.clear_penalty;
    Unknowns start = Unknowns::Constant(n, 0.3);
    start[white] = 1;

    const auto size = std::size_t(nodes_);
    Node all_white{};
    all_white.root[std::size_t(white)] = 1;
    lattice_.assign(size * size * size, all_white);
    if (resins_ == 1) return;
    const auto coordinate = [&](std::size_t i) {
        const double t = double(i) / double(size - 1);
        return t * t * t;
    };
    // Along red each node starts from its neighbour; rows are independent, so threads change nothing.
    parallel_for(
        0, size * size, 4,
        [&](std::size_t row) {
            if (progress) progress->check_cancelled();
            Unknowns guess = start;
            for (std::size_t red = size; red-- > 0;) {
                const Eigen::Vector3d target(coordinate(red), coordinate(row % size), coordinate(row / size));
                // A neighbour on the boundary of the gamut may have lost resins; a little of each brings them back.
                const InvertedColour solved = invert_appearance(colour_, target, penalty, options, guess);
                guess = (solved.fractions.cwiseSqrt().array() + 0.02).matrix();
                Node& node = lattice_[row * size + red];
                for (Eigen::Index r = 0; r < n; ++r)
                    node.root[std::size_t(r)] = static_cast<float>(std::sqrt(solved.fractions[r]));
            }
        },
        progress);
    lattice_.back() = all_white;  // white, exactly
}

LatticeView Separation::view() const { return {lattice_.front().root.data(), nodes_, static_cast<int>(resins_)}; }

void Separation::mixtures(const float* red, const float* green, const float* blue, std::size_t n,
                          CumulativeMixture* out) const {
    lattice_mixtures(view(), red, green, blue, n, out);
}

std::vector<double> Separation::fractions(const Eigen::Vector3f& rgb) const {
    std::array<float, max_resins> shares;
    lattice_shares(view(), rgb.x(), rgb.y(), rgb.z(), shares.data());
    std::vector<double> fractions(resins_);
    double sum = 0;
    for (std::size_t r = 0; r < resins_; ++r) sum += fractions[r] = double(shares[r]);
    for (double& f : fractions) f /= sum;
    return fractions;
}

Eigen::Vector3d Separation::predicted(const Eigen::Vector3f& rgb) const { return colour_.rgb(fractions(rgb)); }

double Separation::gamut_distance(const Eigen::Vector3f& rgb) const {
    return optics::ciede2000(optics::lab_from_linear_srgb(rgb.cast<double>().cwiseMax(0).cwiseMin(1)),
                             optics::lab_from_linear_srgb(predicted(rgb)));
}

}  // namespace voxtone::halftone
