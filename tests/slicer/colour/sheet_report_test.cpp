// SPDX-License-Identifier: GPL-3.0-or-later
//
// What reports draw and tell of a print that shows colours, and of the loop that made it, of predictions whose every
// figure is laid down by hand.
#include "slicer/colour/loop_report.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "halftone/loop/appearance_loop.h"
#include "io/decoders/decode_png.h"
#include "io/files/whole_file.h"
#include "judged_sheet.h"
#include "slicer/colour/asked_alpha.h"
#include "slicer/colour/colour_report.h"
#include "slicer/colour/night_prediction.h"
#include "slicer/colour/viewer_report.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/said_progress.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using Catch::Matchers::Contains, Catch::Matchers::EndsWith, Catch::Matchers::StartsWith;

namespace {

const Eigen::Vector3f red = of_codes(170, 60, 60), blue = of_codes(60, 90, 140), grey = of_codes(150, 150, 150);

/// Codes of a pixel, from the upper left.
using Pixel = std::array<int, 4>;
class Drawn {
public:
    explicit Drawn(std::span<const std::uint8_t> file)
        : texels_(io::decode_png(std::as_bytes(file), "drawn.png", {}).texels) {}
    [[nodiscard]] Pixel at(std::uint32_t column, std::uint32_t row) const {
        const std::uint8_t* const rgba = texels_.srgb8.data() + 4 * (std::size_t{row} * texels_.width_px + column);
        return {rgba[0], rgba[1], rgba[2], rgba[3]};
    }
    [[nodiscard]] std::array<std::uint32_t, 2> size() const { return {texels_.width_px, texels_.height_px}; }

private:
    io::TexelImage texels_;
};
Drawn drawn(const std::filesystem::path& file) { return Drawn(io::read_whole_file(file, 1 << 20)); }

/// Of two triangles, all of one colour.
io::TexturedMesh painted(const Eigen::Vector3f& rgb) {
    io::TexturedMesh mesh;
    mesh.materials.resize(1), mesh.materials[0].rgb = rgb;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, mesh.triangles = {{0, 1, 2}};
    mesh.material_of_triangle = {0};
    return mesh;
}

halftone::LoopStep step_of(int iteration, double mean, double saturated) {
    halftone::LoopStep step;
    step.iteration = iteration, step.saturated_share = saturated, step.seconds = 2 + iteration;
    step.seen.mean = mean, step.seen.median = mean - 0.5, step.seen.percentile_95 = 3 * mean;
    step.cells.mean = mean + 1;
    return step;
}

/// Of a sheet whose square from column 30 and row 20 on is changed from red to what it is.
JobLoop loop_on(const JudgedSheet& sheet) {
    JobLoop loop;
    loop.model = "transport", loop.seconds = 12.5;
    loop.cells = std::make_shared<const LoopCells>(
        ViewedCells{sheet.p.predicted.surface, sheet.p.target, {100, 90, 80}}, sheet.body, DepthZones{}, 1);
    loop.result.state.steps = {step_of(0, 6, 0), step_of(1, 3, 0.25), step_of(2, 4, 0.5)};
    loop.result.state.best = 1;
    loop.result.why_stopped = "it stopped gaining";
    loop.result.in_gamut.assign(4800, 1);
    for (std::size_t i = 0; i < 1200; ++i) loop.result.in_gamut[i] = 0;
    loop.result.state.shown = loop.result.state.open = sheet.p.target;
    for (const std::uint32_t i : JudgedSheet::cells_of({30, 20, 70, 60})) loop.result.state.open[i] = red;
    return loop;
}

}  // namespace

TEST_CASE("A loop's page tells its errors by iteration, which was best, and what was in reach") {
    const JudgedSheet sheet;
    const io::ReportLoop report = loop_report(loop_on(sheet), sheet.body, nullptr, {});
    REQUIRE(report.iterations.size() == 3);
    const io::ReportIteration& one = report.iterations[1];
    CHECK((one.number == 1 && one.mean == 3 && one.median == 2.5 && one.p95 == 9 && one.cells_mean == 4));
    CHECK((one.saturated_share == 0.25 && one.seconds == 3));
    CHECK(report.best == 1);
    CHECK(report.seconds == 12.5);
    CHECK_THAT(report.note, StartsWith("The resins were rearranged 2 times and the print predicted after each by the "
                                       "model transport in cells of 100.0 x 90.0 x 80.0 um; it stopped gaining."));
    CHECK_THAT(report.note, Contains("75.0 % have a target that the resins can show"));
    CHECK(report.sections.empty());
    CHECK(report.sections_note.empty());
}

