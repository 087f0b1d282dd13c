// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/local_profiles/local_profiles.h"

#include <numeric>

#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "response_samples.h"
#include "scattering/local_profiles/banded_blocks.h"
#include "tests/same_for_threads.h"

using namespace voxtone;
using namespace voxtone::scattering;
using namespace voxtone::scattering::testing;
using Catch::Matchers::Contains;

namespace {

LocalProfiles factored(const optics::SampledBssrdf& data, const LocalProfileOptions& options = {}) {
    std::vector<FactorSummary> summary;
    LocalProfiles profiles = factor_responses(data, options, summary);
    for (const FactorSummary& channel : summary) CHECK(channel.converged);
    return profiles;
}

}  // namespace

TEST_CASE("Rings hold every offset of the window once, at the knots that its distance lies between") {
    const auto rings = profile_rings(10);
    std::size_t offsets = 0;
    for (const ProfileRing& ring : rings) {
        offsets += ring.offsets.size();
        for (const auto& d : ring.offsets) CHECK(std::hypot(d.x, d.y) == Approx(ring.radius));
        CHECK(static_cast<double>(ring.knot) + 1 - ring.low_share == Approx(ring.radius));
        CHECK((ring.low_share >= 0 && ring.low_share <= 1 && ring.knot < 10));
    }
    CHECK(offsets == 317);
    const auto of_half = rings_of_half_window(rings, 10);
    const auto half = optics::half_window(10);
    REQUIRE(of_half.size() == half.size());
    for (std::size_t s = 0; s < half.size(); ++s)
        CHECK(rings[of_half[s]].radius == Approx(std::hypot(half[s].x, half[s].y)));
    CHECK(rings[0].offsets.size() == 1);
    CHECK(rings.back().low_share == 0);
}

TEST_CASE("A sum over a ring takes what lies in the grid") {
    const PointGrid grid{4, 3};
    std::vector<double> image(12), sum(4);
    std::iota(image.begin(), image.end(), 1.0);
    const auto rings = profile_rings(2);
    REQUIRE(rings[1].offsets.size() == 4);
    sum_over_ring(grid, rings[1], image, 1, sum);
    CHECK(sum == std::vector<double>{1 + 6 + 9, 2 + 5 + 7 + 10, 3 + 6 + 8 + 11, 4 + 7 + 12});
}

TEST_CASE("Blocks of five bands are solved as Eigen solves them") {
    constexpr int n = 7;
    BandedBlocks blocks(3, n);
    RandomStream random(1, 0);
    for (std::size_t b = 0; b < 3; ++b) {
        Eigen::MatrixXd L = Eigen::MatrixXd::Zero(n, n);
        for (int i = 0; i < n; ++i)
            for (int j = std::max(0, i - 2); j <= i; ++j) L(i, j) = random.uniform() + (i == j);
        const Eigen::MatrixXd A = L * L.transpose();
        auto block = blocks.clear(b);
        for (int i = 0; i < n; ++i)
            for (int j = std::max(0, i - 2); j <= i; ++j)
                block.add(static_cast<std::size_t>(i), static_cast<std::size_t>(j), A(i, j));
        block.factorise();
        std::vector<double> right(3 * n), x(3 * n);
        for (double& value : right) value = random.uniform() - 0.5;
        blocks.solve(right, x, b, b + 1);
        Eigen::VectorXd r(n);
        for (int i = 0; i < n; ++i) r[i] = right[static_cast<std::size_t>(3 * i) + b];
        const Eigen::VectorXd truth = A.ldlt().solve(r);
        for (int i = 0; i < n; ++i)
            CHECK(x[static_cast<std::size_t>(3 * i) + b] == Approx(truth[i]).epsilon(1e-9).margin(1e-12));
    }
}

TEST_CASE("Profiles of responses that are their products come back") {
    const LocalProfiles truth = wandering_profiles({20, 14}, 6, 2);
    LocalProfileOptions options;
    options.tolerance = 1e-9;
    const LocalProfiles found = factored(separable_responses(truth, 0, 1), options);
    for (std::size_t c = 0; c < 2; ++c)
        for (std::size_t i = 0; i < truth.channels[c].size(); ++i)
            CHECK(found.channels[c][i] == Approx(truth.channels[c][i]).epsilon(2e-4));  // data are floats
}

TEST_CASE("Profiles from counts are as far off as counts must be, and keep the light") {
    const LocalProfiles truth = wandering_profiles({40, 40}, 6, 1);
    std::vector<double> errors;
    for (const double counts : {50.0, 800.0}) {
        const auto data = separable_responses(truth, counts, 7);
        const LocalProfiles found = factored(data);
        const ReconstructionError error = reconstruction_error(data, 0, found);
        CHECK(error.light == Approx(1).epsilon(1e-3));
        CHECK(error.albedo_error < 2e-3);
        // A fit that follows some of the noise stays below it, but not far: 7 knots for 56 pairs a point.
        CHECK(error.light_error < error.noise_error);
        CHECK(error.light_error > 0.75 * error.noise_error);
        // Other counts of the same surface: noise and error of the fit add up.
        const ReconstructionError check = reconstruction_error(separable_responses(truth, counts, 8), 0, found);
        CHECK(check.excess > 0);
        CHECK(check.excess < 0.5 * check.noise_error);
        errors.push_back(profile_error(truth, found, 0));
    }
    // A sixteenth of the variance: a quarter of the error, where smoothness does not help the poorer one more.
    CHECK(errors[1] < 0.45 * errors[0]);
    CHECK(errors[1] > 0.2 * errors[0]);
}

