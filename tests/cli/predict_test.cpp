// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <filesystem>

#include <fmt/core.h>
#include <png.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "base/job_outlook.h"
#include "io/profiles/resin_file.h"
#include "run_program.h"
#include "slicer/predict/predict_job.h"
#include "tests/optics/transport/slab_scene.h"

using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

/// An 8-bit RGB picture, rows from the top.
void write_png(const std::string& path, int width, int height, const std::vector<std::uint8_t>& rgb) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(width);
    image.height = static_cast<png_uint_32>(height);
    image.format = PNG_FORMAT_RGB;
    REQUIRE(png_image_write_to_file(&image, path.c_str(), 0, rgb.data(), 0, nullptr));
}

/// A picture of one colour with a black mark over its top left quarter: asymmetric in every way.
std::string marked_picture(const Folder& folder) {
    std::vector<std::uint8_t> rgb;
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 24; ++x) rgb.insert(rgb.end(), 3, x < 12 && y < 8 ? 0 : 255);
    write_png(folder / "mark.png", 24, 16, rgb);
    return folder / "mark.png";
}

/// The slab of that picture, 2.4 x 1.6 x 1 mm, as a stack.
std::string marked_stack(const Folder& folder, const std::string& more = "") {
    const Outcome made =
        run_program(fmt::format("slice --quiet --no-report --iterations 0 {} --width 2.4mm --thickness 1mm {} -o {}",
                                marked_picture(folder), more, folder / "out"));
    REQUIRE(made.exit_code == 0);
    return folder / "out";
}

/// The same, made once for all tests that read it and leave it as it is.
const std::string& usual_stack() {
    static const Folder folder("marked");
    static const std::string stack = marked_stack(folder);
    return stack;
}

double linear(std::uint8_t code) {
    const double c = code / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// Mean of a linear channel over a part of the picture, in shares of its size.
double mean_channel(const Bitmap& bitmap, std::size_t channel, double left, double top, double right, double bottom) {
    double sum = 0;
    int count = 0;
    for (int y = int(top * bitmap.height); y < int(bottom * bitmap.height); ++y)
        for (int x = int(left * bitmap.width); x < int(right * bitmap.width); ++x, ++count)
            sum += linear(bitmap.at(x, y)[channel]);
    return sum / count;
}

double mean_green(const Bitmap& bitmap, double left, double top, double right, double bottom) {
    return mean_channel(bitmap, 1, left, top, right, bottom);
}

bool same_bytes(const std::string& a, const std::string& b) { return read_file(a) == read_file(b); }

/// The last line of --json.
nlohmann::json result_of(const std::string& out) {
    const std::size_t begin = out.rfind('\n', out.size() - 2);
    return nlohmann::json::parse(out.substr(begin == std::string::npos ? 0 : begin + 1)).at("result");
}

}  // namespace

TEST_CASE("predict draws a slab upright, one pixel per cell, the same for any number of threads") {
    const Folder folder("predict");
    const std::string predict = "predict --predict monte-carlo --spp 32 " + usual_stack();
    const Outcome outcome =
        run_program(predict + " --json --threads 1 -o " + (folder / "a.png") + " -o " + (folder / "a.exr"));
    REQUIRE(outcome.exit_code == 0);
    const auto result = result_of(outcome.out);
    CHECK(result["view"] == "top");
    CHECK(result["backing"] == "black");
    CHECK(result["size_px"] == nlohmann::json({29, 19}));  // 57 x 19 voxels of 42.3 x 84.7 um, cells of 2 x 1
    const Bitmap picture = read_png(folder / "a.png");
    CHECK(picture.width == 29);
    CHECK(picture.height == 19);
    // The mark is on the top left, well away from its border; light that spreads leaves a third of the white at most.
    const double mark = mean_green(picture, 0.05, 0.05, 0.4, 0.4);
    CHECK(mark < 0.33 * mean_green(picture, 0.6, 0.1, 0.95, 0.4));
    CHECK(mark < 0.33 * mean_green(picture, 0.05, 0.6, 0.4, 0.9));
    CHECK(mark < 0.33 * mean_green(picture, 0.6, 0.6, 0.95, 0.9));

    REQUIRE(run_program(predict + " --quiet --threads 2 -o " + (folder / "b.png") + " -o " + (folder / "b.exr"))
                .exit_code == 0);
    CHECK(same_bytes(folder / "a.png", folder / "b.png"));
    CHECK(same_bytes(folder / "a.exr", folder / "b.exr"));
    REQUIRE(run_program(predict + " --quiet --seed 2 -o " + (folder / "c.png")).exit_code == 0);
    CHECK(!same_bytes(folder / "a.png", folder / "c.png"));
}

