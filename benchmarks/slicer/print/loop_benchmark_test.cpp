// SPDX-License-Identifier: GPL-3.0-or-later
//
// The judge is judged where the answer is known.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "base/error.h"
#include "base/random.h"
#include "benchmarks/sets.h"
#include "flat_white.h"
#include "flip.h"
#include "gratings.h"
#include "io/files/whole_file.h"
#include "io/pictures/picture_writer.h"
#include "judge_slab.h"
#include "optics/colour/colour.h"
#include "printed_codes.h"
#include "scores.h"
#include "stroke_font.h"
#include "targets.h"
#include "tests/halftone/loop/flat_surface.h"
#include "tests/io/files/temporary_folder.h"
#include "variants.h"

using namespace voxtone;
using namespace voxtone::loop_benchmark;

namespace {

double gaussian(std::uint64_t i, std::uint64_t stream) {
    RandomStream random(stream, i);
    const double r = std::sqrt(-2 * std::log(1 - random.uniform()));
    return r * std::cos(2 * std::numbers::pi * random.uniform());
}

}  // namespace

TEST_CASE("the modulation of a known grating is found, noise and all", "[loop_benchmark]") {
    const double width = 20, height = 14;
    const optics::Surface surface =
        test::flat_surface(static_cast<int>(width / 0.085), static_cast<int>(height / 0.085), 0.085);
    const auto blocks = grating_blocks(width, height);
    const std::array<double, 3> kept{0.8, 0.5, 0.25};
    Colours target, print;
    for (std::size_t i = 0; i < surface.cells.size(); ++i) {
        const double x = static_cast<double>(surface.cells[i].centre_mm[0]),
                     y = static_cast<double>(surface.cells[i].centre_mm[1]);
        const double t = grating_light(blocks, x, y);
        target.push_back(Eigen::Vector3f::Constant(static_cast<float>(t)));
        double p = t;
        for (const GratingBlock& b : blocks)
            if (x >= b.x0 && x < b.x1 && y >= b.y0 && y < b.y1) {
                const double mean = b.full ? 0.5 : 0.4, share = b.per_mm < 0.75  ? kept[0]
                                                                : b.per_mm < 1.5 ? kept[1]
                                                                                 : kept[2];
                p = 0.9 * (mean + share * (t - mean));  // darker as a whole: modulation is relative to the mean
            }
        print.push_back(Eigen::Vector3f::Constant(static_cast<float>(p + 0.05 * gaussian(i, 5))));
    }
    const auto found = modulation_by_frequency(width, height, surface, target, print);
    for (std::size_t f = 0; f < 3; ++f) CHECK(found[f] == Approx(kept[f]).margin(0.01));
    // A shift by a quarter of a period keeps nothing.
    Colours shifted = target;
    const GratingBlock& b = blocks[0];
    for (std::size_t i = 0; i < shifted.size(); ++i) {
        const double x = static_cast<double>(surface.cells[i].centre_mm[0]);
        shifted[i] = Eigen::Vector3f::Constant(
            static_cast<float>(0.4 + 0.15 * std::sin(2 * std::numbers::pi * b.per_mm * (x - 0.5 * (b.x0 + b.x1)))));
    }
    CHECK(std::abs(modulation_kept(b, surface, target, shifted)) < 0.01);
}

TEST_CASE("noise of the tracer is taken out of an error that is there, and flatters none", "[loop_benchmark]") {
    Colours target(20000, Eigen::Vector3f::Constant(0.3F)), off(target.size(), Eigen::Vector3f(0.3F, 0.42F, 0.3F));
    const auto with_noise = [&](const Colours& colours) {
        std::array<Colours, 2> half{colours, colours};
        for (std::size_t h = 0; h < 2; ++h)
            for (std::size_t i = 0; i < colours.size(); ++i)
                for (Eigen::Index c = 0; c < 3; ++c)
                    half[h][i][c] += static_cast<float>(0.02 * gaussian(i, 10 * h + static_cast<std::size_t>(c)));
        return half;
    };
    const double truth = differences(target, off).front();
    const Figures figures = compare(target, with_noise(off), {});
    CHECK(figures.mean == Approx(truth).epsilon(0.02));
    CHECK(figures.median == Approx(truth).epsilon(0.02));
    const Figures nothing = compare(target, with_noise(target), {});
    CHECK(nothing.mean > 0);
    CHECK(nothing.mean < 0.5 * nothing.noise * 1.5);
    std::vector<char> half_of_them(target.size(), 0);
    for (std::size_t i = 0; i < half_of_them.size(); i += 2) half_of_them[i] = 1;
    CHECK(compare(target, with_noise(off), half_of_them).cells == target.size() / 2);
}