TEST_CASE("The magnified square is the one that the loop changed most, upright, eight pixels a cell") {
    JudgedSheet sheet;
    sheet.p.target[JudgedSheet::at(30, 20)] = blue;  // its lower left corner
    sheet.p.target[JudgedSheet::at(31, 59)] = of_codes(255, 255, 255);
    const io::ReportLoop report = loop_report(loop_on(sheet), sheet.body, nullptr, {});
    REQUIRE(report.crops.size() == 3);
    CHECK((report.crops[0].caption == "target" && report.crops[1].caption == "open loop"));
    CHECK(report.crops[2].caption == "result");
    for (const io::ReportPicture& crop : report.crops) {
        CHECK((crop.width_px == 320 && crop.height_px == 320));
        CHECK(crop.px_per_mm == Approx(80));
    }
    const Drawn target(report.crops[0].file), open(report.crops[1].file), result(report.crops[2].file);
    CHECK(target.size() == std::array<std::uint32_t, 2>{320, 320});
    CHECK(target.at(0, 319) == Pixel{60, 90, 140, 255});
    CHECK(target.at(7, 312) == Pixel{60, 90, 140, 255});
    CHECK(target.at(8, 319) == Pixel{150, 150, 150, 255});
    CHECK(target.at(0, 311) == Pixel{150, 150, 150, 255});
    CHECK(target.at(8, 0) == Pixel{255, 255, 255, 255});
    CHECK(open.at(100, 100) == Pixel{170, 60, 60, 255});
    CHECK(result.at(100, 100) == Pixel{150, 150, 150, 255});
    CHECK(result.at(0, 319) == Pixel{60, 90, 140, 255});
}

TEST_CASE("The cut goes through the middle of the changed square, upright, from its surface down") {
    JudgedSheet sheet;
    // Another material in each of these: column 50 of row 40, its neighbour, and the layer below the surface.
    sheet.p.volume = optics::make_resin_volume({80, 60, 20}, {0.1, 0.1, 0.1}, [](int x, int y, int z) {
        if (y != 40) return optics::Material{4};
        if (z >= 18) return optics::air;
        if (z == 17) return optics::Material{1};
        return x == 30 ? optics::Material{2} : optics::Material{3};
    });
    const std::vector<io::Rgb> palette{{9, 9, 9}, {10, 0, 0}, {0, 20, 0}, {0, 0, 30}, {40, 40, 0}};
    io::ReportLoop report = loop_report(loop_on(sheet), sheet.body, &sheet.p.volume, palette);
    REQUIRE(report.sections.size() == 1);
    CHECK(report.sections_note ==
          "Upright cut at y = 4.05 mm, 4 mm wide around x = 5.05 mm, the topmost 1.2 mm there.");
    CHECK(report.sections[0].caption == "resins, as the bitmaps colour them");
    CHECK(report.sections[0].px_per_mm == 200);
    const Drawn cut(report.sections[0].file);
    CHECK(cut.size() == std::array<std::uint32_t, 2>{800, 240});
    CHECK(cut.at(400, 0) == Pixel{10, 0, 0, 255});
    CHECK(cut.at(400, 19) == Pixel{10, 0, 0, 255});
    CHECK(cut.at(400, 20) == Pixel{0, 0, 30, 255});
    CHECK(cut.at(19, 100) == Pixel{0, 20, 0, 255});
    CHECK(cut.at(20, 100) == Pixel{0, 0, 30, 255});
    CHECK(cut.at(799, 239) == Pixel{0, 0, 30, 255});
    // A body's through its middle, whatever changed; what lies below it is nothing.
    sheet.becomes_body();
    report = loop_report(loop_on(sheet), sheet.body, &sheet.p.volume, palette);
    CHECK(report.crops.empty());
    CHECK_THAT(report.sections_note, StartsWith("Upright cut at y = 3.05 mm, 4 mm wide around x = 4.05 mm"));
    CHECK(Drawn(report.sections[0].file).at(400, 0) == Pixel{40, 40, 0, 255});
    const auto thin = optics::make_resin_volume(
        {80, 60, 4}, {0.1, 0.1, 0.1}, [](int, int, int z) { return z < 2 ? optics::Material{1} : optics::air; });
    report = loop_report(loop_on(sheet), sheet.body, &thin, palette);
    CHECK(Drawn(report.sections[0].file).at(400, 39) == Pixel{10, 0, 0, 255});
    CHECK(Drawn(report.sections[0].file).at(400, 40)[3] == 0);
}

