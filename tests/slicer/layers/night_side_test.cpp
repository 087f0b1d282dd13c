// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the night's layers are asked for, against what each shell lets through by a model of its own; and blocks of
// voxels that are put down by hand.
#include "slicer/layers/night_side.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "optics/colour/colour.h"
#include "slicer/layers/block_mixtures.h"
#include "slicer/layers/mixture_fill.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;
using Eigen::Vector3f;

namespace {

constexpr double thickness_mm = 3, depth_mm = 0.5;
constexpr int clear = 2;

/// White and black over a core of white, with clear resin.
struct Slab {
    Slab() {
        resins.resins.push_back({"Clear", "T", {0, 0, 0}, {0.1, 0.1, 0.1}});
        resins = resins.subset(std::vector<std::string>{"K", "W", "T"});
        geometry.shell_mm = depth_mm;
        geometry.core_resin = geometry.white_resin = 1;
        geometry.core_mm = thickness_mm - depth_mm;
        geometry.backing = optics::Backing::white;
        mesh.materials.resize(1);
        mesh.positions = {{0, 0, 3}, {8, 0, 3}, {0, 8, 3}}, mesh.triangles = {{0, 1, 2}};
        mesh.material_of_triangle = {0};
        mesh.corner_uv = {{Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)}};
        surface.positions_mm = mesh.positions, surface.triangles = mesh.triangles;
        surface.source_triangle = {0}, surface.source_uv = mesh.corner_uv;
    }
    optics::ResinSet resins = optics::vero_opaque();
    optics::ShellGeometry geometry;
    io::TexturedMesh mesh;
    VisibleSurface surface;
};

const Slab& slab() {
    static const Slab one;
    return one;
}

struct Day {
    optics::ShellAppearance appearance{slab().resins, slab().geometry};
    halftone::Separation separation{appearance};
};
const Day& day() {
    static const Day one;
    return one;
}

/// A picture of one grey, of sRGB's code.
std::shared_ptr<const io::Texture> picture_of(std::uint8_t grey) {
    io::TexelImage image{2, 2, {}, {}};
    for (int n = 0; n < 4; ++n) image.srgb8.insert(image.srgb8.end(), {grey, grey, grey, 255});
    return std::make_shared<const io::Texture>(std::move(image), io::Wrap::clamp, io::Wrap::clamp);
}

std::unique_ptr<const NightSide> night_of(std::uint8_t grey, double mm = thickness_mm) {
    static const SurfaceColour white(slab().mesh, 0.1);
    return std::make_unique<const NightSide>(day().appearance, day().separation, white, slab().surface, slab().mesh,
                                             picture_of(grey), mm, 0.1, clear);
}

/// What a shell of these resins over the core lets through, of what clear resin does there: by the same geometry, from
/// behind.
double through(const Vector3f& rgb) {
    optics::ShellGeometry geometry = slab().geometry;
    geometry.core_mm = thickness_mm - 2 * depth_mm;
    geometry.backing = optics::Backing::none;
    geometry.from_behind = true;
    geometry.white_resin = clear;
    const optics::ShellAppearance behind(slab().resins, geometry);
    return behind.appearance(day().separation.fractions(rgb))[1] / behind.appearance(std::vector<double>{0, 0, 1})[1];
}

}  // namespace

TEST_CASE("A night lies as deep from below as the day does from above, and shows its own picture") {
    const auto night = night_of(120);
    CHECK(night->day_mm() == Approx(depth_mm));
    CHECK(night->from_mm() == Approx(thickness_mm - depth_mm));
    const float linear = float(optics::srgb_decode(120 / 255.0));
    CHECK(night->asked(0, 0.3f, 0.3f).isApprox(Vector3f::Constant(linear), 1e-3f));
    CHECK(night->slab().materials[0].texture->width_px() == 2);
    CHECK(slab().mesh.materials[0].texture == nullptr);
}

TEST_CASE("The night is asked for what is to be seen over what the day lets through there") {
    const auto night = night_of(40);
    const Vector3f asked = Vector3f::Constant(0.002f);
    // At nodes of the lattice, even in the cube root.
    const Vector3f light = Vector3f::Ones(), dark = Vector3f::Constant(std::pow(0.5f, 3));
    const Vector3f under_light = night->wanted(asked, light), under_dark = night->wanted(asked, dark);
    CHECK(double(under_dark[1] / under_light[1]) == Approx(through(light) / through(dark)).epsilon(0.01));
    CHECK(under_dark[1] > 1.05f * under_light[1]);
    CHECK(night->wanted(2 * asked, light).isApprox(2 * under_light, 1e-4f));
    // No more than clear resin has.
    const Vector3f most = night->wanted(Vector3f::Constant(1e6f), light);
    CHECK(night->wanted(Vector3f::Constant(1e7f), dark).isApprox(most, 1e-5f));
    CHECK(most[1] > under_light[1]);
}

