// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parts of a tray that are no models, as a user meets them. What their voxels are, and what is refused of them, is
// tested without the program (tests/slicer/plate).
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include <fmt/core.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "run_program.h"
#include "tests/io/files/schema.h"
#include "tests/places.h"

using namespace voxtone::test;
using nlohmann::json;

namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using Rgba = std::array<std::uint8_t, 4>;

const std::string fast = " --iterations 0 --predict none --no-report ";

json json_in(const std::string& file) { return json::parse(read_file(file)); }

/// Layers of a stack as its bitmaps have them.
class Bitmaps {
public:
    explicit Bitmaps(std::string folder) : folder_(std::move(folder)), manifest_(json_in(folder_ + "/manifest.json")) {}
    [[nodiscard]] std::array<int, 3> size() const {
        return {manifest_["size_px"][0], manifest_["size_px"][1], manifest_["layers"]};
    }
    /// Rows counted upward.
    [[nodiscard]] Rgba at(int i, int j, int k) const {
        auto [layer, is_new] = layers_.try_emplace(k);
        if (is_new) layer->second = read_png(fmt::format("{}/layers/slice_{:05}.png", folder_, k));
        return layer->second.at(i, layer->second.height - 1 - j);
    }

private:
    std::string folder_;
    json manifest_;
    mutable std::map<int, Bitmap> layers_;
};

struct Box {
    std::array<int, 3> at, size;
};
/// The first copy of a part.
Box box_of(const std::string& out, const std::string& part) {
    const json tray = json_in(out + "/tray.json");
    for (const json& one : tray["parts"])
        if (one["name"] == part) return {one["at_px"][0], one["size_px"]};
    FAIL("no part " << part);
    return {};
}

/// Voxels of a part's box that are not those of a stack.
std::size_t unlike(const Bitmaps& print, const Box& box, const Bitmaps& stack, const std::array<int, 3>& from = {}) {
    std::size_t wrong = 0;
    for (int k = 0; k < box.size[2]; ++k)
        for (int j = 0; j < box.size[1]; ++j)
            for (int i = 0; i < box.size[0]; ++i)
                wrong += print.at(box.at[0] + i, box.at[1] + j, box.at[2] + k) !=
                         stack.at(from[0] + i, from[1] + j, from[2] + k);
    return wrong;
}

std::map<Rgba, std::size_t> colours_in(const Bitmaps& print, const Box& box) {
    std::map<Rgba, std::size_t> colours;
    for (int k = 0; k < box.size[2]; ++k)
        for (int j = 0; j < box.size[1]; ++j)
            for (int i = 0; i < box.size[0]; ++i) ++colours[print.at(box.at[0] + i, box.at[1] + j, box.at[2] + k)];
    return colours;
}

std::map<std::string, std::string> layers_of(const std::string& out) {
    std::map<std::string, std::string> files;
    for (auto& [name, bytes] : read_tree(out))
        if (name.starts_with("layers/")) files.emplace(name, std::move(bytes));
    return files;
}

/// Models, a stack of one of them in `old`, with its container.
struct Shelf {
    explicit Shelf(const std::string& name) : folder("components_" + name) {
        folder.write("marker.obj", marker_obj());
        folder.write("ramp.obj", soft_box_obj(2.5, 1.5, 1.5));
    }
    void slice(const std::string& more = "", const std::string& name = "old") const {
        const Outcome made = run_program("slice " + (folder / "ramp.obj") + fast + more + " -o " + (folder / name));
        CAPTURE(made.err);
        REQUIRE(made.exit_code == 0);
    }
    [[nodiscard]] Outcome tray(const std::string& parts, const std::string& options = "") const {
        folder.write("tray.json", R"({"format": "voxtone-tray", "version": 1, "parts": [)" + parts + "]}");
        return run_program("slice " + (folder / "tray.json") + fast + options + " -o " + (folder / "out"));
    }
    Folder folder;
};

const Rgba white{220, 222, 216, 255}, cyan{0, 150, 200, 255};

}  // namespace

