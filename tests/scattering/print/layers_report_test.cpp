// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/layers_report.h"

#include <catch2/catch.hpp>

#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::scattering;
using Catch::Matchers::Contains;

TEST_CASE("Where the spread of light in a print cannot be traced the report says why") {
    const io::TemporaryFolder folder;
    io::ProfileMap map;
    map.width_px = map.height_px = 4;
    io::StackDescription stack;
    stack.size_px = {1000, 1000};
    stack.layers = 201;
    Progress progress;
    const auto said = [&] {
        const io::ReportSection section = spread_section(map, stack, folder.path(), 1, progress);
        CHECK(section.title == "How light spreads in the print");
        CHECK(section.tables.empty());
        REQUIRE(section.paragraphs.size() == 1);
        return section.paragraphs[0];
    };
    CHECK_THAT(said(), Contains("201 million voxels were not traced here"));
    stack.layers = 200;  // there is no job.json
    CHECK_THAT(said(), Contains("It was not traced: ") && Contains("--show layered-profile"));
}
