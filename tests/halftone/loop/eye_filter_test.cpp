// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "base/error.h"
#include "base/random.h"
#include "halftone/loop/eye_filter.h"
#include "optics/colour/colour.h"
#include "tests/same_for_threads.h"

using namespace voxtone;
using namespace voxtone::halftone;

namespace {

constexpr double distance_mm = 300, mm_per_degree = distance_mm * std::numbers::pi / 180;

optics::SurfaceCell cell_at(const Eigen::Vector3d& at, const Eigen::Vector3d& normal, double area) {
    optics::SurfaceCell cell;
    for (std::size_t a = 0; a < 3; ++a) {
        cell.centre_mm[a] = static_cast<float>(at[static_cast<Eigen::Index>(a)]);
        cell.normal[a] = static_cast<float>(normal[static_cast<Eigen::Index>(a)]);
    }
    cell.area_mm2 = static_cast<float>(area);
    return cell;
}

optics::Surface plate(double width, double depth, double pitch, double z = 0, double up = 1) {
    optics::Surface surface;
    const int nx = static_cast<int>(width / pitch), ny = static_cast<int>(depth / pitch);
    for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x)
            surface.cells.push_back(cell_at({(x + 0.5) * pitch, (y + 0.5) * pitch, z}, {0, 0, up}, pitch * pitch));
    return surface;
}

void append(optics::Surface& surface, const optics::Surface& more) {
    surface.cells.insert(surface.cells.end(), more.cells.begin(), more.cells.end());
}

/// Points spread evenly over a sphere (golden spiral).
optics::Surface sphere(double radius, int count) {
    optics::Surface surface;
    const double turn = std::numbers::pi * (3 - std::sqrt(5.0));
    for (int i = 0; i < count; ++i) {
        const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z);
        const Eigen::Vector3d n(r * std::cos(turn * i), r * std::sin(turn * i), z);
        surface.cells.push_back(cell_at(radius * n, n, 4 * std::numbers::pi * radius * radius / count));
    }
    return surface;
}

Eigen::Vector3f of_opponent(std::size_t channel, double value) {
    static const Eigen::Matrix3d back =
        (opponent_from_xyz_matrix(OpponentSpace::neutral) * optics::xyz_from_linear_srgb_matrix()).inverse();
    return (back.col(static_cast<Eigen::Index>(channel)) * value).cast<float>();
}

double opponent(std::size_t channel, const Eigen::Vector3f& rgb) {
    static const Eigen::Matrix3d to =
        opponent_from_xyz_matrix(OpponentSpace::neutral) * optics::xyz_from_linear_srgb_matrix();
    return (to * rgb.cast<double>())[static_cast<Eigen::Index>(channel)];
}

/// What the eye makes of stripes: amplitude of a grating in an opponent channel, sum of weight exp(-(pi spread f)^2)
/// over the Gaussians of X. Zhang, B. A. Wandell, J. SID 5, 61 (1997), scaled to the sum 1.
double eye_transfer(std::size_t opponent_channel, double cycles_per_degree, EyeSurround surround) {
    static const std::vector<std::pair<double, double>> published[3]{
        {{0.921, 0.0283}, {0.105, 0.133}, {-0.108, 4.336}},
        {{0.531, 0.0392}, {0.330, 0.494}},
        {{0.488, 0.0536}, {0.371, 0.386}}};  // weight, spread in degrees
    double sum = 0, weights = 0;
    for (const auto& [weight, spread] : published[opponent_channel]) {
        if (surround == EyeSurround::none && weight < 0) continue;
        const double a = std::numbers::pi * spread * cycles_per_degree;
        sum += weight * std::exp(-a * a), weights += weight;
    }
    return sum / weights;
}

}  // namespace

