// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/resolve_job.h"

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "base/error.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

using Change = std::function<void(SliceOptions&)>;

SliceOptions named() {
    SliceOptions options;
    options.model = "a.obj";
    options.out = "out";
    return options;
}

ResolvedJob changed(SliceOptions options, const Change& change) {
    change(options);
    return resolve(options);
}

void check_refused(const SliceOptions& options, const std::string& key, const Change& change) {
    INFO(key);
    CHECK_THROWS_AS(changed(options, change), UsageError);
    CHECK_THROWS_WITH(changed(options, change), StartsWith("--" + key) || Contains("unit"));
}

/// Every name of an enum, set as a text, comes out as its value.
template <class Enum>
void check_words(std::string SliceOptions::*text, const std::function<Enum(const ResolvedJob&)>& value) {
    for (const Named<Enum>& entry : NamesOf<Enum>::table) {
        INFO(entry.name);
        CHECK(value(changed(named(), [&](SliceOptions& o) { o.*text = entry.name; })) == entry.value);
    }
}

}  // namespace

TEST_CASE("What the user wrote becomes values") {
    const ResolvedJob job = changed(named(), [](SliceOptions& o) {
        o.unit = "cm";
        o.rotate = "z90";
        o.layers = "3-5";
        o.iterations = std::string("7");
        o.formats = {"png", "vdb"};
        o.memory_gib = 2;
        o.predict = "monte-carlo";
    });
    CHECK_FALSE(job.is_picture());
    CHECK(job.shows_colours());
    REQUIRE(job.placement.unit);
    CHECK(job.placement.unit->mm == 10);
    CHECK(job.placement.rotation * Eigen::Vector3d::UnitX() == Eigen::Vector3d::UnitY());
    REQUIRE(job.layers);
    CHECK(job.layers->first == 3);
    CHECK(job.layers->layers() == 3);
    CHECK(job.loop.iterations == 7);
    CHECK(job.formats == std::vector{io::LayerFormat::png, io::LayerFormat::vdb});
    CHECK(job.prediction.memory_bytes == std::uint64_t{2} << 30);
    CHECK_FALSE(job.prediction.automatic);
    CHECK(job.prediction.model == PredictionModel::monte_carlo);
    CHECK(job.raw.rotate == "z90");
}

TEST_CASE("What the job is to decide is nothing") {
    const ResolvedJob job = resolve(named());
    CHECK_FALSE(job.placement.unit);
    CHECK_FALSE(job.layers);
    CHECK_FALSE(job.loop.iterations);
    CHECK(job.loop.method == LoopMethod::automatic);
    CHECK(job.formats.empty());
    CHECK(job.prediction.automatic);
    CHECK(job.prediction.memory_bytes > 0);
    CHECK_FALSE(changed(named(), [](SliceOptions& o) { o.predict = "none"; }).prediction.automatic);
    CHECK_FALSE(changed(named(), [](SliceOptions& o) { o.predict = "none"; }).prediction.model);
    CHECK(changed(named(), [](SliceOptions& o) { o.model = "a.png"; }).is_picture());
}

TEST_CASE("Every word comes out as its value") {
    check_words<Mixing>(&SliceOptions::mixing, [](const ResolvedJob& job) { return job.colour.mixing; });
    check_words<AlphaMeaning>(&SliceOptions::alpha, [](const ResolvedJob& job) { return job.colour.alpha; });
    check_words<ScreenKind>(&SliceOptions::screen, [](const ResolvedJob& job) { return job.colour.screen; });
    check_words<optics::Backing>(&SliceOptions::backing,
                                 [](const ResolvedJob& job) { return job.picture.backing.kind; });
    check_words<RepairMode>(&SliceOptions::repair, [](const ResolvedJob& job) { return job.repair; });
    check_words<CavityMode>(&SliceOptions::cavities, [](const ResolvedJob& job) { return job.cavities; });
    check_words<halftone::Intent>(&SliceOptions::intent, [](const ResolvedJob& job) { return job.loop.intent; });
    check_words<LoopMethod>(&SliceOptions::loop_method, [](const ResolvedJob& job) { return job.loop.method; });
    check_words<PredictionModel>(&SliceOptions::loop_model, [](const ResolvedJob& job) { return job.loop.model; });
    check_words<PredictionModel>(&SliceOptions::predict, [](const ResolvedJob& job) { return *job.prediction.model; });
}