TEST_CASE("cells that are too dark and all white have nothing more to give, nor those that are too light and all ink",
          "[loop_benchmark]") {
    constexpr int n = 30;
    Judgement j;
    j.surface = test::flat_surface(n, n, 0.085);
    const std::size_t cells = j.surface.cells.size();
    j.target.assign(cells, Eigen::Vector3f::Constant(0.5F));
    j.mapped = j.target;
    j.in_gamut.assign(cells, 1);
    const Eye eye(j.surface, 300);
    const auto at_limit = [&](float shown, float white) {
        j.half[0].assign(cells, Eigen::Vector3f::Constant(shown));
        j.half[1] = j.half[0];
        j.white_share.assign(cells, 0.5F);
        std::fill_n(j.white_share.begin(), cells / 2, white);
        return score(j, eye).at_limit;
    };
    CHECK(at_limit(0.4F, 1.0F) == Approx(0.5).margin(0.01));
    CHECK(at_limit(0.4F, 0.0F) == 0);
    CHECK(at_limit(0.6F, 0.0F) == Approx(0.5).margin(0.01));
    CHECK(at_limit(0.6F, 1.0F) == 0);
}

TEST_CASE("a print that is half as contrasty in its detail keeps half of it, whatever its level and its noise",
          "[loop_benchmark]") {
    constexpr int n = 60;
    const optics::Surface surface = test::flat_surface(n, n, 0.085);
    const auto grey = [](double lightness) {  // CIE L*
        const double f = (lightness + 16) / 116;
        return Eigen::Vector3f::Constant(static_cast<float>(f * f * f)).eval();
    };
    Colours target, print, level;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const double stripe = x / 3 % 2 ? 10 : -10;
            target.push_back(grey(50 + stripe));
            print.push_back(grey(60 + 0.5 * stripe + gaussian(target.size(), 8)));
            level.push_back(grey(60));
        }
    CHECK(contrast_kept(surface, target, print, {}) == Approx(0.5).margin(0.01));
    CHECK(contrast_kept(surface, target, target, {}) == Approx(1));
    CHECK(contrast_kept(surface, target, level, {}) == Approx(0).margin(1e-3));
    CHECK(contrast_kept(surface, level, print, {}) == Approx(0).margin(1e-3));
}

TEST_CASE("smoothing the white keeps planes and symmetric falls, and takes noise away", "[loop_benchmark]") {
    const std::size_t columns = 60, rows = 40;
    const auto fall = [&](std::size_t x, std::size_t y) {
        const auto u = static_cast<double>(std::min(x, columns - 1 - x)),
                   v = static_cast<double>(std::min(y, rows - 1 - y));
        return 0.8 - 0.1 * std::exp(-u / 20) - 0.1 * std::exp(-v / 20);
    };
    std::vector<float> value;
    for (std::size_t y = 0; y < rows; ++y)
        for (std::size_t x = 0; x < columns; ++x)
            value.push_back(static_cast<float>(fall(x, y) + 0.03 * gaussian(y * columns + x, 3)));
    smooth_flat_white(value, columns, rows, 1, 0.085, true, true);
    double worst_inside = 0;
    for (std::size_t y = 8; y < rows - 8; ++y)
        for (std::size_t x = 8; x < columns - 8; ++x)
            worst_inside = std::max(worst_inside, std::abs(static_cast<double>(value[y * columns + x]) - fall(x, y)));
    CHECK(worst_inside < 0.012);
    CHECK(value[0] == value[columns - 1]);
    CHECK(value[0] == value[(rows - 1) * columns]);
}