TEST_CASE("a flat colour stays as it is", "[eye_filter]") {
    optics::Surface surface = plate(6, 3, 0.0847);
    append(surface, sphere(2, 3000));
    surface.cells.push_back(cell_at({90, 90, 90}, {0, 1, 0}, 1e-7));  // alone, and tiny
    const EyeFilter eye(surface, distance_mm);
    const EyeFilter as_light(surface, distance_mm, EyeSurround::published, OpponentSpace::neutral);
    const Eigen::Vector3f colour(0.8F, 0.1F, 0.3F);
    const std::vector<Eigen::Vector3f> flat(surface.cells.size(), colour);
    float worst = 0;
    for (const auto& seen : {eye.filter(flat), eye.smoothed(flat), as_light.filter(flat)})
        for (const auto& c : seen) worst = std::max(worst, (c - colour).cwiseAbs().maxCoeff());
    CHECK(worst < 2e-6F);
}

TEST_CASE(
    "edges between black and white stay without colour where white is neutral, and do not in the published channels",
    "[eye_filter]") {
    const optics::Surface surface = plate(12, 6, 0.1);
    std::vector<Eigen::Vector3f> halves;
    for (const optics::SurfaceCell& cell : surface.cells)
        halves.push_back(Eigen::Vector3f::Constant(cell.centre_mm[0] < 6 ? 0.02F : 1.0F));
    const auto most_colour = [&](OpponentSpace space) {
        float most = 0;
        for (const auto& c : EyeFilter(surface, distance_mm, EyeSurround::none, space).filter(halves))
            most = std::max(most, c.maxCoeff() - c.minCoeff());
        return most;
    };
    CHECK(most_colour(OpponentSpace::cielab) < 1e-5F);
    CHECK(most_colour(OpponentSpace::neutral) < 5e-4F);
    CHECK(most_colour(OpponentSpace::published) > 0.1F);
    for (const double y : {0.2, 1.0}) {
        const Eigen::Vector3d white = opponent_from_xyz_matrix(OpponentSpace::neutral) *
                                      optics::xyz_from_linear_srgb_matrix() * Eigen::Vector3d::Constant(y);
        CHECK(std::abs(white[1]) < 3e-4 * y);  // the matrix has four digits
        CHECK(std::abs(white[2]) < 3e-4 * y);
        CHECK(white[0] == Approx(y).epsilon(0.03));
    }
}

TEST_CASE("the amplitude of a grating falls by the transfer function of the Gaussians", "[eye_filter][slow]") {
    // Wide enough that the middle does not see a border through any Gaussian but the widest of luminance, whose part of
    // the signal is nothing at these frequencies and whose mean is nothing anywhere.
    const optics::Surface surface = plate(24, 14, 0.0847);
    const EyeFilter eye(surface, distance_mm, EyeSurround::published, OpponentSpace::neutral);
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (const double cycles_per_mm : {0.25, 0.5, 1.0, 2.0, 3.0}) {
            const double k = 2 * std::numbers::pi * cycles_per_mm;
            std::vector<Eigen::Vector3f> rgb;
            for (const auto& c : surface.cells)
                rgb.push_back(of_opponent(channel, std::sin(k * (c.centre_mm[0] - 12))));
            const auto seen = eye.filter(rgb);
            double in_phase = 0, count = 0;
            for (std::size_t i = 0; i < rgb.size(); ++i) {
                const auto& at = surface.cells[i].centre_mm;
                if (std::abs(at[0] - 12) > 4 || std::abs(at[1] - 7) > 0.5) continue;
                const double s = std::sin(k * (at[0] - 12));
                in_phase += s * opponent(channel, seen[i]);
                count += s * s;
            }
            const double wanted = eye_transfer(channel, cycles_per_mm * mm_per_degree, EyeSurround::published);
            CAPTURE(channel, cycles_per_mm, in_phase / count, wanted);
            CHECK(std::abs(in_phase / count - wanted) < 0.015);
            if (cycles_per_mm == 1.0 && channel == 0) CHECK(std::abs(in_phase / count - 1.08 * wanted) > 0.015);
        }
}

