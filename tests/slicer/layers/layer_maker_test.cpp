// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layers of voxels against what each voxel must be, found by looking at all triangles.
#include "slicer/layers/layer_maker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "optics/layered/shell_appearance.h"
#include "slicer/mesh/triangle_tree.h"
#include "tests/slicer/layers/made_voxels.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;
using Eigen::Vector3f;
using voxtone::test::made_voxels;
using voxtone::test::MadeVoxels;
using voxtone::test::placed_voxels;

namespace {

const Vector3d pitch(25.4 / 600, 25.4 / 300, 0.027);
constexpr int resins = 5;
/// None of the resins, so that core is told from shell.
constexpr io::Material core = resins + 1;

/// Of the usual set, coarse: what colours come out is not asked here.
const halftone::Separation& separation() {
    static const optics::ResinSet set = optics::vero_opaque().subset(std::vector<std::string>{"C", "M", "Y", "K", "W"});
    static const optics::ShellAppearance appearance = [] {
        optics::ShellGeometry geometry;
        geometry.core_resin = set.find("W");
        return optics::ShellAppearance(set, geometry);
    }();
    static const halftone::Separation made = [] {
        halftone::SeparationOptions options;
        options.nodes = 5;
        return halftone::Separation(appearance, options);
    }();
    return made;
}

const halftone::BlueNoiseScreen& screen() {
    static const halftone::BlueNoiseScreen made({pitch.x(), pitch.y(), pitch.z()});
    return made;
}

/// A body whose triangles have one colour each. Its parts refer to one another.
struct Body {
    Body(const SolidMesh& mesh, const VoxelGrid& voxels, double depth, std::vector<Vector3f> colours)
        : grid(voxels), depth_mm(depth), colour_of(std::move(colours)) {
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            surface.source_triangle.push_back(t);
            surface.source_uv.push_back({Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)});
            textured.corner_rgb.push_back({colour_of[t], colour_of[t], colour_of[t]});
        }
        surface.positions_mm = textured.positions = mesh.positions_mm;
        surface.triangles = textured.triangles = mesh.triangles;
        textured.material_of_triangle.assign(mesh.triangles.size(), 0);
        textured.materials.emplace_back();
        colour.emplace(textured, pitch.x());
        solid.emplace(mesh, grid);
        index.emplace(surface);
        shell.emplace(*index, grid, depth_mm);
    }
    [[nodiscard]] LayerSources sources(const halftone::BlueNoiseScreen* by, const SkinSource* skin = nullptr) const {
        return {*solid, nullptr, surface, *shell, core, MixtureSources{*colour, separation(), by, 1, skin}};
    }
    /// The triangles nearest to a place, within the rounding by which the shell takes distances to be the same; the
    /// distance is the least.
    std::vector<std::uint32_t> nearest(const Vector3d& p, double& distance_mm) const {
        std::vector<double> square;
        for (const auto& [a, b, c] : surface.triangles) {
            const auto& at = surface.positions_mm;
            const Vector3d w = nearest_weights(p, at[a], at[b], at[c]);
            square.push_back((w[0] * at[a] + w[1] * at[b] + w[2] * at[c] - p).squaredNorm());
        }
        const double least = *std::min_element(square.begin(), square.end());
        distance_mm = std::sqrt(least);
        std::vector<std::uint32_t> found;
        for (std::uint32_t t = 0; t < square.size(); ++t)
            if (square[t] <= least * (1 + 5e-6) + 3e-8) found.push_back(t);
        return found;
    }
    [[nodiscard]] halftone::CumulativeMixture mixture(std::uint32_t triangle) const {
        halftone::CumulativeMixture found;
        const Vector3f& rgb = colour_of[triangle];
        separation().mixtures(&rgb.x(), &rgb.y(), &rgb.z(), 1, &found);
        return found;
    }

    VoxelGrid grid;
    double depth_mm;
    std::vector<Vector3f> colour_of;
    io::TexturedMesh textured;
    VisibleSurface surface;
    std::optional<SurfaceColour> colour;
    std::optional<Solid> solid;
    std::optional<SurfaceIndex> index;
    std::optional<SurfaceShell> shell;
};

std::vector<Vector3f> random_colours(std::size_t count, std::uint64_t seed) {
    std::vector<Vector3f> colours;
    for (std::size_t n = 0; n < count; ++n) {
        RandomStream random(seed, n);
        colours.emplace_back(random.uniform(), random.uniform(), random.uniform());
    }
    return colours;
}

