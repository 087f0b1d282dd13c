// SPDX-License-Identifier: GPL-3.0-or-later
//
// A whole proof of a small stack: what stands in its files, read by libpng and OpenEXR, and what is said of it.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "slicer/proof/proof_job.h"
#include "tests/slicer/print/small_pictures.h"
#include "tests/slicer/print/small_print.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using Catch::Matchers::Contains;
using nlohmann::json;

namespace {

PrintDesk& desk() { return printed_desk(); }

ProofOptions small_proof(const std::vector<std::string>& names) {
    ProofOptions options;
    options.stacks = {desk().path("out").string()};
    for (const std::string& name : names) options.files.push_back(desk().path(name).string());
    options.size.assign("36x24");
    options.samples = 8;
    options.view.assign("front");
    options.overwrite = true;
    return options;
}

struct Proofed {
    JobResult result;
    json says;
    Numbers numbers;
};
Proofed proofed(const ProofOptions& options) {
    Proofed made{run_proof_job(options, desk().said), {}, {}};
    made.says = json::parse(made.result.json);
    made.numbers = read_numbers(options.files.front());
    return made;
}

std::vector<std::size_t> pixels_that_see(const Numbers& numbers, int what) {
    std::vector<std::size_t> pixels;
    for (std::size_t p = 0; p < numbers.of.at("seen").size(); ++p)
        if (numbers.of.at("seen")[p] == float(what)) pixels.push_back(p);
    return pixels;
}

double mean_of(const std::vector<float>& values, const std::vector<std::size_t>& pixels) {
    double sum = 0;
    for (const std::size_t p : pixels) sum += values[p];
    return sum / double(pixels.size());
}

double middle_column(const Numbers& numbers, const std::vector<std::size_t>& pixels) {
    double sum = 0;
    for (const std::size_t p : pixels) sum += double(p % std::size_t(numbers.width)) + 0.5;
    return sum / double(pixels.size());
}

constexpr int sky = 0, ground = 1, print = 2, target = 3;

}  // namespace

TEST_CASE("A proof's numbers are what its picture shows, and its figures are theirs") {
    ProofOptions options = small_proof({"p.exr", "p.png"});
    options.exposure_ev = -1;
    const Proofed made = proofed(options);
    const Numbers& n = made.numbers;
    REQUIRE((n.width == 36 && n.height == 24));
    CHECK(made.result.exit_code == ExitCode::done);
    CHECK(made.says.at("size_px") == json({36, 24}));
    CHECK(made.says.at("files") == json(options.files));
    CHECK(made.says.at("stacks") == json(options.stacks));
    CHECK(made.says.at("light") == "studio");
    CHECK(made.says.at("surface") == json({"mesh"}));
    CHECK(made.says.at("complete") == true);
    CHECK(made.says.at("samples") == json({8, 8}));
    CHECK(made.says.at("paths") == 36 * 24 * 8);
    std::set<std::string> names;
    for (const auto& [name, values] : n.of) names.insert(name);
    // The usual set has four channels.
    for (const char* name : {"R", "G", "B", "c1", "c2", "c3", "c4"}) {
        CHECK(names.erase(name) == 1);
        CHECK(names.erase(std::string("error.") + name) == 1);
        for (const float error : n.of.at(std::string("error.") + name)) CHECK(error >= 0);
    }
    CHECK(names == std::set<std::string>{"A", "samples", "roughness", "seen"});
    const std::vector<std::uint8_t> codes = read_codes(options.files[1]);
    for (std::size_t p = 0; p < 36 * 24; ++p) {
        CHECK(n.of.at("A")[p] == 1);
        CHECK(n.of.at("samples")[p] == 8);
        std::size_t channel = 0;
        for (const char* name : {"R", "G", "B"}) {
            CHECK(std::abs(code_of(0.5 * double(n.of.at(name)[p])) - codes[3 * p + channel++]) < 0.51);
        }
    }
    // The box of 2 x 1.5 mm stands in the middle on its ground, and looks at us with its front.
    const auto body = pixels_that_see(n, print);
    CHECK(middle_column(n, body) == Approx(18).margin(0.5));
    CHECK(pixels_that_see(n, target).empty());
    CHECK(pixels_that_see(n, ground).size() > 36);
    for (const std::size_t p : pixels_that_see(n, sky)) CHECK(p / 36 < 16);
    CHECK(mean_of(n.of.at("R"), body) > 1.2 * mean_of(n.of.at("B"), body) - 0.2);
    double squares = 0;
    for (const std::size_t p : body) squares += double(n.of.at("error.G")[p]) * double(n.of.at("error.G")[p]);
    CHECK(made.says.at("standard_error").get<double>() ==
          Approx(std::sqrt(squares / double(body.size()))).epsilon(0.5));
    CHECK_THAT(n.comment, Contains("8 to 8 samples a pixel") && Contains("light studio") &&
                              Contains("exposure -1 EV") && Contains("Flecks of colour") && !Contains("target") &&
                              !Contains("Stopped"));
    CHECK_THAT(made.result.text, Contains("36 x 24 pixels, 8 to 8 samples each") && Contains("flecks of colour") &&
                                     !Contains("target") && !Contains("stopped"));
}