TEST_CASE("A tray of a model, a box, and stacks that were sliced before, voxel for voxel") {
    const Shelf shelf("voxels");
    shelf.slice("--formats png,gcvf");
    const std::string parts = R"({"model": "marker.obj"},
        {"box": [2, 1.5, 1], "mixture": {"W": 1, "C": 3}, "copies": 2, "name": "patch"},
        {"cylinder": {"diameter": 3, "height": 1}, "resin": "C", "at": [10, 10, 0.5]},
        {"stack": "old"}, {"gcvf": "old/stack.gcvf", "name": "boxed", "at": [14, 3, 0.5]})";
    const Outcome made = shelf.tray(parts);
    CAPTURE(made.err);
    REQUIRE(made.exit_code == 0);
    const std::string out = shelf.folder / "out";
    CHECK(run_program("verify --quiet " + out).exit_code == 0);
    CHECK(voxtone::io::schema_faults("tray-stack", read_file(out + "/tray.json")) == std::vector<std::string>{});
    const Bitmaps print(out), old(shelf.folder / "old");

    const Box stack = box_of(out, "old"), boxed = box_of(out, "boxed");
    CHECK(stack.size == old.size());
    CHECK(unlike(print, stack, old) == 0);
    CHECK(colours_in(old, {{}, old.size()}).size() > 3);
    // Of the container the body alone: all of this one, which fills its box.
    CHECK(boxed.size == old.size());
    CHECK(unlike(print, boxed, old) == 0);

    const Box patch = box_of(out, "patch");
    CHECK(patch.size == std::array<int, 3>{47, 18, 37});  // 1.990 x 1.524 x 0.999 mm
    const auto colours = colours_in(print, patch);
    CHECK(colours.size() == 2);
    const double voxels = 47 * 18 * 37;
    CHECK(double(colours.at(cyan)) / voxels == Approx(0.75).margin(0.01));
    CHECK(double(colours.at(white)) / voxels == Approx(0.25).margin(0.01));
    const auto round = colours_in(print, box_of(out, "cylinder"));
    CHECK(round.size() == 2);
    const double voxel_mm3 = 25.4 / 600 * 25.4 / 300 * 0.027;
    CHECK(double(round.at(cyan)) * voxel_mm3 == Approx(std::acos(-1) / 4 * 9 * 37 * 0.027).epsilon(0.005));

    const json manifest = json_in(out + "/manifest.json");
    REQUIRE(manifest["members"].size() == 5);
    CHECK(manifest["members"][1]["verdict"] == "none: component");
    CHECK(manifest["members"][1]["boxes_mm"].size() == 2);
    CHECK(manifest["members"][1]["ml"].get<double>() == Approx(2 * voxels * voxel_mm3 * 1e-3).epsilon(1e-4));
    CHECK(manifest["members"][3]["ml"] == manifest["members"][4]["ml"]);

    // The same again does nothing, shards are the same bits.
    CHECK_THAT(shelf.tray(parts).out, Contains("nothing was done"));
    const std::string cut = shelf.folder / "cut";
    for (int shard = 1; shard <= 3; ++shard)
        REQUIRE(run_program(fmt::format("slice {}{} --formats png --shard {}/3 -o {}", shelf.folder / "tray.json", fast,
                                        shard, cut))
                    .exit_code == 0);
    REQUIRE(run_program("merge --quiet " + cut).exit_code == 0);
    CHECK(layers_of(cut) == layers_of(out));
    CHECK(json_in(cut + "/tray.json")["parts"][3]["at_px"] == json_in(out + "/tray.json")["parts"][3]["at_px"]);

    // A stack that is made anew is another tray's.
    shelf.slice("--overwrite --depth 0.5mm");
    CHECK(shelf.tray(parts).exit_code == 3);
}

