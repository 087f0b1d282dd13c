// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/separation/mixture_lattice.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "base/contracts.h"
#include "base/error.h"

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

std::size_t checked_size(const AppearanceColour& colour, const SeparationOptions& options) {
    validate(options);
    const std::size_t resins = colour.appearance().resins();
    VOXTONE_EXPECT(resins >= 1 && resins <= std::size_t(max_resins));
    return static_cast<std::size_t>(options.nodes);
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

Unknowns penalties(const optics::ShellAppearance& appearance, const SeparationOptions& options) {
    const auto n = static_cast<Eigen::Index>(appearance.resins());
    Unknowns penalty = Unknowns::Constant(n, options.ink_penalty);
    penalty[static_cast<Eigen::Index>(appearance.geometry().white())] = 0;
    for (Eigen::Index r = 0; r < n; ++r)
        if (is_clear(appearance, std::size_t(r))) penalty[r] = options.clear_penalty;
    return penalty;
}

Unknowns first_guess(const optics::ShellAppearance& appearance) {
    Unknowns guess = Unknowns::Constant(static_cast<Eigen::Index>(appearance.resins()), 0.3);
    guess[static_cast<Eigen::Index>(appearance.geometry().white())] = 1;
    return guess;
}

}  // namespace

MixtureLattice::MixtureLattice(const AppearanceColour& colour, const SeparationOptions& options)
    : colour_(colour),
      options_(options),
      size_(checked_size(colour, options)),
      penalty_(penalties(colour.appearance(), options)),
      root_(size_ * size_ * size_),
      rows_(size_ * size_, {size_, first_guess(colour.appearance())}),
      solved_(root_.size()) {
    white_.root[std::size_t(colour.appearance().geometry().white())] = 1;
    if (penalty_.size() == 1) std::ranges::fill(root_, white_);
}

const MixtureLattice::Roots& MixtureLattice::at(std::size_t node) {
    require_node(view(), node);
    return root_[node].root;
}

LatticeView MixtureLattice::view() {
    const bool one_resin = penalty_.size() == 1;
    return {root_.front().root.data(), static_cast<int>(size_), static_cast<int>(penalty_.size()),
            one_resin ? nullptr : &solved_, this};
}

void MixtureLattice::solve(std::size_t node) {
    const std::size_t row = node / size_;
    solved_.require(node, row, [&] {
        while (rows_[row].first_solved > node % size_) solve_next(row);
    });
}

void MixtureLattice::solve_next(std::size_t row) {
    const auto coordinate = [&](std::size_t i) {
        const double t = double(i) / double(size_ - 1);
        return t * t * t;
    };
    auto& [red, guess] = rows_[row];
    --red;
    const Eigen::Vector3d target(coordinate(red), coordinate(row % size_), coordinate(row / size_));
    const InvertedColour solved = invert_appearance(colour_, target, penalty_, options_, guess);
    // A neighbour on the boundary of the gamut may have lost resins; a little of each brings them back.
    guess = (solved.fractions.cwiseSqrt().array() + 0.02).matrix();
    const std::size_t at = row * size_ + red;
    for (Eigen::Index r = 0; r < solved.fractions.size(); ++r)
        root_[at].root[std::size_t(r)] = static_cast<float>(std::sqrt(solved.fractions[r]));
    if (at + 1 == root_.size()) root_[at] = white_;  // exactly
    solved_.mark(at);
}

}  // namespace voxtone::halftone