TEST_CASE("The two models agree on the colour of a slab") {
    const Folder folder("agree");
    const std::string& stack = usual_stack();
    const auto mean = [&](const std::string& model) {
        const Outcome outcome = run_program(
            fmt::format("predict --overwrite --json {} --predict {} -o {}", stack, model, folder / "p.png"));
        REQUIRE(outcome.exit_code == 0);
        return result_of(outcome.out);
    };
    const auto traced = mean("monte-carlo --spp 128"), solved = mean("transport");
    CHECK(solved["cells"] == traced["cells"]);
    CHECK_FALSE(solved.contains("standard_error"));
    // Noise of the mean of some hundred cells; besides it the predictor may be off by what it is held to on average,
    // half a unit of CIEDE2000 (tests/optics/transport/predictor_accuracy_test.cpp), which for a grey is half a unit of
    // L*.
    const double noise = 4 * double(traced["standard_error"]["mean"]) / std::sqrt(double(traced["cells"]));
    CHECK(noise < 0.008);
    for (std::size_t c = 0; c < 3; ++c) {
        const double truth = traced["mean_rgb"][c], allowed = 0.5 * 3 / 116 * std::pow(truth, 2.0 / 3);
        CHECK(std::abs(truth - double(solved["mean_rgb"][c])) < noise + allowed);
    }
}

TEST_CASE("An all white slab is white") {
    const Folder folder("white");
    write_png(folder / "white.png", 2, 2, std::vector<std::uint8_t>(12, 255));
    REQUIRE(run_program(
                fmt::format("slice --quiet --no-report --iterations 0 --load W {} --width 2mm --thickness 1mm -o {}",
                            folder / "white.png", folder / "out"))
                .exit_code == 0);
    const Outcome outcome = run_program(fmt::format(
        "predict --overwrite --json --predict monte-carlo --spp 32 {} -o {}", folder / "out", folder / "p.png"));
    REQUIRE(outcome.exit_code == 0);
    const auto result = result_of(outcome.out);
    // Media-relative white is 1. Errors of single cells are independent, so that of the mean is less by the root of
    // their number; the ratio of two noisy values is biased by about the square of one's error, below 0.02 here.
    const double error = double(result["standard_error"]["mean"]) / std::sqrt(double(result["cells"]));
    for (const double mean : result["mean_rgb"]) CHECK(std::abs(mean - 1) < 4 * error + 0.02);
    // Without noise the body is its own white twin.
    const Outcome exact = run_program(
        fmt::format("predict --overwrite --json --predict transport {} -o {}", folder / "out", folder / "p.png"));
    const auto without_noise = result_of(exact.out);
    for (const double mean : without_noise["mean_rgb"]) CHECK(mean == Approx(1).epsilon(1e-6));
}

