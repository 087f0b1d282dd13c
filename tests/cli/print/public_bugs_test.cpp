// SPDX-License-Identifier: GPL-3.0-or-later
//
// Public bug reports of other programs, tried on this one: tests/data/bugs/README.md. Every input gives the right
// colours, sizes and amounts, or the one sentence that its line of the table asks for: the first of each report by the
// program, once with the report's own files; where nothing but a body is asked of a line, its colours and all of others
// by the rooms that make the body.
#include <algorithm>
#include <cmath>
#include <exception>
#include <set>

#include <fmt/format.h>

#include <catch2/catch.hpp>

#include "body_of_line.h"
#include "bug_table.h"
#include "io/files/zip_reader.h"
#include "stack_voxels.h"
#include "tests/cli/run_program.h"

using namespace voxtone;
using namespace voxtone::test;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

/// Voxels of 0.2 mm, which the test body fills without a rest, and the screen that needs no making. The usual resins:
/// with white alone every colour is out of reach, and moving them takes longer than all else. The report, and with it
/// target.glb and target.png, is drawn where one of them is looked at.
std::string command(const BugLine& line, const Folder& folder) {
    const std::string file = (bug_folder() / line.file).string();
    const bool looked_at = !line.sides.empty() || !line.spots.empty() || !line.like.empty();
    if (line.verb == "slice")
        return fmt::format(
            "slice '{}' {} {} --iterations 0 --predict none --screen error-diffusion --printer '{}' -o '{}'", file,
            line.options, looked_at ? "" : "--no-report", (bug_folder() / "printer.json").string(), folder / "out");
    if (line.verb == "predict")
        return fmt::format("predict '{}' {} -o '{}'", file, line.options, folder / "target.png");
    return fmt::format("{} '{}' {}", line.verb, file, line.options);
}

void check_words(const BugLine& line, const std::string& all) {
    for (const std::string& words : line.says) CHECK_THAT(all, Contains(words));
    for (const std::string& words : line.unsaid) CHECK_THAT(all, !Contains(words));
    CHECK((all.find("LOST") != std::string::npos) == line.lost);
}

void check_refusal(const std::string& err) {
    CHECK_THAT(err, Contains("voxtone: "));
    CHECK(err.size() > 60);
}

void check_size_and_volume(const BugLine& line, const std::array<double, 3>& size_mm, double volume_mm3) {
    INFO(fmt::format("printed: {} mm3, {:.3f} x {:.3f} x {:.3f} mm", volume_mm3, size_mm[0], size_mm[1], size_mm[2]));
    constexpr double voxel = 0.2, rounding = 1e-6;
    for (std::size_t k = 0; line.size_mm && k < 3; ++k)
        CHECK(std::abs(size_mm[k] - (*line.size_mm)[k]) < voxel + rounding);
    if (line.volume_mm3) CHECK(std::abs(volume_mm3 / *line.volume_mm3 - 1) <= line.volume_error + rounding);
}

void check_sides(const BugLine& line, const fs::path& glb) {
    if (line.sides.empty()) return;
    const GlbSides target = glb_sides(glb);
    for (std::size_t k = 0; line.size_mm && k < 3; ++k) CHECK(std::abs(target.size_mm[k] - (*line.size_mm)[k]) < 0.01);
    for (const auto& [side, wanted] : line.sides) {
        INFO(side);
        CHECK(target.sides.contains(side));
        if (!target.sides.contains(side)) continue;
        const Codes& seen = target.sides.at(side);
        INFO(fmt::format("seen ({}, {}, {}), wanted ({}, {}, {})", seen[0], seen[1], seen[2], wanted[0], wanted[1],
                         wanted[2]));
        for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(seen[c] - wanted[c]) <= line.code_error);
    }
}

void check_spot(const BugLine& line, const Spot& spot, const Codes& seen) {
    INFO(fmt::format("at {}, {}: seen ({}, {}, {}), wanted ({}, {}, {})", spot.at[0], spot.at[1], seen[0], seen[1],
                     seen[2], spot.codes[0], spot.codes[1], spot.codes[2]));
    for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(seen[c] - spot.codes[c]) <= line.code_error);
}

void check_print(const BugLine& line, const fs::path& out) {
    if (line.size_mm || line.volume_mm3 || !line.top.empty()) {
        const StackVoxels voxels = stack_voxels(out);
        check_size_and_volume(line, voxels.size_mm, voxels.volume_mm3);
        for (const auto& [role, share] : line.top) {
            const double seen = voxels.top.contains(role) ? voxels.top.at(role) : -1;
            INFO(role << " in the middle from above: " << seen);
            CHECK(seen >= share[0]);
            CHECK(seen <= share[1]);
        }
    }
    check_sides(line, out / "target.glb");
}

void check_picture(const BugLine& line, const fs::path& file) {
    if (line.spots.empty()) return;
    const Bitmap picture = read_png(file.string());
    for (const Spot& spot : line.spots) {
        const auto pixel =
            picture.at(static_cast<int>(spot.at[0] * picture.width), static_cast<int>(spot.at[1] * picture.height));
        check_spot(line, spot, {pixel[0], pixel[1], pixel[2]});
    }
}

