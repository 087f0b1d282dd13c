// SPDX-License-Identifier: GPL-3.0-or-later
//
// make_screen FILE: writes the blue-noise tiles of the pitches in built_in_screens.h, one after the other, 2 bytes a
// voxel in the machine's byte order. Run by the build; the library embeds the file.
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <vector>

#include "base/parallel.h"
#include "halftone/screens/built_in_screens.h"
#include "halftone/screens/void_and_cluster.h"

int main(int argc, char** argv) try {
    if (argc != 2) {
        std::fprintf(stderr, "usage: make_screen FILE\n");
        return 2;
    }
    using voxtone::halftone::built_in_screens;
    std::vector<std::vector<std::uint16_t>> tiles(built_in_screens.size());
    voxtone::parallel_for(0, tiles.size(), 1, [&](std::size_t n) {
        voxtone::halftone::VoidAndClusterOptions options;
        options.pitch_mm = built_in_screens[n].pitch_mm;
        tiles[n] = voxtone::halftone::void_and_cluster_thresholds(options);
    });
    std::ofstream file(argv[1], std::ios::binary);
    for (const auto& tile : tiles)
        file.write(reinterpret_cast<const char*>(tile.data()),
                   static_cast<std::streamsize>(tile.size() * sizeof(tile[0])));
    file.close();
    if (!file) {
        std::fprintf(stderr, "make_screen: %s could not be written\n", argv[1]);
        return 4;
    }
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "make_screen: %s\n", error.what());
    return 1;
}
