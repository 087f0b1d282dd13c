// SPDX-License-Identifier: GPL-3.0-or-later
//
// A whole prediction of a small stack: what stands in its files and what is said of it.
#include <algorithm>
#include <cmath>
#include <functional>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "slicer/predict/predict_job.h"
#include "tests/slicer/print/small_pictures.h"
#include "tests/slicer/print/small_print.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using Catch::Matchers::Contains;
using nlohmann::json;

namespace {

PrintDesk& desk() { return printed_desk(); }

PredictOptions small_prediction(const std::vector<std::string>& names) {
    PredictOptions options;
    options.stack = desk().path("out").string();
    for (const std::string& name : names) options.files.push_back(desk().path(name).string());
    options.overwrite = true;
    return options;
}

json predicted(const PredictOptions& options, std::string* text = nullptr) {
    const PredictResult result = run_predict_job(options, desk().said);
    if (text) *text = result.text;
    return json::parse(result.json);
}

double brightness(const json& result) { return result.at("mean_rgb")[1].get<double>(); }

}  // namespace

TEST_CASE("A prediction's picture, numbers and figures say the same") {
    std::string text;
    const json says = predicted(small_prediction({"p.exr", "p.png", "p.html"}), &text);
    CHECK(says.at("view") == "top");
    CHECK(says.at("backing") == "black");
    CHECK(says.at("model") == "transport");
    CHECK(says.at("boundary") == "voxels");
    CHECK(says.at("relative_to") == "white resin");
    CHECK(says.at("channels") == 4);
    // 47 x 35 x 56 voxels of 42.3 x 84.7 x 27 um, in cells as near to 85 um as whole voxels come.
    CHECK(says.at("voxels") == json({47, 35, 56}));
    CHECK(says.at("size_px") == json({24, 35}));
    CHECK(says.at("cells") == 24 * 35);
    CHECK(says.at("cell_um")[0].get<double>() == Approx(84.667).epsilon(1e-4));
    CHECK(says.at("cell_um")[2].get<double>() == Approx(81));
    const Numbers n = read_numbers(desk().path("p.exr").string());
    REQUIRE((n.width == 24 && n.height == 35));
    const std::vector<std::uint8_t> codes = read_codes(desk().path("p.png").string());
    std::size_t c = 0;
    for (const char* name : {"R", "G", "B"}) {
        double sum = 0, area = 0;
        for (std::size_t p = 0; p < 24 * 35; ++p) {
            const double value = double(n.of.at(name)[p]), part = p % 24 == 23 ? 0.5 : 1;  // the last is half a cell
            sum += part * value, area += part;
            CHECK(std::abs(code_of(value) - codes[3 * p + c]) < 0.51);
        }
        CHECK(says.at("mean_rgb")[c++].get<double>() == Approx(sum / area).epsilon(1e-4));
    }
    // The front, below in the picture, is as dark in red as the back, and the right is redder than the left.
    const auto mean = [&](std::size_t x0, std::size_t x1) {
        double sum = 0;
        for (std::size_t y = 0; y < 35; ++y)
            for (std::size_t x = x0; x < x1; ++x) sum += double(n.of.at("R")[y * 24 + x]);
        return sum / double(35 * (x1 - x0));
    };
    CHECK(mean(16, 23) > mean(1, 8) + 0.05);
    CHECK_THAT(text, Contains("840 cells of 84.7 x 84.7 x 81.0 um, seen from above, media-relative values, a black "
                              "sheet under it") &&
                         Contains("mean colour (linear sRGB): ") && !Contains("standard error"));
    CHECK_THAT(desk().said.notes(), Contains("47 x 35 x 56 voxels and 840 surface cells"));
    CHECK(std::filesystem::file_size(desk().path("p.html")) > 1000);
    json seconds = says.at("seconds");
    for (const char* key : {"read", "surface", "predict", "write"}) CHECK(seconds.at(key).get<double>() >= 0);
}

TEST_CASE("What lies under a print, how it is read and how fine it is looked at are as they are asked for") {
    PredictOptions options = small_prediction({"p.png"});
    std::string text;
    const json relative = predicted(options);
    options.absolute = true;
    const json black = predicted(options, &text);
    CHECK(black.at("relative_to") == "entered light");
    CHECK(brightness(black) < brightness(relative) - 0.01);
    CHECK_THAT(text, Contains("absolute values") && Contains("a black sheet under it"));
    options.backing = "white";
    const json white = predicted(options, &text);
    CHECK(white.at("backing") == "white");
    CHECK_THAT(text, Contains("a white sheet under it"));
    CHECK(brightness(white) > brightness(black));
    options.backing = "auto";
    options.absolute = false;
    options.cell_mm = 0.3;
    const json coarse = predicted(options);
    CHECK(coarse.at("cells").get<int>() < 100);
    CHECK(brightness(coarse) == Approx(brightness(relative)).epsilon(0.02));
}

TEST_CASE("Of light paths it is said how sure they are, and more are surer") {
    PredictOptions options = small_prediction({"p.exr"});
    options.model = "monte-carlo";
    options.cell_mm = 0.5;
    double before = 1;
    for (const std::uint32_t paths : {8u, 128u}) {
        options.quality.paths = paths;
        std::string text;
        const json says = predicted(options, &text);
        const double mean = says.at("standard_error").at("mean"), most = says["standard_error"].at("max");
        CHECK(mean > 0);
        CHECK(most >= mean);
        CHECK(mean < 0.5 * before);
        before = mean;
        CHECK_THAT(text, Contains(fmt::format("standard error of a value: mean {:.4f}, largest {:.4f}", mean, most)));
    }
}