TEST_CASE("A stack alone in its tray is that stack again, whatever the printer wants of its bitmaps") {
    const Shelf shelf("mirrored");
    json profile = json_in(source_dir() + "/data/printers/stratasys-j750-hm.json");
    profile["flip_x"] = profile["swap_xy"] = true;
    shelf.folder.write("mirrored.json", profile.dump());
    const std::string printer = "--printer " + (shelf.folder / "mirrored.json");
    shelf.slice(printer + " --formats png,gcvf");
    CHECK(json_in(shelf.folder / "old/manifest.json")["orientation"]["flip_x"] == true);
    for (const char* part : {R"({"stack": "old"})", R"({"gcvf": "old/stack.gcvf"})"}) {
        CAPTURE(part);
        const Outcome made = shelf.tray(part, printer + " --formats png --overwrite");
        CAPTURE(made.err);
        REQUIRE(made.exit_code == 0);
        CHECK(layers_of(shelf.folder / "out") == layers_of(shelf.folder / "old"));
    }
}

TEST_CASE("A stack of other cartridges is printed by roles in a tray, and that is said") {
    const Shelf shelf("cartridges");
    shelf.slice("--resins j750-opaque --formats png,gcvf");
    for (const char* part : {R"({"stack": "old"})", R"({"gcvf": "old/stack.gcvf"})"}) {
        CAPTURE(part);
        const Outcome same = shelf.tray(part, "--resins vero-opaque --formats png --overwrite");
        CHECK(same.exit_code == 0);
        CHECK_THAT(same.err, !Contains("[cartridges]"));
        const Outcome other = shelf.tray(part, "--resins j750-vivid --formats png --overwrite");
        CHECK(other.exit_code == 0);
        CHECK_THAT(other.err, Contains("VeroMgnt as VeroMGT-V") && Contains("[cartridges]"));
        CHECK(layers_of(shelf.folder / "out") == layers_of(shelf.folder / "old"));
    }
}

TEST_CASE("A tray may be of components alone, and is estimated") {
    const Shelf shelf("alone");
    const std::string parts =
        R"({"box": [6, 4, 2], "mixture": {"C": 1, "VeroMagentaV": 1}, "copies": 3}, {"cylinder": {"diameter": 5, "height": 2}, "resin": "k"})";
    REQUIRE(shelf.tray(parts).exit_code == 0);
    const json manifest = json_in(shelf.folder / "out/manifest.json");
    std::map<std::string, double> ml;
    for (const json& resin : manifest["resins"]) ml[resin["role"]] = resin["ml"];
    CHECK(ml["C"] == Approx(3 * 0.024).epsilon(0.02));
    CHECK(ml["C"] == Approx(ml["M"]).epsilon(0.001));
    CHECK(ml["K"] == Approx(std::acos(-1) / 4 * 0.05).epsilon(0.02));
    const Outcome said = run_program("estimate --json " + (shelf.folder / "tray.json") + " --iterations 0");
    CAPTURE(said.err);
    REQUIRE(said.exit_code == 0);
    const auto begin = said.out.rfind('\n', said.out.size() - 2);
    const json estimate = json::parse(said.out.substr(begin == std::string::npos ? 0 : begin + 1))["result"];
    for (const json& resin : estimate["resins"])
        CHECK(resin["ml"].get<double>() == Approx(ml[resin["role"]]).margin(1e-4));
}

TEST_CASE("A stack that cannot be taken as it is, is refused in a sentence") {
    const Shelf shelf("refused");
    shelf.slice();
    fs::remove(shelf.folder / "old/layers/slice_00050.png");
    const Outcome said = shelf.tray(R"({"box": [1, 1, 2], "resin": "W"}, {"stack": "old"})", "--fail-fast");
    CHECK(said.exit_code == 3);
    CHECK_THAT(said.err, Contains("parts[1]") && Contains("not there") && Contains("slice_00050.png"));
    CHECK_FALSE(fs::exists(shelf.folder / "out/manifest.json"));
}