TEST_CASE("from very near everything is seen, from very far only the mean", "[eye_filter]") {
    const optics::Surface surface = plate(5, 4, 0.1);
    std::vector<Eigen::Vector3f> rgb;
    Eigen::Vector3f mean = Eigen::Vector3f::Zero();
    for (std::size_t i = 0; i < surface.cells.size(); ++i) {
        RandomStream random(8, i);
        rgb.emplace_back(static_cast<float>(random.uniform()), 0.2F, static_cast<float>(random.uniform()));
        mean += rgb.back() / static_cast<float>(surface.cells.size());
    }
    const auto far = EyeFilter(surface, 1e5, EyeSurround::published, OpponentSpace::neutral).filter(rgb);
    for (const auto& c : far) REQUIRE((c - mean).cwiseAbs().maxCoeff() < 5e-3F);
    // From 2 mm the narrow Gaussians are 0.001 mm wide, the wide ones of colour 0.02, that of luminance 0.15 mm: only
    // the part of the latter, 12 %, sees more than one cell.
    const auto near = EyeFilter(surface, 2, EyeSurround::none).filter(rgb);
    float worst = 0;
    for (std::size_t i = 0; i < rgb.size(); ++i) worst = std::max(worst, (near[i] - rgb[i]).cwiseAbs().maxCoeff());
    CHECK(worst < 1e-5F);
}

TEST_CASE("without the surround the luminance channel is a low-pass that darkens nothing", "[eye_filter]") {
    CHECK(eye_transfer(0, 0, EyeSurround::none) == Approx(1));
    CHECK(eye_transfer(0, 1, EyeSurround::none) < 1);
    CHECK(eye_transfer(0, 1, EyeSurround::published) > 1.05);
    const optics::Surface surface = plate(6, 6, 0.1);
    std::vector<Eigen::Vector3f> rgb;
    for (const auto& c : surface.cells)
        rgb.push_back(c.centre_mm[0] < 3 ? Eigen::Vector3f::Zero().eval() : Eigen::Vector3f::Ones().eval());
    const auto least = [&](EyeSurround surround) {
        double low = 1;
        for (const auto& c : EyeFilter(surface, distance_mm, surround, OpponentSpace::neutral).filter(rgb))
            low = std::min(low, opponent(0, c));
        return low;
    };
    CHECK(least(EyeSurround::none) > -1e-4);
    CHECK(least(EyeSurround::published) < -0.04);
}

TEST_CASE("black beside tinted white keeps its own colour, which it does not where colour is smoothed as light",
          "[eye_filter]") {
    const optics::Surface surface = plate(12, 6, 0.1);
    std::vector<Eigen::Vector3f> rgb;
    for (const auto& c : surface.cells)
        rgb.push_back(c.centre_mm[0] < 6 ? Eigen::Vector3f::Constant(0.006F).eval()
                                         : Eigen::Vector3f(0.85F, 0.9F, 1.0F));
    // Half a millimetre inside the black: by how much what is asked and what is seen differ in chroma.
    const auto tint = [&](OpponentSpace space) {
        const auto seen = EyeFilter(surface, distance_mm, EyeSurround::none, space).views(rgb).lab;
        double most = 0;
        for (std::size_t i = 0; i < seen.size(); ++i)
            if (std::abs(surface.cells[i].centre_mm[0] - 5.45) < 0.01)
                most = std::max(most, static_cast<double>(seen[i].tail<2>().norm()));
        return most;
    };
    const double of_white = optics::lab_from_linear_srgb(Eigen::Vector3d(0.85, 0.9, 1.0)).tail<2>().norm();
    CHECK(tint(OpponentSpace::cielab) < 0.25 * of_white);
    CHECK(tint(OpponentSpace::neutral) > 0.6 * of_white);
}