TEST_CASE("A target stands to the right of its print, as large, lit alike, and looks much the same") {
    ProofOptions options = small_proof({"p.exr"});
    options.with_target = true;
    options.size.assign("60x24");
    options.samples = 16;
    options.light_width_mm = {};
    options.lights = {"even"};
    const Proofed made = proofed(options);
    const auto left = pixels_that_see(made.numbers, print), right = pixels_that_see(made.numbers, target);
    REQUIRE(left.size() > 50);
    CHECK(double(right.size()) == Approx(double(left.size())).epsilon(0.15));
    CHECK(middle_column(made.numbers, left) < 30 - 5);
    CHECK(middle_column(made.numbers, right) > 30 + 5);
    for (const char* name : {"R", "G", "B"})
        CHECK(mean_of(made.numbers.of.at(name), right) ==
              Approx(mean_of(made.numbers.of.at(name), left)).epsilon(0.25));
    CHECK_THAT(made.numbers.comment, Contains("The target, on the right"));
    CHECK_THAT(made.result.text, Contains("the target, on the right"));
}

TEST_CASE("Under several lights a proof is one picture below the other, each as it is alone") {
    ProofOptions options = small_proof({"p.exr"});
    std::vector<Proofed> alone;
    for (const char* light : {"overcast", "even", "spot"}) {
        options.lights = {light};
        alone.push_back(proofed(options));
    }
    options.lights = {"overcast", "even", "spot"};
    const Proofed all = proofed(options);
    REQUIRE(all.numbers.height == 3 * 24);
    CHECK(all.says.at("size_px") == json({36, 72}));
    for (const auto& [name, values] : all.numbers.of) {
        std::vector<float> wanted;
        for (const Proofed& one : alone)
            wanted.insert(wanted.end(), one.numbers.of.at(name).begin(), one.numbers.of.at(name).end());
        CHECK(values == wanted);
    }
    std::uint64_t paths = 0;
    double squares = 0;
    for (const Proofed& one : alone) {
        paths += one.says.at("paths").get<std::uint64_t>();
        squares += std::pow(one.says.at("standard_error").get<double>(), 2) / 3;
    }
    CHECK(all.says.at("paths") == paths);
    CHECK(all.says.at("standard_error").get<double>() == Approx(std::sqrt(squares)));
    CHECK(all.says.at("light") == "overcast, even, spot");
    CHECK_FALSE(alone[0].says.contains("beams"));
    REQUIRE(all.says.at("beams").size() == 1);
    CHECK(all.says["beams"] == alone[2].says["beams"]);
    CHECK(all.says["beams"][0]["light"] == "spot");
    CHECK(all.says["beams"][0]["width_mm"] == 2);
    CHECK(all.says["beams"][0]["responses"].empty());
    CHECK_THAT(all.result.text, Contains("a spot of light, 2 mm wide") && Contains("told of flat slabs alone"));
    CHECK_THAT(all.result.text, !Contains("other places"));
    CHECK_THAT(alone[0].result.text, !Contains("told of flat slabs"));
    CHECK_THAT(all.numbers.comment, Contains("light overcast; below even; below a spot of light, 2 mm wide, at ("));
    CHECK_THAT(all.numbers.comment, !Contains("missing"));
}

