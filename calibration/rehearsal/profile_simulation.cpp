// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/rehearsal/profile_simulation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"
#include "calibration/rehearsal/sensor.h"
#include "optics/profiles/resin_profile.h"

namespace voxtone::calibration {
namespace {

using std::numbers::pi;
constexpr double reach_beyond_corner = 1.3, coefficients_per_blur = 2, table_per_blur = 8;

// Seen through an even disc.
std::vector<double> through_disc(std::vector<double> coefficients, const optics::HankelGrid& grid, double radius_mm) {
    for (std::size_t i = 1; i < coefficients.size(); ++i) {
        const double z = 2 * pi * grid.k()[i] * radius_mm;
        if (z > 0) coefficients[i] *= 2 * std::cyl_bessel_j(1, z) / z;
    }
    return coefficients;
}

// Cubic through a table of an even function.
double between(const std::vector<double>& table, double at) {
    const auto last = static_cast<std::ptrdiff_t>(table.size()) - 1;
    const auto i = std::min(static_cast<std::ptrdiff_t>(at), last - 1);
    const double t = at - static_cast<double>(i);
    const auto value = [&](std::ptrdiff_t j) { return table[static_cast<std::size_t>(std::min(std::abs(j), last))]; };
    const double a = value(i - 1), b = value(i), c = value(i + 1), d = value(i + 2);
    return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

}  // namespace

void SpotCamera::validate() const {
    if (seconds.empty()) throw InputError("there are no exposure times");
    for (std::size_t k = 0; k < seconds.size(); ++k)
        if (!(seconds[k] > (k > 0 ? seconds[k - 1] : 0.0) && std::isfinite(seconds[k])))
            throw InputError(fmt::format("an exposure time is {}; it must be above the one before it", seconds[k]));
    expect_within("the size of the picture", size_px, 64, 4000);
    expect_within("mm per pixel", mm_per_px, 1e-4, 10);
    for (const double offset : offset_px)
        expect_within("the offset of the spot", offset, 1 - size_px / 2.0, size_px / 2.0 - 1);
    expect_within("the radius of the spot", spot_mm, 0, 100);
    expect_within("the stretch", stretch, 0.5, 2);
    expect_within("the blur", blur_mm, mm_per_px / 10, 100);
    expect_within("stray light", stray, 0, 1);
    expect_within("the peak", peak, 1e-6, 1e6);
    expect_within("the full well", full_well, 0, 1e9);
    expect_within("the read noise", read_noise, 0, 0.99);
    expect_within("the black level", black, 0, 0.99);
    expect_within("the bits of a sample", bits, 8, 16);
}

optics::HankelGrid SpotCamera::grid() const {
    const double farthest = (Eigen::Vector2d::Constant(size_px / 2.0) + offset_px.cwiseAbs()).norm() * mm_per_px;
    const double reach = reach_beyond_corner * farthest * std::max(stretch, 1 / stretch);
    return {reach, static_cast<std::size_t>(std::ceil(coefficients_per_blur * reach / blur_mm))};
}

SlabProfiles slab_profiles(const optics::ResinSet& set, const std::string& role, double thickness_mm,
                           const optics::HankelGrid& grid, std::uint32_t paths, std::uint64_t seed,
                           const Progress* progress) {
    if (!set.channels.is_rgb())
        throw InputError(fmt::format("resin set {} has {}; photographs have red, green and blue", set.name,
                                     channels_text(set.channels)));
    if (!(thickness_mm > 0 && std::isfinite(thickness_mm)))
        throw InputError(fmt::format("the slab is {} mm thick; it must be above 0", thickness_mm));
    const std::vector<std::string> roles{role};
    const optics::Resin resin = set.subset(roles).resins[0];
    SlabProfiles slab;
    for (std::size_t c = 0; c < 3; ++c) {
        optics::ResinProfile profile =
            optics::resin_profile(resin.medium(c), set.g, thickness_mm, grid, {paths, seed + c}, progress);
        slab.R[c] = std::move(profile.R), slab.T[c] = std::move(profile.T);
    }
    return slab;
}

SpotScene::SpotScene(const std::array<std::vector<double>, 3>& side, const SpotCamera& camera)
    : camera_(camera), step_mm_(camera.blur_mm / table_per_blur) {
    camera.validate();
    const optics::HankelGrid grid = camera.grid();
    const double with_pixel = std::hypot(camera.blur_mm, camera.mm_per_px / std::sqrt(12.0));
    const auto entries = static_cast<std::size_t>(grid.reach_mm() / step_mm_);
    double brightest = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        VOXTONE_EXPECT(side[c].size() == grid.size());
        const std::vector<double> lit = through_disc(side[c], grid, camera.spot_mm),
                                  sharp = grid.blurred(lit, camera.blur_mm), seen = grid.blurred(lit, with_pixel);
        total_[c] = side[c][0];
        sharp_[c].resize(entries), seen_[c].resize(entries);
        parallel_for(0, entries, 64, [&](std::size_t i) {
            const double r = static_cast<double>(i) * step_mm_;
            sharp_[c][i] = grid.profile(sharp, r), seen_[c][i] = grid.profile(seen, r);
        });
        brightest = std::max(brightest, sharp_[c][0]);
    }
    if (!(brightest > 0)) throw InputError("no light comes out of the slab on this side; make it thinner");
    gain_ = camera.peak / (brightest * camera.seconds[0]);
}

double SpotScene::light(std::size_t channel, double r_mm) const { return between(seen_[channel], r_mm / step_mm_); }

optics::RadialSamples SpotScene::truth(std::size_t channel, double spacing_mm, std::size_t samples) const {
    optics::RadialSamples result{spacing_mm, {}, total_[channel], {}};
    for (std::size_t i = 0; i < samples; ++i)
        result.light.push_back(light(channel, static_cast<double>(i) * spacing_mm));
    return result;
}

Eigen::Vector2d SpotScene::centre_px() const {
    return Eigen::Vector2d::Constant(camera_.size_px / 2.0) + camera_.offset_px;
}

namespace {

/// Full scale in, a sample out: noise, black level, quantisation.
float recorded(const SpotCamera& camera, double value, RandomStream& random) {
    const double steps = (1 << camera.bits) - 1;
    value = with_noise(value, camera.full_well, camera.read_noise, random);
    value = std::clamp(camera.black + value, 0.0, 1.0);
    return static_cast<float>(std::round(value * steps) / steps);
}

/// `light` by channel and side of the picture.
Exposure even_photograph(const SpotCamera& camera, std::uint32_t number, const std::string& name,
                         const std::array<Eigen::Vector3d, 2>& light) {
    constexpr double seconds = 1, brighter_left = 0.02;
    io::Photograph photo{name, camera.size_px, camera.size_px, io::SampleCoding::linear, 16, {}, seconds};
    photo.pixels.resize(std::size_t{camera.size_px} * camera.size_px);
    for (std::uint32_t y = 0; y < camera.size_px; ++y)
        for (std::uint32_t x = 0; x < camera.size_px; ++x) {
            const std::size_t i = photo.index(x, y);
            RandomStream random(camera.seed + 1, i, number);
            const double fall = 1 + brighter_left * (0.5 - (x + 0.5) / camera.size_px);
            for (Eigen::Index c = 0; c < 3; ++c)
                photo.pixels[i][c] = recorded(camera, fall * light[x < camera.size_px / 2 ? 0 : 1][c], random);
        }
    return {std::move(photo), seconds};
}

}  // namespace

EvenPhotographs even_photographs(const SlabProfiles& slab, double card_albedo, const SpotCamera& camera) {
    constexpr double white = 0.8;  // where a perfect diffuser would be, and the screen; part of full scale
    const Eigen::Vector3d R(slab.R[0][0], slab.R[1][0], slab.R[2][0]), T(slab.T[0][0], slab.T[1][0], slab.T[2][0]),
        one = Eigen::Vector3d::Ones(), none = Eigen::Vector3d::Zero();
    return {even_photograph(camera, 0, "card", {white * R, white * card_albedo * one}),
            even_photograph(camera, 1, "card, dark", {none, none}),
            even_photograph(camera, 2, "slab on the screen", {white * T, white * T}),
            even_photograph(camera, 3, "screen", {white * one, white * one}),
            even_photograph(camera, 4, "screen, dark", {none, none})};
}

Exposure SpotScene::photograph(std::size_t exposure, bool lit) const {
    VOXTONE_EXPECT(exposure < camera_.seconds.size());
    const SpotCamera& o = camera_;
    const double t = o.seconds[exposure];
    const double gauss = 0.5 / std::sqrt(3.0);  // two points on each axis of a pixel
    const Eigen::Vector2d centre = centre_px();
    io::Photograph photo{fmt::format("{} exposure {}", lit ? "lit" : "dark", exposure + 1),
                         o.size_px,
                         o.size_px,
                         io::SampleCoding::linear,
                         16,
                         {},
                         t};
    photo.pixels.resize(std::size_t{o.size_px} * o.size_px);
    parallel_for(0, o.size_px, 8, [&](std::size_t y) {
        for (std::uint32_t x = 0; x < o.size_px; ++x) {
            const Eigen::Vector2d middle(x + 0.5, static_cast<double>(y) + 0.5);
            const std::size_t i = photo.index(x, static_cast<std::uint32_t>(y));
            RandomStream random(o.seed, i, static_cast<std::uint32_t>(2 * exposure + (lit ? 1 : 0)));
            const double stray = o.stray * (1.5 - middle.x() / o.size_px);
            for (std::size_t c = 0; c < 3; ++c) {
                double light = stray * sharp_[c][0];
                if (lit)
                    for (const double dx : {-gauss, gauss})
                        for (const double dy : {-gauss, gauss}) {
                            const Eigen::Vector2d at = (middle + Eigen::Vector2d(dx, dy) - centre) * o.mm_per_px;
                            light +=
                                between(sharp_[c], std::hypot(at.x() / o.stretch, at.y() * o.stretch) / step_mm_) / 4;
                        }
                photo.pixels[i][static_cast<Eigen::Index>(c)] = recorded(o, std::max(0.0, light) * gain_ * t, random);
            }
        }
    });
    return {std::move(photo), t};
}

}  // namespace voxtone::calibration
