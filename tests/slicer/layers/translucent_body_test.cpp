// SPDX-License-Identifier: GPL-3.0-or-later
//
// Printed voxels of flat slabs with alpha, read by the modes of their layers.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "halftone/separation/translucency.h"
#include "optics/colour/colour.h"
#include "optics/layered/layered_appearance.h"
#include "optics/media/effective_medium.h"
#include "optics/media/resin_volume.h"
#include "optics/monte_carlo/monte_carlo.h"
#include "slicer/colour/asked_alpha.h"
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
    /// `layers`: of a slab as a picture's is; 0: a body.
    explicit Colours(int layers)
        : appearance(set, geometry(set, layers)), separation(appearance), translucency(appearance, separation, 5) {}
    static optics::ShellGeometry geometry(const optics::ResinSet& set, int layers) {
        optics::ShellGeometry geometry;
        if (layers > 0) {
            const double slab_mm = layers * pitch_mm[2];
            geometry.shell_mm = std::min(geometry.shell_mm, slab_mm);
            geometry.core_mm = std::max(slab_mm - geometry.shell_mm, 1e-6);
        }
        geometry.core_resin = set.find("W");
        geometry.pitch_mm = pitch_mm;
        return geometry;
    }
};

constexpr int whole_layers = 148;  // 4 mm

/// A body of the standard's thickness, or a slab that is thinner.
const Colours& colours(int layers = whole_layers) {
    static std::map<int, Colours> made;
    return made.try_emplace(layers, layers == whole_layers ? 0 : layers).first->second;
}

const halftone::BlueNoiseScreen& screen() {
    static const halftone::BlueNoiseScreen made(pitch_mm);
    return made;
}

/// A slab of one colour and alpha. `translucent`: alpha counts.
MadeVoxels voxels_of(const Vector3f& rgb, float alpha, bool translucent = true, int layers = whole_layers) {
    VoxelGrid grid;
    grid.pitch_mm = {pitch_mm[0], pitch_mm[1], pitch_mm[2]};
    grid.size = {64, 32, layers};
    const Vector3d mm = grid.pitch_mm.cwiseProduct(Vector3d(64, 32, layers));
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
    MixtureSources sources{colour, colours(layers).separation, &screen(), 1, nullptr};
    if (translucent)
        sources.translucent = {&colours(layers).translucency, float(colours(layers).appearance.geometry().shell_mm)};
    return made_voxels({solid, nullptr, top, shell, 5, sources});
}

