// SPDX-License-Identifier: GPL-3.0-or-later
//
// Photographs of slabs whose profiles are known come back as these profiles, whatever the bench does; what it may not
// do is refused.
#include <cmath>
#include <functional>
#include <string>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/bench/slab_reading.h"
#include "calibration/rehearsal/bench_camera.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

constexpr double pitch_mm = 0.08;

// A soft step, as a slab makes of an edge, without a renderer: black side, white side and softness of each channel.
RenderedSlab soft_slab() {
    RenderedSlab slab{"X", 0.5, 0.03, 0.03, 6, {}};
    constexpr double black[] = {0.45, 0.2, 0.03}, white[] = {0.75, 0.3, 0.6}, soft[] = {0.6, 0.3, 0.1};
    for (std::size_t c = 0; c < 3; ++c)
        for (int k = 0; k < int(2 * slab.reach_mm / RenderedSlab::step_mm); ++k) {
            const double x = (k + 0.5) * RenderedSlab::step_mm - slab.reach_mm;
            slab.F[c].push_back(black[c] + (white[c] - black[c]) * 0.5 * std::erfc(-x / (soft[c] * std::sqrt(2.0))));
        }
    return slab;
}

struct Bench {
    EdgeSetup setup;
    BareSheet sheet{{0.011, 0.0105, 0.012}, {0.965, 0.94, 0.938}};
    BenchCameraOptions camera;
    double bias = 1;
    int shots = 2;
    bool with_paper = true;
    std::function<void(io::Photograph&)> spoil;  ///< the first photograph of the slab

    Bench() {
        setup.pitch_mm = pitch_mm;
        setup.blur_mm = pitch_mm;
        camera.width_mm = 96;
        camera.height_mm = 72;
    }

    struct Read {
        EdgeProfile profile;
        BenchLight light;
        SheetReading sheet;
        SlabView view;
        std::vector<std::string> warnings;
    };

    /// What the photographs without a slab say.
    struct Lit {
        BenchLight light;
        BoardView board;
        SheetReading sheet;
    };
    [[nodiscard]] Lit lit(const BenchCamera& taken) const {
        const CheckerChart chart = find_checker("colorchecker24");
        BenchLightPhotos photos{taken.of_checker(chart, 0), taken.of_sheet(1), std::nullopt};
        if (with_paper) photos.paper = taken.of_paper(2);
        Lit result;
        result.light = measure_bench_light(photos, chart, {}, result.board, 20);
        result.sheet = read_sheet(cut_strip(photos.sheet, result.board, result.light.scale(photos.sheet)), "sheet");
        return result;
    }
    /// Most benches do not differ in it: photographed once.
    [[nodiscard]] bool is_lit_as_usual() const {
        const auto light = [](const Bench& b) {
            const BenchCameraOptions& c = b.camera;
            return std::tuple(b.with_paper, b.setup.blur_mm, c.turn_deg, c.uneven, c.vignetting, c.electrons,
                              c.exposure);
        };
        return light(*this) == light(Bench());
    }

    [[nodiscard]] Read read() const {
        const BenchCamera taken(setup, sheet, camera);
        static const Lit usual = [] {
            const Bench bench;
            return bench.lit(BenchCamera(bench.setup, bench.sheet, bench.camera));
        }();
        const Lit of_sheet = is_lit_as_usual() ? usual : lit(taken);
        const BoardView& board = of_sheet.board;
        Read result;
        result.light = of_sheet.light;
        result.sheet = of_sheet.sheet;
        const BenchReference reference{
            &result.light, &result.sheet, board.place.to_px(Eigen::Vector2d::Zero()), 20, 10, 10};
        std::vector<SlabView> views;
        for (int shot = 0; shot < shots; ++shot) {
            io::Photograph photo = taken.of_slab(soft_slab(), bias, {1.5 * shot, 0.5}, 3 + std::uint64_t(shot));
            if (shot == 0 && spoil) spoil(photo);
            views.push_back(read_slab(photo, reference, result.warnings));
        }
        result.view = views[0];
        result.profile = join_views(views, "X", 0.5, result.warnings);
        std::ranges::copy(result.light.warnings, std::back_inserter(result.warnings));
        return result;
    }
};