TEST_CASE("In absolute terms a wide white slab over black is as white as plane-parallel layers say") {
    namespace exact = voxtone::optics::testing;
    const Folder folder("absolute");
    write_png(folder / "white.png", 2, 2, std::vector<std::uint8_t>(12, 255));
    // 40 layers of white; in the middle of 12 mm nobody sees the sides.
    REQUIRE(run_program(fmt::format("slice --quiet --no-report --iterations 0 --resins vero-opaque --load W {} "
                                    "--width 12mm --thickness 1.08mm -o {}",
                                    folder / "white.png", folder / "out"))
                .exit_code == 0);
    const Outcome absolute =
        run_program(fmt::format("predict --overwrite --json --absolute --predict monte-carlo --spp 64 {} -o {}",
                                folder / "out", folder / "p.png"));
    REQUIRE(absolute.exit_code == 0);
    const auto result = result_of(absolute.out);
    const Bitmap picture = read_png(folder / "p.png");
    const auto set = voxtone::io::find_resin_set("vero-opaque").subset(std::vector<std::string>{"W"});
    const std::array<exact::SlabLayer, 1> slab{{{1, 40}}};
    // A fifth of the width and of the height; cells are independent of each other.
    const double cells = 0.04 * double(result["cells"]),
                 error = double(result["standard_error"]["mean"]) / std::sqrt(cells);
    CHECK(error < 0.003);
    for (std::size_t c = 0; c < 3; ++c) {
        const double wanted = exact::exact_appearance(set, slab, voxtone::optics::Backing::black, c);
        INFO(wanted);
        CHECK(std::abs(mean_channel(picture, c, 0.4, 0.4, 0.6, 0.6) - wanted) < 4 * error);
    }
}

TEST_CASE("Ctrl-C stops a prediction with 5 and leaves no file") {
    const Folder folder("stop");
    const Outcome outcome = run_and_signal(
        fmt::format("predict --json --predict monte-carlo --spp 20000 {} -o {}", usual_stack(), folder / "p.png"),
        "\"stage\":\"predict", SIGINT);
    CHECK(outcome.exit_code == 5);
    CHECK_THAT(outcome.err, Contains("cancelled"));
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        CHECK(entry.path().filename().string().find("p.png") == std::string::npos);
}

TEST_CASE("A spectral resin set gives a picture for the eye and numbers per wavelength") {
    const Folder folder("spectral");
    folder.write("grey.json",
                 R"({"format": "voxtone-resins", "version": 1, "name": "grey", "source": "test", "g": 0.4, "eta": 1.5,
        "channels": {"kind": "wavelength", "nm": [450, 550, 600, 650]}, "resins": [
        {"name": "White", "role": "W", "sigma_t_per_mm": [9, 9, 9, 9], "albedo": [0.999, 0.999, 0.999, 0.999]},
        {"name": "Black", "role": "K", "sigma_t_per_mm": [5, 5, 5, 5], "albedo": [0.3, 0.3, 0.3, 0.3]}]})");
    const std::string stack = marked_stack(folder, "--load K,W --resins " + (folder / "grey.json"));
    const Outcome outcome = run_program(
        fmt::format("predict --overwrite --json --predict monte-carlo --spp 16 {} -o {}", stack, folder / "p.exr"));
    REQUIRE(outcome.exit_code == 0);
    const auto result = result_of(outcome.out);
    CHECK(result["channels"] == 4);
    CHECK(result["resins"] == "grey");
    const std::string exr = read_file(folder / "p.exr");
    for (const char* name : {"450nm", "650nm", "error.550nm"}) CHECK_THAT(exr, Contains(name));
    // Resins alike at every wavelength are grey but for noise: 551 cells of an error of 0.15 each give 0.007, on a mean
    // of 0.7 1 %, which the way from four wavelengths to R, G, B enlarges threefold; three times that.
    const auto& mean = result["mean_rgb"];
    CHECK(double(mean[0]) == Approx(double(mean[1])).epsilon(0.1));
    CHECK(double(mean[2]) == Approx(double(mean[1])).epsilon(0.1));
}

