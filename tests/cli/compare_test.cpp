// SPDX-License-Identifier: GPL-3.0-or-later
//
// `compare` on photographs of prints that the fast predictor did not make: Monte Carlo pictures before the camera of
// the rehearsals, developed to JPEG as a phone does. Once as a user runs it, which is what its job alone makes of the
// same prediction; what else is asked of it is asked of that job: each run by itself would trace eight million paths.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <variant>

#include <fmt/format.h>
#include <jpeglib.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "calibration/compare/compare_job.h"
#include "calibration/compare/print_difference.h"
#include "io/files/whole_file.h"
#include "io/pictures/photograph.h"
#include "io/pictures/picture_writer.h"
#include "io/pictures/srgb_code.h"
#include "io/profiles/resin_file.h"
#include "optics/camera/camera.h"
#include "optics/colour/colour.h"
#include "optics/layered/flat_colour.h"
#include "run_program.h"
#include "slicer/predict/top_print.h"
#include "tests/calibration/compare/compare_samples.h"
#include "tests/io/files/schema.h"
#include "tests/outcomes.h"
#include "tests/places.h"

using namespace voxtone;
using namespace voxtone::test;
using calibration::testing::hand_camera;
using Catch::Matchers::Contains;

namespace {

/// Patches of many colours under discs, 144 x 96 pixels.
void write_picture(const std::string& file) {
    io::Picture8 picture{144, 96, 3, std::vector<std::uint8_t>(std::size_t(144 * 96 * 3), 230)};
    RandomStream random(7, 0);
    const auto paint = [&](auto&& inside) {
        std::array<std::uint8_t, 3> code{};
        for (std::uint8_t& value : code) value = std::uint8_t(20 + 225 * random.uniform());
        for (int y = 0; y < 96; ++y)
            for (int x = 0; x < 144; ++x)
                if (inside(x, y)) std::copy(code.begin(), code.end(), picture.codes.begin() + 3 * (y * 144 + x));
    };
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 6; ++column)
            paint([&](int x, int y) { return x / 24 == column && x % 24 > 3 && y / 32 == row && y % 32 > 5; });
    for (int disc = 0; disc < 14; ++disc) {
        const double u = 144 * random.uniform(), v = 96 * random.uniform(), r = 2 + 4 * random.uniform();
        paint([&](int x, int y) { return std::hypot(x - u, y - v) < r; });
    }
    io::write_whole_file(file, io::png_bytes(picture));
}

/// 12 x 8 x 2 mm; sliced once for all.
struct Sliced {
    Folder folder{"compare"};
    std::string stack = folder / "out";
    Sliced() {
        write_picture(folder / "picture.png");
        const Outcome made = run_program(
            "slice --quiet --no-report --iterations 0 --predict none --width 12mm "
            "--thickness 2mm " +
            folder / "picture.png" + " -o " + stack);
        INFO(made.err);
        REQUIRE(made.exit_code == 0);
    }
};
const Sliced& sliced() {
    static const Sliced made;
    return made;
}

calibration::PredictedPrint print_of(const slicer::PredictOptions& options, const slicer::TopPrint& top) {
    calibration::PredictedPrint print;
    print.name = options.stack;
    print.columns = top.columns, print.rows = top.rows;
    print.cell_mm = {top.cell_mm[0], top.cell_mm[1]};
    print.rgb = top.rgb;
    print.by_paths = top.rgb;
    print.set = top.set;
    print.seen = slicer::eye_over(top, 300);
    return print;
}

calibration::PredictedPrint predicted(const slicer::PredictOptions& options) {
    Progress silent;
    return print_of(options, slicer::predict_top_picture(options, silent));
}

