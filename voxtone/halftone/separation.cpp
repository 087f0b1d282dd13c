// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/halftone/separation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "voxtone/base/contracts.h"
#include "voxtone/base/error.h"
#include "voxtone/base/parallel.h"
#include "voxtone/halftone/invert_appearance.h"
#include "voxtone/optics/colour.h"

namespace voxtone::halftone {

namespace {

/// Cube root of x in [0, 1], relative error below 1e-6: two Newton steps from a bit-level guess. The same bits everywhere,
/// which a library's cbrtf does not promise, and several times faster.
float cube_root(float x) {
    if (x < 1e-9f) return 0;
    const auto bits = __builtin_bit_cast(std::uint32_t, x);
    float y = __builtin_bit_cast(float, bits / 3 + 0x2a514067u);
    y = y - (y - x / (y * y)) * (1.0f / 3.0f);
    y = y - (y - x / (y * y)) * (1.0f / 3.0f);
    return y - (y - x / (y * y)) * (1.0f / 3.0f);
}

void validate(const SeparationOptions& options) {
    const auto need = [](bool good, const char* name, double value, const char* rule) {
        if (!good) throw UsageError(fmt::format("separation: {} = {}: {}", name, value, rule));
    };
    need(options.nodes >= 2 && options.nodes <= 65, "nodes", options.nodes, "must be 2 to 65");
    need(options.ink_penalty > 0, "ink_penalty", options.ink_penalty, "must be above 0");
    need(options.clear_penalty > 0, "clear_penalty", options.clear_penalty, "must be above 0");
    need(options.lightness_weight > 0 && options.chroma_weight > 0 && options.hue_weight > 0, "weights", options.hue_weight, "must be above 0");
}

/// A resin that changes nothing: the appearance of the core does not move when some of it is mixed in.
bool is_clear(const optics::ShellAppearance& appearance, std::size_t resin) {
    std::vector<double> alone(appearance.resins(), 0.0), mixed = alone;
    const auto core = std::size_t(appearance.geometry().core_resin);
    if (resin == core) return false;
    alone[resin] = 1;
    const std::vector<double> seen = appearance.media_relative(alone);
    // Through a clear shell the core is seen, dimmed by nothing but the light that the shell lets past.
    return *std::min_element(seen.begin(), seen.end()) > 0.9;
}

}  // namespace

Separation::Separation(const optics::ShellAppearance& appearance, const SeparationOptions& options, const Progress* progress)
    : appearance_(appearance), resins_(appearance.resins()), nodes_(options.nodes) {
    validate(options);
    VOXTONE_EXPECT(resins_ >= 1 && resins_ <= std::size_t(max_resins));
    if (appearance.channels() != 3)
        throw InputError(fmt::format("the resin set has {} wavelengths; colour separation needs an RGB set", appearance.channels()));
    solve(options, progress);
}

void Separation::solve(const SeparationOptions& options, const Progress* progress) {
    const auto n = static_cast<Eigen::Index>(resins_);
    const auto core = static_cast<Eigen::Index>(appearance_.geometry().core_resin);
    Unknowns penalty = Unknowns::Constant(n, options.ink_penalty);
    penalty[core] = 0;
    for (Eigen::Index r = 0; r < n; ++r)
        if (is_clear(appearance_, std::size_t(r))) penalty[r] = options.clear_penalty;
    Unknowns start = Unknowns::Constant(n, 0.3);
    start[core] = 1;

    const auto size = std::size_t(nodes_);
    lattice_.assign(size * size * size, Node{});
    const auto coordinate = [&](std::size_t i) {
        const double t = double(i) / double(size - 1);
        return t * t * t;
    };
    // Along red each node starts from its neighbour; rows are independent, so threads change nothing.
    parallel_for(
        0, size * size, 4,
        [&](std::size_t row) {
            Unknowns guess = start;
            for (std::size_t red = size; red-- > 0;) {
                const Eigen::Vector3d target(coordinate(red), coordinate(row % size), coordinate(row / size));
                // A neighbour on the boundary of the gamut may have lost resins; a little of each brings them back.
                const InvertedColour solved = invert_appearance(appearance_, target, penalty, options, guess);
                guess = (solved.fractions.cwiseSqrt().array() + 0.02).matrix();
                Node& node = lattice_[row * size + red];
                for (Eigen::Index r = 0; r < n; ++r) node.root[r] = static_cast<float>(std::sqrt(solved.fractions[r]));
            }
        },
        progress);
    // White is the core itself, exactly.
    Node& white = lattice_.back();
    std::fill(std::begin(white.root), std::end(white.root), 0.0f);
    white.root[core] = 1;
}

Separation::Node Separation::interpolate(float red, float green, float blue) const {
    // Tetrahedra that share the diagonal from black to white, so that greys are interpolated between greys.
    const float scale = static_cast<float>(nodes_ - 1);
    const std::array<float, 3> rgb{red, green, blue};
    std::array<float, 3> part;
    std::size_t at = 0, stride = 1;
    std::array<std::size_t, 3> step;
    for (std::size_t c = 0; c < 3; ++c) {
        const float position = cube_root(std::clamp(rgb[c], 0.0f, 1.0f)) * scale;
        const int cell = std::min(static_cast<int>(position), nodes_ - 2);
        part[c] = std::min(position - static_cast<float>(cell), 1.0f);
        step[c] = stride;
        at += stride * std::size_t(cell);
        stride *= std::size_t(nodes_);
    }
    if (part[0] < part[1]) std::swap(part[0], part[1]), std::swap(step[0], step[1]);
    if (part[1] < part[2]) std::swap(part[1], part[2]), std::swap(step[1], step[2]);
    if (part[0] < part[1]) std::swap(part[0], part[1]), std::swap(step[0], step[1]);
    const Node& a = lattice_[at];
    const Node& b = lattice_[at += step[0]];
    const Node& c = lattice_[at += step[1]];
    const Node& d = lattice_[at += step[2]];
    Node out;
    for (int r = 0; r < max_resins; ++r)
        out.root[r] = (1 - part[0]) * a.root[r] + (part[0] - part[1]) * b.root[r] + (part[1] - part[2]) * c.root[r] + part[2] * d.root[r];
    return out;
}

void Separation::mixtures(const float* red, const float* green, const float* blue, std::size_t n, CumulativeMixture* out) const {
    for (std::size_t i = 0; i < n; ++i) {
        const Node node = interpolate(red[i], green[i], blue[i]);
        std::array<float, max_resins> share;
        float sum = 0;
        for (std::size_t r = 0; r < std::size_t(max_resins); ++r) {
            share[r] = node.root[r] * node.root[r];
            sum += share[r];
        }
        const float scale = 65536.0f / sum;
        float cumulative = 0.5f;
        for (std::size_t r = 0; r < std::size_t(max_resins); ++r) {
            cumulative += share[r] * scale;
            out[i].bound[r] = static_cast<std::uint16_t>(std::min(cumulative, 65535.0f));
        }
        for (std::size_t r = resins_ - 1; r < std::size_t(max_resins); ++r) out[i].bound[r] = 65535;
    }
}

std::vector<double> Separation::fractions(const Eigen::Vector3f& rgb) const {
    const Node node = interpolate(rgb.x(), rgb.y(), rgb.z());
    std::vector<double> fractions(resins_);
    double sum = 0;
    for (std::size_t r = 0; r < resins_; ++r) sum += fractions[r] = double(node.root[r]) * double(node.root[r]);
    for (double& f : fractions) f /= sum;
    return fractions;
}

Eigen::Vector3d Separation::predicted(const Eigen::Vector3f& rgb) const {
    const std::vector<double> f = fractions(rgb);
    Eigen::Vector3d colour;
    appearance_.media_relative(f, {colour.data(), 3});
    return colour;
}

double Separation::mapping_distance(const Eigen::Vector3f& rgb) const {
    return optics::ciede2000(optics::lab_from_linear_srgb(rgb.cast<double>().cwiseMax(0).cwiseMin(1)), optics::lab_from_linear_srgb(predicted(rgb)));
}

}  // namespace voxtone::halftone