TEST_CASE("A sheet under a picture is grey, a colour, a checker or a picture") {
    const auto sheet = [](const char* words) {
        const BackingChoice choice = parse_backing("backing", words);
        CHECK(choice.kind == optics::Backing::sheet);
        CHECK(choice.words == words);
        return choice;
    };
    CHECK(sheet("grey:0.5").linear_rgb == std::array{0.5, 0.5, 0.5});
    const BackingChoice colour = sheet("#ff8000");
    CHECK(colour.linear_rgb[0] == Approx(1));
    CHECK(colour.linear_rgb[1] == Approx(0.2158605));
    CHECK(colour.linear_rgb[2] == 0);
    CHECK(sheet("checker:2mm").checker_mm == 2);
    CHECK(sheet("desk.png").picture == "desk.png");
    CHECK(parse_backing("backing", "none") == optics::Backing::none);
}

TEST_CASE("A bad value is refused, its key named") {
    const std::vector<std::pair<const char*, Change>> bad{
        {"model", [](SliceOptions& o) { o.model.clear(); }},
        {"out", [](SliceOptions& o) { o.out.clear(); }},
        {"scale", [](SliceOptions& o) { o.scale = 0; }},
        {"size", [](SliceOptions& o) { o.size_mm = -1; }},
        {"width", [](SliceOptions& o) { o.width_mm = -1; }},
        {"thickness", [](SliceOptions& o) { o.thickness_mm = 0; }},
        {"depth", [](SliceOptions& o) { o.depth_mm = 0; }},
        {"depth", [](SliceOptions& o) { o.depth_mm = 11; }},
        {"predict-cell", [](SliceOptions& o) { o.predict_cell_mm = 6; }},
        {"iterations", [](SliceOptions& o) { o.iterations = "often"; }},
        {"viewing-distance", [](SliceOptions& o) { o.viewing_distance_mm = 1; }},
        {"memory", [](SliceOptions& o) { o.memory_gib = -1; }},
        {"verdict-good", [](SliceOptions& o) { o.verdict_good = 0; }},
        {"verdict-bad", [](SliceOptions& o) { o.verdict_bad = 1; }},
        {"threads", [](SliceOptions& o) { o.threads = 2000; }},
        {"unit", [](SliceOptions& o) { o.unit = "mile"; }},
        {"rotate", [](SliceOptions& o) { o.rotate = "w90"; }},
        {"layers", [](SliceOptions& o) { o.layers = "5-3"; }},
        {"formats", [](SliceOptions& o) { o.formats = {"bmp"}; }},
        {"backing", [](SliceOptions& o) { o.backing = "red"; }},
        {"backing", [](SliceOptions& o) { o.backing = "grey:1.5"; }},
        {"backing", [](SliceOptions& o) { o.backing = "grey:dark"; }},
        {"backing", [](SliceOptions& o) { o.backing = "#12345"; }},
        {"backing", [](SliceOptions& o) { o.backing = "checker:0"; }},
        {"backing", [](SliceOptions& o) { o.backing = "cow.obj"; }},
        {"repair", [](SliceOptions& o) { o.repair = "on"; }},
        {"cavities", [](SliceOptions& o) { o.cavities = "on"; }},
        {"screen", [](SliceOptions& o) { o.screen = "lines"; }},
        {"mixing", [](SliceOptions& o) { o.mixing = "paint"; }},
        {"alpha", [](SliceOptions& o) { o.alpha = "glass"; }},
        {"alpha", [](SliceOptions& o) { o.alpha = "translucency", o.coat_mm = 1; }},
        {"intent", [](SliceOptions& o) { o.intent = "good"; }},
        {"loop-model", [](SliceOptions& o) { o.loop_model = "none"; }},
        {"loop-method", [](SliceOptions& o) { o.loop_method = "ascent"; }},
        {"predict", [](SliceOptions& o) { o.predict = "luck"; }},
        {"show", [](SliceOptions& o) { o.show = "layers"; }}};
    for (const auto& [key, change] : bad) check_refused(named(), key, change);
}
