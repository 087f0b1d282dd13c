// SPDX-License-Identifier: GPL-3.0-or-later
//
// The loop goes by the fast predictor; whether the print came nearer to its target is asked of light paths.
#include <string>

#include <fmt/core.h>
#include <catch2/catch.hpp>

#include "exr_numbers.h"
#include "run_program.h"
#include "tests/places.h"

using namespace voxtone::test;

namespace {

/// Mean square of what a picture is off its target, averaged over 5 x 5 cells (0.42 mm, about what an eye averages from
/// 300 mm), so that noise of single cells does not count.
double mean_square_off(const ExrNumbers& picture, const ExrNumbers& target) {
    constexpr int reach = 2;
    REQUIRE((picture.width == target.width && picture.height == target.height));
    double sum = 0;
    int count = 0;
    for (int y = reach; y < picture.height - reach; ++y)
        for (int x = reach; x < picture.width - reach; ++x, ++count)
            for (int c = 0; c < 3; ++c) {
                double off = 0;
                for (int j = y - reach; j <= y + reach; ++j)
                    for (int i = x - reach; i <= x + reach; ++i)
                        off += double(picture.at(i, j)[c]) - double(target.at(i, j)[c]);
                off /= (2 * reach + 1) * (2 * reach + 1);
                sum += off * off;
            }
    return sum / count;
}

}  // namespace

TEST_CASE("The loop's print is nearer to its target by Monte Carlo, which it never asked") {
    const Folder folder("truth");
    const auto off = [&](const std::string& iterations) {
        const std::string out = folder / fmt::format("out-{}", iterations.substr(0, 1)), traced = out + "-traced.exr";
        REQUIRE(run_program(fmt::format("slice --quiet --iterations {} {}/examples/models/spot/"
                                        "spot_texture.png --width 4mm --thickness 2mm -o {}",
                                        iterations, source_dir(), out))
                    .exit_code == 0);
        REQUIRE(run_program(fmt::format("predict --quiet --predict monte-carlo --spp 256 {} -o {}", out, traced))
                    .exit_code == 0);
        return mean_square_off(read_exr(traced), read_exr(out + "/target.exr"));
    };
    // Of 25 cells with an error of 0.036 noise is 5e-5 a channel.
    const double open_loop = off("0"), loop = off("4 --intent absolute");
    CAPTURE(open_loop, loop);
    CHECK(open_loop > 0.01);
    CHECK(loop < 0.8 * open_loop);
}