TEST_CASE("predict makes meshes of bodies") {
    const Folder folder("body");
    folder.write("marker.obj", marker_obj());
    REQUIRE(run_program(fmt::format("slice --quiet --no-report --iterations 0 --resins vero-opaque --size 2mm {} "
                                    "-o {}",
                                    folder / "marker.obj", folder / "out"))
                .exit_code == 0);
    const Outcome outcome = run_program(fmt::format(
        "predict --overwrite --quiet --predict monte-carlo --spp 4 --cell 0.17mm {0} -o {1}.glb -o {1}.ply -o {1}.png",
        folder / "out", folder / "p"));
    REQUIRE(outcome.exit_code == 0);
    CHECK_THAT(read_file(folder / "p.glb"), Contains("KHR_materials_unlit") && Contains("COLOR_0"));
    CHECK_THAT(read_file(folder / "p.ply"),
               Contains("property float appearance_r") && Contains("property float error_b"));
    CHECK(read_png(folder / "p.png").width > 100);
    const Outcome exr = run_program(fmt::format("predict --overwrite {} -o {}", folder / "out", folder / "p.exr"));
    CHECK(exr.exit_code == 2);
    CHECK_THAT(exr.err, Contains("--view top"));
}

TEST_CASE("Light paths leave a tilted body at its mesh, so that it has the colour of the flat one") {
    const Folder folder("tilted");
    folder.write("box.obj", ramp_box_obj(2.4, 2.4, 1));
    const auto colour = [&](const std::string& rotate, const std::string& boundary) {
        const std::string out = folder / ("out" + rotate);
        if (!std::filesystem::exists(out))
            REQUIRE(run_program(fmt::format("slice --quiet --no-report --iterations 0 --rotate z0{} {} -o {}", rotate,
                                            folder / "box.obj", out))
                        .exit_code == 0);
        const Outcome seen = run_program(
            fmt::format("predict --overwrite --json --quiet --view body --predict monte-carlo --spp 32 --cell 0.2mm {} "
                        "--boundary {} -o {}",
                        out, boundary, folder / "p.ply"));
        REQUIRE(seen.exit_code == 0);
        const auto result = result_of(seen.out);
        CHECK(result["boundary"] == (boundary == "auto" ? "mesh" : boundary));
        return std::array<double, 3>(result["mean_rgb"]);
    };
    const auto flat = colour("", "auto"), tilted = colour(",x35", "auto"), stairs = colour(",x35", "voxels");
    for (std::size_t c = 0; c < 2; ++c) {
        INFO(flat[c] << " flat, " << tilted[c] << " tilted, " << stairs[c] << " with stairs");
        CHECK(std::abs(tilted[c] - flat[c]) < 0.01);
        CHECK(stairs[c] - flat[c] > 0.03);
    }
    // A convex body is not met again: the same bits.
    const auto followed = [&](const std::string& outside) {
        return run_program(
            fmt::format("predict --overwrite --json --quiet --view body --predict monte-carlo --spp 2 "
                        "--cell 0.5mm {} --outside {} -o {}",
                        folder / "out", outside, folder / "p.ply"));
    };
    const auto lost = result_of(followed("lost").out), again_met = result_of(followed("followed").out);
    CHECK(again_met["light_outside"] == "followed");
    CHECK(again_met["mean_rgb"] == lost["mean_rgb"]);
    CHECK(followed("followed --boundary voxels").exit_code == 2);
    CHECK(followed("everywhere").exit_code == 2);
    // The fast predictor gathers it cell by cell: nothing for a convex body but what its steps take from each other.
    const auto gathered = [&](const std::string& arguments) {
        return run_program("predict --overwrite --json --quiet --cell 0.2mm --outside " + arguments + " -o " +
                           (folder / "p.ply") + " " + (folder / "out,x35"));
    };
    const auto fast = result_of(gathered("lost --view body").out),
               met = result_of(gathered("followed --view body").out);
    CHECK(met["light_outside"] == "followed");
    for (std::size_t c = 0; c < 3; ++c)
        CHECK(double(met["mean_rgb"][c]) == Approx(double(fast["mean_rgb"][c])).margin(0.01));
    const Outcome from_above = run_program("predict --overwrite --quiet --view top --outside followed -o " +
                                           (folder / "p.png") + " " + (folder / "out"));
    CHECK(from_above.exit_code == 3);
    CHECK_THAT(from_above.err, Contains("--view body"));
    // What is not the model any more is not taken for it.
    folder.write("box.obj", ramp_box_obj(2.4, 2.4, 1.1));
    const std::string again = "predict --overwrite --quiet --view body --predict monte-carlo --spp 2 --cell 0.5mm " +
                              (folder / "out") + " -o " + (folder / "p.ply");
    const Outcome changed = run_program(again);
    CHECK(changed.exit_code == 0);
    CHECK_THAT(changed.err, Contains("box.obj holds something else than when it was sliced"));
    const Outcome refused = run_program(again + " --boundary mesh");
    CHECK(refused.exit_code == 3);
    CHECK_THAT(refused.err, Contains("--boundary voxels"));
}