TEST_CASE("A batch looks for the components of its trays before it starts") {
    const Shelf shelf("batch");
    shelf.slice();
    shelf.folder.write("tray.json", R"({"format": "voxtone-tray", "version": 1, "parts": [
        {"box": [2, 2, 2], "resin": "W"}, {"stack": "old"}]})");
    shelf.folder.write("quick.json", R"({"format": "voxtone-job", "version": 1, "iterations": 0, "report": false})");
    const std::string words = "batch " + (shelf.folder / "tray.json") + " --preset " + (shelf.folder / "quick.json") +
                              " -o " + (shelf.folder / "jobs");
    const Outcome made = run_program(words);
    CAPTURE(made.err);
    REQUIRE(made.exit_code == 0);
    CHECK_THAT(run_program(words).out, Contains("1 before, and unchanged"));
    const std::string out = shelf.folder / "jobs/tray";
    CHECK(unlike(Bitmaps(out), box_of(out, "old"), Bitmaps(shelf.folder / "old")) == 0);
    fs::remove(shelf.folder / "old/manifest.json");
    const Outcome wrong = run_program(words);
    CHECK(wrong.exit_code == 3);
    CHECK_THAT(wrong.err, Contains("old/manifest.json") && Contains("no job was started"));
}

TEST_CASE("The report of a tray shows its components") {
    const Shelf shelf("report");
    shelf.slice();
    shelf.folder.write("tray.json", R"({"format": "voxtone-tray", "version": 1, "parts": [
        {"model": "ramp.obj", "size": "3mm"}, {"stack": "old"}, {"box": [4, 3, 2], "mixture": {"W": 1, "C": 1}}]})");
    const std::string out = shelf.folder / "out";
    const Outcome made =
        run_program("slice " + (shelf.folder / "tray.json") + " --iterations 0 --predict none -o " + out);
    CAPTURE(made.err);
    REQUIRE(made.exit_code == 0);
    CHECK_THAT(read_file(out + "/report.html"), Contains("stack, neither looped nor predicted"));
    // From above, at so many pixels a millimetre: the box is of one colour, and no other place has it.
    const Bitmap above = read_png(out + "/tray.png");
    std::map<Rgba, std::size_t> colours;
    for (const Rgba& pixel : above.pixels) ++colours[pixel];
    CHECK(colours.size() > 50);
    const auto most = [&] {
        std::size_t pixels = 0;
        for (const auto& [colour, count] : colours)
            if (colour[2] > colour[0] + 60) pixels = std::max(pixels, count);
        return pixels;
    }();
    const double px_per_mm = 20;
    CHECK(double(most) > 0.8 * 4 * 3 * px_per_mm * px_per_mm);
    CHECK(double(most) < 1.05 * 4 * 3 * px_per_mm * px_per_mm);
}

TEST_CASE("A finished job keeps its loop for one of another report or other layers") {
    const Folder folder("keep-loop");
    folder.write("ramp.obj", ramp_box_obj(3, 2, 1));
    const auto slice = [&](const std::string& options, const std::string& out) {
        const Outcome made = run_program("slice --iterations 1 --predict none --no-report " + (folder / "ramp.obj") +
                                         " " + options + " -o " + (folder / out));
        CAPTURE(made.err);
        REQUIRE(made.exit_code == 0);
        return made.err.find("the appearance loop was run before") != std::string::npos;
    };
    const std::string skin = folder / "out/skin.mixtures";
    CHECK_FALSE(slice("", "plain"));
    CHECK_FALSE(std::filesystem::exists(folder / "plain/skin.mixtures"));
    CHECK_FALSE(slice("--keep-loop", "out"));
    CHECK(layers_of(folder / "out") == layers_of(folder / "plain"));
    const std::string kept = read_file(skin);
    CHECK(slice("--keep-loop --overwrite --layers 0-20", "out"));
    CHECK_FALSE(slice("--layers 0-20", "few"));
    CHECK(layers_of(folder / "out") == layers_of(folder / "few"));
    CHECK(read_file(skin) == kept);
    // Another job's is replaced.
    CHECK_FALSE(slice("--keep-loop --overwrite --size 4mm", "out"));
    CHECK(read_file(skin) != kept);
    CHECK(slice("--keep-loop --overwrite --size 4mm --layers 0-10", "out"));
    CHECK_FALSE(std::filesystem::exists(folder / "out/loop.checkpoint"));
}

