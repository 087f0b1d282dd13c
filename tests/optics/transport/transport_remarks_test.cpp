// SPDX-License-Identifier: GPL-3.0-or-later
//
// A prediction that went less than well says so: each remark from where it is counted to Appearance::remarks.
#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <vector>

#include "base/random.h"
#include "optics/transport/transport.h"
#include "optics/transport/viewing_field.h"

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

/// What a predictor remarks of a slab on black, 1 mm thick, whose voxels are by chance of one resin or of another.
std::vector<std::string> remarks_of_slab(const TransportOptions& options, const Medium& one, const Medium& other) {
    ResinSet set = vero_opaque();
    set.g = 0;
    for (std::size_t r = 0; r < set.resins.size(); ++r) {
        const Medium& medium = r == 0 ? one : other;
        std::fill(set.resins[r].sigma_t_per_mm.begin(), set.resins[r].sigma_t_per_mm.end(), medium.sigma_t());
        std::fill(set.resins[r].albedo.begin(), set.resins[r].albedo.end(), medium.albedo());
    }
    const ResinVolume volume = make_resin_volume({48, 24, 36}, {0.0423333, 0.0846667, 0.027}, [](int x, int y, int z) {
        return 1 +
               static_cast<int>(voxtone::philox4x32({std::uint32_t((z * 24 + y) * 48 + x), 0, 0, 0}, {1, 0})[0] % 2);
    });
    const Scene scene{&volume, &set, Backing::black, Sides::open};
    return TransportPredictor(options).predict(scene, find_surface(scene, {2, 1, 3}, SurfacePart::top)).remarks;
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

TEST_CASE("Light is clipped where it is seen, not where a correction leaves a little below none") {
    CHECK(phi_code.fits(-0.003f));
    CHECK_FALSE(phi_code.fits(-0.005f));
    CHECK(phi_code.fits(2.003f));
    CHECK_FALSE(phi_code.fits(2.005f));
    CHECK(phi_code(-0.003f) == 0);
    CHECK(phi_code(2.003f) == 65535);
}

TEST_CASE("Open solves and late changes are counted where they happen") {
    for (const Refinement refinement : {Refinement::none, Refinement::all}) {
        TransportOptions usual;
        usual.refinement = refinement;
        const Medium white{0.001, 30}, thin{0.05, 0.45};
        CHECK(remarks_of_slab(usual, white, white).empty());
        // Residuals of single precision never become nothing where resins are as unlike as these.
        TransportOptions never_there = usual;
        never_there.start_tolerance = 0;
        CHECK(says(remarks_of_slab(never_there, {0.001, 3'000}, {0.0001, 0.01}), "diffusion solves"));
        // Light that crosses the body without being scattered needs sweeps, not diffusion.
        TransportOptions once = usual;
        once.sweeps = 1;
        once.first_change = 0;
        CHECK(says(remarks_of_slab(once, thin, thin), "the last sweep"));
    }
}