TEST_CASE("predict says what is wrong before any work is done") {
    const Folder folder("wrong");
    const std::string& stack = usual_stack();
    const auto fails = [&](const std::string& arguments, int code, const std::string& says) {
        INFO(arguments);
        const Outcome outcome = run_program("predict " + arguments);
        CHECK(outcome.exit_code == code);
        CHECK_THAT(outcome.err, Contains(says));
    };
    const std::string to = " -o " + (folder / "p.png");
    fails(stack, 2, "out");
    fails(stack + " -o p.jpg", 2, ".png");
    fails(stack + to + " --predict magic", 2, "monte-carlo");
    fails(stack + to + " --cell 1m", 2, "--cell");
    fails(stack + to + " --spp 0", 2, "--spp");
    fails(stack + to + " --sweeps 0", 2, "--sweeps");
    fails(stack + to + " --backing red", 2, "--backing");
    fails(stack + to + " --assign \"#ffffff=W\"", 2, "manifest");
    fails(stack + to + " --nearest", 2, "--nearest");
    fails(stack + " -o " + (folder / "p.glb"), 2, "--view body");
    fails(stack + " -o " + (folder / "nowhere/p.png"), 4, "nowhere");
    fails((folder / "nothing") + to, 4, "nothing");
    fails(stack + to + " --resins no-such-set", 3, "no-such-set");
    fails(stack + to + " --memory 0.00001", 5, "--memory");
    fails(stack + "/layers" + to, 3, "--printer");
    fails(stack + "/layers --printer stratasys-j750-hm" + to, 3, "--assign");
    CHECK_FALSE(std::filesystem::exists(folder / "p.png"));
    // The same layers as a foreign stack, with an assignment: the same picture as with the manifest, but for the set's
    // order.
    const auto manifest = nlohmann::json::parse(read_file(stack + "/manifest.json"));
    std::string assign;
    for (const auto& resin : manifest["resins"])
        assign += fmt::format("{}#{:02x}{:02x}{:02x}={}", assign.size() ? "," : "", int(resin["rgb"][0]),
                              int(resin["rgb"][1]), int(resin["rgb"][2]), std::string(resin["role"]));
    const std::string quick = " --quiet --predict monte-carlo --spp 4 --cell 0.3mm";
    REQUIRE(run_program("predict " + stack + quick + to).exit_code == 0);
    REQUIRE(run_program("predict " + stack + "/layers --printer stratasys-j750-hm --assign \"" + assign + "\"" + quick +
                        " -o " + (folder / "q.png"))
                .exit_code == 0);
    CHECK(same_bytes(folder / "p.png", folder / "q.png"));
}