struct Agreement {
    double chi2 = 0, worst = 0, level = 0;  ///< mean of squared errors; largest difference; level of the difference
};

// Of a profile with what the camera should have seen; `wrong`: the truth made wrong by this part.
Agreement compare(const Bench& bench, const Bench::Read& read, double wrong = 0) {
    EdgeSetup camera = bench.setup;
    camera.pitch_mm = read.profile.x_mm[1] - read.profile.x_mm[0];
    const RenderedSlab slab = soft_slab();
    Agreement all;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::vector<double> truth = seen_by_camera(slab, c, read.profile.x_mm, camera);
        double off = 0, squares = 0;
        for (std::size_t k = 0; k < truth.size(); ++k) {
            const double d = read.profile.value[c][k] - (1 + wrong) * truth[k] / bench.bias;
            const double level = read.light.level_error[Eigen::Index(c)] * truth[k];
            squares += d * d / (std::pow(read.profile.error[c][k], 2) + level * level) / double(truth.size());
            off += d / double(truth.size());
            all.worst = std::max(all.worst, std::abs(d));
        }
        all.chi2 = std::max(all.chi2, squares);
        all.level = std::max(all.level, std::abs(off));
    }
    return all;
}

Bench::Read check_close(const Bench& bench, const char* what) {
    const Bench::Read read = bench.read();
    const Agreement a = compare(bench, read), wrong = compare(bench, read, 0.03);
    INFO(what << ": chi2 " << a.chi2 << ", worst " << a.worst << ", level " << a.level
              << "; wrong by 3 %: " << wrong.chi2);
    // Squares of errors are 1 on average; 125 correlated samples and three channels.
    CHECK(a.chi2 < 2);
    CHECK(a.worst < 0.006);
    CHECK(a.level < 0.002);
    CHECK(wrong.chi2 > 4);
    return read;
}

}  // namespace

TEST_CASE("profiles come back from photographs, whatever the bench does", "[edge]") {
    Bench bench;
    SECTION("all that a bench does by default") { static_cast<void>(check_close(bench, "default")); }
    SECTION("nothing but a camera without noise") {
        bench.camera.turn_deg = bench.camera.uneven = bench.camera.electrons = bench.camera.vignetting = 0;
        const Bench::Read read = bench.read();
        const Agreement a = compare(bench, read);
        INFO(a.worst);
        CHECK(a.worst < 0.003);
    }
    SECTION("the other way round, and turned further") {
        bench.camera.turn_deg = -9;
        static_cast<void>(check_close(bench, "turned by 9 degrees"));
    }
    SECTION("uneven light, corrected and said") {
        bench.camera.uneven = 0.03;
        const Bench::Read read = check_close(bench, "3 % of light lost");
        REQUIRE(read.light.unevenness);
        // 3 % across 10 mm, 0.8 of it along x and 0.6 along y: up to 2.1 % in a corner; smoothing takes some.
        CHECK(*read.light.unevenness == Approx(0.021).margin(0.003));
        CHECK(read.light.left_over < 0.004);
        CHECK_THAT(fmt::format("{}", fmt::join(read.warnings, "|")),
                   Contains("the light varies by") && Contains("[uneven-light]"));
    }
    SECTION("a factor on the slabs' photographs") {
        bench.bias = 0.913;
        static_cast<void>(check_close(bench, "bias"));
    }
    SECTION("a sharper and a softer camera") {
        bench.setup.blur_mm = 0.5 * pitch_mm;
        static_cast<void>(check_close(bench, "half a pixel"));
        bench.setup.blur_mm = 1.6 * pitch_mm;
        static_cast<void>(check_close(bench, "1.6 pixels"));
    }
    SECTION("little light") {
        bench.camera.exposure = 0.25;
        static_cast<void>(check_close(bench, "a quarter of the light"));
    }
    SECTION("scratches are left out") {
        bench.camera.scratches = 3;
        const Bench::Read read = check_close(bench, "scratches");
        CHECK(read.view.strip.left_out_share > 0.005);
    }
    SECTION("no white paper") {
        bench.with_paper = false;
        const Bench::Read read = check_close(bench, "no paper");
        CHECK_THAT(fmt::format("{}", fmt::join(read.warnings, "|")), Contains("No photograph of white paper"));
    }
    SECTION("one photograph") {
        bench.shots = 1;
        const Bench::Read read = check_close(bench, "one");
        CHECK_THAT(fmt::format("{}", fmt::join(read.warnings, "|")),
                   Contains("take a second one") && Contains("[slab-photo]"));
    }
}