TEST_CASE("How far colours are moved is told over the surface, and how they were separated") {
    JudgedSheet sheet;
    sheet.job.printer.pitch_um = {42, 84, 27};
    const std::optional<JobPrediction> none;
    const auto report_of = [&](const Eigen::Vector3f& rgb) {
        const io::TexturedMesh mesh = painted(rgb);
        const SurfaceColour colour(mesh, 0.1);
        io::Report report;
        add_colour_report({sheet.job, sheet.body, five_resins(), colour, none}, "It was left out.", report);
        REQUIRE(report.gamut.has_value());
        REQUIRE(report.sections.size() == 1);
        return report;
    };
    const Eigen::Vector3f green = of_codes(0, 255, 0);
    const double far = five_resins().separation.gamut_distance(green);
    io::Report report = report_of(green);
    CHECK(report.gamut->mapped_share == 1);
    CHECK(report.gamut->mean_de2000 == Approx(far));
    CHECK(report.gamut->p95_de2000 == Approx(far));
    CHECK(report.gamut->max_de2000 == Approx(far));
    CHECK_THAT(report.prediction_note, StartsWith("Predicted with the separation's own model"));
    CHECK_THAT(report.prediction_note, EndsWith(" It was left out."));
    CHECK_FALSE(report.prediction.has_value());
    CHECK(report.sections[0].title == "Mixtures");
    REQUIRE(report.sections[0].paragraphs.size() == 1);
    CHECK_THAT(report.sections[0].paragraphs[0],
               StartsWith("Colours were separated for what voxels of 42.0 x 84.0 x 27.0 um look like"));
    CHECK(report_of(grey).gamut->mapped_share == 0);
    sheet.job.options.colour.mixing = Mixing::ideal, sheet.job.why_these_resins = "They show it best.";
    report = report_of(grey);
    REQUIRE(report.sections[0].paragraphs.size() == 2);
    CHECK(report.sections[0].paragraphs[0] == "They show it best.");
    CHECK_THAT(report.sections[0].paragraphs[1], StartsWith("Colours were separated as if resins mixed ideally"));
}

TEST_CASE("A prediction's figures are those of its cells, and its noise is told where it has some") {
    JudgedSheet sheet;
    std::optional<JobPrediction> prediction(sheet.p);
    JobPrediction& p = *prediction;
    p.model = "monte-carlo", p.seconds = 7, p.cell_um = {84, 85, 81};
    for (std::size_t i = 0; i < 4800; ++i) p.difference[i] = i < 1200 ? 6 : 1.2;
    p.summary = {.mean = 2.4, .median = 1.2, .percentile_95 = 6, .max = 6.5};
    const io::TexturedMesh mesh = painted(grey);
    const SurfaceColour colour(mesh, 0.1);
    io::Report report;
    add_colour_report({sheet.job, sheet.body, five_resins(), colour, prediction}, "", report);
    REQUIRE(report.prediction.has_value());
    const io::ReportPrediction& told = *report.prediction;
    CHECK((told.model == "monte-carlo" && told.seconds == 7 && told.cells == 4800));
    CHECK(told.cell_um == std::array<double, 3>{84, 85, 81});
    CHECK((told.mean_de2000 == 2.4 && told.median_de2000 == 1.2 && told.p95_de2000 == 6 && told.max_de2000 == 6.5));
    REQUIRE(told.histogram.size() == 13);
    for (const auto& [edge, share] : told.histogram)
        CHECK(share == Approx(edge == 1 ? 0.75 : edge == 5 ? 0.25 : 0).margin(1e-5));
    CHECK_THAT(told.note, StartsWith("Predicted by the model monte-carlo from the printed voxels, in 4800 cells of "
                                     "84.0 x 85.0 x 81.0 um"));
    CHECK_THAT(told.note, !Contains("noise"));
    CHECK(report.prediction_note.empty());
    p.predicted.standard_error = {0.01f, 0.02f, 0.06f};
    io::Report noisy;
    add_colour_report({sheet.job, sheet.body, five_resins(), colour, prediction}, "", noisy);
    CHECK_THAT(noisy.prediction->note, EndsWith("a standard error of 0.030 on average, is part of the differences."));
    // Lines of the summary.
    report.gamut = io::ReportGamut{.mapped_share = 0.125, .mean_de2000 = 1, .p95_de2000 = 2, .max_de2000 = 3};
    report.verdict.emplace().sentence = "On the whole good.";
    CHECK(
        colour_summary(report) ==
        "  On the whole good.\n"
        "  cell by cell, before the eye blurs them: CIEDE2000 mean 2.40, median 1.20, 95 % 6.00, max 6.50 (cells of 84 "
        "um)\n"
        "  out of the resins' reach, on a thick body: 12.5 % of the surface; moved by CIEDE2000 mean 1.00, 95 % 2.00, "
        "max 3.00\n");
    CHECK(colour_summary({}).empty());
}

