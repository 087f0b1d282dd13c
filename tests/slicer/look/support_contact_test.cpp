// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/support_contact.h"

#include <vector>

#include <catch2/catch.hpp>

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

/// A table of 20 x 12 x 4 voxels on a leg of 4 x 4 x 10 at x in [2, 6), y in [4, 8): asymmetric along x.
optics::ResinVolume table() {
    optics::ResinVolumeBuilder builder({20, 12, 14}, {0.1, 0.2, 0.05});
    for (int z = 0; z < 14; ++z) {
        std::vector<optics::Material> layer;
        for (int y = 0; y < 12; ++y)
            for (int x = 0; x < 20; ++x) layer.push_back(z >= 10 || (x >= 2 && x < 6 && y >= 4 && y < 8) ? 1 : 0);
        builder.add_layer(layer);
    }
    return builder.finish();
}

}  // namespace

TEST_CASE("support lies under overhangs, beside what stands below them, and on the tray") {
    const optics::ResinVolume volume = table();
    const SupportContact contact(volume, 0.01, 0.3);
    const optics::Point up{0, 0, 1}, down{0, 0, -1}, left{-1, 0, 0}, right{1, 0, 0};
    CHECK(!contact.touched({1.0, 1.2, 0.7}, up));     // the table's top
    CHECK(contact.touched({1.5, 1.2, 0.5}, down));    // its underside
    CHECK(!contact.touched({2.0, 1.2, 0.6}, right));  // its edges
    CHECK(!contact.touched({0.0, 1.2, 0.6}, left));
    CHECK(contact.touched({0.6, 1.2, 0.25}, right));  // the leg
    CHECK(contact.touched({0.2, 1.2, 0.25}, left));
    CHECK(contact.touched({0.4, 1.2, 0.0}, down));  // the foot
    CHECK(contact.roughness({1.5, 1.2, 0.5}, down) == 0.3);
    CHECK(contact.roughness({1.0, 1.2, 0.7}, up) == 0.01);
}