/// Its shares of resins in each four layers, from above.
std::vector<std::vector<double>> printed(const Vector3f& rgb, float alpha, int layers = whole_layers) {
    const MadeVoxels made = voxels_of(rgb, alpha, true, layers);
    constexpr int group = 4;
    std::vector<std::vector<double>> shares;
    for (int k = layers - group; k >= 0; k -= group) {
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

Seen seen(const std::vector<std::vector<double>>& shares, double slab_mm, const optics::TranslucencyScale& scale) {
    const optics::ResinSet& set = colours().set;
    static const optics::EffectiveMedium medium(set, pitch_mm, optics::SeenFrom::above);
    static const optics::OrdinatePlan plan = optics::appearance_plan(set.g, set.eta);
    optics::SlabReading reading;
    Seen out{};
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<optics::LayerOf> layers;
        for (const auto& share : shares) layers.push_back({medium(share, c), slab_mm / double(shares.size())});
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

/// Alpha by light paths through the voxels, which stand among mirrors.
double traced(const Vector3f& rgb, float alpha, int layers, const optics::TranslucencyScale& scale) {
    const MadeVoxels made = voxels_of(rgb, alpha, true, layers);
    const optics::ResinVolume volume = optics::make_resin_volume(
        {64, 32, layers}, pitch_mm, [&](int i, int j, int k) { return optics::Material(made.at(i, j, k)); });
    const optics::MonteCarlo model({.paths = 6000});
    const auto luminance = [&](optics::Backing backing) {
        const optics::Scene scene{&volume, &colours().set, backing, optics::Sides::mirrored};
        const optics::Surface top = optics::find_surface(scene, {64, 32, 1}, optics::SurfacePart::top);
        const std::vector<float> value = model.predict(scene, top).value;
        REQUIRE(value.size() == 3);
        return 0.2126 * double(value[0]) + 0.7152 * double(value[1]) + 0.0722 * double(value[2]);
    };
    const double through = luminance(optics::Backing::none) - luminance(optics::Backing::black);
    return optics::translucency_alpha(scale.eta_per_cm({luminance(optics::Backing::white), std::max(through, 0.0)}));
}

Seen seen(const std::vector<std::vector<double>>& shares) {
    static const optics::TranslucencyScale scale(colours().set.eta);
    return seen(shares, optics::translucency_slab_mm, scale);
}

const std::array nine_colours{Vector3f(1, 1, 1),          Vector3f(0.5f, 0.5f, 0.5f),  Vector3f(0.2f, 0.2f, 0.2f),
                              Vector3f(0.7f, 0.1f, 0.1f), Vector3f(0.1f, 0.4f, 0.15f), Vector3f(0.1f, 0.2f, 0.6f),
                              Vector3f(0.8f, 0.7f, 0.1f), Vector3f(0.1f, 0.5f, 0.6f),  Vector3f(0.6f, 0.35f, 0.25f)};

}  // namespace

TEST_CASE("Printed slabs of nine colours read as the alpha that was asked for, and keep their colours", "[slow]") {
    double worst = 0, colour_sum = 0;
    int slabs = 0;
    for (const Vector3f& rgb : nine_colours) {
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

TEST_CASE("Thin slabs of nine colours have a ramp of alpha as greys as thin have it", "[slow]") {
    for (const int layers : {20, 76}) {  // about 0.5 and 2 mm
        const double slab_mm = layers * pitch_mm[2];
        const optics::TranslucencyScale scale(colours().set.eta, slab_mm);
        double worst = 0;
        for (const Vector3f& rgb : nine_colours) {
            const double most = seen(printed(rgb, 1, layers), slab_mm, scale).alpha;
            double before = 0;
            for (const float asked : {0.2f, 0.35f, 0.5f, 0.65f, 0.8f, 0.95f}) {
                CAPTURE(rgb.transpose(), layers, asked, most);
                const double alpha = seen(printed(rgb, asked, layers), slab_mm, scale).alpha;
                CHECK(alpha >= before - 1e-3);
                CHECK(std::abs(alpha - std::min<double>(asked, most)) < 0.05);
                before = alpha;
                worst = std::max(worst, std::abs(alpha - std::min<double>(asked, most)));
            }
        }
        std::printf("ramps of A, slabs of %.2f mm: worst %.3f of A\n", slab_mm, worst);
    }
}

TEST_CASE("Ramps of alpha by light paths: slabs of 0.5, 2 and 4 mm", "[.ramps]") {
    double worst = 0;
    for (const int layers : {20, 76, whole_layers}) {
        const optics::TranslucencyScale scale(colours().set.eta, layers * pitch_mm[2]);
        for (const Vector3f& rgb : nine_colours) {
            const double most = traced(rgb, 1, layers, scale);
            double before = 0;
            for (const float asked : {0.2f, 0.35f, 0.5f, 0.65f, 0.8f, 0.95f}) {
                CAPTURE(rgb.transpose(), layers, asked, most);
                const double alpha = traced(rgb, asked, layers, scale);
                CHECK(alpha >= before - 0.02);
                CHECK(std::abs(alpha - std::min<double>(asked, most)) < 0.05);
                before = alpha;
                worst = std::max(worst, std::abs(alpha - std::min<double>(asked, most)));
            }
        }
    }
    std::printf("ramps of A by light paths, slabs of 0.54, 2.05, 4.00 mm: worst %.3f of A\n", worst);
}

TEST_CASE("Maps of alpha say what was asked for, what the printed slab reads, and what is given up", "[slow]") {
    io::TexturedMesh mesh;
    mesh.positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
    mesh.triangles = {{0, 1, 2}};
    mesh.material_of_triangle = {0};
    mesh.materials.emplace_back().rgb = {0.7f, 0.1f, 0.1f};
    VisibleSurface surface;
    surface.positions_mm = mesh.positions;
    surface.triangles = mesh.triangles;
    surface.source_triangle = {0};
    surface.source_uv.assign(1, {Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)});
    for (const float asked : {0.2f, 0.97f, 0.995f}) {
        mesh.materials[0].alpha = asked;
        const SurfaceColour colour(mesh, 0.1);
        const PrintedAlpha alpha(surface, colour, colours().translucency);
        const double shown = seen(printed(mesh.materials[0].rgb, asked)).alpha;
        const Vector3f at = alpha.at(0, 0.2f, 0.3f);
        CAPTURE(asked, shown, at.transpose());
        CHECK(at[0] == asked);
        CHECK(at[1] == Approx(shown).margin(0.02));
        const bool gives_up = asked == 0.97f;
        CHECK(at[2] == Approx(gives_up ? asked - at[1] : 0).margin(1e-6 + (asked == 0.2f ? 0.02 : 0)));
        CHECK((at[2] > 0.05f) == gives_up);
        const io::ReportTranslucency figures = alpha.figures();
        CHECK(figures.asked_mean == Approx(asked));
        CHECK(figures.given_up_mean == Approx(at[2]));
        CHECK(figures.given_up_max == Approx(at[2]));
        CHECK(figures.given_up_share == (gives_up ? 1 : 0));
        CHECK((alpha.warning().find("[alpha-range]") != std::string::npos) == gives_up);
        const auto maps = alpha.maps();
        REQUIRE(maps.size() == 3);
        for (const std::size_t map : {std::size_t{0}, std::size_t{1}})
            CHECK(maps[map].colour(0, 0.2f, 0.3f)[1] == Approx(optics::srgb_decode(double(at[Eigen::Index(map)]))));
        CHECK((maps[2].colour(0, 0.2f, 0.3f)[2] < 0.1f) == gives_up);  // yellow or darker
    }
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