TEST_CASE("Predicting has one time for all of it: every stage is expected before it begins") {
    const Folder folder("expected");
    class Stages final : public voxtone::Progress, public voxtone::ShowsOutlook {
    public:
        std::vector<std::string> to_come, begun, unexpected;
        void expect(std::vector<voxtone::ExpectedStage> stages) override {
            to_come.clear();
            for (const voxtone::ExpectedStage& stage : stages) {
                CHECK(stage.seconds > 0);
                to_come.push_back(stage.name);
            }
        }
        void expect_steps(std::uint64_t) override {}

    private:
        void on_stage(std::string_view name, std::uint64_t, std::string_view) override {
            begun.emplace_back(name);
            if (std::find(to_come.begin(), to_come.end(), name) == to_come.end()) unexpected.emplace_back(name);
        }
    } stages;
    voxtone::slicer::PredictOptions options;
    options.stack = usual_stack();
    options.files = {folder / "p.png"};
    (void)voxtone::slicer::run_predict_job(options, stages);
    CHECK(stages.begun == std::vector<std::string>{"read layers", "find the surface", "predict", "write"});
    CHECK(stages.unexpected.empty());
}

TEST_CASE("What a prediction remarks of itself is said on the console and in the JSON result") {
    const Folder folder("remarks");
    const std::string& stack = usual_stack();
    // Dark resins, in which light is anything but diffuse: the second sweep, the last after `--sweeps 1`, changes 13 %.
    std::string resins;
    for (const char* role : {"C", "M", "Y", "K", "W"})
        resins += fmt::format(
            R"({}{{"name": "{}", "role": "{}", "sigma_t_per_mm": [5, 5, 5], "albedo": [0.05, 0.05, 0.05]}})",
            resins.empty() ? "" : ", ", role, role);
    folder.write("dark.json", fmt::format(R"({{"format": "voxtone-resins", "version": 1, "name": "dark",
        "source": "test", "channels": {{"kind": "rgb"}}, "g": 0, "eta": 1.5, "resins": [{}]}})",
                                          resins));
    const std::string predict =
        fmt::format("predict --overwrite {} --resins {} -o {}", stack, folder / "dark.json", folder / "p.png");
    const Outcome text = run_program(predict + " --sweeps 1"), json = run_program(predict + " --json --sweeps 1");
    REQUIRE(text.exit_code == 0);
    CHECK_THAT(text.err, Contains("warning: the last sweep") && Contains("of the white that colours refer to") &&
                             Contains("[prediction-doubt]"));
    const auto last = json.out.rfind("\n", json.out.size() - 2) + 1;
    const auto result = nlohmann::json::parse(json.out.substr(last));
    CHECK_THAT(result.dump(), Contains("\"warnings\":[\"the last sweep"));
    const Outcome usual = run_program(predict + " --json --sweeps 3");
    CHECK_THAT(usual.out, !Contains("the last sweep"));
}

TEST_CASE("What memory cannot hold, and what does not fit the stack, is refused before its layers are read") {
    const Folder folder("refused-early");
    const std::string& stack = usual_stack();
    const auto predicted = [&](const std::string& arguments) {
        return run_program("predict --json --overwrite " + stack + arguments);
    };
    const std::string picture = " -o " + (folder / "p.png"), quick = " --predict monte-carlo --spp 2 --cell 0.4mm";
    REQUIRE_THAT(predicted(picture + quick).out, Contains("read layers"));
    // A slab of 3.9 mm^3 has more than the 32 blocks of 6,400 bytes that the smallest tile has.
    const Outcome memory = predicted(picture + " --memory 0.0001");
    CHECK(memory.exit_code == 5);
    CHECK_THAT(memory.out + memory.err, Contains("needs at least") && Contains("--memory") && Contains("--cell 0.2mm"));
    CHECK_THAT(memory.out, !Contains("read layers"));
    const Outcome kind = predicted(" -o " + (folder / "p.glb"));
    CHECK(kind.exit_code == 2);
    CHECK_THAT(kind.out, !Contains("read layers"));
    // The bound is no more than is needed.
    const Outcome just = predicted(picture + " --memory 0.1");
    INFO(just.err);
    CHECK(just.exit_code == 0);
}