TEST_CASE("letters are drawn as wide and as dark as their size says", "[loop_benchmark]") {
    std::vector<Stroke> strokes;
    const double unit = 12 * mm_per_point / 10, end = add_text(strokes, "l", 1, 1, 12);
    CHECK(end == Approx(1 + (1 + 1.7) * unit));
    const auto ink = draw_strokes(strokes, 4, 6, 50);
    double area = 0;
    for (const float c : ink) area += static_cast<double>(c) / 2500;
    const double line = 0.95 * unit;  // a stem of 7 units with round ends
    CHECK(area == Approx(7 * unit * line + std::numbers::pi * line * line / 4).epsilon(0.01));
    CHECK(add_text(strokes, "~", 0, 0, 10) == Approx((2.6 + 1.7) * mm_per_point));
}

TEST_CASE("a white picture is judged white up to its edges, and a grey one is not", "[loop_benchmark]") {
    const io::TemporaryFolder folder;
    const auto judged = [&](const std::string& name, float light) {
        io::LinearPicture picture{40, 32,
                                  std::vector<Eigen::Vector4f>(40 * 32, Eigen::Vector4f(light, light, light, 1))};
        io::write_whole_file(folder.path() / (name + ".png"),
                             io::png_bytes(io::encode_over(picture, Eigen::Vector3f::Ones())));
        slicer::SliceOptions options;
        options.model = (folder.path() / (name + ".png")).string();
        options.out = (folder.path() / name).string();
        options.width_mm = 2;
        options.thickness_mm = 1;
        options.depth_mm = 0.5;
        options.report = false;
        const Print print = make_print(options, false);
        CHECK(print.seconds > 0);
        CHECK(make_print(options, true).seconds == print.seconds);  // taken as it is
        return judge_slab(print.options,
                          {.paths = 64, .white_paths = 256, .cell_mm = 0.085, .cache = folder.path() / "traced"});
    };
    const Judgement white = judged("white", 1.0F);
    REQUIRE(white.surface.cells.size() == white.columns * white.rows);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& c : white.print()) mean += c.cast<double>();
    mean /= static_cast<double>(white.surface.cells.size());
    // 450 cells of 128 paths with 0.4 per path, three channels: 0.0017 each; the white twin's noise adds as much.
    CHECK((mean - Eigen::Vector3d::Ones()).cwiseAbs().maxCoeff() < 0.01);
    const Judgement grey = judged("grey", 0.4F);
    Eigen::Vector3d grey_mean = Eigen::Vector3d::Zero();
    for (const auto& c : grey.print()) grey_mean += c.cast<double>();
    grey_mean /= static_cast<double>(grey.surface.cells.size());
    CHECK(grey_mean.maxCoeff() < 0.8);
    CHECK(grey_mean.minCoeff() > 0.2);
    CHECK(grey.target.front()[0] == Approx(0.4).margin(0.01));
}

TEST_CASE("options of a variant are those of slice, and unknown ones are refused", "[loop_benchmark]") {
    slicer::SliceOptions options;
    set_options(parse_set({"depth=0.7mm", "seed=5"}), options);
    CHECK(options.depth_mm == 0.7);
    CHECK(options.seed == 5);
    CHECK_THROWS_AS(set_options(parse_set({"dept=1"}), options), UsageError);
    CHECK_THROWS_AS(parse_set({"depth"}), UsageError);
    CHECK(variants({}).size() == 2);
}

TEST_CASE("pages are made in the size that is asked for", "[loop_benchmark]") {
    const io::TemporaryFolder folder;
    std::vector<std::string> missing;
    const auto targets = make_targets(folder.path() / "no-models", folder.path(), "", {6, 4}, missing);
    CHECK(missing.size() == benchmarks::pictures().size());
    REQUIRE(targets.size() == 6);
    for (const Target& t : targets) {
        CHECK(t.width_mm == 6);
        CHECK(t.height_mm == 4);
        CHECK(std::filesystem::exists(t.picture));
    }
}

TEST_CASE("figures are judged on pictures and bodies that they were not chosen on", "[loop_benchmark]") {
    const auto held_out = [](const std::vector<benchmarks::SetEntry>& all) {
        return std::count_if(all.begin(), all.end(), [](const auto& entry) { return entry.held_out; });
    };
    CHECK(held_out(benchmarks::pictures()) >= 6);
    CHECK(held_out(benchmarks::bodies()) >= 2);
    for (const auto& body : benchmarks::bodies()) CHECK(body.size_mm > 0);
}

namespace {

FlipPicture flat_picture(const Eigen::Vector3f& rgb) { return {40, 30, std::vector<Eigen::Vector3f>(1200, rgb)}; }

double middle_of(const std::vector<double>& difference) { return difference[15 * 40 + 20]; }

}  // namespace

