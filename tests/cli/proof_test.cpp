// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>

#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "exr_numbers.h"
#include "io/pictures/picture_writer.h"
#include "io/profiles/resin_file.h"
#include "optics/media/resins.h"
#include "run_program.h"

using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

std::string marker_stack(const Folder& folder) {
    folder.write("marker.obj", marker_obj());
    const Outcome made = run_program(
        fmt::format("slice --quiet --no-report --iterations 0 {} -o {}", folder / "marker.obj", folder / "out"));
    REQUIRE(made.exit_code == 0);
    return folder / "out";
}

/// The same, made once for all tests that read it and leave it as it is.
const std::string& usual_stack() {
    static const Folder folder("proof-marker");
    static const std::string stack = marker_stack(folder);
    return stack;
}

nlohmann::json result_of(const std::string& out) {
    const std::size_t begin = out.rfind('\n', out.size() - 2);
    return nlohmann::json::parse(out.substr(begin == std::string::npos ? 0 : begin + 1)).at("result");
}

/// Mean code of green over a box of pixels.
double mean_green(const Bitmap& picture, int left, int top, int right, int bottom) {
    double sum = 0;
    for (int y = top; y < bottom; ++y)
        for (int x = left; x < right; ++x) sum += picture.at(x, y)[1];
    return sum / ((right - left) * (bottom - top));
}

/// Within which distance the shadow beyond an edge falls to a share of what it is there, by the R(r) of a profile file:
/// what a half-plane sends to a place that lies x outside is the integral of 2 r acos(x / r) R(r) over r > x.
double falls_within(const std::string& file, double share) {
    const auto R = nlohmann::json::parse(read_file(file)).at("R");
    const double spacing = R["spacing_mm"], weights[3] = {0.2126, 0.7152, 0.0722};  // luminance, IEC 61966-2-1
    std::vector<double> light(R["light"][0].size());
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < light.size(); ++i) light[i] += weights[c] * R["light"][c][i].get<double>();
    const auto sent = [&](double x) {
        double sum = 0;
        for (std::size_t i = 1; i < light.size(); ++i) {
            const double r = double(i) * spacing;
            if (r > x) sum += spacing * 2 * r * std::acos(x / r) * light[i];
        }
        return sum;
    };
    double x = 0;
    while (sent(x) > share * sent(0)) x += spacing;
    return x;
}

}  // namespace

TEST_CASE("a proof shows the print upright on its ground, the same for any number of threads") {
    const Folder folder("proof");
    const std::string proof = "proof " + usual_stack() + " --size 96x64 --spp 8 --view front --light overcast";
    const Outcome outcome =
        run_program(proof + " --json --threads 1 -o " + (folder / "a.png") + " -o " + (folder / "a.exr"));
    REQUIRE(outcome.exit_code == 0);
    const auto result = result_of(outcome.out);
    CHECK(result["format"] == "voxtone-proof");
    CHECK(result["surface"] == nlohmann::json({"mesh"}));
    CHECK(result["complete"] == true);
    CHECK(result["samples"] == nlohmann::json({8, 8}));
    const Bitmap picture = read_png(folder / "a.png");
    REQUIRE(picture.width == 96);
    REQUIRE(picture.height == 64);
    // Eight samples leave flecks that no print has.
    CHECK_THAT(run_program(proof + " -o " + (folder / "c.png")).out,
               Contains("noise of the picture, not of the print"));
    // White resin on a grey ground; the marker's tower stands on the left, over a base twice as wide.
    const double ground = mean_green(picture, 2, 40, 8, 60);
    CHECK(mean_green(picture, 30, 14, 40, 30) > ground + 10);
    CHECK(mean_green(picture, 56, 14, 66, 24) < mean_green(picture, 30, 14, 40, 24) - 5);
    CHECK_THAT(read_file(folder / "a.png"), Contains("Proof of a print by light paths: 8 to 8 samples a pixel"));

    REQUIRE(
        run_program(proof + " --quiet --threads 2 -o " + (folder / "b.png") + " -o " + (folder / "b.exr")).exit_code ==
        0);
    CHECK(read_file(folder / "a.png") == read_file(folder / "b.png"));
    CHECK(read_file(folder / "a.exr") == read_file(folder / "b.exr"));
}

