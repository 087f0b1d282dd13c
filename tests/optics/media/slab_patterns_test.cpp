// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/media/slab_patterns.h"

#include <cmath>
#include <set>

#include <catch2/catch.hpp>

#include "base/error.h"

using namespace voxtone;
using namespace voxtone::optics;
using Catch::Matchers::Contains;

namespace {

ResinSet with_clear() {
    ResinSet set = vero_opaque();
    set.resins.push_back({"clear", "T", {0, 0, 0}, {1, 1, 1}});
    return set;
}

}  // namespace

TEST_CASE("Squares of a chess slab are white over black and translucent, by turns") {
    SlabOptions options;
    options.pattern = SlabPattern::chess;
    options.width = options.height = 16, options.margin = 2;
    const MixtureSlab slab = make_slab(with_clear(), options);  // squares of 8 points
    CHECK(slab.volume.size() == std::array<int, 3>{20, 20, 20});
    const auto at = [&](int x, int y, int depth) { return slab.volume.at(x + 2, 19 - (y + 2), 19 - depth); };
    CHECK(at(0, 0, 0) == 1);
    CHECK(at(0, 0, 2) == 1);
    CHECK(at(0, 0, 3) == 2);
    CHECK(at(8, 0, 0) == 3);
    CHECK(at(0, 8, 0) == 3);
    CHECK(at(15, 15, 0) == 1);
    CHECK(at(-1, 0, 0) == 3);  // the margin goes on
    const ResinSet set = with_clear();
    for (std::size_t c = 0; c < 3; ++c) {
        CHECK(slab.mixtures.resins[0].medium(c).sigma_s == Approx(set.resins[4].medium(c).sigma_s));
        CHECK(slab.mixtures.resins[2].medium(c).sigma_t() < 0.3 * slab.mixtures.resins[0].medium(c).sigma_t());
    }
}

TEST_CASE("Slabs follow from their seed, and go on where a margin is cut wider") {
    for (const SlabPattern pattern : {SlabPattern::marble, SlabPattern::stone}) {
        SlabOptions options;
        options.pattern = pattern;
        options.width = 12, options.height = 10, options.margin = 1;
        const MixtureSlab slab = make_slab(with_clear(), options);
        options.margin = 4;
        const MixtureSlab wider = make_slab(with_clear(), options);
        options.seed = 2;
        const MixtureSlab other = make_slab(with_clear(), options);
        std::set<int> kinds;
        int same = 0, all = 0;
        for (int z = 0; z < 20; ++z)
            for (int y = 0; y < 12; ++y)
                for (int x = 0; x < 14; ++x) {
                    const int here = slab.volume.at(x, y, z);
                    CHECK(here == wider.volume.at(x + 3, y + 3, z));
                    same += here == other.volume.at(x + 3, y + 3, z);
                    ++all;
                    kinds.insert(here);
                }
        CHECK(kinds.size() > 3);
        CHECK(kinds.count(0) == 0);
        CHECK(static_cast<std::size_t>(*kinds.rbegin()) <= slab.mixtures.resins.size());
        CHECK(same < all / 2);
        CHECK_NOTHROW(slab.mixtures.validate());
    }
}

TEST_CASE("Slabs are made of any channels") {
    ResinSet set;
    set.name = "two waves";
    set.channels.wavelengths_nm = {500, 600};
    set.resins = {{"w", "W", {20, 10}, {0.999, 0.999}}, {"k", "K", {5, 5}, {0.3, 0.3}}, {"t", "T", {0, 0}, {1, 1}}};
    const MixtureSlab slab = make_slab(set, {});
    CHECK(slab.mixtures.channels == set.channels);
    CHECK(slab.mixtures.resins[0].sigma_t_per_mm.size() == 2);
}

TEST_CASE("A slab that cannot be made is refused with the reason") {
    CHECK_THROWS_WITH((void)make_slab(vero_opaque(), {}), Contains("no resin of role T"));
    const auto refused = [](auto change, const std::string& message) {
        SlabOptions options;
        change(options);
        CHECK_THROWS_WITH((void)make_slab(with_clear(), options), Contains(message));
    };
    refused([](SlabOptions& o) { o.pitch_mm = 0; }, "pitch");
    refused([](SlabOptions& o) { o.thickness_mm = 0; }, "thickness");
    refused([](SlabOptions& o) { o.thickness_mm = 0.05; }, "number of layers");
    refused([](SlabOptions& o) { o.layer_mm = -1; }, "depth of a voxel");
    refused([](SlabOptions& o) { o.feature_mm = std::nan(""); }, "size of the pattern");
    refused([](SlabOptions& o) { o.width = 0; }, "columns across");
}