/// Two walls in a grid of 40 voxels along x, with `gap` empty ones between them from voxel 10 + `shift` on. Their faces
/// lie beside the borders of voxels.
struct Walls {
    Walls(int gap, int shift) : gap_begin(10 + shift), gap_end(gap_begin + gap) {
        grid.pitch_mm = pitch;
        grid.size = {40, 6, 7};
    }
    [[nodiscard]] SolidMesh mesh() const {
        const auto box = [](double from, double to) {
            return shapes::box(pitch.cwiseProduct(Vector3d(from, 0.8, 0.7)),
                               pitch.cwiseProduct(Vector3d(to, 5.3, 6.2)));
        };
        return shapes::joined(box(1.8, gap_begin + 0.2), box(gap_end - 0.3, 34.1));
    }
    /// Whether the voxel's centre lies within one.
    [[nodiscard]] bool holds(int i, int j, int k) const {
        return i >= 2 && i < 34 && (i < gap_begin || i >= gap_end) && j >= 1 && j < 5 && k >= 1 && k < 6;
    }
    int gap_begin, gap_end;
    VoxelGrid grid;
};

/// Voxels of a made body that are not what they must be: `allowed(i, j, k, triangles, material)` for those of the
/// shell. Counts shell voxels.
template <class Allowed>
std::size_t wrong_voxels(const Body& body, const MadeVoxels& made, const Walls& walls, std::uint64_t& shell_voxels,
                         const Allowed& allowed) {
    std::size_t wrong = 0;
    shell_voxels = 0;
    for (int k = 0; k < body.grid.size[2]; ++k)
        for (int j = 0; j < body.grid.size[1]; ++j)
            for (int i = 0; i < body.grid.size[0]; ++i) {
                const io::Material material = made.at(i, j, k);
                if (!walls.holds(i, j, k)) {
                    wrong += material != io::background;
                    continue;
                }
                double distance_mm = 0;
                const std::vector<std::uint32_t> near = body.nearest(body.grid.centre(i, j, k), distance_mm);
                REQUIRE(std::abs(distance_mm - body.depth_mm) > 1e-5);
                if (distance_mm > body.depth_mm) {
                    wrong += material != core;
                    continue;
                }
                ++shell_voxels;
                wrong += !allowed(i, j, k, near, material);
            }
    return wrong;
}

}  // namespace

TEST_CASE("Two walls with a gap: every voxel has the resin of its nearest triangle's colour at its threshold") {
    for (int gap = 1; gap <= 7; ++gap)
        for (int shift = 0; shift < 8; ++shift) {
            CAPTURE(gap, shift);
            const Walls walls(gap, shift);
            const Body body(walls.mesh(), walls.grid, 0.06, random_colours(24, 5));
            const MadeVoxels made = made_voxels(body.sources(&screen()));
            std::uint64_t shell_voxels = 0;
            const std::size_t wrong =
                wrong_voxels(body, made, walls, shell_voxels,
                             [&](int i, int j, int k, const std::vector<std::uint32_t>& near, io::Material material) {
                                 return std::any_of(near.begin(), near.end(), [&](std::uint32_t t) {
                                     return material == 1 + halftone::select_resin(body.mixture(t),
                                                                                   screen().threshold(i, j, k), resins);
                                 });
                             });
            CHECK(wrong == 0);
            CHECK(made.counts.shell_voxels == shell_voxels);
            CHECK(made.counts.body_voxels == std::uint64_t(34 - 2 - gap) * 4 * 5);
            CHECK(shell_voxels < made.counts.body_voxels);  // there is core
        }
}

TEST_CASE("A copy of a part is screened where it stands in its print") {
    const Walls walls(3, 2);
    const Body body(walls.mesh(), walls.grid, 0.06, random_colours(24, 9));
    const LayerSources sources = body.sources(&screen());
    const int layers = walls.grid.size[2];
    const int others = GENERATE(0, 3, 20);
    CAPTURE(others);
    const MadeVoxels at_home = made_voxels(sources);
    CHECK(placed_voxels(sources, {0, 0, 0}, 0, layers, others).materials == at_home.materials);
    // The screen repeats.
    CHECK(placed_voxels(sources, {64, 128, 64}, 0, layers, others).materials == at_home.materials);
    for (const std::array<int, 3>& at : {std::array{7, 0, 0}, std::array{0, 5, 0}, std::array{100, 33, 12}}) {
        CAPTURE(at[0], at[1], at[2]);
        const MadeVoxels made = placed_voxels(sources, at, 0, layers, others);
        std::uint64_t shell_voxels = 0;
        const std::size_t wrong =
            wrong_voxels(body, made, walls, shell_voxels,
                         [&](int i, int j, int k, const std::vector<std::uint32_t>& near, io::Material material) {
                             const std::uint16_t threshold = screen().threshold(i + at[0], j + at[1], k + at[2]);
                             return std::any_of(near.begin(), near.end(), [&](std::uint32_t t) {
                                 return material == 1 + halftone::select_resin(body.mixture(t), threshold, resins);
                             });
                         });
        CHECK(wrong == 0);
        CHECK(made.counts.shell_voxels == shell_voxels);
        CHECK(made.materials != at_home.materials);
        // Some of its layers, from within a block.
        const MadeVoxels some = placed_voxels(sources, at, 2, 5, others);
        const std::size_t layer = std::size_t(walls.grid.size[0]) * std::size_t(walls.grid.size[1]);
        CHECK(std::equal(some.materials.begin() + std::ptrdiff_t(2 * layer),
                         some.materials.begin() + std::ptrdiff_t(5 * layer),
                         made.materials.begin() + std::ptrdiff_t(2 * layer)));
    }
}

