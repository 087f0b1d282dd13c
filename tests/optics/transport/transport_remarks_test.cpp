// SPDX-License-Identifier: GPL-3.0-or-later
//
// A prediction that went less than well says so: each remark from where it is counted to Appearance::remarks.
#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <vector>

#include "voxtone/optics/transport/transport.h"

using namespace voxtone::optics;

namespace {

TransportSummary fine() {
    TransportSummary summary;
    summary.kept_values = 100'000;
    summary.clipped_values = 100;
    summary.mean_change = 0.02;
    return summary;
}

bool says(const std::vector<std::string>& remarks, const std::string& what) {
    return std::any_of(remarks.begin(), remarks.end(),
                       [&](const std::string& remark) { return remark.find(what) != std::string::npos; });
}

/// What a predictor remarks of a block of one resin, 0.8 mm wide and high.
std::vector<std::string> remarks_of_block(const TransportOptions& options, double sigma_t_per_mm, double albedo) {
    ResinSet set = vero_opaque();
    for (Resin& resin : set.resins) {
        std::fill(resin.sigma_t_per_mm.begin(), resin.sigma_t_per_mm.end(), sigma_t_per_mm);
        std::fill(resin.albedo.begin(), resin.albedo.end(), albedo);
    }
    const ResinVolume volume =
        make_resin_volume({20, 10, 30}, {0.0423333, 0.0846667, 0.027}, [](int, int, int) { return 1; });
    const Scene scene{&volume, &set, Backing::none, Sides::open};
    return TransportPredictor(options).predict(scene, find_surface(scene, {2, 1, 3}, SurfacePart::all)).remarks;
}

}  // namespace

TEST_CASE("What went less than well in a prediction is remarked, and nothing else") {
    CHECK(remarks_of(TransportSummary{}).empty());
    CHECK(remarks_of(fine()).empty());
    TransportSummary clipped = fine(), open = fine(), late = fine();
    clipped.clipped_values = 1'234;
    REQUIRE(remarks_of(clipped).size() == 1);
    CHECK(says(remarks_of(clipped), "1.2 % of its light clipped"));
    open.open_solves = 3;
    REQUIRE(remarks_of(open).size() == 1);
    CHECK(says(remarks_of(open), "3 diffusion solves"));
    late.mean_change = 0.057;
    REQUIRE(remarks_of(late).size() == 1);
    CHECK(says(remarks_of(late), "by 5.7 % on average"));
}

TEST_CASE("Open solves and late changes are counted where they happen, on voxels and on viewing cells") {
    for (const bool viewing_cells : {false, true}) {
        CAPTURE(viewing_cells);
        TransportOptions usual;
        usual.viewing_cells = viewing_cells;
        CHECK(remarks_of_block(usual, 30, 0.99).empty());
        TransportOptions never_there = usual;
        never_there.start_tolerance = 1e-30;
        CHECK(says(remarks_of_block(never_there, 30, 0.99), "diffusion solves"));
        // Light that crosses the body without being scattered needs sweeps, not diffusion.
        TransportOptions once = usual;
        once.sweeps = 1;
        CHECK(says(remarks_of_block(once, 0.5, 0.999), "the last sweep"));
    }
}
