// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/finished_stack.h"

#include <filesystem>
#include <functional>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/said_progress.h"
#include "tests/slicer/plate/common_job.h"
#include "tests/slicer/plate/written_stack.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

/// A body of resins drawn by chance, with air in it and around it.
constexpr std::array<int, 3> print_size{64, 40, 36}, body_low{30, 14, 2}, body_high{57, 33, 35};

bool is_in_body(int i, int j, int k) {
    return i >= body_low[0] && j >= body_low[1] && k >= body_low[2] && i < body_high[0] && j < body_high[1] &&
           k < body_high[2];
}

SourceVoxels drawn_voxels(int resins) {
    SourceVoxels made{print_size, {}};
    RandomStream random(5, 0);
    for (int k = 0; k < print_size[2]; ++k)
        for (int j = 0; j < print_size[1]; ++j)
            for (int i = 0; i < print_size[0]; ++i)
                made.materials.push_back(is_in_body(i, j, k) ? io::Material(random.uniform() * (resins + 1))
                                                             : io::background);
    return made;
}

/// Without what is around the body.
SourceVoxels body_of(const SourceVoxels& print) {
    SourceVoxels body;
    for (std::size_t axis = 0; axis < 3; ++axis) body.size[axis] = body_high[axis] - body_low[axis];
    for (int k = body_low[2]; k < body_high[2]; ++k)
        for (int j = body_low[1]; j < body_high[1]; ++j)
            for (int i = body_low[0]; i < body_high[0]; ++i) body.materials.push_back(print.at(i, j, k));
    return body;
}

ReadyComponent opened(ComponentKind kind, const fs::path& path, const OpenedJob& common) {
    Progress progress;
    return open_finished_stack({kind, {}, {}, path.string()}, common, progress);
}

std::string fault(ComponentKind kind, const fs::path& path, const OpenedJob& common) {
    try {
        (void)opened(kind, path, common);
        return "none";
    } catch (const Error& error) {
        return error.what();
    }
}

constexpr ComponentKind stack = ComponentKind::stack, gcvf = ComponentKind::gcvf;

}  // namespace

TEST_CASE("A finished stack is taken voxel for voxel, a container without the air around its body") {
    const io::TemporaryFolder folder;
    const OpenedJob common = common_of();
    const auto resins = common.resins.entries.size();
    const SourceVoxels print = drawn_voxels(int(resins));
    write_stack(folder.path() / "old", common, print);
    const fs::path manifest = folder.path() / "old/manifest.json", container = folder.path() / "old/stack.gcvf";

    const ReadyComponent whole = opened(stack, folder.path() / "old", common), body = opened(gcvf, container, common);
    CHECK(source_voxels(*whole.layers) == print);
    CHECK(source_voxels(*body.layers) == body_of(print));
    for (std::size_t r = 0; r < resins; ++r) {
        const auto voxels = std::uint64_t(std::ranges::count(print.materials, io::Material(r + 1)));
        CHECK(whole.voxels[r] == voxels);
        CHECK(body.voxels[r] == voxels);
    }
    CHECK(whole.files == std::vector{manifest.string()});
    CHECK(body.files == std::vector{container.string()});
    CHECK_FALSE(whole.is_one_mixture);
    // Cells of half a millimetre: 1.27 to 2.41 mm along x and 1.19 to 2.79 mm along y are taken.
    for (int x = 0; x < whole.outline.width(); ++x)
        for (int y = 0; y < whole.outline.height(); ++y) {
            CAPTURE(x, y);
            CHECK(whole.outline.at(x, y) == (x >= 2 && x <= 4 && y >= 2 && y <= 5));
        }
    CHECK(body.outline.width() == 3);
    CHECK(body.outline.height() == 4);
    CHECK(body.outline.area() == 12);
}