TEST_CASE("Layers are the same whichever are asked for, also from within a block") {
    const Walls walls(3, 5);
    const Body body(walls.mesh(), walls.grid, 0.06, random_colours(24, 6));
    const LayerSources sources = body.sources(&screen());
    REQUIRE(body.shell->block_size()[2] > 4);
    const MadeVoxels whole = made_voxels(sources);
    const std::size_t layer = std::size_t(walls.grid.size[0]) * std::size_t(walls.grid.size[1]);
    for (int begin = 0; begin < walls.grid.size[2]; ++begin)
        for (int end = begin + 1; end <= walls.grid.size[2]; ++end) {
            CAPTURE(begin, end);
            const MadeVoxels part = made_voxels(sources, begin, end);
            std::size_t wrong = 0;
            for (std::size_t v = 0; v < part.materials.size(); ++v) {
                const int k = int(v / layer);
                wrong += part.materials[v] != (k < begin || k >= end ? io::background : whole.materials[v]);
            }
            CHECK(wrong == 0);
        }
}

TEST_CASE("By error diffusion the same voxels are shell, and get resins that their colour asks for") {
    for (const auto& [gap, shift] : {std::pair{1, 0}, std::pair{3, 5}, std::pair{7, 7}}) {
        CAPTURE(gap, shift);
        const Walls walls(gap, shift);
        // A face asks for white or black alone, so that each voxel can have one resin only, or two where faces meet.
        std::vector<Vector3f> colours;
        for (std::size_t t = 0; t < 24; ++t) colours.push_back(Vector3f::Constant(t / 2 % 2 ? 1.0f : 0.0f));
        const Body body(walls.mesh(), walls.grid, 0.06, colours);
        const MadeVoxels made = made_voxels(body.sources(nullptr));
        std::uint64_t shell_voxels = 0;
        std::size_t both = 0;
        const auto has_share = [](const halftone::CumulativeMixture& mixture, int resin) {
            const int below = resin == 0 ? 0 : mixture.bound[std::size_t(resin - 1)];
            const int above = resin + 1 == resins ? 65536 : mixture.bound[std::size_t(resin)];
            return above > below && below < 65535;
        };
        const std::size_t wrong = wrong_voxels(
            body, made, walls, shell_voxels,
            [&](int, int, int, const std::vector<std::uint32_t>& near, io::Material material) {
                both += near.size() > 1;
                return material >= 1 && material <= resins &&
                       std::any_of(near.begin(), near.end(),
                                   [&](std::uint32_t t) { return has_share(body.mixture(t), material - 1); });
            });
        CHECK(wrong == 0);
        CHECK(made.counts.shell_voxels == shell_voxels);
        CHECK(both < shell_voxels / 4);
    }
}

TEST_CASE("Layers by error diffusion are the same whichever are asked for, and keep the shares of their mixture") {
    // More than the 32 layers after which errors start anew.
    VoxelGrid grid;
    grid.pitch_mm = pitch;
    grid.size = {32, 16, 48};
    const SolidMesh mesh = shapes::box(Vector3d::Zero(), pitch.cwiseProduct(Vector3d(32, 16, 48)));
    const Vector3f grey(0.35f, 0.3f, 0.4f);
    const Body body(mesh, grid, 10, std::vector<Vector3f>(12, grey));
    const LayerSources sources = body.sources(nullptr);
    const MadeVoxels whole = made_voxels(sources);
    const std::size_t layer = 32 * 16;
    for (const auto& [begin, end] : {std::pair{5, 9}, std::pair{30, 40}, std::pair{47, 48}}) {
        CAPTURE(begin, end);
        const MadeVoxels part = made_voxels(sources, begin, end);
        CHECK(part.counts.body_voxels == std::uint64_t(end - begin) * layer);
        std::size_t wrong = 0;
        for (std::size_t v = 0; v < part.materials.size(); ++v) {
            const int k = int(v / layer);
            wrong += part.materials[v] != (k < begin || k >= end ? io::background : whole.materials[v]);
        }
        CHECK(wrong == 0);
    }
    // 16^3 voxels hold the shares within 0.7 % (error_diffusion.h); these are six such boxes.
    const std::vector<double> wanted = separation().fractions(grey);
    for (int r = 0; r < resins; ++r) {
        CAPTURE(r);
        const double share = double(std::count(whole.materials.begin(), whole.materials.end(), io::Material(r + 1))) /
                             double(whole.materials.size());
        CHECK(share == Approx(wanted[std::size_t(r)]).margin(0.007));
    }
}
