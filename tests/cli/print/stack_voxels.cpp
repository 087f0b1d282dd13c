// SPDX-License-Identifier: GPL-3.0-or-later
#include "stack_voxels.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"

namespace voxtone::test {

StackVoxels stack_voxels(const std::filesystem::path& folder) {
    const auto manifest = nlohmann::json::parse(read_file(folder / "manifest.json"));
    const auto background = manifest.at("background_rgb").get<std::array<std::uint8_t, 3>>();
    std::array<int, 3> least{}, most{};
    least.fill(std::numeric_limits<int>::max());
    most.fill(-1);
    StackVoxels found;
    std::map<std::array<int, 2>, std::array<std::uint8_t, 3>> uppermost;
    for (int layer = 0; layer < manifest.at("layers").get<int>(); ++layer) {
        const Bitmap bitmap = read_png((folder / "layers" / fmt::format("slice_{:05}.png", layer)).string());
        for (int y = 0; y < bitmap.height; ++y)
            for (int x = 0; x < bitmap.width; ++x) {
                const std::array<std::uint8_t, 4> pixel = bitmap.at(x, y);
                if (std::equal(background.begin(), background.end(), pixel.begin())) continue;
                ++found.solid;
                if (std::abs(2 * x + 1 - bitmap.width) * 5 < bitmap.width &&
                    std::abs(2 * y + 1 - bitmap.height) * 5 < bitmap.height)
                    uppermost[{x, y}] = {pixel[0], pixel[1], pixel[2]};
                const std::array<int, 3> at{x, y, layer};
                for (std::size_t k = 0; k < 3; ++k) {
                    least[k] = std::min(least[k], at[k]);
                    most[k] = std::max(most[k], at[k]);
                }
            }
    }
    for (const auto& resin : manifest.at("resins")) {
        const auto rgb = resin.at("rgb").get<std::array<std::uint8_t, 3>>();
        const auto here =
            std::count_if(uppermost.begin(), uppermost.end(), [&](const auto& v) { return v.second == rgb; });
        found.top[resin.at("role")] =
            static_cast<double>(here) / static_cast<double>(std::max<std::size_t>(1, uppermost.size()));
    }
    found.volume_mm3 = static_cast<double>(found.solid);
    const auto pitch = manifest.at("pitch_um").get<std::array<double, 3>>();
    for (std::size_t k = 0; k < 3; ++k) {
        found.volume_mm3 *= pitch[k] / 1000;
        if (found.solid) found.size_mm[k] = (most[k] - least[k] + 1) * pitch[k] / 1000;
    }
    return found;
}

}  // namespace voxtone::test