TEST_CASE("slice --predict shows target, prediction and difference, upright, with its figures") {
    const Folder folder("report");
    REQUIRE(run_program(
                fmt::format(
                    "slice --quiet {} --width 2.4mm --thickness 1mm --predict monte-carlo --predict-cell 0.17mm -o {}",
                    marked_picture(folder), folder / "out"))
                .exit_code == 0);
    const auto report = nlohmann::json::parse(read_file(folder / "out/report.json"));
    const auto& predicted = report["predicted"];
    CHECK(predicted["model"] == "monte-carlo");
    CHECK(predicted["cell_um"][0] == Approx(4 * 25400.0 / 600).epsilon(1e-5));
    CHECK(predicted["de2000"]["mean"] > 0);
    double share = 0;
    for (const auto& bar : predicted["de2000"]["histogram"]) share += double(bar["share"]);
    CHECK(share == Approx(1));
    const std::string page = read_file(folder / "out/report.html");
    CHECK_THAT(page, Contains("Predicted against asked for") && Contains("difference, CIEDE2000"));
    for (const char* name : {"target", "predicted"}) {
        INFO(name);
        const Bitmap picture = read_png(folder / fmt::format("out/{}.png", name));
        CHECK(picture.width == 15);   // 57 voxels in cells of 4
        CHECK(picture.height == 10);  // 19 in cells of 2
        const double mark = mean_green(picture, 0.07, 0.05, 0.4, 0.4);
        CHECK(mark < 0.33 * mean_green(picture, 0.6, 0.1, 0.95, 0.4));
        CHECK(mark < 0.33 * mean_green(picture, 0.07, 0.6, 0.4, 0.9));
        CHECK(mark < 0.33 * mean_green(picture, 0.6, 0.6, 0.95, 0.9));
        CHECK(std::filesystem::exists(folder / fmt::format("out/{}.exr", name)));
    }
    // The stack as it lies there gives the same prediction, the seed being the same.
    REQUIRE(run_program(fmt::format("predict --overwrite --quiet --predict monte-carlo --cell 0.17mm {} -o {}",
                                    folder / "out", folder / "again.png"))
                .exit_code == 0);
    CHECK(same_bytes(folder / "again.png", folder / "out/predicted.png"));

    // By transport too, whose larger cells are a quick look here as there.
    REQUIRE(run_program(fmt::format("slice --quiet {} --width 2.4mm --thickness 1mm --predict transport --iterations 0 "
                                    "--predict-cell 0.3mm -o {}",
                                    marked_picture(folder), folder / "coarse"))
                .exit_code == 0);
    REQUIRE(run_program(fmt::format("predict --quiet --cell 0.3mm {} -o {}", folder / "coarse", folder / "coarse.png"))
                .exit_code == 0);
    CHECK(same_bytes(folder / "coarse.png", folder / "coarse/predicted.png"));

    // A part of the layers is not predicted, and the report says so.
    REQUIRE(run_program(fmt::format("slice --quiet {} --width 2.4mm --thickness 1mm --layers 0-9 -o {}",
                                    marked_picture(folder), folder / "part"))
                .exit_code == 0);
    const auto part = nlohmann::json::parse(read_file(folder / "part/report.json"));
    CHECK_FALSE(part.contains("predicted"));
    CHECK_THAT(std::string(part["prediction"]), Contains("a part is not predicted"));

    // Too little memory: the print is whole, and the job says why it is not predicted.
    const Outcome little =
        run_program(fmt::format("slice --quiet {} --width 2.4mm --thickness 1mm --predict monte-carlo --iterations 0 "
                                "--memory 0.00001 --overwrite "
                                "-o {}",
                                marked_picture(folder), folder / "out"));
    CHECK(little.exit_code == 0);
    CHECK_THAT(little.err, Contains("not predicted") && Contains("[not-predicted]") && Contains("--memory"));
    CHECK_FALSE(nlohmann::json::parse(read_file(folder / "out/report.json")).contains("predicted"));
    CHECK_FALSE(std::filesystem::exists(folder / "out/predicted.exr"));
    CHECK(run_program("verify " + (folder / "out")).exit_code == 0);
}
