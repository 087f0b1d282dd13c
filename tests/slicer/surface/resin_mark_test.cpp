// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <fmt/core.h>

#include "base/error.h"
#include "base/progress.h"
#include "io/files/json_object.h"
#include "io/files/whole_file.h"
#include "io/lettering/font_file.h"
#include "io/lettering/set_text.h"
#include "io/pictures/picture_writer.h"
#include "slicer/print/run_print.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;

namespace {

/// A white slab of 14 x 7 x 3 mm.
SliceOptions white_slab(const io::TemporaryFolder& folder) {
    const std::filesystem::path picture = folder.path() / "white.png";
    io::write_whole_file(picture, io::png_bytes({2, 1, 3, std::vector<std::uint8_t>(6, 255)}));
    SliceOptions options;
    options.model = picture.string();
    options.out = (folder.path() / "out").string();
    options.width_mm = 14;
    options.thickness_mm = 3;
    options.predict = "none";
    options.iterations.assign(1, '0');  // a literal here trips a warning of GCC 12
    options.report = false;
    return options;
}

double mm3_of(const SliceOptions& options, const std::string& role) {
    for (const io::JsonObject& resin : io::JsonObject::read(options.out + "/manifest.json").objects("resins"))
        if (resin.text("role") == role) return 1000 * resin.number("ml", 0, 1e9);
    return -1;
}

}  // namespace

TEST_CASE("A label of a resin is of that resin alone, as deep as the shell, whatever decides the mixtures", "[slow]") {
    const io::Coverage ink = io::set_text("HO8", io::find_font(io::default_font), 5);
    double ink_mm2 = 0;
    for (const std::uint8_t share : ink.ink) ink_mm2 += share / 255.0 * ink.pixel_mm * ink.pixel_mm;
    const auto [screen, iterations] =
        GENERATE(table<std::string, std::string>({{"blue-noise", "0"}, {"error-diffusion", "0"}, {"blue-noise", "2"}}));
    INFO(screen << ", " << iterations << " iterations");
    const io::TemporaryFolder folder;
    SliceOptions options = white_slab(folder);
    options.screen = screen;
    options.iterations = iterations;
    options.labels = {"HO8; size=5mm; place=top; resin=M"};
    Progress quiet;
    (void)run_print({options}, quiet);
    // The outline's staircase, and a little magenta that the loop puts beside the letters.
    CHECK(mm3_of(options, "M") == Approx(ink_mm2 * 1).epsilon(0.03));
}

TEST_CASE("A label of a resin that is not loaded is refused") {
    const io::TemporaryFolder folder;
    SliceOptions options = white_slab(folder);
    options.labels = {"HO8; place=top; resin=T"};
    Progress quiet;
    CHECK_THROWS_WITH(run_print({options}, quiet), Contains("resin=T is not loaded") && Contains("C, M, Y, K, W"));
}
