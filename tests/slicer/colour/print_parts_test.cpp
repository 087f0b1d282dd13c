// SPDX-License-Identifier: GPL-3.0-or-later
//
// The voxels of a small box as the loop and its prediction see them: its shape, its print, and both without a coat.
#include "slicer/colour/print_parts.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "slicer/colour/job_loop.h"
#include "slicer/colour/skin_gradient.h"
#include "slicer/colour/viewed_cells.h"
#include "tests/slicer/layers/made_voxels.h"
#include "tests/slicer/print/sample_body.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

constexpr double coat_mm = 0.3, depth_mm = 0.4;
constexpr std::uint64_t plenty = std::uint64_t{1} << 30;
// As the built-in screen has them, twice as large.
const Vector3d pitch_mm(2 * 25.4 / 600, 2 * 25.4 / 300, 2 * 0.027);

optics::ResinSet with_clear() {
    optics::ResinSet set = optics::vero_opaque();
    set.resins.push_back({"Clear", "T", {0, 0, 0}, {0.1, 0.1, 0.1}});
    return set.subset(std::vector<std::string>{"K", "W", "T"});
}

/// A grey box of 3 x 3.2 x 2.2 mm over white, in black, white and clear resin.
struct GreyBox {
    /// `is_jelly`: alpha from 0.1 to 1 over each face.
    explicit GreyBox(double coat = 0, bool is_jelly = false) {
        resins.set = with_clear(), resins.core = 1, resins.entries.resize(3);
        job.colour.depth_mm = depth_mm, job.colour.coat_mm = coat;
        body = test::body_of(shapes::box({0, 0, 0}, {3, 3.2, 2.2}), pitch_mm,
                             std::vector<Vector3f>(12, Vector3f::Constant(0.2f)));
        if (is_jelly) body.model.mesh.corner_alpha.assign(12, {0.1f, 0.6f, 1.0f});
        geometry.core_resin = geometry.white_resin = 1, geometry.shell_mm = depth_mm;
        geometry.over_mm = coat, geometry.clear_resin = coat > 0 ? 2 : -1;
        colour = std::make_unique<const JobColour>(resins.set, geometry);
        parts = std::make_unique<const PrintParts>(job, body, resins, *colour, Progress());
    }
    /// Of a voxel's middle below the nearest face; of a box of whole mm.
    [[nodiscard]] double depth(int i, int j, int k) const {
        const Vector3d at = body.grid.centre(i, j, k), to = Vector3d(3, 3.2, 2.2) - at;
        return std::min(at.minCoeff(), to.minCoeff());
    }
    template <class Visit>
    void for_each(const Visit& visit) const {
        for (int k = 0; k < body.grid.size[2]; ++k)
            for (int j = 0; j < body.grid.size[1]; ++j)
                for (int i = 0; i < body.grid.size[0]; ++i) visit(i, j, k);
    }
    ResolvedJob job;
    LoadedResins resins;
    JobBody body;
    optics::ShellGeometry geometry;
    std::unique_ptr<const JobColour> colour;
    std::unique_ptr<const PrintParts> parts;
};

const GreyBox& bare() {
    static const GreyBox one;
    return one;
}
const GreyBox& coated() {
    static const GreyBox one(coat_mm);
    return one;
}

}  // namespace

TEST_CASE("A print's shape is of one material throughout, whichever is asked for") {
    for (const optics::Material material : {optics::Material{1}, optics::Material{2}, optics::Material{7}}) {
        const optics::ResinVolume shape = bare().parts->shape(material, plenty, Progress());
        CHECK(shape.size() == bare().body.grid.size);
        CHECK(shape.pitch_mm()[1] == Approx(pitch_mm.y()));
        CHECK(shape.count()[material] == bare().body.grid.voxels());
    }
    CHECK_THROWS_AS(bare().parts->shape(1, 10, Progress()), ResourceError);
}

TEST_CASE("A print as a volume has the voxels of its layers: core below the shell, mixtures of the others above") {
    const optics::ResinVolume print = bare().parts->volume(nullptr, plenty, Progress());
    const test::MadeVoxels layers = test::made_voxels(bare().parts->sources(nullptr));
    int unlike = 0, wrong_core = 0, black = 0, shell = 0;
    bare().for_each([&](int i, int j, int k) {
        const optics::Material material = print.at(i, j, k);
        unlike += material != layers.at(i, j, k);
        const double depth = bare().depth(i, j, k);
        if (depth > depth_mm + 0.01) wrong_core += material != 2;
        if (depth < depth_mm - 0.01) ++shell, black += material == 1;
    });
    CHECK((unlike == 0 && wrong_core == 0));
    // As much black as the separation asks for.
    const double share = bare().colour->separation.fractions(Vector3f::Constant(0.2f))[0];
    CHECK(double(black) / shell == Approx(share).margin(0.02));
}