TEST_CASE("A body is predicted all around, at its mesh where light paths are asked") {
    PredictOptions options = small_prediction({"b.glb", "b.ply", "b.png"});
    options.view = "body";
    std::string text;
    const json says = predicted(options, &text);
    CHECK(says.at("view") == "body");
    CHECK(says.at("backing") == "none");
    CHECK_FALSE(says.contains("size_px"));
    CHECK(says.at("cells").get<int>() > 2 * 24 * 35);
    CHECK_THAT(text, Contains("the whole surface") && Contains("nothing under it"));
    for (const char* name : {"b.glb", "b.ply", "b.png"}) CHECK(std::filesystem::exists(desk().path(name)));
    options = small_prediction({"b.glb"});
    options.view = "body", options.model = "monte-carlo", options.quality.paths = 2, options.cell_mm = 0.5;
    CHECK(predicted(options).at("boundary") == "mesh");
    options.boundary = "voxels";
    CHECK(predicted(options).at("boundary") == "voxels");
    options.boundary = "auto", options.lit = true;
    CHECK_NOTHROW(predicted(options));
    const std::string glb = [&] {
        std::ifstream in(desk().path("b.glb"), std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(in), {});
    }();
    CHECK_THAT(glb, Contains("KHR_materials_volume") && Contains("KHR_materials_ior"));
}

TEST_CASE("What a prediction is asked for is checked at its bounds, with the option's name") {
    const auto says = [](const auto& set) -> std::string {
        PredictOptions options;
        options.stack = "out", options.files = {"p.png"};
        set(options);
        try {
            (void)resolve(options);
        } catch (const UsageError& error) {
            return error.what();
        }
        return {};
    };
    CHECK(says([](auto&) {}).empty());
    CHECK_THAT(says([](auto& o) { o.files.clear(); }), Contains("--out"));
    CHECK_THAT(says([](auto& o) { o.files = {"p.png", "p.bmp"}; }), Contains("--out") && Contains("p.bmp"));
    CHECK(says([](auto& o) { o.files = {"P.PNG"}; }).empty());
    struct Range {
        const char* key;
        std::function<void(PredictOptions&, double)> set;
        double least, most, below, above;
    };
    const Range ranges[] = {
        {"cell", [](auto& o, double x) { o.cell_mm = x; }, 0.01, 5, 0.009, 5.1},
        {"spp", [](auto& o, double x) { o.quality.paths = std::uint32_t(x); }, 2, 1048576, 1, 1048577},
        {"error", [](auto& o, double x) { o.quality.error = x; }, 0, 0.999, -0.001, 1},
        {"sweeps", [](auto& o, double x) { o.quality.sweeps = int(x); }, 1, 100, 0, 101},
        {"memory", [](auto& o, double x) { o.memory_gib = x; }, 0, most_memory_gib, -1, 2 * most_memory_gib},
        {"threads", [](auto& o, double x) { o.threads = int(x); }, 0, 1024, -1, 1025}};
    for (const Range& range : ranges)
        for (const double x : {range.least, range.most, range.below, range.above}) {
            CAPTURE(range.key, x);
            const std::string said = says([&](auto& o) { range.set(o, x); });
            if (x == range.least || x == range.most)
                CHECK(said.empty());
            else
                CHECK_THAT(said, Catch::StartsWith(fmt::format("--{} ", range.key)));
        }
    CHECK_THAT(says([](auto& o) { o.lit = true; }), Contains("--lit"));
    CHECK(says([](auto& o) { o.lit = true, o.files = {"p.glb"}; }).empty());
    for (const char* file : {"p.glb", "p.ply"}) {
        CHECK_THAT(says([&](auto& o) { o.view = "top", o.files = {file}; }), Contains(file) && Contains("--view body"));
        CHECK(says([&](auto& o) { o.view = "body", o.files = {file}; }).empty());
    }
    CHECK_THAT(says([](auto& o) { o.view = "body", o.files = {"p.exr"}; }), Contains("--view top"));
    CHECK(says([](auto& o) { o.view = "top", o.files = {"p.exr", "p.html"}; }).empty());
    CHECK_THAT(says([](auto& o) { o.outside = "followed", o.model = "monte-carlo", o.boundary = "voxels"; }),
               Contains("--outside"));
    PredictOptions options;
    options.stack = "out", options.files = {"p.glb"}, options.outside = "followed", options.model = "monte-carlo";
    CHECK(resolve(options).boundary == BodyEnd::mesh);
    options.model = "transport";
    CHECK(resolve(options).boundary == BodyEnd::automatic);
    CHECK_FALSE(resolve(options).backing);
    PredictOptions flat = small_prediction({"p.glb"});
    CHECK_THROWS_WITH(run_predict_job(flat, desk().said), Contains("--view body"));
    flat = small_prediction({"p.png"});
    flat.memory_gib = 1e-4;
    CHECK_THROWS_AS(run_predict_job(flat, desk().said), ResourceError);
}
