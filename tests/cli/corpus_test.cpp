// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every model of the corpus that may lie beside the tree gives either a stack that passes `verify` or a clear error.
#include <algorithm>
#include <cctype>

#include <fmt/core.h>

#include <catch2/catch.hpp>

#include "run_program.h"
#include "tests/outcomes.h"
#include "tests/places.h"

using namespace voxtone::test;
namespace fs = std::filesystem;

namespace {

bool is_input(const fs::path& path) {
    const std::string folder = path.parent_path().filename().string();
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    if (extension == ".obj" || extension == ".ply" || extension == ".stl" || extension == ".gltf" ||
        extension == ".glb" || extension == ".3mf")
        return true;
    return folder.rfind("img_", 0) == 0 && (extension == ".png" || extension == ".jpg");
}

}  // namespace

TEST_CASE("Every model of the corpus gives a stack or a clear error") {
    const fs::path corpus = fs::path(source_dir()) / "../shared/models";
    if (!fs::exists(corpus)) return skip("the model corpus is not beside the tree");
    // Made to be refused: none of its corners is a number. Flat models have fewer than the 30 layers that the printer
    // asks for.
    const std::string without_shape = "BoxWithInfinites.glb", flat = "takes no fewer than 30";
    int inputs = 0;
    for (const auto& entry : fs::recursive_directory_iterator(corpus)) {
        if (!entry.is_regular_file() || !is_input(entry.path())) continue;
        const Folder folder("corpus");
        const bool picture = entry.path().parent_path().filename().string().rfind("img_", 0) == 0;
        const Outcome outcome =
            run_program(fmt::format("slice --quiet --no-report --iterations 0 '{}' {} -o {}", entry.path().string(),
                                    picture ? "--width 7mm --thickness 1.5mm" : "--size 9mm", folder / "out"));
        INFO(entry.path().string() << ": " << outcome.err);
        ++inputs;
        CHECK((outcome.exit_code == 0 || outcome.exit_code == 3));
        if (outcome.exit_code == 0) {
            const Outcome verified = run_program("verify --quiet " + (folder / "out"));
            INFO(verified.out);
            CHECK(verified.exit_code == 0);
        } else {
            CHECK(outcome.err.size() > 40);
            CHECK(outcome.err.find("voxtone: ") != std::string::npos);
            CHECK((entry.path().filename() == without_shape || outcome.err.find(flat) != std::string::npos));
        }
    }
    CHECK(inputs >= 27);
}
