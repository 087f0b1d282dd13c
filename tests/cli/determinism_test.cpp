// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "run_program.h"
#include "tests/places.h"

using namespace voxtone::test;

namespace {

const std::string spot = source_dir() + "/examples/models/spot/spot.obj";

auto layers_of(const Folder& folder, const std::string& out) { return read_tree(folder / (out + "/layers")); }

}  // namespace

TEST_CASE("The same bits for any number of threads, for ranges run apart, and for both screens") {
    const Folder folder("same");
    for (const char* screen : {"blue-noise", "error-diffusion"}) {
        INFO(screen);
        const std::string slice =
            fmt::format("slice --quiet --no-report --iterations 0 --overwrite --screen {} --size 3mm {}", screen, spot);
        REQUIRE(run_program(fmt::format("{} --threads 1 -o {}", slice, folder / "one")).exit_code == 0);
        REQUIRE(run_program(fmt::format("{} --threads 5 -o {}", slice, folder / "five")).exit_code == 0);
        const auto whole = layers_of(folder, "one");
        CHECK(whole.size() > 100);
        CHECK(whole == layers_of(folder, "five"));
        const auto hash = [&](const std::string& out) {
            return nlohmann::json::parse(read_file(folder / (out + "/manifest.json"))).at("content_sha256");
        };
        CHECK(hash("one") == hash("five"));

        // 41 lies within a slab: its layers are made twice, by two runs.
        REQUIRE(run_program(fmt::format("{} --layers 0-40 -o {}", slice, folder / "low")).exit_code == 0);
        REQUIRE(
            run_program(fmt::format("{} --layers 41-{} -o {}", slice, whole.size() - 1, folder / "high")).exit_code ==
            0);
        auto parts = layers_of(folder, "low");
        const auto high = layers_of(folder, "high");
        parts.insert(parts.end(), high.begin(), high.end());
        CHECK(parts == whole);
    }
}