TEST_CASE("a proof shows prints as a set's residual says, and leaves all else as it was") {
    const Folder folder("proof-residual");
    const std::string& stack = usual_stack();
    const auto shot = [&](double step) {
        voxtone::optics::ResinSet set = voxtone::optics::vero_opaque();
        // The same step of all three roots for every mixture.
        set.residual = {std::vector<double>(5, 30), Eigen::MatrixXd::Constant(1, 5, 0.2),
                        Eigen::MatrixX3d::Constant(1, 3, step)};
        folder.write("set.json", voxtone::io::resin_set_text(set));
        const std::string file = folder / fmt::format("{}.png", step);
        REQUIRE(run_program(fmt::format("proof --quiet {} --resins {} --size 96x64 --spp 8 --view front -o {}", stack,
                                        folder / "set.json", file))
                    .exit_code == 0);
        return read_png(file);
    };
    const Bitmap plain = shot(1e-9), lighter = shot(0.05);
    CHECK(plain.at(1, 1) == lighter.at(1, 1));
    CHECK(plain.at(48, 62) == lighter.at(48, 62));
    int changed = 0;
    double by = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 96; ++x) {
            if (lighter.at(x, y) == plain.at(x, y)) continue;
            ++changed;
            by += lighter.at(x, y)[1] - plain.at(x, y)[1];
        }
    CHECK(changed > 500);
    CHECK(changed < 5000);  // not the ground, not the sky
    CHECK(by / changed > 8);
}

TEST_CASE("a proof's files, lights and views are checked before it works") {
    const Folder folder("proof-options");
    folder.write("there.png", "x");
    const auto refused = [&](const std::string& arguments, int code, const std::string& says) {
        const Outcome outcome = run_program("proof " + arguments);
        INFO(arguments << "\n" << outcome.err);
        CHECK(outcome.exit_code == code);
        CHECK_THAT(outcome.err, Contains(says));
    };
    const std::string out = " -o " + (folder / "p.png");
    refused("out", 2, "--out");
    refused("out -o p.jpg", 2, ".png for the eye, .exr for numbers");
    refused("out -o " + (folder / "there.png"), 3, "there.png");
    refused("out --size 800" + out, 2, "WIDTHxHEIGHT");
    refused("out --size 16000x16000 --memory 1" + out, 5, "ask for fewer pixels");
    refused("out --light moon" + out, 2, "none of studio, overcast, even, behind, edge, slit, spot, laser");
    refused("out --light-at 1,2,3" + out, 2, "only a beam lights one place");
    refused("out --light spot --light-at 1,2" + out, 2, "X,Y,Z");
    refused("out --light edge --light-at here" + out, 2, "middle, or three lengths");
    refused("out --light edge --light studio --light-width 1mm" + out, 2,
            "only a slit, a spot and a laser have a width");
    refused("out --light slit --light-width 0mm" + out, 2, "above 0, up to 1000mm");
    refused(usual_stack() + " --light spot --light-at 900,900,0" + out, 3, "the camera sees no print there");
    refused(usual_stack() + " --light edge --camera 0,0,900 --look-at 0,900,900" + out, 3,
            "sees no print, so the beam");
    refused("out --view side" + out, 2, "--view");
    refused("out --view top --camera 0,0,9" + out, 2, "would be ignored");
    refused("out --camera 1,2" + out, 2, "X,Y,Z");
    refused("out --roughness 0,1" + out, 2, "from 0 (smooth) to 0.9");
    refused("out --filter 2" + out, 2, "must be 0 to 1 pixel");
    refused("out --ground 2" + out, 2, "reflectance from 0 to 1");
    refused((folder / "nothing") + out, 4, "nothing");
    refused((folder / "nothing") + " --light " + (folder / "no.exr") + out, 4, "no.exr");
    CHECK(!std::filesystem::exists(folder / "p.png"));
}