TEST_CASE("the derivative by what the narrowest Gaussian leaves is that of differences, far from borders",
          "[eye_filter]") {
    const optics::Surface surface = plate(14, 14, 0.1);
    const EyeFilter eye(surface, distance_mm);
    // Patches in the middle, which the border is far from; F = sum of weights times what is seen.
    std::vector<Eigen::Vector3f> rgb, weight, change;
    for (std::size_t i = 0; i < surface.cells.size(); ++i) {
        RandomStream random(3, i);
        const auto& at = surface.cells[i].centre_mm;
        const bool is_inner = std::abs(at[0] - 7) < 1 && std::abs(at[1] - 7) < 1;
        const auto drawn = [&] { return static_cast<float>(random.uniform()); };
        rgb.emplace_back(0.2F + 0.5F * drawn(), 0.1F + 0.5F * drawn(), 0.05F + 0.5F * drawn());
        weight.push_back(is_inner ? Eigen::Vector3f(drawn(), drawn(), drawn()) : Eigen::Vector3f::Zero().eval());
        change.push_back(is_inner ? Eigen::Vector3f(drawn(), -drawn(), drawn()) : Eigen::Vector3f::Zero().eval());
    }
    const auto product = [](const auto& a, const auto& b) {
        double sum = 0;
        for (std::size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i].dot(b[i]));
        return sum;
    };
    const EyeFilter::Views here = eye.views(rgb);
    constexpr float step = 1e-3F;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        // What raises one and what lowers another do not cancel.
        std::vector<Eigen::Vector3f> of_one = weight;
        for (Eigen::Vector3f& w : of_one) w = w[0] * Eigen::Vector3f::Unit(static_cast<Eigen::Index>(channel));
        const auto of_moved = [&](float by) {
            std::vector<Eigen::Vector3f> moved = rgb;
            for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += by * change[i];
            return product(eye.views(moved).lab, of_one);
        };
        const double slope = product(eye.smoothed(eye.by_smoothed(of_one, here)), change);
        CAPTURE(channel);
        CHECK(slope == Approx((of_moved(step) - of_moved(-step)) / (2 * static_cast<double>(step))).epsilon(0.02));
    }
}

TEST_CASE("a small spot looks the same on a large sphere as on a plate", "[eye_filter][slow]") {
    const double radius = 12, pitch = 0.1;
    const optics::Surface flat = plate(12, 12, pitch);
    const optics::Surface round =
        sphere(radius, static_cast<int>(4 * std::numbers::pi * radius * radius / (pitch * pitch)));
    const auto spot = [](double r) {
        return Eigen::Vector3f(static_cast<float>(std::exp(-r * r / 0.8)), static_cast<float>(std::exp(-r * r / 0.4)),
                               0.2F);
    };
    std::vector<Eigen::Vector3f> on_flat, on_round;
    for (const auto& c : flat.cells) on_flat.push_back(spot(std::hypot(c.centre_mm[0] - 6, c.centre_mm[1] - 6)));
    for (const auto& c : round.cells)
        on_round.push_back(c.centre_mm[2] > 0 ? spot(std::hypot(c.centre_mm[0], c.centre_mm[1])) : spot(9));
    const auto seen_flat = EyeFilter(flat, distance_mm, EyeSurround::published, OpponentSpace::neutral).filter(on_flat),
               seen_round =
                   EyeFilter(round, distance_mm, EyeSurround::published, OpponentSpace::neutral).filter(on_round);
    // Mean over rings, because the points lie elsewhere.
    for (const double ring : {0.1, 0.4, 0.7, 1.1}) {
        const auto mean = [&](const optics::Surface& s, const std::vector<Eigen::Vector3f>& v, double x, double y) {
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            double n = 0;
            for (std::size_t i = 0; i < v.size(); ++i) {
                const auto& at = s.cells[i].centre_mm;
                if (at[2] < 0 || std::abs(std::hypot(at[0] - x, at[1] - y) - ring) > 0.1) continue;
                sum += v[i].cast<double>();
                n += 1;
            }
            return Eigen::Vector3d(sum / n);
        };
        const Eigen::Vector3d a = mean(flat, seen_flat, 6, 6), b = mean(round, seen_round, 0, 0);
        CAPTURE(ring, a.transpose(), b.transpose());
        CHECK((a - b).cwiseAbs().maxCoeff() < 0.02);
    }
}