TEST_CASE("Of a box that has lost its model it is told how far light goes on beside a beam") {
    PrintDesk lost;
    SliceOptions sliced = lost.options("out");
    sliced.report = false;
    (void)lost.print(sliced);
    std::filesystem::remove(lost.path("box.obj"));
    ProofOptions options = small_proof({"p.exr"});
    options.stacks = {sliced.out};
    options.view.assign("top");
    options.size.assign("40x40");
    options.samples = 24;
    options.lights = {"edge"};
    const Proofed made = proofed(options);
    CHECK(made.says.at("surface") == json({"box"}));
    REQUIRE(made.says.at("beams").at(0).at("responses").size() == 1);
    const json& response = made.says["beams"][0]["responses"][0];
    CHECK(response.at("slab") == 0);
    CHECK(response.at("stack") == sliced.out);
    const std::vector<double> at = response.at("distance_mm"), light = response.at("luminance"),
                              error = response.at("standard_error");
    REQUIRE((at.size() > 10 && light.size() == at.size() && error.size() == at.size()));
    CHECK(std::is_sorted(at.begin(), at.end()));
    CHECK(at.front() < -0.5);
    CHECK(at.back() > 0.5);
    CHECK(light.front() > 5 * light.back());
    for (const double e : error) CHECK(e >= 0);
    // The half comes before the tenth, and both are told in words too.
    CHECK(response.at("half_mm").get<double>() > 0);
    CHECK(response.at("half_mm").get<double>() < response.at("tenth_mm").get<double>());
    CHECK(response.at("tenth_error_mm").get<double>() > 0);
    CHECK_THAT(made.result.text,
               Contains(fmt::format("to a half within {:.3f} +- {:.3f} mm", response["half_mm"].get<double>(),
                                    response["half_error_mm"].get<double>())) &&
                   Contains(fmt::format("to a tenth within {:.3f}", response["tenth_mm"].get<double>())) &&
                   !Contains(", slab "));
}

TEST_CASE("Faces are as rough as the printer leaves them, and without a ground there is none") {
    ProofOptions options = small_proof({"p.exr"});
    options.roughness = {0.1, 0.4};
    options.ground = "none";
    const auto roughness = [&](const char* finish, const char* view) {
        options.finish = finish, options.view = view;
        const Proofed made = proofed(options);
        CHECK(made.says.at("finish") == finish);
        CHECK(pixels_that_see(made.numbers, ground).empty());
        for (const std::size_t p : pixels_that_see(made.numbers, sky)) CHECK(made.numbers.of.at("roughness")[p] == 0);
        const auto body = pixels_that_see(made.numbers, print);
        REQUIRE(body.size() > 30);
        return mean_of(made.numbers.of.at("roughness"), body);
    };
    CHECK(roughness("matt", "top") == Approx(0.4));
    CHECK(roughness("glossy", "top") == Approx(0.1).margin(0.03));
}

TEST_CASE("Two prints stand side by side in their order, the first on the left") {
    desk().write_box("tall.obj", {1, 1, 3});
    SliceOptions tall = desk().options("tall");
    tall.model = desk().path("tall.obj").string();
    tall.report = false;
    (void)desk().print(tall);
    ProofOptions options = small_proof({"p.exr"});
    options.size.assign("60x40");
    options.stacks.push_back(tall.out);
    const auto highest = [](const Numbers& n, int from, int to) {
        for (std::size_t p = 0; p < n.of.at("seen").size(); ++p)
            if (n.of.at("seen")[p] == print && int(p % 60) >= from && int(p % 60) < to) return int(p / 60);
        return 1000;
    };
    const Numbers both = proofed(options).numbers;
    CHECK(highest(both, 30, 60) + 5 < highest(both, 0, 25));
    std::swap(options.stacks[0], options.stacks[1]);
    const Numbers swapped = proofed(options).numbers;
    CHECK(highest(swapped, 0, 25) + 5 < highest(swapped, 35, 60));
}