TEST_CASE("the sheet, the scale and the blur are measured", "[edge]") {
    Bench bench;
    const Bench::Read read = bench.read();
    CHECK(1 / read.view.board.px_per_mm == Approx(pitch_mm).epsilon(2e-4));
    CHECK(read.view.board.turn_deg == Approx(2).margin(0.02));
    CHECK(std::abs(read.view.edge.offset_mm) < 0.02);
    CHECK(std::abs(read.view.edge.turn_deg) < 4 * read.view.edge.turn_error_deg + 0.02);
    CHECK(read.view.edge.turn_error_deg < 0.3);
    CHECK(read.sheet.edge.blur_mm == Approx(bench.setup.blur_mm).epsilon(0.06));
    CHECK(read.view.blur_mm == Approx(bench.setup.blur_mm).epsilon(0.1));
    CHECK(std::abs(read.sheet.edge.offset_mm) < 0.05 * pitch_mm);
    for (std::size_t c = 0; c < 3; ++c) {
        CHECK(read.sheet.seen_white[c] == Approx(bench.sheet.white[c]).margin(0.004));
        CHECK(read.sheet.seen_black[c] == Approx(bench.sheet.black[c]).margin(0.001));
    }
    // What a base of .985 looks like under its surface is what was measured of it, by another renderer.
    const EdgeSetup setup;
    const BareSheet rendered = render_bare_sheet(setup, 5);
    const optics::EdgeKernels kernels = bare_sheet_kernels(setup);
    for (std::size_t c = 0; c < 3; ++c) {
        CHECK(optics::far_from_edge(kernels, setup.white[c]) == Approx(rendered.white[c]).epsilon(0.005));
        CHECK(optics::far_from_edge(kernels, setup.black[c]) == Approx(rendered.black[c]).epsilon(0.03));
    }
    CHECK(rendered.white[0] < 0.98);  // the surface keeps some of it in
    // And back: what looks like the rendered sheet has the setup's base.
    SheetReading seen;
    seen.seen_white = rendered.white;
    seen.seen_black = rendered.black;
    const SheetBase base = base_under_surface(seen, kernels);
    for (std::size_t c = 0; c < 3; ++c) {
        CHECK(base.white[c] == Approx(setup.white[c]).epsilon(0.005));
        CHECK(base.black[c] == Approx(setup.black[c]).epsilon(0.03));
        CHECK_FALSE(base.too_bright[c]);
    }
    seen.seen_white = {1.1, 1.1, 1.1};
    CHECK(base_under_surface(seen, kernels).too_bright == std::array{true, true, true});
}