TEST_CASE("under the edge of a beam slabs that scatter differently are told apart, below the same in even light") {
    const Folder folder("proof-beam");
    const std::string resins = " --resins vero-opaque-clear";
    REQUIRE(run_program("laminate print \"W 2\" \"W 0.3, K 1.7\" --width 6mm --depth 6mm --base K=0.5mm --quiet -o " +
                        (folder / "slabs") + resins)
                .exit_code == 0);
    const std::string proof = "proof " + (folder / "slabs") + resins +
                              " --view top --size 96x48 --spp 64 --quiet --json --light even --light edge";
    std::vector<nlohmann::json> results;
    for (const char* threads : {"1", "2"}) {
        const std::string name = folder / threads;
        const Outcome outcome =
            run_program(fmt::format("{} --threads {} -o {}.png -o {}.exr", proof, threads, name, name));
        INFO(outcome.out << outcome.err);
        REQUIRE(outcome.exit_code == 0);
        results.push_back(result_of(outcome.out));
    }
    CHECK(read_file(folder / "1.png") == read_file(folder / "2.png"));
    CHECK(read_file(folder / "1.exr") == read_file(folder / "2.exr"));
    const auto& result = results[0];
    CHECK(result["surface"] == nlohmann::json({"box"}));
    CHECK(result["light"] == "even, edge");
    REQUIRE(result["beams"].size() == 1);
    const auto& responses = result["beams"][0]["responses"];
    CHECK(responses == results[1]["beams"][0]["responses"]);
    REQUIRE(responses.size() == 2);
    const auto number = [&](std::size_t slab, const char* key) { return responses[slab][key].get<double>(); };
    // 2 mm of white and 0.3 mm of it on black.
    const double error = std::hypot(number(0, "tenth_error_mm"), number(1, "tenth_error_mm"));
    CHECK(number(0, "tenth_mm") > number(1, "tenth_mm") + 4 * error);
    CHECK(responses[1]["slab"] == 1);
    // By adding-doubling of endless slabs on black: no light paths, no pixels.
    REQUIRE(run_program("laminate predict \"W 2\" --quiet -o " + (folder / "thick.json") + resins).exit_code == 0);
    REQUIRE(run_program("laminate predict \"W 0.3, K 1.7\" --quiet -o " + (folder / "thin.json") + resins).exit_code ==
            0);
    for (const auto& [key, share] : {std::pair{"half", 0.5}, {"tenth", 0.1}})
        for (std::size_t slab : {0u, 1u}) {
            const double off = number(slab, fmt::format("{}_mm", key).c_str()) -
                               falls_within(folder / (slab == 0 ? "thick.json" : "thin.json"), share);
            CAPTURE(key, slab, off);
            CHECK(std::abs(off) < 4 * number(slab, fmt::format("{}_error_mm", key).c_str()));
        }
    CHECK(number(0, "tenth_mm") - falls_within(folder / "thin.json", 0.1) > 4 * number(0, "tenth_error_mm"));
    CHECK(falls_within(folder / "thick.json", 0.1) - number(1, "tenth_mm") > 4 * number(1, "tenth_error_mm"));
    CHECK(responses[0]["distance_mm"].size() == responses[0]["luminance"].size());
    CHECK(responses[0]["distance_mm"].front().get<double>() < -2);

    const Bitmap picture = read_png(folder / "1.png");
    REQUIRE(picture.height == 96);
    // Where the second slab is: evenly lit above; lit and dark below.
    CHECK(std::abs(mean_green(picture, 64, 12, 84, 20) - mean_green(picture, 64, 28, 84, 36)) < 12);
    CHECK(mean_green(picture, 64, 60, 84, 68) > mean_green(picture, 64, 76, 84, 84) + 60);
    CHECK_THAT(read_file(folder / "1.png"), Contains("light even; below the edge of a beam across ("));
}

TEST_CASE("a beam falls on bodies where it is told to, and tells why it has no figures") {
    const Folder folder("proof-beam-body");
    const std::string proof =
        "proof " + usual_stack() + " --size 64x48 --spp 8 --view front --overwrite -o " + (folder / "p.png");
    const Outcome spot = run_program(proof + " --light spot --light-width 0.5mm");
    INFO(spot.err);
    REQUIRE(spot.exit_code == 0);
    CHECK_THAT(spot.out, Contains("a spot of light, 0.5 mm wide, at (") && Contains("told of flat slabs alone"));
    CHECK_THAT(read_file(folder / "p.png"), Contains("0.5 mm wide, at ("));
    const Outcome edge = run_program(proof + " --light edge --light-at 3,0,1 --json --quiet");
    REQUIRE(edge.exit_code == 0);
    const auto beam = result_of(edge.out)["beams"][0];
    CHECK(beam["responses"].empty());
    CHECK_FALSE(beam.contains("width_mm"));
    // Of the base's front, 6 x 2 mm in the lower half of the picture, the left is lit and the right is not.
    const Bitmap picture = read_png(folder / "p.png");
    CHECK(mean_green(picture, 16, 30, 28, 40) > mean_green(picture, 40, 30, 52, 40) + 30);
}