/// As the program predicts it for a comparison, light paths and all.
const calibration::PredictedPrint& foretold() {
    static const calibration::PredictedPrint made = [] {
        slicer::PredictOptions options;
        options.stack = sliced().stack;
        Progress silent;
        const auto top = std::get<slicer::TopPrint>(
            slicer::predict_photographed(options, slicer::ResinParts::extinction_and_absorption, silent));
        calibration::PredictedPrint print = print_of(options, top);
        print.model = "transport";
        print.by_paths = top.by_paths;
        print.response = {.columns = top.response.columns,
                          .rows = top.response.rows,
                          .channels = top.response.channels,
                          .resins = top.response.resins,
                          .value = top.response.value,
                          .by_extinction = top.response.by_extinction,
                          .by_absorption = top.response.by_absorption};
        return print;
    }();
    return made;
}

/// As it is taken for printed: by light paths, 128 a cell, with resins of this set.
calibration::PredictedPrint printed(const std::string& resins = {}) {
    slicer::PredictOptions options;
    options.stack = sliced().stack;
    options.model = "monte-carlo";
    options.quality.paths = 128;
    options.resins = resins;
    return predicted(options);
}
const calibration::PredictedPrint& as_foretold() {
    static const calibration::PredictedPrint print = printed();
    return print;
}

void write_jpeg(const std::string& file, const io::Photograph& photo) {
    std::FILE* out = std::fopen(file.c_str(), "wb");
    REQUIRE(out != nullptr);
    jpeg_compress_struct info{};
    jpeg_error_mgr errors{};
    info.err = jpeg_std_error(&errors);
    jpeg_create_compress(&info);
    jpeg_stdio_dest(&info, out);
    info.image_width = photo.width_px;
    info.image_height = photo.height_px;
    info.input_components = 3;
    info.in_color_space = JCS_RGB;
    jpeg_set_defaults(&info);
    jpeg_set_quality(&info, 92, TRUE);
    jpeg_start_compress(&info, TRUE);
    std::vector<std::uint8_t> row(std::size_t{3} * photo.width_px);
    for (std::uint32_t y = 0; y < photo.height_px; ++y) {
        for (std::uint32_t x = 0; x < photo.width_px; ++x)
            for (int c = 0; c < 3; ++c)
                row[3 * x + std::size_t(c)] = io::linear_to_srgb8(photo.pixels[photo.index(x, y)][c]);
        std::uint8_t* rows = row.data();
        jpeg_write_scanlines(&info, &rows, 1);
    }
    jpeg_finish_compress(&info);
    jpeg_destroy_compress(&info);
    std::fclose(out);
}

std::string photographed(const Folder& folder, const calibration::PredictedPrint& print,
                         const calibration::PhotoOptions& camera, double blur_mm = 0) {
    const std::string file = folder / "photograph.jpg";
    write_jpeg(file, simulate_photo(calibration::testing::thing_of(print, blur_mm),
                                    calibration::find_checker("colorchecker24"), camera)
                         .photograph);
    return file;
}

struct Compared {
    nlohmann::json json;
    std::string warnings;
};

/// The job, of what is foretold. Throws as it does.
Compared compared_with_foretold(const Folder& folder, const std::string& photograph, bool refit = false) {
    class Listens final : public Progress {
    public:
        std::string told;

    private:
        void on_warning(const std::string& message) override { told += message + "\n"; }
    } progress;
    calibration::CompareJob job;
    job.photos = {photograph};
    job.stack = sliced().stack;
    job.out = folder / "compared";
    job.overwrite = true;
    job.refit = refit;
    const JobResult made = run_compare_job(
        job, [](Progress&) { return foretold(); }, progress);
    return {nlohmann::json::parse(made.json), progress.told};
}

Outcome compare(const Folder& folder, const std::string& photograph, const std::string& more = "") {
    return run_program("compare --quiet --json --overwrite " + more + " " + photograph + " " + sliced().stack + " -o " +
                       folder / "compared");
}

nlohmann::json comparison(const Folder& folder, const std::string& photograph, const std::string& more = "") {
    const Outcome outcome = compare(folder, photograph, more);
    INFO(outcome.out << outcome.err);
    REQUIRE(outcome.exit_code == 0);
    const std::string json = read_file(folder / "compared/compare.json");
    CHECK(io::schema_faults("compare", json) == std::vector<std::string>{});
    return nlohmann::json::parse(json);
}