TEST_CASE("What a proof is asked for is checked at its bounds, with the option's name") {
    const auto says = [](const auto& set) -> std::string {
        ProofOptions options;
        options.stacks = {"out"}, options.files = {"p.png"};
        set(options);
        try {
            (void)resolve(options);
        } catch (const UsageError& error) {
            return error.what();
        }
        return {};
    };
    CHECK(says([](auto&) {}).empty());
    CHECK_THAT(says([](auto& o) { o.stacks.clear(); }), Contains("name a stack"));
    CHECK_THAT(says([](auto& o) { o.files.clear(); }), Contains("--out"));
    CHECK_THAT(says([](auto& o) { o.files = {"a.png", "a.jpg"}; }), Contains("--out a.jpg"));
    CHECK(says([](auto& o) { o.files = {"a.png", "a.exr"}; }).empty());
    struct Range {
        const char* key;
        std::function<void(ProofOptions&, double)> set;
        double least, most, below, above;
    };
    const Range ranges[] = {
        {"focal", [](auto& o, double x) { o.focal_mm = x; }, 10, 2000, 9.9, 2001},
        {"filter", [](auto& o, double x) { o.filter_px = x; }, 0, 1, -0.1, 1.1},
        {"spp", [](auto& o, double x) { o.samples = std::uint32_t(x); }, 2, 1048576, 1, 1048577},
        {"error", [](auto& o, double x) { o.error = x; }, 1e-4, 0.99, 0.9e-4, 1},
        {"exposure", [](auto& o, double x) { o.exposure_ev = x; }, -20, 20, -20.1, 20.1},
        {"turn-light", [](auto& o, double x) { o.turn_light_deg = x; }, -360, 360, -361, 361},
        {"turn", [](auto& o, double x) { o.turn_deg = x; }, -360, 360, -361, 361},
        {"roughness",
         [](auto& o, double x) {
             o.roughness = {x, 0.3};
         },
         0, 0.9, -0.1, 0.91},
        {"roughness",
         [](auto& o, double x) {
             o.roughness = {0, x};
         },
         0, 0.9, -0.1, 0.91},
        {"threads", [](auto& o, double x) { o.threads = int(x); }, 0, 1024, -1, 1025},
        {"ground", [](auto& o, double x) { o.ground = fmt::format("{}", x); }, 0, 1, -0.1, 1.1},
        {"size", [](auto& o, double x) { o.size = fmt::format("{}x100", int(x)); }, 16, 16384, 15, 16385},
        {"size", [](auto& o, double x) { o.size = fmt::format("100x{}", int(x)); }, 16, 16384, 15, 16385},
        {"light-width", [](auto& o, double x) { o.lights = {"slit"}, o.light_width_mm = x; }, 1e-9, 1000, 0, 1001}};
    for (const Range& range : ranges)
        for (const double x : {range.least, range.most, range.below, range.above}) {
            CAPTURE(range.key, x);
            const std::string said = says([&](auto& o) { range.set(o, x); });
            if (x == range.least || x == range.most)
                CHECK(said.empty());
            else
                CHECK_THAT(said, Catch::StartsWith(fmt::format("--{} ", range.key)));
        }
    CHECK(says([](auto& o) { o.error = 0; }).empty());
    CHECK(says([](auto& o) { o.ground = "none"; }).empty());
    CHECK_THAT(says([](auto& o) { o.size = "800"; }), Contains("WIDTHxHEIGHT"));
    CHECK_THAT(says([](auto& o) { o.lights = {"moon"}; }), Contains("--light") && Contains("moon"));
    CHECK(says([](auto& o) { o.lights = {"moon.exr"}; }).empty());
    CHECK_THAT(says([](auto& o) { o.camera = "1,2"; }), Contains("--camera") && Contains("X,Y,Z"));
    CHECK_THAT(says([](auto& o) { o.camera = "1,2,3", o.view = "top"; }), Contains("--view top"));
    CHECK_THAT(says([](auto& o) { o.light_at = "1,2,3"; }), Contains("--light-at"));
    CHECK_THAT(says([](auto& o) { o.light_at = "", o.lights = {"spot"}; }), Contains("--light-at"));
    for (const char* light : {"edge", "studio"})
        CHECK_THAT(says([&](auto& o) { o.lights = {light}, o.light_width_mm = 1; }), Contains("--light-width"));
    CHECK(says([](auto& o) { o.lights = {"studio", "spot"}, o.light_width_mm = 1; }).empty());
    CHECK(says([](auto& o) { o.lights = {"edge"}, o.light_at = "1,2,3"; }).empty());

    ProofOptions options;
    options.stacks = {"out"}, options.files = {"p.png"};
    options.size = "640x480", options.camera = "1,2,3", options.look_at = "4,5,6", options.up = "-y";
    options.lights = {"spot"}, options.light_at = "7,8,9", options.ground = "0.25";
    const ResolvedProof job = resolve(options);
    CHECK((job.width_px == 640 && job.height_px == 480));
    CHECK(job.camera == optics::Point{1, 2, 3});
    CHECK(job.look_at == optics::Point{4, 5, 6});
    CHECK(job.light_at == optics::Point{7, 8, 9});
    CHECK(job.up == ProofUp::minus_y);
    CHECK(job.ground == 0.25);
    CHECK_FALSE(job.view);
    CHECK(resolve([&] {
              options.lights.clear(), options.light_at = "middle";
              return options;
          }())
              .lamps.at(0)
              .kind == ProofLight::studio);
    options.size = "16384x16384", options.memory_gib = 1, options.camera.clear();
    CHECK_THROWS_WITH(run_proof_job(options, desk().said), Contains("ask for fewer pixels"));
}