TEST_CASE("light from behind comes through a clear slab, and what lies behind it is seen through it") {
    const Folder folder("proof-behind");
    const auto clear = voxtone::io::png_bytes({2, 2, 4, std::vector<std::uint8_t>(16, 0)});
    folder.write("clear.png", std::string(clear.begin(), clear.end()));
    REQUIRE(run_program("slice --quiet --no-report --iterations 0 --alpha translucency --width 8mm --thickness 1mm " +
                        (folder / "clear.png") + " -o " + (folder / "out"))
                .exit_code == 0);
    const auto shot = [&](const std::string& words) {
        const std::string file = folder / "shot.exr";
        const Outcome outcome =
            run_program("proof --quiet --overwrite " + (folder / "out") +
                        " --size 48x48 --spp 64 --ground none --roughness 0,0 " + words + " -o " + file);
        CAPTURE(outcome.err);
        REQUIRE(outcome.exit_code == 0);
        return read_exr(file);
    };
    const auto mean = [](const ExrNumbers& picture, int left, int top, int edge) {
        double sum = 0;
        for (int y = top; y < top + edge; ++y)
            for (int x = left; x < left + edge; ++x) sum += picture.at(x, y)[1];
        return sum / (edge * edge);
    };
    // Upright through two faces, to and fro between them: (1 - R) / (1 + R), and 2 R / (1 + R) is mirrored.
    const double eta = 1.5, R = std::pow((eta - 1) / (eta + 1), 2);
    const ExrNumbers behind = shot("--light behind");
    CHECK(mean(behind, 20, 20, 8) == Approx((1 - R) / (1 + R)).margin(0.01));
    CHECK(mean(behind, 0, 0, 2) == Approx(1).margin(1e-6));  // the source itself
    CHECK(mean(shot("--light even --backing black"), 20, 20, 8) == Approx(2 * R / (1 + R)).margin(0.01));
    CHECK(mean(shot("--light even --backing white"), 20, 20, 8) == Approx(1).margin(0.03));
    // Squares of 4 mm from the corner at the lower left on.
    const ExrNumbers checker = shot("--light even --backing checker:4mm");
    CHECK(mean(checker, 12, 28, 6) < 0.15);
    CHECK(mean(checker, 30, 28, 6) > 0.6);
    CHECK(mean(checker, 12, 12, 6) > 0.6);
    CHECK(mean(checker, 30, 12, 6) < 0.15);
    const auto refused = [&](const std::string& words, const std::string& said) {
        const Outcome outcome = run_program("proof " + (folder / "out") + " -o " + (folder / "no.png") + " " + words);
        CHECK(outcome.exit_code == 2);
        CHECK_THAT(outcome.err, Contains(said));
    };
    refused("--light behind --backing white", "between the print and --light behind");
    refused("--light behind --with-target", "leave --with-target out");
}

TEST_CASE("a proof that is stopped leaves what it has, and says so in the file") {
    const Folder folder("proof-stopped");
    const Outcome outcome = run_and_signal(
        fmt::format("proof --json {} --size 64x48 --spp 2 --error 0.0005 -o {}", usual_stack(), folder / "p.png"),
        "are wanted", SIGINT);
    INFO(outcome.out << outcome.err);
    CHECK(outcome.exit_code == 5);
    CHECK(result_of(outcome.out)["complete"] == false);
    CHECK_THAT(outcome.out, Contains("[stopped-early]"));
    CHECK_THAT(read_file(folder / "p.png"), Contains("Stopped before it was as wanted"));
}

TEST_CASE("a stack that lost its model is proofed by its voxels, which is said, and without its target") {
    const Folder folder("proof-lost");
    const std::string stack = marker_stack(folder);
    std::filesystem::remove(folder / "marker.obj");
    const Outcome outcome =
        run_program(fmt::format("proof --json {} --size 32x24 --spp 2 -o {}", stack, folder / "p.png"));
    REQUIRE(outcome.exit_code == 0);
    CHECK(result_of(outcome.out)["surface"] == nlohmann::json({"cells"}));
    CHECK_THAT(outcome.out + outcome.err, Contains("marker.obj is gone"));
    const Outcome target =
        run_program(fmt::format("proof {} --size 32x24 --with-target -o {}", stack, folder / "q.png"));
    CHECK(target.exit_code == 3);
    CHECK_THAT(target.err, Contains("--with-target") && Contains("slice again"));
}
