// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/mixture_correction.h"

#include <cmath>
#include <vector>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "optics/scene/scene.h"
#include "optics/scene/surface_mixtures.h"

namespace voxtone::optics {
namespace {

constexpr std::array<double, 3> pitch{0.0423, 0.0847, 0.027};
constexpr std::array<int, 3> size{72, 36, 40};

// Cyan (1) and white (5) drawn voxel by voxel: cyan's share left of the middle and right of it.
ResinVolume two_halves(double left, double right) {
    return make_resin_volume(size, pitch, [&](int x, int y, int z) {
        const auto address = static_cast<std::uint64_t>((z * size[1] + y) * size[0] + x);
        return RandomStream(9, address).uniform() < (2 * x < size[0] ? left : right) ? 1 : 5;
    });
}

Surface top_of(const ResinVolume& volume, const ResinSet& set) {
    const Scene scene{&volume, &set, Backing::black, Sides::open};
    return find_surface(scene, cell_voxels(pitch, 0.085), SurfacePart::top);
}

ResinSet corrected_set() {
    ResinSet set = vero_opaque();
    Eigen::MatrixXd centres(2, 5);
    centres << 0.4, 0, 0, 0, 0.6, 0, 0, 0, 0, 1;
    Eigen::MatrixX3d weights(2, 3);
    weights << -0.02, 0.01, 0.03, 0.005, 0.005, 0.01;
    set.residual = {{1, 1, 1, 1, 1}, centres, weights};
    return set;
}

}  // namespace

TEST_CASE("The mixture at a place is that of the halftone around it, and changes smoothly across an edge") {
    const ResinSet set = vero_opaque();
    const ResinVolume flat = two_halves(0.4, 0.4), edge = two_halves(0.8, 0.1);
    const Surface surface = top_of(flat, set);
    const std::vector<float> of_flat = surface_mixtures(flat, surface, 5), of_edge = surface_mixtures(edge, surface, 5);
    double mean = 0;
    for (std::size_t i = 0; i < surface.cells.size(); ++i) {
        const float* const cell = of_flat.data() + 5 * i;
        CHECK(cell[0] + cell[4] == Approx(1).epsilon(1e-5));
        CHECK(std::abs(cell[0] - 0.4f) < 0.15);
        mean += cell[0] / static_cast<double>(surface.cells.size());
        const double x = static_cast<double>(surface.cells[i].centre_mm[0]) - 0.5 * size[0] * pitch[0];
        const float cyan = of_edge[5 * i];
        if (x < -0.3) CHECK(cyan > 0.65f);
        if (x > 0.3) CHECK(cyan < 0.25f);
        if (std::abs(x) < 0.04) CHECK(std::abs(cyan - 0.45f) < 0.15);
    }
    CHECK(mean == Approx(0.4).margin(0.01));
}

TEST_CASE("Corrections leave white white and move flat mixtures as the residual does") {
    const ResinSet set = corrected_set();
    const MixtureCorrection relative(set, set.find("W")), absolute(set, -1);
    const std::vector<double> white{0, 0, 0, 0, 1}, pale{0.4, 0, 0, 0, 0.6};
    CHECK((relative.of(white) * Eigen::Vector3d::Ones() - Eigen::Vector3d::Ones()).norm() < 1e-12);
    const FlatColour flat(set);
    const Eigen::Matrix3d to_rgb = linear_srgb_of(flat.white());
    CHECK((absolute.of(pale) * (to_rgb * flat.physics(pale)) - to_rgb * flat.xyz(pale)).norm() < 1e-12);

    const ResinVolume print = two_halves(0.4, 0.4);
    const Surface surface = top_of(print, set);
    const std::vector<Eigen::Matrix3f> corrections = relative.of_surface(print, surface);
    Eigen::Matrix3f mean = Eigen::Matrix3f::Zero();
    for (const Eigen::Matrix3f& correction : corrections) mean += correction / static_cast<float>(corrections.size());
    CHECK((mean - relative.of(pale).cast<float>()).norm() < 0.01);
    CHECK_FALSE(MixtureCorrection(vero_opaque(), 4).any());
}

TEST_CASE("The derivatives of corrected colours are those of their transpose") {
    const ResinSet set = corrected_set();
    const MixtureCorrection correction(set, 4);
    std::vector<Eigen::Matrix3f> corrections;
    std::vector<Eigen::Vector3f> rgb, by;
    RandomStream random(5, 0);
    const auto vector = [&] {
        return Eigen::Vector3f(float(random.uniform()), float(random.uniform()), float(random.uniform()));
    };
    for (int n = 0; n < 10; ++n) {
        const double cyan = random.uniform();
        corrections.push_back(correction.of(std::vector<double>{cyan, 0, 0, 0, 1 - cyan}).cast<float>());
        rgb.push_back(vector());
        by.push_back(vector());
    }
    std::vector<Eigen::Vector3f> moved = rgb, back = by;
    correct_colours(corrections, moved);
    correct_derivatives(corrections, back);
    for (std::size_t n = 0; n < rgb.size(); ++n)
        CHECK(by[n].dot(moved[n]) == Approx(back[n].dot(rgb[n])).epsilon(1e-5));
}

}  // namespace voxtone::optics