TEST_CASE("Logarithms of single counts would lose light, counts do not") {
    // What Eq. 7 in logarithms by plain least squares gives of homogeneous data of about one count a pair: the mean of
    // the logarithms of what is not 0.
    LocalProfiles truth{{30, 30}, 3, 0.5, {ProfileImages(4 * 900)}};
    for (std::size_t k = 0; k < 4; ++k)
        std::fill_n(truth.channels[0].begin() + static_cast<std::ptrdiff_t>(900 * k), 900,
                    std::exp(-0.8 * static_cast<double>(k)));
    const auto data = separable_responses(truth, 3, 5);
    double logs = 0, n = 0;
    for (std::size_t i = 0; i < 900; ++i)
        if (const double R = data.channels[0].pairs[3 * 900 + i]; R > 0) logs += std::log(R), ++n;  // offset (3, 0)
    const double far = std::exp(-2.4);
    CHECK(std::exp(logs / n) > 3 * far);
    const LocalProfiles found = factored(data);
    // What pairs show is their light: 245 counts here, known to 6 %.
    double mean = 0;
    for (std::size_t i = 0; i < 900; ++i)
        if (i % 30 < 27) mean += response_at(found, 0, i)[3 * 7 + 6] / 810;
    CHECK(mean == Approx(far).epsilon(0.15));
    CHECK(reconstruction_error(data, 0, found).light == Approx(1).epsilon(1e-3));
}

TEST_CASE("The factorisation has the same bits for any number of threads") {
    const auto data = separable_responses(wandering_profiles({33, 21}, 5, 2), 60, 3);
    const auto channels = test::same_for_threads([&] { return factored(data).channels; }, {2, 7});
    CHECK(channels.size() == data.channels.size());
}

TEST_CASE("A single point, a row of points and a window larger than the grid have profiles too") {
    for (const PointGrid grid : {PointGrid{1, 1}, PointGrid{9, 1}, PointGrid{1, 9}, PointGrid{3, 3}}) {
        const LocalProfiles found = factored(separable_responses(wandering_profiles(grid, 4, 1), 100, 2));
        for (const double P : found.channels[0]) CHECK((std::isfinite(P) && P >= 0));
    }
}

TEST_CASE("What cannot be factored is refused with the reason") {
    auto data = separable_responses(wandering_profiles({5, 5}, 2, 1), 0, 1);
    std::vector<FactorSummary> summary;
    const auto with = [&](auto change) {
        LocalProfileOptions options;
        change(options);
        return options;
    };
    CHECK_THROWS_WITH((void)factor_responses(data, with([](auto& o) { o.curvature = 0; }), summary),
                      Contains("curvature"));
    CHECK_THROWS_WITH((void)factor_responses(data, with([](auto& o) { o.tolerance = 1; }), summary),
                      Contains("tolerance"));
    CHECK_THROWS_WITH((void)factor_responses(data, with([](auto& o) { o.max_steps = 0; }), summary), Contains("steps"));
    std::fill(data.channels[0].pairs.begin(), data.channels[0].pairs.end(), 0.0f);
    CHECK_THROWS_WITH((void)factor_responses(data, {}, summary), Contains("no light at all"));
}

TEST_CASE("Light by knot and radial samples hold all light of a profile") {
    const auto rings = profile_rings(6);
    for (const double width : {0.6, 1.5, 6.0}) {
        std::vector<double> P;
        double light = 0;
        for (int k = 0; k <= 6; ++k) P.push_back(2 * std::exp(-k / width));
        for (const ProfileRing& ring : rings)
            light += 0.25 * static_cast<double>(ring.offsets.size()) * 2 * std::exp(-ring.radius / width);
        const auto by_knot = light_by_knot(P, rings, 0.5);
        CHECK(std::accumulate(by_knot.begin(), by_knot.end(), 0.0) == Approx(light));
        const auto samples = radial_samples(P, 6, 0.5);
        CHECK(samples.spacing_mm == 0.5);
        const optics::HankelGrid grid(3, 8);
        CHECK(grid.from_even(samples.light, 0.5)[0] == Approx(light));
        for (std::size_t k = 1; k <= 6; ++k) CHECK(samples.light[k] == Approx(P[k]));
    }
}

TEST_CASE("Responses around a point, and how far light goes, are those of the data where the data are products") {
    const LocalProfiles truth = wandering_profiles({13, 11}, 3, 1);
    const auto data = separable_responses(truth, 0, 1);
    for (const std::size_t point : {0u, 60u, 142u}) {
        const auto a = response_at(truth, 0, point), b = response_at(data, 0, point);
        REQUIRE(a.size() == 49);
        for (std::size_t i = 0; i < 49; ++i) CHECK(a[i] == Approx(b[i]).epsilon(1e-6).margin(1e-12));
    }
    CHECK(response_at(data, 0, 0)[0] == 0);  // outside
    const SpreadImages of_model = spread_of(truth, 0), of_data = spread_of(data, 0);
    const auto within = optics::light_within_window(data, 0);
    for (std::size_t i = 0; i < 143; ++i) {
        CHECK(of_model.albedo[i] == Approx(of_data.albedo[i]).epsilon(1e-6));
        CHECK(of_model.width_mm[i] == Approx(of_data.width_mm[i]).epsilon(1e-6));
        CHECK(of_data.albedo[i] == Approx(within[i]).epsilon(1e-6));
    }
    const ReconstructionError error = reconstruction_error(data, 0, truth);
    CHECK(error.light_error < 1e-6);
    CHECK(error.light == Approx(1).epsilon(1e-6));
}