TEST_CASE("A job that was done is a part with the loop that it kept") {
    const Shelf shelf("jobs");
    const std::string looped = " --size 2mm --iterations 1 --predict none --no-report ";
    const std::string slice = "slice " + (shelf.folder / "ramp.obj") + looped + " -o " + (shelf.folder / "done");
    REQUIRE(run_program(slice + " --until loop").exit_code == 0);
    REQUIRE(run_program(slice).exit_code == 0);
    shelf.folder.write("tray.json", R"({"format": "voxtone-tray", "version": 1, "parts": [{"job": "done"}]})");
    const auto tray = [&](const std::string& options, const std::string& out) {
        const Outcome made = run_program("slice " + (shelf.folder / "tray.json") + " --predict none --no-report " +
                                         options + " -o " + (shelf.folder / out));
        CAPTURE(made.err);
        REQUIRE(made.exit_code == 0);
        return made.err;
    };
    const auto is_taken = [](const std::string& said) {
        return said.find("the appearance loop was run before") != std::string::npos &&
               said.find("is run again") == std::string::npos;
    };
    CHECK(is_taken(tray("", "out")));
    CHECK(layers_of(shelf.folder / "out") == layers_of(shelf.folder / "done"));
    const auto estimate = [&] {
        return run_program("estimate --quick " + (shelf.folder / "tray.json") + " --predict none").out;
    };
    CHECK_THAT(estimate(), !Contains("loop"));
    // And each of several, though the tray says which resins it loads and the job did not.
    shelf.folder.write("two.json",
                       R"({"format": "voxtone-tray", "version": 1, "parts": [{"job": "done"}, {"job": "done"}]})");
    const Outcome two = run_program("slice " + (shelf.folder / "two.json") +
                                    " --predict none --no-report --until loop -o " + (shelf.folder / "two"));
    CHECK_THAT(two.err, Contains("two/parts/ramp-1/skin.mixtures") && Contains("two/parts/ramp-2/skin.mixtures"));
    CHECK(is_taken(two.err));
    // Also where loops are a task of their own.
    CHECK(is_taken(tray("--until loop", "cut")));
    for (const char* shard : {"--shard 1/2", "--shard 2/2"}) CHECK(is_taken(tray(shard, "cut")));
    REQUIRE(run_program("merge --quiet " + (shelf.folder / "cut")).exit_code == 0);
    CHECK(layers_of(shelf.folder / "cut") == layers_of(shelf.folder / "done"));
    // Of another job, or not there, it is run again, and said why.
    shelf.folder.write("tray.json",
                       R"({"format": "voxtone-tray", "version": 1, "parts": [{"job": "done", "depth": "0.6mm"}]})");
    CHECK_THAT(tray("", "deep"), Contains("is run again") && Contains("of another job"));
    CHECK(layers_of(shelf.folder / "deep") != layers_of(shelf.folder / "done"));
    fs::remove(shelf.folder / "done/skin.mixtures");
    shelf.folder.write("tray.json", R"({"format": "voxtone-tray", "version": 1, "parts": [{"job": "done"}]})");
    CHECK_THAT(estimate(), Contains("loop"));
    CHECK_THAT(tray("", "again"), Contains("is run again") && Contains("kept nothing of its own"));
    CHECK(layers_of(shelf.folder / "again") == layers_of(shelf.folder / "done"));
    // A job of another printer or other resins is another print.
    for (const char* other : {"--printer stratasys-j750-hq", "--resins vero-opaque"}) {
        const Outcome refused =
            run_program("slice " + (shelf.folder / "tray.json") + fast + other + " -o " + (shelf.folder / "other"));
        CHECK(refused.exit_code == 3);
        CHECK_THAT(refused.err, Contains("parts[0]") && Contains("is a job for the"));
    }
}