bool names(const nlohmann::json& compared, const std::string& cause) {
    for (const std::string sentence : compared["causes"])
        if (sentence.starts_with(cause)) return true;
    return false;
}

}  // namespace

TEST_CASE("a photographed print differs by as much as the print itself does") {
    const Folder folder("true");
    slicer::PredictOptions options;
    options.stack = sliced().stack;
    calibration::PrintReading exact;
    exact.cells.value = as_foretold().rgb;
    exact.cells.good.assign(as_foretold().cells(), 1);
    const double truth = difference_of(predicted(options), {exact}).ciede2000.mean;

    const std::string photograph = photographed(folder, as_foretold(), hand_camera());
    const nlohmann::json compared = comparison(folder, photograph, "--refit");
    const std::string regions = read_file(folder / "compared/regions.json");
    CHECK(io::schema_faults("print-regions", regions) == std::vector<std::string>{});
    CHECK(compared["ciede2000"]["mean"].get<double>() == Approx(truth).margin(0.4));
    CHECK(compared["photographs"][0]["correlation"] > 0.8);
    CHECK(compared["photographs"][0]["light"] == "ground");
    CHECK_FALSE(names(compared, "resin"));
    CHECK_FALSE(names(compared, "blur"));
    const std::string page = read_file(folder / "compared/compare.html");
    CHECK_THAT(page, Contains("Printed and predicted") && Contains("than predicted") && Contains("id=\"cut\""));
    CHECK(compared_with_foretold(folder, photograph, true).json == compared);
    CHECK(read_file(folder / "compared/regions.json") == regions);
}

TEST_CASE("a comparison says by which lamp, and refits by daylight alone") {
    const Folder folder("lamp");
    const std::string photograph = photographed(folder, as_foretold(), hand_camera());
    const nlohmann::json under_a = comparison(folder, photograph, "--illuminant A");
    CHECK(under_a["illuminant"] == "A");
    CHECK_THAT(read_file(folder / "compared/compare.html"), Contains(" under A"));
    CHECK(compared_with_foretold(folder, photograph).json["illuminant"] == "D65");

    const Outcome refused = compare(folder, photograph, "--illuminant A --refit");
    CHECK(refused.exit_code == 2);
    CHECK_THAT(refused.out, Contains("is looked at under A") && Contains("give --illuminant D65"));
    CHECK(compare(folder, photograph, "--illuminant sun").exit_code == 3);
}

TEST_CASE("a rehearsal prints with the resins of the print's job where none are named") {
    const Folder folder("rehearsal");
    const auto rehearsed = [&](const std::string& resins) {
        const std::string file = folder / ("photograph" + resins + ".png");
        const Outcome outcome =
            run_program("calibrate simulate --quiet --no-checker --width 120 --height 90 --paths 2 " +
                        (resins.empty() ? "" : "--resins " + resins + " ") + sliced().stack + " -o " + file);
        INFO(outcome.err);
        REQUIRE(outcome.exit_code == 0);
        return read_file(file);
    };
    const std::string usual = rehearsed("");
    CHECK(usual == rehearsed("j750-vivid"));
    CHECK(usual != rehearsed("vero-opaque"));
}

TEST_CASE("an exposure larger by 0.3 EV is told as that, and as nothing else") {
    const Folder folder("exposure");
    calibration::PhotoOptions camera = hand_camera();
    camera.exposure = 0.7;
    const nlohmann::json usual = compared_with_foretold(folder, photographed(folder, as_foretold(), camera)).json;
    camera.exposure *= std::exp2(0.3);
    const nlohmann::json more = compared_with_foretold(folder, photographed(folder, as_foretold(), camera)).json;
    CHECK(more["exposure_ev"].get<double>() - usual["exposure_ev"].get<double>() == Approx(0.3).margin(0.03));
    CHECK(more["ciede2000"]["mean"].get<double>() == Approx(usual["ciede2000"]["mean"].get<double>()).margin(0.1));
    CHECK(names(usual, "exposure"));
}

