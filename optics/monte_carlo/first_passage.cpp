// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/monte_carlo/first_passage.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/contracts.h"
#include "optics/monte_carlo/voxel_walk.h"

namespace voxtone::optics {
namespace {

using Vector = std::array<double, 3>;

constexpr int paths_of_a_table = 8192;
constexpr std::size_t orders = 24;  ///< of Legendre's polynomials
using Orders = std::array<double, orders + 1>;

double inner(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vector even_direction(PathRandom& random) {
    const double z = 2 * random.uniform() - 1, phi = 2 * std::numbers::pi * random.uniform();
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
}

/// phi_l / phi_{l-1} of the mode with decay k: k (l phi_{l-1} + (l + 1) phi_{l+1}) = (2 l + 1) (1 - albedo g^l) sigma_t
/// phi_l, solved from the top, where it has died away.
Orders ratios_of_mode(const Medium& medium, double g, double k) {
    Orders ratio{};
    for (std::size_t l = orders; l-- > 1;) {
        const double n = double(l), h = (2 * n + 1) * (medium.sigma_t() - medium.sigma_s * std::pow(g, n));
        ratio[l] = k * n / (h - k * (n + 1) * ratio[l + 1]);
    }
    return ratio;
}

/// The least decay for which order 0 holds, too: k phi_1 = sigma_a phi_0. Up to it all ratios are positive (the decays
/// of the orders above lie between those of all: tridiagonal matrices); forward scattering has others beyond.
double decay(const Medium& medium, double g) {
    double low = 0, high = 0.9 * medium.sigma_t();
    for (int step = 0; step < 60; ++step) {
        const double k = 0.5 * (low + high);
        const Orders ratio = ratios_of_mode(medium, g, k);
        const bool beyond = std::any_of(ratio.begin(), ratio.end(), [](double r) { return r < 0; });
        (!beyond && k * ratio[1] < medium.sigma_a ? low : high) = k;
    }
    return 0.5 * (low + high);
}

/// (2 l + 1) phi_l i_l(k r), i_l the modified spherical Bessel functions of the first kind.
Orders mode_on_sphere(const Medium& medium, double g, double radius) {
    const double k = decay(medium, g), x = k * radius;
    const Orders phi = ratios_of_mode(medium, g, k);
    Orders bessel{}, out{};
    for (std::size_t l = orders; l-- > 1;) bessel[l] = x / (2 * double(l) + 1 + x * bessel[l + 1]);
    double product = x > 1e-6 ? std::sinh(x) / x : 1.0;
    for (std::size_t l = 0; l < orders; ++l) {
        if (l > 0) product *= phi[l] * bessel[l];
        out[l] = (2 * double(l) + 1) * product;
    }
    return out;
}

double legendre_sum(const Orders& factors, double mu) {
    double before = 1, here = mu, sum = factors[0] + factors[1] * mu;
    for (std::size_t l = 2; l < orders; ++l) {
        const double n = double(l), next = ((2 * n - 1) * mu * here - (n - 1) * before) / n;
        before = here;
        here = next;
        sum += factors[l] * here;
    }
    return sum;
}

}  // namespace

double even_share(double g) { return (1 - std::abs(g)) / ((1 + std::abs(g)) * (1 + std::abs(g))); }

FirstPassage::FirstPassage(const Medium& medium, double g, std::span<const double> radii_mm) : medium_(medium), g_(g) {
    VOXTONE_EXPECT(medium.albedo() >= least_albedo);
    for (const double radius : radii_mm) spheres_.push_back({radius, 1, {}});
    while (first_ < spheres_.size() && spheres_[first_].radius * medium.sigma_t() < least_optical_radius) ++first_;
    for (std::size_t i = first_; i < spheres_.size(); ++i) tabulate(i);
}

/// The largest sphere below `below` that fits, from an even scattering; the weight kept, 1 where none fits.
double FirstPassage::pass(double clear_mm, std::size_t below, Vector& at, Vector& d, PathRandom& random) const {
    std::size_t i = below;
    while (i > first_ && spheres_[i - 1].radius > clear_mm) --i;
    if (i <= first_) return 1;
    const Sphere& sphere = spheres_[i - 1];
    const Vector normal = even_direction(random);
    for (std::size_t a = 0; a < 3; ++a) at[a] += sphere.radius * normal[a];
    const double place = random.uniform() * double(intervals), phi = 2 * std::numbers::pi * random.uniform();
    const auto k = static_cast<std::size_t>(place);
    const double low = static_cast<double>(sphere.cosines[k]), high = static_cast<double>(sphere.cosines[k + 1]);
    const double mu = low + (high - low) * (place - double(k)), r = std::sqrt(std::max(0.0, 1 - mu * mu));
    // Any two directions across the normal do: the azimuth is even.
    const Vector& other = std::abs(normal[0]) < 0.5 ? Vector{1, 0, 0} : Vector{0, 1, 0};
    Vector e{normal[1] * other[2] - normal[2] * other[1], normal[2] * other[0] - normal[0] * other[2],
             normal[0] * other[1] - normal[1] * other[0]};
    const double length = std::sqrt(inner(e, e));
    for (double& x : e) x /= length;
    const Vector f{normal[1] * e[2] - normal[2] * e[1], normal[2] * e[0] - normal[0] * e[2],
                   normal[0] * e[1] - normal[1] * e[0]};
    for (std::size_t a = 0; a < 3; ++a) d[a] = mu * normal[a] + r * (std::cos(phi) * e[a] + std::sin(phi) * f[a]);
    return sphere.weight;
}

/// From the middle of a sphere to its skin, through the smaller ones.
FirstPassage::Exit FirstPassage::trace(std::size_t sphere, PathRandom& random) const {
    const double radius = spheres_[sphere].radius;
    Vector at{}, d = even_direction(random);
    double weight = pass(radius, sphere, at, d, random);
    for (;;) {
        const double way = inner(at, d), square = inner(at, at);
        const double to_skin = -way + std::sqrt(std::max(0.0, way * way - square + radius * radius));
        const double free = -std::log1p(-random.uniform()) / medium_.sigma_t(), step = std::min(free, to_skin);
        for (std::size_t a = 0; a < 3; ++a) at[a] += step * d[a];
        if (free >= to_skin) return {inner(at, d) / radius, weight};
        weight *= medium_.albedo();
        if (random.uniform() < even_share(g_)) {
            d = even_direction(random);
            weight *= pass(radius - std::sqrt(inner(at, at)), sphere, at, d, random);
            continue;
        }
        // What is not even of Henyey and Greenstein's: theirs, of which as much is left out as is even.
        for (;;) {
            Vector turned = d;
            turn_henyey_greenstein(turned, g_, random);
            const double q = 1 + g_ * g_ - 2 * g_ * inner(d, turned);
            if (random.uniform() < even_share(g_) * q * std::sqrt(q) / (1 - g_ * g_)) continue;
            d = turned;
            break;
        }
    }
}

void FirstPassage::tabulate(std::size_t sphere) {
    const Orders mode = mode_on_sphere(medium_, g_, spheres_[sphere].radius);
    std::vector<Exit> exits;
    double all = 0, psi = 0;
    for (std::uint32_t path = 0; path < paths_of_a_table; ++path) {
        PathRandom random(1, {{static_cast<std::int32_t>(sphere), 0, 0}, 0, path});
        const Exit exit = trace(sphere, random);
        exits.push_back(exit);
        all += exit.weight;
        psi += exit.weight * legendre_sum(mode, exit.cosine);
    }
    std::sort(exits.begin(), exits.end(), [](const Exit& a, const Exit& b) {
        return a.cosine != b.cosine ? a.cosine < b.cosine : a.weight < b.weight;
    });
    Sphere& made = spheres_[sphere];
    made.weight = all / psi;
    double sum = 0;
    std::size_t k = 1;
    for (const Exit& exit : exits) {
        sum += exit.weight;
        while (k < intervals && sum >= all * double(k) / double(intervals))
            made.cosines[k++] = static_cast<float>(exit.cosine);
    }
    made.cosines[0] = 0;
    made.cosines[intervals] = 1;
}

}  // namespace voxtone::optics