TEST_CASE("A picture's target, print and their difference are drawn upright, a pixel a cell, and kept as files") {
    const io::TemporaryFolder folder;
    JudgedSheet sheet;
    sheet.p.target[JudgedSheet::at(0, 0)] = red, sheet.p.predicted.rgb[JudgedSheet::at(79, 59)] = blue;
    sheet.p.difference[JudgedSheet::at(2, 58)] = 20;
    sheet.p.predicted.channels = 3;
    for (const Eigen::Vector3f& rgb : sheet.p.predicted.rgb)
        sheet.p.predicted.value.insert(sheet.p.predicted.value.end(), rgb.data(), rgb.data() + 3);
    std::optional<JobPrediction> prediction(sheet.p);
    const io::TexturedMesh mesh = painted(grey);
    const SurfaceColour colour(mesh, 0.1);
    SaidProgress progress;
    const auto draw = [&] {
        io::Report report;
        draw_colour_report({sheet.job, sheet.body, five_resins(), colour, prediction}, report, folder.path(), progress);
        REQUIRE(report.views.size() == 1);
        CHECK(report.views[0].name == "top");
        return report.views[0].pictures;
    };
    std::vector<io::ReportPicture> pictures = draw();
    REQUIRE(pictures.size() == 3);
    CHECK((pictures[0].caption == "target" && pictures[1].caption == "predicted"));
    CHECK(pictures[2].caption == "difference, CIEDE2000: white 0, yellow 2, orange 5, red 10, black 20");
    for (const io::ReportPicture& picture : pictures) {
        CHECK((picture.width_px == 80 && picture.height_px == 60));
        CHECK(picture.px_per_mm == Approx(10));
    }
    const Drawn target = drawn(folder.path() / "target.png"), print = drawn(folder.path() / "predicted.png"),
                difference = drawn(folder.path() / "difference.png");
    CHECK(target.size() == std::array<std::uint32_t, 2>{80, 60});
    CHECK(target.at(0, 59) == Pixel{170, 60, 60, 255});
    CHECK(target.at(79, 0) == Pixel{150, 150, 150, 255});
    CHECK(print.at(79, 0) == Pixel{60, 90, 140, 255});
    CHECK(print.at(0, 59) == Pixel{150, 150, 150, 255});
    CHECK(difference.at(2, 1) == Pixel{0, 0, 0, 255});
    CHECK(difference.at(1, 1) == Pixel{255, 255, 255, 255});
    CHECK(std::filesystem::exists(folder.path() / "target.exr"));
    CHECK(std::filesystem::exists(folder.path() / "predicted.exr"));
    CHECK_FALSE(std::filesystem::exists(folder.path() / "open-loop.png"));
    prediction->open_loop.assign(4800, red);
    pictures = draw();
    REQUIRE(pictures.size() == 5);
    CHECK(pictures[3].caption == "open loop: without the appearance loop");
    CHECK(pictures[4].caption == "difference of the open loop");
    CHECK(drawn(folder.path() / "open-loop.png").at(40, 30) == Pixel{170, 60, 60, 255});
}

TEST_CASE("Of a picture too large for the page means are drawn, of what is covered, and the scale is told by them") {
    // 1300 cells in a row are 433 pixels of 3, the last of one cell and two that there are not.
    JobPrediction p;
    p.volume =
        optics::make_resin_volume({1300, 3, 1}, {0.1, 0.1, 0.1}, [](int, int, int) { return optics::Material{1}; });
    p.predicted.surface.cell_voxels = {1, 1, 1}, p.predicted.channels = 3;
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 1300; ++x) {
            if (x == 1 && y == 1) continue;
            optics::SurfaceCell& cell = p.predicted.surface.cells.emplace_back();
            cell.cell = {x, y, 0}, cell.normal = {0, 0, 1}, cell.area_mm2 = 0.01f;
            cell.centre_mm = {0.1f * (float(x) + 0.5f), 0.1f * (float(y) + 0.5f), 0.1f};
            p.target.push_back(Eigen::Vector3f::Constant(x == 0 ? 0.9f : x < 3 ? 0.4f : 0.5f));
        }
    p.predicted.rgb = p.target, p.difference.assign(p.target.size(), 0);
    p.predicted.value.assign(3 * p.target.size(), 0.5f);
    p.channels = optics::vero_opaque().channels;
    const io::TemporaryFolder folder;
    const JudgedSheet sheet;
    const std::optional<JobPrediction> prediction(std::move(p));
    const io::TexturedMesh mesh = painted(grey);
    const SurfaceColour colour(mesh, 0.1);
    SaidProgress progress;
    io::Report report;
    draw_colour_report({sheet.job, sheet.body, five_resins(), colour, prediction}, report, folder.path(), progress);
    const io::ReportPicture& shown = report.views.at(0).pictures.at(0);
    CHECK((shown.width_px == 434 && shown.height_px == 1));
    CHECK(shown.px_per_mm == Approx(10.0 / 3));
    CHECK(drawn(folder.path() / "target.png").size() == std::array<std::uint32_t, 2>{1300, 3});
}