TEST_CASE("droplets that spread by 0.06 mm are told as blur") {
    const Folder folder("blur");
    const nlohmann::json compared =
        compared_with_foretold(folder, photographed(folder, as_foretold(), hand_camera(), 0.06)).json;
    CHECK(names(compared, "blur"));
    CHECK(compared["blur_mm"]["print"].get<double>() == Approx(0.06).margin(0.02));
    CHECK_FALSE(names(compared, "resin"));
}

TEST_CASE("a resin whose extinction is off by a tenth is named, and the set is made better") {
    const Folder folder("resin");
    const optics::ResinSet usual = io::find_resin_set("j750-vivid");
    optics::ResinSet set = usual;
    const auto magenta = std::size_t(set.find("M"));
    for (double& sigma_t : set.resins[magenta].sigma_t_per_mm) sigma_t *= 1.1;
    io::write_whole_file(folder / "changed.json", io::resin_set_text(set));
    const nlohmann::json changed =
        compared_with_foretold(folder, photographed(folder, printed(folder / "changed.json"), hand_camera()), true)
            .json;
    CHECK(names(changed, "resin: VeroMagentaV"));
    CHECK(changed["resins"][1]["extinction_change"].get<double>() == Approx(0.1).margin(0.03));

    const Outcome fit = run_program("calibrate fit --json --quiet " + folder / "compared/regions.json" +
                                    " --prior j750-vivid -o " + folder / "better.json");
    INFO(fit.out << fit.err);
    REQUIRE(fit.exit_code == 0);
    const optics::ResinSet better = io::read_resin_set(folder / "better.json");
    // Thick mixtures that were not printed, by the set that the print was made of.
    const optics::FlatColour truth(set), before(usual), after(better);
    RandomStream random(3, 0);
    double error_before = 0, error_after = 0;
    for (int i = 0; i < 200; ++i) {
        std::vector<double> shares(5, 0.0);
        shares[magenta] = 0.5 * random.uniform();
        shares[std::size_t(i % 4)] += 0.4 * random.uniform();
        for (const double ink : std::vector<double>(shares.begin(), shares.begin() + 4)) shares[4] += ink;
        shares[4] = 1 - shares[4];
        error_before += optics::ciede2000(truth.lab(shares), before.lab(shares));
        error_after += optics::ciede2000(truth.lab(shares), after.lab(shares));
    }
    CHECK(error_after < 0.6 * error_before);
    CHECK(run_program("calibrate fit " + folder / "compared/regions.json" + " " + folder / "better.json -o " +
                      folder / "none.json")
              .exit_code == 3);
}

TEST_CASE("what cannot be compared is told in a sentence") {
    const Folder folder("refused");
    const std::string photo = photographed(folder, calibration::testing::discs(), hand_camera());
    CHECK_THROWS_WITH(compared_with_foretold(folder, photo), Contains("is no photograph of"));
    CHECK(run_program("compare " + photo + " -o " + folder / "a").exit_code == 2);
    CHECK_THAT(compare(folder, photo, "--view front").out, Contains("--view: would be ignored") && Contains("is flat"));
    folder.write("no.nef", "MM no picture");
    CHECK_THAT(compare(folder, folder / "no.nef").out, Contains("no.nef"));
    const Outcome none = run_program("compare " + photo + " " + folder / "nothing" + " -o " + folder / "b");
    CHECK(none.exit_code != 0);
    CHECK_THAT(none.err, Contains("nothing"));
    calibration::PhotoOptions camera = hand_camera();
    camera.sheet = 0;
    camera.electrons = 0;
    CHECK_THAT(compared_with_foretold(folder, photographed(folder, as_foretold(), camera)).warnings,
               Contains("stays in the comparison. [uneven-ground]"));
    camera = hand_camera();
    camera.exposure = 1.8;
    CHECK_THAT(compared_with_foretold(folder, photographed(folder, as_foretold(), camera)).warnings,
               Contains("were left out. [clipped-print]"));
}

