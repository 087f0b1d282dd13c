// SPDX-License-Identifier: GPL-3.0-or-later
//
// --illuminant through the whole program, with vero-opaque's R, G, B taken for 610, 550 and 450 nm. What a prediction
// holds by channel is linear in its colour: colours by day say what they are under a lamp, by weights of a numpy script
// over the CIE's tables (1931 observer, Bradford) that shares nothing with the program.
#include <array>
#include <string>

#include <fmt/core.h>
#include <Eigen/LU>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "io/profiles/resin_file.h"
#include "run_program.h"
#include "tests/places.h"

using namespace voxtone;
using namespace voxtone::test;

namespace {

const std::string picture = source_dir() + "/examples/models/spot/spot_texture.png";

std::string spectral_set(const Folder& folder) {
    optics::ResinSet set = io::find_resin_set("vero-opaque");
    set.channels.wavelengths_nm = {450, 550, 610};
    for (optics::Resin& resin : set.resins) {
        std::swap(resin.sigma_t_per_mm[0], resin.sigma_t_per_mm[2]);
        std::swap(resin.albedo[0], resin.albedo[2]);
    }
    folder.write("spectral.json", io::resin_set_text(set));
    return folder / "spectral.json";
}

void slice(const Folder& folder, const std::string& resins, const std::string& lamp, const std::string& out) {
    const Outcome sliced =
        run_program(fmt::format("slice --quiet {} --width 3mm --thickness 1mm --resins {} --illuminant {} --iterations "
                                "0 --predict none -o {}",
                                picture, resins, lamp, folder / out));
    INFO(sliced.out << sliced.err);
    REQUIRE(sliced.exit_code == 0);
}

nlohmann::json predict(const Folder& folder, const std::string& stack, const std::string& more) {
    const Outcome outcome = run_program(
        fmt::format("predict --overwrite --json {} {} -o {}", folder / stack, more, folder / (stack + ".exr")));
    INFO(outcome.out << outcome.err);
    REQUIRE(outcome.exit_code == 0);
    const std::size_t begin = outcome.out.rfind('\n', outcome.out.size() - 2);
    return nlohmann::json::parse(outcome.out.substr(begin == std::string::npos ? 0 : begin + 1)).at("result");
}

Eigen::Vector3d mean(const nlohmann::json& result) {
    const auto rgb = result.at("mean_rgb").get<std::array<double, 3>>();
    return {rgb[0], rgb[1], rgb[2]};
}

}  // namespace

TEST_CASE("A print is seen, and sliced, under the lamp that it is asked for", "[slow]") {
    const Folder folder("lamp");
    const std::string set = spectral_set(folder);
    Eigen::Matrix3d by_day, under_a, under_f11;
    by_day << -0.107924, -0.040028, 1.147953, 0.115152, 0.805625, 0.079224, 0.996659, 0.036234, -0.032892;
    under_a << -0.138453, -0.215645, 1.354098, 0.099235, 0.785287, 0.115478, 0.980291, 0.056842, -0.037133;
    under_f11 << -0.045586, -0.237764, 1.283350, 0.027625, 0.922971, 0.049404, 1.050235, -0.020232, -0.030003;

    slice(folder, set, "D65", "day");
    const Eigen::Vector3d day = mean(predict(folder, "day", "--absolute"));
    const Eigen::Vector3d by_channel = by_day.inverse() * day;
    const auto a = predict(folder, "day", "--absolute --illuminant A");
    CHECK(a.at("illuminant") == "A");
    CHECK((mean(a) - under_a * by_channel).cwiseAbs().maxCoeff() < 2e-4);
    const auto f11 = predict(folder, "day", "--absolute --illuminant F11");
    CHECK((mean(f11) - under_f11 * by_channel).cwiseAbs().maxCoeff() < 2e-4);
    CHECK((mean(f11) - day).cwiseAbs().maxCoeff() > 2e-3);  // ten times what it may be off

    // A print for that lamp looks under it as the other does by day, and is looked at under it without a word.
    slice(folder, set, "F11", "shop");
    const auto shop = predict(folder, "shop", "");
    CHECK(shop.at("illuminant") == "F11");
    const Eigen::Vector3d wanted = mean(predict(folder, "day", ""));
    const double off = (mean(shop) - wanted).norm();
    CHECK(off < 0.5 * (mean(predict(folder, "day", "--illuminant F11")) - wanted).norm());
}

TEST_CASE("Parts of a tray are seen under the lamps that they were made for, all of them under one that is named",
          "[slow]") {
    const Folder folder("lamp_tray");
    const auto plan = [&](const std::string& first, const std::string& second) {
        const auto part = [&](const std::string& name, const std::string& lamp) {
            return nlohmann::json{
                {"model", picture}, {"name", name}, {"illuminant", lamp}, {"width", "3mm"}, {"thickness", "1mm"}};
        };
        folder.write("tray.json", nlohmann::json{{"format", "voxtone-tray"},
                                                 {"version", 1},
                                                 {"parts", {part("day", first), part("shop", second)}}}
                                      .dump());
        const Outcome sliced = run_program(fmt::format(
            "slice --quiet --overwrite {} --iterations 0 --predict none -o {}", folder / "tray.json", folder / "out"));
        INFO(sliced.err);
        REQUIRE(sliced.exit_code == 0);
    };
    plan("D65", "A");
    CHECK(predict(folder, "out/parts/day", "").at("illuminant") == "D65");
    const auto shop = predict(folder, "out/parts/shop", "");
    CHECK(shop.at("illuminant") == "A");
    CHECK((mean(shop) - mean(predict(folder, "out/parts/shop", "--illuminant D65"))).norm() > 1e-3);
    const std::string whole =
        fmt::format("predict --view top --overwrite {} -o {} ", folder / "out", folder / "all.exr");
    const Outcome refused = run_program(whole);
    CHECK(refused.exit_code == 3);
    CHECK(refused.err.find("no lamp shows both so: name one with --illuminant") != std::string::npos);
    CHECK(predict(folder, "out", "--view top --illuminant A").at("illuminant") == "A");
    plan("A", "A");
    CHECK(predict(folder, "out", "--view top").at("illuminant") == "A");
}

TEST_CASE("A lamp is a file that job.json finds again, and a guess for sets without wavelengths") {
    const Folder folder("lamp_file");
    folder.write("led.csv", "nm,power\n380,0\n450,10\n500,3\n600,8\n780,0\n");
    slice(folder, "vero-opaque", folder / "led.csv", "guessed");
    const auto job = nlohmann::json::parse(read_file(folder / "guessed/job.json"));
    CHECK(job.at("illuminant") == "../led.csv");
    CHECK(job.dump().find("\"input\":\"illuminant\"") != std::string::npos);
    const Outcome seen = run_program(fmt::format("predict {} -o {}", folder / "guessed", folder / "guessed.exr"));
    CHECK(seen.exit_code == 0);
    CHECK(seen.err.find("[guessed-light]") != std::string::npos);

    const Outcome refused =
        run_program(fmt::format("predict {} --illuminant sun -o {}", folder / "guessed", folder / "sun.exr"));
    CHECK(refused.exit_code == 3);
    CHECK(refused.err.find("--illuminant sun: there is no such lamp") != std::string::npos);
}