TEST_CASE("FLIP is what its paper says where that can be said by hand", "[loop_benchmark]") {
    constexpr double per_degree = 67;
    const FlipPicture white = flat_picture({1, 1, 1}), black = flat_picture({0, 0, 0});
    CHECK(middle_of(flip(white, white, per_degree)) == Approx(0).margin(1e-12));
    // Flat pictures have no features. HyAB of white and black is 100, the largest in the gamut is that of green (87.7,
    // -86.2, 83.2) and blue (32.3, 79.2, -107.9), a and b times L / 100: 55.4 + hypot(101.2, 107.8).
    const double most = std::pow(203.3, 0.7), far = std::pow(100, 0.7), bend = 0.4 * most;
    const double wanted = far < bend ? 0.95 * far / bend : 0.95 + 0.05 * (far - bend) / (most - bend);
    CHECK(middle_of(flip(white, black, per_degree)) == Approx(wanted).margin(0.002));
    CHECK(middle_of(flip(flat_picture({0, 1, 0}), flat_picture({0, 0, 1}), per_degree)) == Approx(1).margin(1e-6));
    // An edge that is lost is worse than the same colours without it, and an equal error of hue spread fine is less.
    FlipPicture edge = white;
    for (std::size_t i = 0; i < edge.rgb.size(); ++i)
        if (i % 40 >= 20) edge.rgb[i].setConstant(0.5F);
    const FlipPicture grey = flat_picture({0.5F, 0.5F, 0.5F});
    const std::vector<double> lost = flip(edge, grey, per_degree);
    CHECK(lost[15 * 40 + 19] > 1.02 * lost[15 * 40 + 2]);
    FlipPicture fine = grey;
    for (std::size_t i = 0; i < fine.rgb.size(); ++i)
        fine.rgb[i] = i % 2 ? Eigen::Vector3f(0.55F, 0.5F, 0.4F) : Eigen::Vector3f(0.45F, 0.5F, 0.6F);
    CHECK(middle_of(flip(grey, fine, per_degree)) <
          0.3 * middle_of(flip(grey, flat_picture({0.55F, 0.5F, 0.4F}), per_degree)));
}

TEST_CASE("codes are read from a sharp page, and none from a blurred one", "[loop_benchmark]") {
    Judgement page;
    constexpr double cell_mm = 0.085;
    page.columns = static_cast<std::size_t>(codes_width_mm / cell_mm);
    page.rows = static_cast<std::size_t>(codes_height_mm / cell_mm);
    page.surface = test::flat_surface(static_cast<int>(page.columns), static_cast<int>(page.rows), cell_mm);
    const std::vector<PrintedCode> codes = printed_codes();
    constexpr int samples = 4;
    const auto light_at = [&](double x, double y) {
        for (const PrintedCode& code : codes) {
            const auto rows = static_cast<double>(code.dark.size());
            const double u = (x - code.x) / code.module_mm, v = (code.y + code.height - y) / code.height * rows;
            if (u >= 0 && v >= 0 && v < rows && u < static_cast<double>(code.dark[0].size()))
                return code.dark[static_cast<std::size_t>(v)][static_cast<std::size_t>(u)] ? 0.02 : 1.0;
        }
        return 1.0;
    };
    Colours sharp;
    for (std::size_t row = 0; row < page.rows; ++row)
        for (std::size_t column = 0; column < page.columns; ++column) {
            double sum = 0;
            for (int b = 0; b < samples; ++b)
                for (int a = 0; a < samples; ++a)
                    sum += light_at((static_cast<double>(column) + (a + 0.5) / samples) * cell_mm,
                                    (static_cast<double>(row) + (b + 0.5) / samples) * cell_mm);
            sharp.push_back(Eigen::Vector3f::Constant(static_cast<float>(sum / (samples * samples))));
        }
    const ReadCodes read = read_codes(page, sharp);
    CHECK(read.square_mm == 0.2);
    CHECK(read.bars_mm == 0.2);
    const ReadCodes lost = read_codes(page, Colours(sharp.size(), Eigen::Vector3f::Constant(0.7F)));
    CHECK(lost.square_mm == 0);
    CHECK(lost.bars_mm == 0);
}