TEST_CASE("What is looked at is bare of its coat, and else the voxels that are printed") {
    const GreyBox& box = coated();
    CHECK(box.parts->zones().clear == 2);
    const test::MadeVoxels layers = test::made_voxels(box.parts->sources(nullptr));
    const optics::ResinVolume seen = box.parts->volume(nullptr, plenty, Progress()),
                              shape = box.parts->shape(7, plenty, Progress());
    int in_coat = 0, wrong = 0, of_shape = 0, clear = 0;
    box.for_each([&](int i, int j, int k) {
        const double depth = box.depth(i, j, k);
        if (depth < coat_mm - 0.01) {
            ++in_coat, clear += layers.at(i, j, k) == 3;
            wrong += seen.at(i, j, k) != optics::air, of_shape += shape.at(i, j, k) != optics::air;
        } else if (depth > coat_mm + 0.01) {
            wrong += seen.at(i, j, k) != layers.at(i, j, k), of_shape += shape.at(i, j, k) != 7;
        }
    });
    CHECK((in_coat > 1000 && clear == in_coat));
    CHECK((wrong == 0 && of_shape == 0));
}

TEST_CASE("Blocks of a box of voxels are those that touch it, and all of them have all of the shell") {
    const auto visited = [&](const optics::VoxelBox& box) {
        std::set<std::array<int, 3>> voxels;
        std::mutex mutex;
        bare().parts->for_each_block(
            box,
            [&](const ShellBlock& block) {
                const std::scoped_lock lock(mutex);
                for_each_shell_voxel(block, [&](int row, int lane) {
                    voxels.insert({block.origin[0] + lane, block.origin[1] + row % block.size[1],
                                   block.origin[2] + row / block.size[1]});
                });
            },
            Progress());
        return voxels;
    };
    const auto& size = bare().body.grid.size;
    const std::set<std::array<int, 3>> all = visited({{0, 0, 0}, {size[0], size[1], size[2]}});
    std::size_t wanted = 0, missed = 0;
    bare().for_each([&](int i, int j, int k) {
        if (bare().depth(i, j, k) > depth_mm - 0.01) return;
        ++wanted, missed += !all.contains({i, j, k});
    });
    CHECK((wanted > 5000 && missed == 0));
    for (const optics::VoxelBox& box :
         {optics::VoxelBox{{0, 0, 0}, {1, 1, 1}}, optics::VoxelBox{{1, 5, 17}, {6, 9, 33}},
          optics::VoxelBox{{20, 12, 36}, {size[0], size[1], size[2]}}, optics::VoxelBox{{-5, -5, -5}, {3, 3, 3}}}) {
        const std::set<std::array<int, 3>> some = visited(box);
        std::size_t in_box = 0, found = 0;
        for (const auto& voxel : all) in_box += box.holds(voxel), found += box.holds(voxel) && some.contains(voxel);
        CHECK((in_box > 0 && found == in_box));
        if (box.end[2] < 20) CHECK(some.size() < all.size() / 2);
    }
    CHECK(visited({{0, 0, 0}, {0, 0, 0}}).empty());
}

TEST_CASE("Voxels of the skin are kept where each is screened by itself from the loop's mixtures") {
    GreyBox diffused;
    diffused.job.colour.screen = ScreenKind::error_diffusion;
    const PrintParts parts(diffused.job, diffused.body, diffused.resins, *diffused.colour, Progress());
    CHECK(std::get<MixtureSources>(parts.sources(nullptr).resins).screen == nullptr);
    CHECK(std::get<MixtureSources>(bare().parts->sources(nullptr).resins).screen != nullptr);
    CHECK(bare().parts->night() == nullptr);
    CHECK(bare().parts->translucency() == nullptr);
    CHECK_FALSE(bare().parts->zones().any());
    CHECK(bare().parts->sources(nullptr).core == 2);
    CHECK(bare().parts->sources(nullptr).thin != nullptr);
    diffused.job.keep_thin = false;
    const PrintParts thin(diffused.job, diffused.body, diffused.resins, *diffused.colour, Progress());
    CHECK(thin.sources(nullptr).thin == nullptr);
}

namespace {

/// Of each voxel another number for each resin, in whole 2^-20.
class ByPlace final : public optics::ResinGradient {
public:
    [[nodiscard]] float at(const std::array<int, 3>& voxel, std::size_t resin) const override {
        const int n = voxel[0] + 40 * voxel[1] + 1000 * voxel[2];
        return std::ldexp(float(n % 4093 - 2000) * float(resin + 1), -20);
    }
};

/// The loop's unknowns of a box, in cells of half a millimetre.
std::unique_ptr<const LoopCells> cells_of(const GreyBox& box) {
    const optics::ResinVolume shape = box.parts->shape(2, plenty, Progress());
    const optics::Scene scene = scene_of(shape, box.resins, box.body, box.job.picture.backing);
    return std::make_unique<const LoopCells>(find_viewed_cells(scene, box.body, 0.5, Progress()), box.body,
                                             box.parts->zones(), box.job.colour.depth_mm);
}

}  // namespace

