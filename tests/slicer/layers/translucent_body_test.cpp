// SPDX-License-Identifier: GPL-3.0-or-later
//
// Printed voxels of flat slabs with alpha, read by the modes of their layers.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "halftone/separation/translucency.h"
#include "optics/colour/colour.h"
#include "optics/layered/layered_appearance.h"
#include "optics/media/effective_medium.h"
#include "tests/slicer/layers/made_voxels.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;
using Eigen::Vector3f;
using voxtone::test::made_voxels;
using voxtone::test::MadeVoxels;

namespace {

constexpr std::array<double, 3> pitch_mm{25.4 / 600, 25.4 / 300, 0.027};

optics::ResinSet with_clear() {
    optics::ResinSet set = optics::vero_opaque();
    set.resins.push_back({"Clear", "T", {0, 0, 0}, {1, 1, 1}});
    return set.subset(std::vector<std::string>{"C", "M", "Y", "K", "W", "T"});
}

struct Colours {
    optics::ResinSet set = with_clear();
    optics::ShellAppearance appearance;
    halftone::Separation separation;
    halftone::Translucency translucency;
    Colours() : appearance(set, geometry(set)), separation(appearance), translucency(appearance, separation, 5) {}
    static optics::ShellGeometry geometry(const optics::ResinSet& set) {
        optics::ShellGeometry geometry;
        geometry.core_resin = set.find("W");
        geometry.pitch_mm = pitch_mm;
        return geometry;
    }
};

const Colours& colours() {
    static const Colours made;
    return made;
}

const halftone::BlueNoiseScreen& screen() {
    static const halftone::BlueNoiseScreen made(pitch_mm);
    return made;
}

/// A slab of one colour and alpha, 148 layers or 4 mm thick. `translucent`: alpha counts.
MadeVoxels voxels_of(const Vector3f& rgb, float alpha, bool translucent = true) {
    VoxelGrid grid;
    grid.pitch_mm = {pitch_mm[0], pitch_mm[1], pitch_mm[2]};
    grid.size = {64, 32, 148};
    const Vector3d mm = grid.pitch_mm.cwiseProduct(Vector3d(64, 32, 148));
    VisibleSurface top;
    top.positions_mm = {{0, 0, mm.z()}, {mm.x(), 0, mm.z()}, mm, {0, mm.y(), mm.z()}};
    top.triangles = {{0, 1, 2}, {0, 2, 3}};
    top.source_triangle = {0, 1};
    top.source_uv.assign(2, {Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)});
    io::TexturedMesh mesh;
    mesh.positions = top.positions_mm;
    mesh.triangles = top.triangles;
    mesh.material_of_triangle = {0, 0};
    mesh.materials.emplace_back();
    mesh.materials[0].rgb = rgb;
    mesh.materials[0].alpha = alpha;
    const SurfaceColour colour(mesh, pitch_mm[0]);
    const SurfaceIndex index(top);
    const SurfaceShell shell(index, grid, translucent ? mm.z() + 1 : 1);
    const Solid solid(shapes::box(Vector3d::Zero(), mm), grid);
    MixtureSources sources{colour, colours().separation, &screen(), 1, nullptr};
    if (translucent) sources.translucent = {&colours().translucency, 1.0f};
    return made_voxels({solid, nullptr, top, shell, 5, sources});
}

/// Its shares of resins in each four layers, from above.
std::vector<std::vector<double>> printed(const Vector3f& rgb, float alpha) {
    const MadeVoxels made = voxels_of(rgb, alpha);
    constexpr int group = 4;
    std::vector<std::vector<double>> shares;
    for (int k = 148 - group; k >= 0; k -= group) {
        auto& share = shares.emplace_back(6, 0.0);
        for (int n = 0; n < group; ++n)
            for (int j = 0; j < 32; ++j)
                for (int i = 0; i < 64; ++i) share[std::size_t(made.at(i, j, k + n) - 1)] += 1.0 / (group * 32 * 64);
    }
    return shares;
}

struct Seen {
    double alpha;
    Vector3d thick;  ///< linear sRGB of the same on a deep core
};

