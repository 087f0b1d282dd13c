// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/report/plot_svg.h"

#include <catch2/catch.hpp>

using namespace voxtone::io;
using Catch::Matchers::Contains;

TEST_CASE("Points lie where their axes say, upwards and to the right") {
    Plot plot({0, 10, false, {5}, "x"}, {0.01, 1, true, {0.1}, "y"}, "<title>", 100, 200);
    plot.line({{0, 0.01}, {5, 0.1}, {10, 1}}, "red", 1.5, true);
    plot.point(10, 0.01, "blue");
    plot.label(0, 1, "one & all", "green");
    const std::string svg = plot.svg();
    CHECK_THAT(svg, Contains("points=\"0.0,200.0 50.0,100.0 100.0,0.0 \"") && Contains("stroke-dasharray"));
    CHECK_THAT(svg, Contains("cx=\"100.0\" cy=\"200.0\""));
    CHECK_THAT(svg, Contains("&lt;title&gt;") && Contains("one &amp; all"));
    CHECK_THAT(svg, Contains(">5<") && Contains(">0.1<"));
}