TEST_CASE("The viewer of a picture has target, open loop and print, and both kinds of differences") {
    JudgedSheet sheet;
    sheet.p.model = "transport";
    const std::uint32_t corner = JudgedSheet::at(0, 59);  // the first place: upper left
    sheet.p.target[corner] = red, sheet.p.predicted.rgb[corner] = blue;
    sheet.p.seen.difference[corner] = 4, sheet.p.difference[corner] = 20;
    std::optional<JobPrediction> prediction(sheet.p);
    const io::TexturedMesh mesh = painted(grey);
    const SurfaceColour colour(mesh, 0.1);
    SaidProgress progress;
    const auto shown = [&] {
        const auto surface =
            viewer_surface({sheet.job, sheet.body, five_resins(), colour, prediction}, 1'000'000, progress);
        REQUIRE(surface.has_value());
        return *surface;
    };
    io::ViewerSurface surface = shown();
    CHECK(surface.size_px == std::array<std::uint32_t, 2>{80, 60});
    REQUIRE(surface.looks.size() == 2);
    CHECK((surface.looks[0].name == "target" && surface.looks[0].caption == "what was asked for"));
    CHECK(
        (surface.looks[1].name == "print" && surface.looks[1].caption == "what will be seen, by the model transport"));
    REQUIRE((surface.seen.size() == 4800 && surface.single.size() == 4800));
    CHECK((surface.seen[0] == 40 && surface.single[0] == 200));
    CHECK((surface.seen[1] == 0 && surface.single[1] == 0));
    prediction->open_loop.assign(4800, red);
    surface = shown();
    REQUIRE(surface.looks.size() == 3);
    CHECK((surface.looks[1].name == "open loop" &&
           surface.looks[1].caption == "what would be seen without the appearance loop"));
    // The report's page has the worst places, and how far away they are looked at from.
    sheet.job.options.loop.viewing_distance_mm = 250;
    io::Report report;
    add_viewer({sheet.job, sheet.body, five_resins(), colour, prediction}, report, progress);
    CHECK(report.viewer.viewing_distance_mm == 250);
    REQUIRE(report.viewer.worst.size() == 1);
    CHECK(report.viewer.worst[0].seen == 4);
    CHECK(report.viewer.surface.has_value());
    progress.cancel();
    CHECK_THROWS_AS(add_viewer({sheet.job, sheet.body, five_resins(), colour, prediction}, report, progress),
                    Cancelled);
}

TEST_CASE("A night is told in a sentence, and drawn with what was asked for beside it") {
    const io::TemporaryFolder folder;
    const JudgedSheet sheet;
    NightPrediction night;
    night.predicted = cells_in_colours(sheet.p.predicted, sheet.p.predicted.rgb);
    night.target = sheet.p.target;
    night.target[JudgedSheet::at(0, 0)] = red, night.predicted.rgb[JudgedSheet::at(79, 59)] = blue;
    night.level = 0.256, night.seen_mean = 3.14, night.beyond = 0.126;
    CHECK(night.words() ==
          "By light from behind 3.1 off (CIEDE2000 as seen), its white 0.256 of what clear resin alone "
          "lets through: a brighter lamp makes up for that. 13 % of the picture asks for more light "
          "than the day's colours leave.");
    const io::ReportSection section = draw_night(night, sheet.p, folder.path());
    CHECK(section.title == "By light from behind");
    CHECK(section.paragraphs == std::vector<std::string>{night.words()});
    REQUIRE(section.pictures.size() == 2);
    CHECK((section.pictures[0].caption == "target" && section.pictures[1].caption == "predicted"));
    CHECK(section.pictures[0].px_per_mm == Approx(10));
    CHECK(drawn(folder.path() / "target-night.png").at(0, 59) == Pixel{170, 60, 60, 255});
    CHECK(drawn(folder.path() / "night.png").at(79, 0) == Pixel{60, 90, 140, 255});
    CHECK(drawn(folder.path() / "night.png").at(0, 59) == Pixel{150, 150, 150, 255});
}