TEST_CASE("photographs that cannot be measured are refused with a sentence", "[edge]") {
    Bench bench;
    const auto refused = [&](const char* why) {
        INFO(why);
        CHECK_THROWS_WITH(bench.read(), Contains(why));
    };
    const auto pixels = [](io::Photograph& photo, auto&& change) {
        for (std::uint32_t y = 0; y < photo.height_px; ++y)
            for (std::uint32_t x = 0; x < photo.width_px; ++x) change(photo.pixels[photo.index(x, y)], x, y);
    };
    SECTION("overexposed") {
        bench.camera.exposure = 1.6;
        refused("overexposed");
    }
    SECTION("a slab that clips") {
        bench.bias = 0.25;
        refused("channel is clipped");
    }
    SECTION("underexposed") {
        bench.camera.exposure = 0.02;
        refused("underexposed");
    }
    SECTION("all of it blurred") {
        bench.setup.blur_mm = 0.35;
        refused("blurred");
    }
    SECTION("one photograph blurred") {
        bench.spoil = [&](io::Photograph& photo) {
            Bench soft = bench;
            soft.setup.blur_mm = 2.5 * pitch_mm;
            photo = BenchCamera(soft.setup, soft.sheet, soft.camera).of_slab(soft_slab(), 1, {0, 0}, 3);
        };
        refused("the photograph is blurred");
    }
    SECTION("turned too far") {
        bench.camera.turn_deg = 20;
        refused("turned by");
    }
    SECTION("light that falls off") {
        bench.camera.uneven = 0.12;
        bench.camera.exposure = 0.5;
        refused("the light varies by");
    }
    SECTION("no edge") {
        bench.spoil = [&](io::Photograph& photo) {
            pixels(photo, [](Eigen::Vector3f& v, auto, auto) { v.setConstant(0.4f); });
        };
        refused("no checkerboard found");
    }
    SECTION("no slab") {
        bench.spoil = [&](io::Photograph& photo) {
            photo = BenchCamera(bench.setup, bench.sheet, bench.camera).of_sheet(9);
        };
        refused("there is no slab");
    }
    SECTION("scratched all over") {
        bench.camera.scratches = 60;
        refused("scratched all over");
    }
    SECTION("photographs in each other's places") {
        const BenchCamera taken(bench.setup, bench.sheet, bench.camera);
        const CheckerChart chart = find_checker("colorchecker24");
        const io::Photograph checker = taken.of_checker(chart, 0), sheet = taken.of_sheet(1), paper = taken.of_paper(2);
        const auto mistaken = [&](BenchLightPhotos photos, const char* why) {
            BoardView board;
            CHECK_THROWS_WITH(measure_bench_light(photos, chart, {}, board, 20), Contains(why));
        };
        mistaken({paper, sheet, paper}, "no colour checker");
        mistaken({checker, paper, paper}, "no checkerboard found");
        mistaken({checker, sheet, sheet}, "the light on the white paper");
    }
    SECTION("a tone curve") {
        const BenchCamera taken(bench.setup, bench.sheet, bench.camera);
        BenchLightPhotos photos{taken.of_checker(find_checker("colorchecker24"), 0), taken.of_sheet(1),
                                taken.of_paper(2)};
        for (io::Photograph* photo : {&photos.checker, &photos.sheet, &*photos.paper})
            pixels(*photo, [](Eigen::Vector3f& v, auto, auto) { v = v.array().sqrt(); });
        BoardView board;
        CHECK_THROWS_WITH(measure_bench_light(photos, find_checker("colorchecker24"), {}, board, 20),
                          Contains("tone curve"));
    }
    SECTION("an edge under the slab that is not where the board says") {
        // What lies within 15 mm of the edge's middle is from another photograph.
        const auto inner_of = [&](const BenchCameraOptions& camera, double shift_mm) {
            return [&, camera, shift_mm](io::Photograph& photo) {
                const io::Photograph other =
                    BenchCamera(bench.setup, bench.sheet, camera).of_slab(soft_slab(), 1, {0, 0}, 3);
                const auto shift = std::uint32_t(std::lround(shift_mm / pitch_mm));
                pixels(photo, [&](Eigen::Vector3f& v, std::uint32_t x, std::uint32_t y) {
                    const double reach = 15 / pitch_mm;
                    if (std::abs(x - photo.width_px / 2.0) < reach && std::abs(y - photo.height_px / 2.0) < reach)
                        v = other.pixels[other.index(x - shift, y)];
                });
            };
        };
        BenchCameraOptions turned = bench.camera;
        turned.turn_deg += 3;
        bench.spoil = inner_of(turned, 0);
        refused("the edge under the slab is turned by");
        bench.spoil = inner_of(bench.camera, 0.5);
        refused("the edge under the slab lies +0.4");
    }
    SECTION("the sheet moved") {
        bench.spoil = [&](io::Photograph& photo) {
            // To the left by 8 mm.
            const io::Photograph old = photo;
            const auto by = std::uint32_t(8 / pitch_mm);
            pixels(photo, [&](Eigen::Vector3f& v, std::uint32_t x, std::uint32_t y) {
                v = old.pixels[old.index(std::min(x + by, old.width_px - 1), y)];
            });
        };
        refused("from where the bare sheet's was");
    }
}
