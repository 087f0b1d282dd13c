// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "halftone/loop/mixture_descent.h"

using namespace voxtone;
using namespace voxtone::halftone;

namespace {

/// Cells that are too far apart to share light.
const CellSmoothing apart = [](std::vector<Eigen::Vector3f>&) {};
/// Cells that are all neighbours.
const CellSmoothing together = [](std::vector<Eigen::Vector3f>& values) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3f& v : values) mean += v.cast<double>() / double(values.size());
    std::fill(values.begin(), values.end(), mean.cast<float>());
};

}  // namespace

TEST_CASE("Descent moves shares towards what lowers the misfit and keeps their sum", "[loop]") {
    SkinMixtures start(2, 1, 3);
    for (std::size_t c = 0; c < 2; ++c) start.cell(c)[2] = 1;
    DescentState state = begin_descent(start, {});
    for (const float f : state.mixtures.all()) CHECK(f >= 0.99f * least_fraction);
    // Resin 0 helps in the first cell, hurts in the second.
    const std::vector<float> gradient{-1, 0, 0, 1, 0, 0};
    for (int i = 0; i < 60; ++i) descend(gradient, apart, state);
    CHECK(state.mixtures.cell(0)[0] > 0.5f);
    CHECK(state.mixtures.cell(1)[0] < 1.1f * least_fraction);
    for (std::size_t c = 0; c < 2; ++c)
        CHECK(state.mixtures.cell(c)[0] + state.mixtures.cell(c)[1] + state.mixtures.cell(c)[2] == Approx(1));
    CHECK(printed(state.mixtures).cell(1)[0] < 0.003f);
    // No gradient at all: nothing moves.
    DescentState still = begin_descent(start, {});
    const SkinMixtures before = still.mixtures;
    descend(std::vector<float>(6, 0.0f), apart, still);
    for (std::size_t i = 0; i < 6; ++i) CHECK(still.mixtures.all()[i] == Approx(before.all()[i]).epsilon(0.01));
}

TEST_CASE("What cells do each for itself only passes resin on", "[loop]") {
    constexpr std::size_t cells = 200;
    SkinMixtures start(cells, 1, 2);
    for (std::size_t c = 0; c < cells; ++c) {
        start.cell(c)[0] = 0.1f;
        start.cell(c)[1] = 0.9f;
    }
    DescentState state = begin_descent(start, {.own = 0.5f});
    // Half of the cells want more of resin 0, half of them less; all together they want nothing.
    std::vector<float> gradient(2 * cells, 0.0f);
    for (std::size_t c = 0; c < cells; ++c) gradient[2 * c] = c % 2 ? 1 : -1;
    descend(gradient, together, state);
    double amount = 0;
    const SkinMixtures print = printed(state.mixtures);
    for (std::size_t c = 0; c < cells; ++c) amount += double(print.cell(c)[0]) / cells;
    CHECK(print.cell(0)[0] > 0.13f);
    CHECK(print.cell(1)[0] < 0.07f);
    // The exponential by itself would have made it 0.128.
    CHECK(amount == Approx(0.1).epsilon(1e-4));
}

TEST_CASE("Cells that want the same go equally fast, each resin and what is their own at a rate of its own", "[loop]") {
    constexpr std::size_t cells = 5, resins = 3, rates = resins + 1;
    SkinMixtures start(cells, 1, resins);
    for (std::size_t c = 0; c < cells; ++c) start.cell(c)[0] = 0.2f, start.cell(c)[1] = 0.3f, start.cell(c)[2] = 0.5f;
    DescentState state = begin_descent(start, {});
    // Half of a step is shared. Resin 0 is wanted steadily, resin 1 more and less in turns.
    const CellSmoothing half = [](std::vector<Eigen::Vector3f>& values) {
        for (Eigen::Vector3f& v : values) v *= 0.5f;
    };
    REQUIRE(state.rate.size() == cells * rates);
    for (int step = 0; step < 6; ++step) {
        std::vector<float> gradient(cells * resins, 0.0f);
        for (std::size_t c = 0; c < cells; ++c)
            gradient[c * resins] = -1, gradient[c * resins + 1] = step % 2 ? 0.8f : -0.8f;
        descend(gradient, half, state);
    }
    for (std::size_t c = 1; c < cells; ++c)
        for (std::size_t part = 0; part < rates; ++part) {
            INFO("cell " << c << ", part " << part);
            CHECK(state.rate[c * rates + part] == state.rate[part]);
        }
    CHECK(state.rate[0] != state.rate[1]);
    CHECK(state.rate[0] != state.rate[resins]);
}

TEST_CASE("Cells that share their light do not overshoot together", "[loop]") {
    // What a cell shows: 5 times the mean ink of all and 0.2 times its own. Steps that suit the cells overshoot 25
    // times.
    constexpr std::size_t cells = 300;
    const auto shown = [](const DescentState& state) {
        std::vector<double> p(cells, 0.0);
        double mean = 0;
        for (std::size_t c = 0; c < cells; ++c) mean += double(state.mixtures.cell(c)[0]) / cells;
        for (std::size_t c = 0; c < cells; ++c) p[c] = 5 * mean + 0.2 * double(state.mixtures.cell(c)[0]);
        return p;
    };
    SkinMixtures start(cells, 1, 2);
    for (std::size_t c = 0; c < cells; ++c) {
        start.cell(c)[0] = 0.1f;
        start.cell(c)[1] = 0.9f;
    }
    DescentState state = begin_descent(start, {});
    std::vector<double> target(cells);
    for (std::size_t c = 0; c < cells; ++c) target[c] = 5 * 0.2 + 0.2 * (c % 3 == 0 ? 0.4 : 0.1);  // mean ink 0.2
    const auto misfit = [&] {
        double sum = 0;
        const auto p = shown(state);
        for (std::size_t c = 0; c < cells; ++c) sum += (p[c] - target[c]) * (p[c] - target[c]);
        return sum;
    };
    const double at_first = misfit();
    double last = at_first;
    int rose = 0;
    for (int i = 0; i < 40; ++i) {
        const auto p = shown(state);
        double mean = 0;
        for (std::size_t c = 0; c < cells; ++c) mean += (p[c] - target[c]) / cells;
        std::vector<float> gradient(2 * cells, 0.0f);
        for (std::size_t c = 0; c < cells; ++c) gradient[2 * c] = float(2 * (0.2 * (p[c] - target[c]) + 5 * mean));
        descend(gradient, together, state);
        rose += misfit() > last;
        last = misfit();
    }
    CHECK(last < 2e-3 * at_first);
    // A rate falls to 0.4 of itself a step: one that is 25 times too large is right after four, and swings no more.
    CHECK(rose <= 4);
    CHECK(state.mixtures.cell(0)[0] > 2 * state.mixtures.cell(1)[0]);
}