TEST_CASE("A finished stack lies as it was sliced, whatever its printer wants of its bitmaps") {
    const io::TemporaryFolder folder;
    const OpenedJob common = common_of();
    const SourceVoxels print = drawn_voxels(int(common.resins.entries.size()));
    for (const int bits : {1, 2, 4, 5}) {
        CAPTURE(bits);
        OpenedJob own = common;
        own.printer.orientation = {(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0};
        const fs::path out = folder.path() / std::to_string(bits);
        write_stack(out, own, print);
        CHECK(source_voxels(*opened(stack, out, own).layers) == print);
        CHECK(source_voxels(*opened(gcvf, out / "stack.gcvf", own).layers) == body_of(print));
        // For a printer that wants nothing of its bitmaps the voxels are the same, unless they are longer along the
        // other axis.
        if (!own.printer.orientation.swap_xy)
            CHECK(source_voxels(*opened(stack, out, common).layers) == print);
        else
            CHECK_THAT(fault(stack, out, common), Contains("84.67 x 42.33 x 27 um"));
    }
}

TEST_CASE("Resins of a stack are those of the tray by name, in whatever order they are loaded") {
    const io::TemporaryFolder folder;
    const OpenedJob common = common_of({}, {"C", "M", "W"}), other = common_of({}, {"W", "Y", "M", "C"});
    const SourceVoxels print = drawn_voxels(3);
    write_stack(folder.path() / "old", common, print);
    SourceVoxels wanted = print;
    for (io::Material& m : wanted.materials) m = std::array<io::Material, 4>{0, 4, 3, 1}[m];
    CHECK(source_voxels(*opened(stack, folder.path() / "old", other).layers) == wanted);
    CHECK(source_voxels(*opened(gcvf, folder.path() / "old/stack.gcvf", other).layers) == body_of(wanted));
    const OpenedJob without = common_of({}, {"W", "M"});
    CHECK_THAT(fault(stack, folder.path() / "old", without),
               Contains(common.resins.entries[0].name + ", which is not loaded") && Contains("load"));
    // Resins of another set stand for those of their roles, which is said once.
    write_stack(folder.path() / "others", common_of("vero-opaque", {"C", "M", "W"}), print);
    for (const auto& [kind, name] : {std::pair{stack, "others"}, {gcvf, "others/stack.gcvf"}}) {
        SaidProgress said;
        const ReadyComponent of_others =
            open_finished_stack({kind, {}, {}, (folder.path() / name).string()}, other, said);
        CHECK(source_voxels(*of_others.layers) == (kind == stack ? wanted : body_of(wanted)));
        CHECK_THAT(said.warnings(), Contains("[cartridges]") && Contains(" as " + other.resins.entries[0].name) &&
                                        !Contains(" as " + other.resins.entries[1].name));
    }
    // A resin that is named and fills nothing is no matter.
    SourceVoxels two = print;
    std::ranges::replace(two.materials, io::Material(1), io::Material(3));
    write_stack(folder.path() / "two", common, two);
    CHECK(fault(stack, folder.path() / "two", without) == "none");
}

TEST_CASE("A stack that cannot be taken as it is, is refused in a sentence") {
    const io::TemporaryFolder folder;
    const OpenedJob common = common_of();
    const SourceVoxels print = drawn_voxels(int(common.resins.entries.size()));
    const fs::path old = folder.path() / "old", layer = old / "layers/slice_00020.png";
    write_stack(old, common, print);
    CHECK_THAT(fault(stack, folder.path() / "gone", common), Contains("stack ") && Contains("gone is not there"));
    CHECK_THAT(fault(gcvf, folder.path() / "gone.gcvf", common), Contains("gone.gcvf is not there"));
    CHECK_THAT(fault(stack, old / "layers", common), Contains("manifest.json") && Contains("which colour"));
    CHECK_THAT(fault(stack, old / "stack.gcvf", common), Contains("is a GCVF") && Contains("\"gcvf\""));
    CHECK_THAT(fault(gcvf, old, common), Contains("is a stack") && Contains("\"stack\""));

    OpenedJob fine = common;
    fine.printer.pitch_um.z() = 14;
    write_stack(folder.path() / "fine", fine, print);
    CHECK_THAT(fault(stack, folder.path() / "fine", common),
               Contains("42.33 x 84.67 x 14 um") && Contains("42.33 x 84.67 x 27:"));
    write_stack(folder.path() / "air", common,
                {print_size, std::vector<io::Material>(print.materials.size(), io::background)});
    CHECK_THAT(fault(stack, folder.path() / "air", common), Contains("holds no voxel of a resin"));

    // Another layer than was written, one that is cut off, one that is gone.
    const std::string good = io::text_of(layer), manifest = io::text_of(old / "manifest.json");
    fs::copy_file(old / "layers/slice_00030.png", layer, fs::copy_options::overwrite_existing);
    CHECK_THAT(fault(stack, old, common), Contains("other voxels than its manifest.json says"));
    std::ofstream(layer, std::ios::binary) << good.substr(0, 40);
    CHECK_THAT(fault(stack, old, common), Contains("slice_00020.png"));
    fs::remove(layer);
    CHECK_THAT(fault(stack, old, common), Contains("not there") && Contains("slice_00020.png"));
    std::ofstream(layer, std::ios::binary) << good;
    CHECK(fault(stack, old, common) == "none");
    std::string changed = manifest;
    const std::string& name = common.resins.entries[0].name;
    changed.replace(changed.find(name), name.size(), std::string(name.size(), 'x'));
    std::ofstream(old / "manifest.json") << changed;
    CHECK_THAT(fault(stack, old, common), Contains("was changed after it was written"));
    fs::resize_file(old / "stack.gcvf", 3000);
    CHECK_THAT(fault(gcvf, old / "stack.gcvf", common), Contains("stack.gcvf"));
}