TEST_CASE("A gradient by voxels is summed over those that share a mixture, whether these are kept or looked up") {
    constexpr std::size_t resins = 3;
    const auto cells = cells_of(bare());
    const SkinMap map = cells->map();
    const auto kept = bare().parts->skin_voxels(map, plenty, Progress());
    REQUIRE(kept);
    CHECK_FALSE(bare().parts->skin_voxels(map, 10, Progress()));
    const auto& size = bare().body.grid.size;
    const ByPlace gradient;
    // Handed over in two boxes.
    const auto visit = [&](const optics::AppearanceSequence::GradientVisitor& take) {
        take(gradient, {{0, 0, 0}, {size[0], size[1], 17}});
        take(gradient, {{0, 0, 17}, {size[0], size[1], size[2]}});
        return true;
    };
    const std::size_t n = cells->seen.surface.cells.size();
    const std::vector<float> looked_up = skin_gradient(*bare().parts, map, nullptr, n, resins, visit, Progress()),
                             by_kept = skin_gradient(*bare().parts, map, &*kept, n, resins, visit, Progress());
    REQUIRE(looked_up.size() == n * map.layers.size() * resins);
    CHECK(looked_up == by_kept);
    // By its definition, voxel by voxel.
    std::vector<double> sum(looked_up.size(), 0);
    kept->for_each(
        {{0, 0, 0}, {size[0], size[1], size[2]}},
        [&](const std::array<int, 3>& voxel, std::uint32_t number) {
            static std::mutex mutex;
            const std::scoped_lock lock(mutex);
            if (number >= SkinVoxels::clear) return;
            for (std::size_t r = 0; r < resins; ++r) sum[number * resins + r] += double(gradient.at(voxel, r));
        },
        Progress());
    double worst = 0, most = 0;
    for (std::size_t i = 0; i < sum.size(); ++i) {
        worst = std::max(worst, std::abs(sum[i] - double(looked_up[i])));
        most = std::max(most, std::abs(sum[i]));
    }
    CHECK(most > 0.01);
    CHECK(worst < 1e-6 * most);
    // Nothing where there is none.
    CHECK(skin_gradient(
              *bare().parts, map, nullptr, n, resins, [](const auto&) { return false; }, Progress())
              .empty());
}

TEST_CASE("A print of the skin's mixtures has each voxel of its own, core below, and clear resin where that lies") {
    for (const GreyBox* box : {&bare(), &coated()}) {
        const auto cells = cells_of(*box);
        const SkinMap map = cells->map();
        const auto kept = box->parts->skin_voxels(map, plenty, Progress());
        REQUIRE(kept);
        const optics::ResinVolume shape = box->parts->shape(2, plenty, Progress());
        halftone::SkinMixtures black(cells->seen.surface.cells.size(), map.layers.size(), 3);
        for (std::size_t at = 0; at < black.all().size(); at += 3) black.all()[at] = 1;
        const optics::ResinVolume print = box->parts->volume(*kept, black, shape, plenty, Progress());
        const double over = box == &coated() ? coat_mm : 0;
        int skin = 0, wrong = 0;
        box->for_each([&](int i, int j, int k) {
            const double depth = box->depth(i, j, k) - over;
            if (depth < -0.01) wrong += print.at(i, j, k) != optics::air;
            if (depth > 0.01 && depth < depth_mm - 0.06) ++skin, wrong += print.at(i, j, k) != 1;
            if (depth > depth_mm + 0.06) wrong += print.at(i, j, k) != 2;
        });
        CHECK((skin > 1000 && wrong == 0));
        CHECK_THROWS_AS(box->parts->volume(*kept, black, shape, 10, Progress()), ResourceError);
    }
}

TEST_CASE("A print of kept voxels that alpha thins is that of a search for each of them", "[slow]") {
    const GreyBox jelly(0, true);
    REQUIRE(jelly.parts->translucency() != nullptr);
    const auto cells = cells_of(jelly);
    const SkinMap map = cells->map();
    const auto kept = jelly.parts->skin_voxels(map, plenty, Progress());
    REQUIRE(kept);
    halftone::SkinMixtures mixtures(cells->seen.surface.cells.size(), map.layers.size(), 3);
    for (std::size_t i = 0; i < mixtures.all().size(); ++i)
        mixtures.all()[i] = float(1 + (7 * i + i / 3) % 5) * (i % 3 == 2 ? 0.0f : 1.0f);
    const SkinSource skin(map, mixtures, jelly.resins.core);
    const optics::ResinVolume shape = jelly.parts->shape(2, plenty, Progress()),
                              searched = jelly.parts->volume(&skin, plenty, Progress()),
                              print = jelly.parts->volume(*kept, mixtures, shape, plenty, Progress());
    std::array<std::size_t, 4> count{};
    int unlike = 0;
    jelly.for_each([&](int i, int j, int k) {
        unlike += print.at(i, j, k) != searched.at(i, j, k);
        ++count[print.at(i, j, k)];
    });
    CHECK(unlike == 0);
    for (const std::size_t material : {1, 2, 3}) CHECK(count[material] > 500);
}