Seen seen(const std::vector<std::vector<double>>& shares) {
    const optics::ResinSet& set = colours().set;
    static const optics::EffectiveMedium medium(set, pitch_mm, optics::SeenFrom::above);
    static const optics::OrdinatePlan plan = optics::appearance_plan(set.g, set.eta);
    static const optics::TranslucencyScale scale(set.eta);
    optics::SlabReading reading;
    Seen out{};
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<optics::LayerOf> layers;
        for (const auto& share : shares)
            layers.push_back({medium(share, c), optics::translucency_slab_mm / double(shares.size())});
        const auto over = [&](const optics::Admittance& below) {
            return optics::layered_appearance(plan, layers, below);
        };
        const double weight = std::array{0.2126, 0.7152, 0.0722}[c];
        reading.on_white += weight * over(optics::Admittance::white_sheet(plan));
        reading.through +=
            weight * (over(optics::Admittance::air(plan, true)) - over(optics::Admittance::air(plan, false)));
        std::vector<double> white(6);
        white[4] = 1;
        out.thick[Eigen::Index(c)] = over(optics::half_space(plan, layers.back().medium)) /
                                     optics::appearance(plan, optics::half_space(plan, medium(white, c)));
    }
    out.alpha = optics::translucency_alpha(scale.eta_per_cm(reading));
    return out;
}

}  // namespace

TEST_CASE("Printed slabs of nine colours read as the alpha that was asked for, and keep their colours", "[slow]") {
    double worst = 0, colour_sum = 0;
    int slabs = 0;
    for (const Vector3f& rgb : {Vector3f(1, 1, 1), Vector3f(0.5f, 0.5f, 0.5f), Vector3f(0.2f, 0.2f, 0.2f),
                                Vector3f(0.7f, 0.1f, 0.1f), Vector3f(0.1f, 0.4f, 0.15f), Vector3f(0.1f, 0.2f, 0.6f),
                                Vector3f(0.8f, 0.7f, 0.1f), Vector3f(0.1f, 0.5f, 0.6f), Vector3f(0.6f, 0.35f, 0.25f)}) {
        CAPTURE(rgb.transpose());
        const Seen opaque = seen(printed(rgb, 1));
        const Vector3d target = optics::lab_from_linear_srgb(opaque.thick);
        double before = 0;
        for (const float asked : {0.2f, 0.35f, 0.5f, 0.65f, 0.8f, 0.95f}) {
            CAPTURE(asked, opaque.alpha);
            const Seen slab = seen(printed(rgb, asked));
            const double wanted = std::min<double>(asked, opaque.alpha);
            worst = std::max(worst, std::abs(slab.alpha - wanted));
            CHECK(std::abs(slab.alpha - wanted) < 0.05);
            CHECK(slab.alpha >= before - 1e-3);
            before = slab.alpha;
            colour_sum += optics::ciede2000(target, optics::lab_from_linear_srgb(slab.thick));
            ++slabs;
        }
    }
    CHECK(colour_sum / slabs < 2);
    std::printf("ramps of A: worst %.3f of A, colours of thick slabs %.2f CIEDE2000 on average\n", worst,
                colour_sum / slabs);
}

TEST_CASE("Alpha of 1 prints the same voxels, of 0 clear resin alone", "[slow]") {
    const Vector3f rgb(0.7f, 0.1f, 0.1f);
    const MadeVoxels whole = voxels_of(rgb, 1, false);
    const MadeVoxels one = voxels_of(rgb, 1), half = voxels_of(rgb, 0.2f);
    // The highest threshold of the screen takes the last resin of any mixture that is screened, and core is then.
    std::size_t others = 0, thinned = 0;
    for (int k = 0; k < 148; ++k)
        for (int j = 0; j < 32; ++j)
            for (int i = 0; i < 64; ++i) {
                const bool highest = screen().row(j, k)[i & halftone::BlueNoiseScreen::mask] == 65535;
                others += one.at(i, j, k) != whole.at(i, j, k) && !highest;
                thinned += half.at(i, j, k) != whole.at(i, j, k);
            }
    CHECK(others == 0);
    CHECK(thinned > 10'000);
    const MadeVoxels clear = voxels_of(rgb, 0);
    CHECK(std::ranges::count(clear.materials, io::Material{6}) == std::ptrdiff_t(clear.materials.size()));
}