TEST_CASE("The lamp's level is such that a picture of one grey is within reach, nearly as bright as it can be") {
    for (const std::uint8_t grey : {std::uint8_t{90}, std::uint8_t{255}}) {
        CAPTURE(int(grey));
        const auto night = night_of(grey);
        const Vector3f most = night->wanted(Vector3f::Constant(1e6f), Vector3f::Ones()),
                       asked = night->wanted(night->asked(0, 0.2f, 0.2f), Vector3f::Ones());
        CHECK(night->beyond() == 0);
        CHECK(asked[1] <= 1.001f * most[1]);
        if (grey == 255) CHECK(asked[1] > 0.85f * most[1]);  // in steps of an eighth
    }
}

TEST_CASE("A slab too thin for day and night is refused, with what to try") {
    std::string said;
    try {
        (void)night_of(90, 2 * depth_mm);
    } catch (const InputError& error) {
        said = error.what();
    }
    CHECK(said ==
          "--view both: the slab is 1 mm thick, and colours of day and night take 0.5 mm each: nothing is left "
          "between them; give a larger --thickness, or a smaller --depth");
}

TEST_CASE("A bare body is air where clear resin lies over its colours, clear below them, and core between") {
    std::array<std::uint8_t, 2> shell{0b10110101, 0b00000010};
    std::array<float, 16> distance{};
    for (std::size_t n = 0; n < 16; ++n) distance[n] = 0.1f * float(n);
    ShellBlock block;
    block.size = {8, 2, 1}, block.shell = shell.data(), block.distance_mm = distance.data();
    DepthZones zones;
    zones.clear = 3, zones.core = 0, zones.colour_from_mm = 0.25f, zones.colour_to_mm = 0.6f;
    zones.clear_from_mm = 0.65f;
    std::array<io::Material, 16> out{};
    out.fill(77);
    LayerCounts counts;
    BareCore(zones, 9).fill(block, out.data(), counts);
    // Lanes 0, 2, 4, 5 and 7 of the first row, lane 1 of the second.
    const std::array<int, 16> wanted{0, 77, 0, 77, 9, 9, 77, 4, 77, 4, 77, 77, 77, 77, 77, 77};
    for (std::size_t n = 0; n < 16; ++n) {
        CAPTURE(n);
        CHECK(int(out[n]) == wanted[n]);
    }
    CHECK(counts.shell_voxels == 0);
    BareCore({}, 9).fill(block, out.data(), counts);
    CHECK((out[0] == 9 && out[7] == 9 && out[1] == 77));
}

TEST_CASE("What layers are counted by adds up, each by itself") {
    LayerCounts sum{1, 2, 3, 4, 5, 6, 7, 8};
    sum += {10, 20, 30, 40, 50, 60, 70, 80};
    CHECK((sum.body_voxels == 11 && sum.shell_voxels == 22 && sum.thin_voxels == 33));
    CHECK((sum.solid_s == 44 && sum.shell_s == 55 && sum.colour_s == 66 && sum.screen_s == 77 && sum.runs_s == 88));
}

TEST_CASE("A mixture is halftoned by the print's own voxels, and one resin alone is a run") {
    const halftone::BlueNoiseScreen screen({25.4 / 600, 25.4 / 300, 0.027});
    halftone::CumulativeMixture mixture;
    mixture.bound.fill(65535);
    mixture.bound[0] = 20000, mixture.bound[1] = 50000;
    const std::array at{70, 3, 130};
    io::LayerRuns row(40, 1);
    MixtureFill(mixture, 3, screen).push(5, 45, 2, 7, at, row);
    row.end_row();
    std::vector<int> laid;
    for (const io::Run& run : row.row(0)) laid.insert(laid.end(), run.length, run.material);
    REQUIRE(laid.size() == 40);
    for (int n = 0; n < 40; ++n) {
        const std::uint16_t t = screen.threshold(5 + n + 70, 2 + 3, 7 + 130);
        CHECK(laid[std::size_t(n)] == (t < 20000 ? 1 : t < 50000 ? 2 : 3));
    }
    // All of the second, whatever the thresholds: bounds of nothing and of all.
    mixture.bound[0] = 0, mixture.bound[1] = 65535;
    io::LayerRuns pure(40, 1);
    MixtureFill(mixture, 3, screen).push(0, 40, 2, 7, at, pure);
    pure.end_row();
    REQUIRE(pure.row(0).size() == 1);
    CHECK((pure.row(0)[0].material == 2 && pure.row(0)[0].length == 40));
    mixture.bound[0] = 1;  // one threshold is another's
    io::LayerRuns nearly(64, 64);
    for (int j = 0; j < 64; ++j) {
        MixtureFill(mixture, 3, screen).push(0, 64, j, 7, {0, 0, 0}, nearly);
        nearly.end_row();
    }
}