TEST_CASE("sides of a wall and sheets behind one another do not mix", "[eye_filter]") {
    optics::Surface surface = plate(4, 4, 0.1, 0.5, 1);
    const std::size_t side = surface.cells.size();
    append(surface, plate(4, 4, 0.1, 0.0, -1));  // the other side of this wall
    append(surface, plate(4, 4, 0.1, -1.0, 1));  // the next wall's upper side
    std::vector<Eigen::Vector3f> rgb(surface.cells.size(), Eigen::Vector3f::Zero());
    for (std::size_t i = 0; i < side; ++i) rgb[i] = Eigen::Vector3f(0.9F, 0.5F, 0.2F);
    const auto seen = EyeFilter(surface, distance_mm, EyeSurround::published, OpponentSpace::neutral).smoothed(rgb);
    for (std::size_t i = 0; i < seen.size(); ++i) REQUIRE((seen[i] - rgb[i]).cwiseAbs().maxCoeff() < 1e-6F);
    // With the wide Gaussians too, but for the widest: what is 1.5 mm behind is not told apart at 23 mm.
    const auto whole = EyeFilter(surface, distance_mm, EyeSurround::published, OpponentSpace::neutral).filter(rgb);
    for (std::size_t i = 0; i < seen.size(); ++i) REQUIRE((whole[i] - rgb[i]).cwiseAbs().maxCoeff() < 0.15F);
    for (std::size_t i = side; i < 2 * side; ++i) REQUIRE(whole[i].norm() < 1e-6F);
}

TEST_CASE("the filter has the same bits for any number of threads", "[eye_filter]") {
    optics::Surface surface = plate(5, 4, 0.0847);
    append(surface, sphere(3, 9000));
    std::vector<Eigen::Vector3f> rgb;
    for (std::size_t i = 0; i < surface.cells.size(); ++i) {
        RandomStream random(7, i);
        rgb.emplace_back(static_cast<float>(random.uniform()), static_cast<float>(random.uniform()), 0.5F);
    }
    const auto seen = test::same_for_threads(
        [&] { return EyeFilter(surface, distance_mm, EyeSurround::published, OpponentSpace::neutral).filter(rgb); });
    CHECK(seen != rgb);
}

TEST_CASE("two pictures at once look as each does alone, and the narrowest Gaussian alone as with the others",
          "[eye_filter]") {
    optics::Surface surface = plate(5, 4, 0.0847);
    append(surface, sphere(3, 9000));
    std::array<std::vector<Eigen::Vector3f>, 2> rgb;
    for (std::size_t i = 0; i < surface.cells.size(); ++i)
        for (std::size_t p = 0; p < 2; ++p) {
            RandomStream random(11 + p, i);
            rgb[p].emplace_back(static_cast<float>(random.uniform()), static_cast<float>(random.uniform()), 0.5F);
        }
    const EyeFilter eye(surface, distance_mm, EyeSurround::none);
    const std::array<EyeFilter::Views, 2> both = eye.views(rgb[0], rgb[1]);
    const EyeFilter narrow(surface, distance_mm, EyeSurround::none, OpponentSpace::cielab, EyeParts::narrowest);
    for (std::size_t p = 0; p < 2; ++p) {
        const EyeFilter::Views alone = eye.views(rgb[p]);
        CHECK(both[p].lab == alone.lab);
        CHECK(both[p].smoothed == alone.smoothed);
        CHECK(narrow.smoothed(rgb[p]) == alone.smoothed);
    }
    CHECK(both[0].smoothed != both[1].smoothed);
}

TEST_CASE("a viewing distance that is none is refused, and a surface without cells is none", "[eye_filter]") {
    const optics::Surface surface = plate(1, 1, 0.1);
    CHECK_THROWS_AS(EyeFilter(surface, 0), InputError);
    CHECK_THROWS_AS(EyeFilter(surface, std::numeric_limits<double>::quiet_NaN()), InputError);
    CHECK(EyeFilter(optics::Surface{}, distance_mm).filter(std::vector<Eigen::Vector3f>{}).empty());
}