void check(const BugLine& line, const Outcome& outcome, const Folder& folder) {
    CHECK(outcome.exit_code == line.exit_code);
    check_words(line, outcome.out + outcome.err);
    if (outcome.exit_code != 0 && line.verb != "verify") check_refusal(outcome.err);
    const fs::path out = folder / "out";
    if (outcome.exit_code == 0 && line.verb == "slice") check_print(line, out);
    if (outcome.exit_code == 0)
        check_picture(line, line.verb == "slice" ? out / "target.png" : fs::path(folder / "target.png"));
    if (!line.like.empty() && outcome.exit_code == 0) {
        const Folder other("bug");
        BugLine twin = line;
        twin.file = line.like;
        CHECK(run_program(command(twin, other)).exit_code == 0);
        CHECK((read_png(folder / "target.png").pixels == read_png(other / "target.png").pixels));
    }
    if (!line.lost || line.exit_code != 0) return;
    const Folder strict("bug");
    CHECK(run_program(command(line, strict) + " --strict").exit_code == 3);
}

/// By the program.
void check_run(const BugLine& line) {
    const Folder folder("bug");
    const std::string run = command(line, folder);
    const Outcome outcome = run_program(run);
    INFO(line.id << ": " << run << "\n" << outcome.out << outcome.err);
    check(line, outcome, folder);
}

bool asks_for_a_body_alone(const BugLine& line) {
    return line.verb == "slice" && line.exit_code == 0 && line.top.empty() && line.like.empty();
}

void check_body(const BugLine& line) {
    const Folder folder("bug");
    const BodyOfLine body = body_of_line(line, folder / "target.glb");
    INFO(line.id << ": " << line.file << " " << line.options << "\n" << body.said);
    CHECK(body.exit_code == 0);
    check_words(line, body.said);
    if (body.exit_code != 0) return;
    check_size_and_volume(line, body.size_mm, body.volume_mm3);
    check_sides(line, folder / "target.glb");
    for (std::size_t s = 0; s < line.spots.size(); ++s) check_spot(line, line.spots[s], body.spots[s]);
    if (!line.lost) return;
    const BodyOfLine strict = body_of_line(line, folder / "strict.glb", true);
    CHECK(strict.exit_code == 3);
    check_refusal(strict.said);
}

BugLine without_report(BugLine line) {
    line.sides.clear();
    line.spots.clear();
    return line;
}

void check_reports(std::string_view letters, int from = 0, int to = 1000) {
    int lines = 0;
    std::set<std::string> run;
    for (const BugLine& line : bug_table()) {
        const int number = std::atoi(line.id.c_str() + 1);
        if (letters.find(line.id[0]) == std::string_view::npos || number < from || number > to) continue;
        ++lines;
        INFO(line.id << ": " << line.file);
        try {
            if (!asks_for_a_body_alone(line)) {
                check_run(line);
                continue;
            }
            const bool is_first = run.insert(line.id).second, is_first_of_all = run.size() == 1 && is_first;
            if (is_first) check_run(is_first_of_all ? line : without_report(line));
            if (!is_first_of_all) check_body(line);
        } catch (const std::exception& error) {
            FAIL_CHECK(error.what());
        }
    }
    CHECK(lines > 0);
}

}  // namespace

TEST_CASE("public bug reports: OBJ, its libraries and its colours") { check_reports("A", 0, 9); }
TEST_CASE("public bug reports: OBJ, its textures, statements and names") { check_reports("A", 10); }
TEST_CASE("public bug reports: PLY") { check_reports("B"); }
TEST_CASE("public bug reports: 3MF") { check_reports("C"); }
TEST_CASE("public bug reports: glTF") { check_reports("D"); }
TEST_CASE("public bug reports: pictures") { check_reports("E"); }
TEST_CASE("public bug reports: STL, units and numbers") { check_reports("F"); }
TEST_CASE("public bug reports: stacks of other programs") { check_reports("G"); }
TEST_CASE("public bug reports: other formats, and parts over each other") { check_reports("HI0"); }

TEST_CASE("public bug reports: compressed scenes, textures of other kinds, archives") { check_reports("MOZ"); }

TEST_CASE("no input of the public bug reports is without a line") {
    std::set<std::string> named;
    for (const BugLine& line : bug_table()) {
        INFO(line.file);
        CHECK(fs::exists(io::path_in_zip(bug_folder() / line.file).file));
        named.insert(line.file);
    }
    const std::set<std::string> models{".obj", ".ply", ".stl", ".3mf", ".glb", ".gltf", ".tif", ".jpg", ".zip"};
    std::size_t inputs = 0;
    for (const auto& entry : fs::recursive_directory_iterator(bug_folder())) {
        if (!entry.is_regular_file() || !models.contains(entry.path().extension().string())) continue;
        ++inputs;
        INFO(entry.path());
        CHECK(named.contains(fs::relative(entry.path(), bug_folder()).generic_string()));
    }
    CHECK(inputs > 200);
}