namespace {

/// A cow of 8 mm, and `proof`'s picture of it by light paths from beside its front, above dark ground.
struct Cow {
    Folder folder{"compare-body"};
    std::string stack = folder / "cow", photograph = folder / "cow.png";
    const optics::Camera truth{
        {.position = {8.8, -22.4, 8.8}, .target = {2.2, 4, 3.9}, .focal_mm = 85, .width_px = 400, .height_px = 320}};
    Cow() {
        const Outcome made = run_program(
            fmt::format("slice --quiet --no-report --iterations 0 --predict none --size 8mm --rotate x90,z180 "
                        "{}/examples/models/spot/spot.obj -o {}",
                        source_dir(), stack));
        INFO(made.err);
        REQUIRE(made.exit_code == 0);
        const Outcome seen = run_program(
            "proof --quiet --camera 8.8,-22.4,8.8 --look-at 2.2,4,3.9 --size 400x320 --spp 16 "
            "--ground 0.18 --light overcast " +
            stack + " -o " + photograph);
        INFO(seen.err);
        REQUIRE(seen.exit_code == 0);
    }
};
const Cow& cow() {
    static const Cow made;
    return made;
}

Outcome compare_cow(const Folder& folder, const std::string& photograph, const std::string& more) {
    return run_program("compare --quiet --json --overwrite " + photograph + " " + cow().stack + " -o " +
                       folder / "compared" + " " + more);
}

optics::Point point_at(const nlohmann::json& list) { return {list[0], list[1], list[2]}; }

}  // namespace

TEST_CASE("a body's camera is found, and how far it differs", "[slow]") {
    const Folder folder("body");
    const Outcome outcome = compare_cow(folder, cow().photograph, "--view front");
    INFO(outcome.out << outcome.err);
    REQUIRE(outcome.exit_code == 0);
    const std::string text = read_file(folder / "compared/compare.json");
    CHECK(io::schema_faults("compare", text) == std::vector<std::string>{});
    const nlohmann::json compared = nlohmann::json::parse(text), &seen = compared["photographs"][0];
    CHECK(seen["light"] == "body");
    CHECK(seen["overlap"] > 0.95);
    const optics::Camera found({.position = point_at(seen["camera"]["position_mm"]),
                                .target = point_at(seen["camera"]["look_at_mm"]),
                                .up = point_at(seen["camera"]["up"]),
                                .focal_mm = seen["camera"]["focal_mm"],
                                .width_px = 400,
                                .height_px = 320});
    double squares = 0;
    for (int corner = 0; corner < 8; ++corner) {  // of a box in it
        const optics::Point p{corner & 1 ? 3.5 : 0.8, corner & 2 ? 3 : 0.5, corner & 4 ? 6.5 : 1};
        const auto a = cow().truth.picture_of(p), b = found.picture_of(p);
        squares += (std::pow(a[0] - b[0], 2) + std::pow(a[1] - b[1], 2)) / 8;
    }
    const double off = std::sqrt(squares) / seen["px_per_cell"].get<double>();
    CHECK(off < 0.5);
    WANTED(off < 0.25);
    CHECK(compared["ciede2000"]["mean"] < 2.5);
    const std::string page = read_file(folder / "compared/compare.html");
    CHECK_THAT(page, Contains("the light is found on the body") && !Contains("How far each resin"));
}

TEST_CASE("a body's photographs that cannot be compared are told in a sentence", "[slow]") {
    const Folder folder("body-refused");
    const auto said = [&](const std::string& photograph, const std::string& more) {
        const Outcome outcome = compare_cow(folder, photograph, more);
        CHECK(outcome.exit_code != 0);
        return outcome.out + outcome.err;
    };
    CHECK_THAT(said(cow().photograph, "--view back"), Contains("is seen from another side: --view"));
    CHECK_THAT(said(photographed(folder, calibration::testing::discs(), hand_camera()), "--view front"),
               Contains("this is no photograph of"));
    CHECK_THAT(said(cow().photograph, "--refit"), Contains("--refit") && Contains("is a body"));
    CHECK_THAT(said(cow().photograph, "--corners 1,1,9,1,9,9,1,9"), Contains("--corners") && Contains("is a body"));
}
