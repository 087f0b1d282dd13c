// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/decoders/picture_colours.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/LU>

#include "io/pictures/srgb_code.h"
#include "optics/colour/colour.h"

namespace voxtone::io {

namespace {

constexpr double reference_white_nits = 203;  // BT.2408-7, table 1
constexpr double hlg_display_nits = 1000;     // BT.2100-2: the nominal display, whose system gamma is 1.2
constexpr double hlg_system_gamma = 1.2;

struct Primaries {
    int code;
    const char* name;
    std::array<double, 8> chromaticities;
};

// H.273, table 2
constexpr Primaries known_primaries[] = {
    {1, "BT.709", {0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329}},
    {4, "BT.470 M", {0.67, 0.33, 0.21, 0.71, 0.14, 0.08, 0.31, 0.316}},
    {5, "BT.601 (625 lines)", {0.64, 0.33, 0.29, 0.6, 0.15, 0.06, 0.3127, 0.329}},
    {6, "BT.601 (525 lines)", {0.63, 0.34, 0.31, 0.595, 0.155, 0.07, 0.3127, 0.329}},
    {7, "SMPTE 240M", {0.63, 0.34, 0.31, 0.595, 0.155, 0.07, 0.3127, 0.329}},
    {9, "BT.2020", {0.708, 0.292, 0.17, 0.797, 0.131, 0.046, 0.3127, 0.329}},
    {11, "DCI-P3", {0.68, 0.32, 0.265, 0.69, 0.15, 0.06, 0.314, 0.351}},
    {12, "Display P3", {0.68, 0.32, 0.265, 0.69, 0.15, 0.06, 0.3127, 0.329}},
};

struct Transfer {
    int code;
    const char* name;
    PictureCurve curve;
    double gamma = 2.2;
};

// H.273, table 3. The curve of a camera (BT.709 and its kin) is shown by the inverse of sRGB's, as viewers do.
constexpr Transfer known_transfers[] = {
    {1, "", PictureCurve::srgb},
    {4, "gamma 2.2", PictureCurve::gamma, 2.2},
    {5, "gamma 2.8", PictureCurve::gamma, 2.8},
    {6, "", PictureCurve::srgb},
    {8, "linear", PictureCurve::linear},
    {13, "", PictureCurve::srgb},
    {14, "", PictureCurve::srgb},
    {15, "", PictureCurve::srgb},
    {16, "PQ", PictureCurve::pq},
    {18, "HLG", PictureCurve::hlg},
};

/// BT.2100-2, table 4: cd/m2 of a PQ code.
double pq_nits(double code) {
    constexpr double m1 = 2610.0 / 16384, m2 = 2523.0 / 32, c1 = 3424.0 / 4096, c2 = 2413.0 / 128, c3 = 2392.0 / 128;
    const double root = std::pow(std::clamp(code, 0.0, 1.0), 1 / m2);
    return 10000 * std::pow(std::max(root - c1, 0.0) / (c2 - c3 * root), 1 / m1);
}

/// BT.2100-2, table 5: scene light, 0 to 1, of an HLG code.
double hlg_scene(double code) {
    constexpr double a = 0.17883277, b = 1 - 4 * a;
    const double c = 0.5 - a * std::log(4 * a), x = std::clamp(code, 0.0, 1.0);
    return x <= 0.5 ? x * x / 3 : (std::exp((x - c) / a) + b) / 12;
}

Eigen::Vector3d xyz_of(double x, double y) { return {x / y, 1, (1 - x - y) / y}; }

/// Columns: XYZ of the primaries so that their sum is white, Y 1. A primary without Y, as those of XYZ itself, is one.
Eigen::Matrix3d to_xyz(const std::array<double, 8>& c) {
    Eigen::Matrix3d primaries;
    for (std::size_t i = 0; i < 6; i += 2) primaries.col(Eigen::Index(i / 2)) << c[i], c[i + 1], 1 - c[i] - c[i + 1];
    const Eigen::Vector3d amounts = primaries.fullPivLu().solve(xyz_of(c[6], c[7]));
    return primaries * amounts.asDiagonal();
}

}  // namespace

PictureColours colours_of_code_points(int primaries, int transfer) {
    PictureColours colours;
    const auto* const p = std::ranges::find(known_primaries, primaries, &Primaries::code);
    const auto* const t = std::ranges::find(known_transfers, transfer, &Transfer::code);
    if (p != std::end(known_primaries)) colours.chromaticities = p->chromaticities;
    if (t != std::end(known_transfers)) {
        colours.curve = t->curve;
        colours.gamma = t->gamma;
    }
    colours.known = p != std::end(known_primaries) && t != std::end(known_transfers);
    colours.name = p != std::end(known_primaries) ? p->name : fmt::format("unknown primaries ({})", primaries);
    if (t == std::end(known_transfers))
        colours.name += fmt::format(", unknown curve ({})", transfer);
    else if (*t->name)
        colours.name += fmt::format(", {}", t->name);
    return colours;
}

bool has_srgb_primaries(const PictureColours& colours) {
    constexpr double rounding = 0.002;
    const PictureColours srgb;
    for (std::size_t i = 0; i < srgb.chromaticities.size(); ++i)
        if (!(std::abs(colours.chromaticities[i] - srgb.chromaticities[i]) <= rounding)) return false;
    return true;
}

bool has_usable_primaries(const PictureColours& colours) {
    constexpr double least_y = 0.01, least_volume = 1e-6;  // of a white; of the body of colours
    if (!(colours.chromaticities[7] >= least_y)) return false;
    const Eigen::Matrix3d xyz = to_xyz(colours.chromaticities);
    return xyz.allFinite() && std::abs(xyz.determinant()) >= least_volume;
}

ColourConversion::ColourConversion(const PictureColours& colours) : colours_(colours) {
    const PictureColours srgb;
    const Eigen::Vector3d white = xyz_of(colours.chromaticities[6], colours.chromaticities[7]);
    const Eigen::Vector3d d65 = xyz_of(srgb.chromaticities[6], srgb.chromaticities[7]);
    Eigen::Matrix3d xyz = to_xyz(colours.chromaticities);
    luminance_ = xyz.row(1).cast<float>();
    for (int i = 0; i < 3; ++i) xyz.col(i) = optics::adapt_white(xyz.col(i), white, d65);
    matrix_ = (to_xyz(srgb.chromaticities).inverse() * xyz).cast<float>();
}

float ColourConversion::decoded(float sample) const {
    if (colours_.narrow) sample = std::clamp((255 * sample - 16) / 219, 0.0f, 1.0f);
    switch (colours_.curve) {
        case PictureCurve::linear:
            return sample;
        case PictureCurve::gamma:
            return std::pow(std::max(sample, 0.0f), static_cast<float>(colours_.gamma));
        case PictureCurve::pq:
            return static_cast<float>(pq_nits(sample) / reference_white_nits);
        case PictureCurve::hlg:
            return static_cast<float>(hlg_scene(sample));
        default:
            return srgb_to_linear(sample);
    }
}

Eigen::Vector3f ColourConversion::operator()(const Eigen::Vector3f& samples) const {
    Eigen::Vector3f light(decoded(samples.x()), decoded(samples.y()), decoded(samples.z()));
    if (colours_.curve == PictureCurve::hlg) {  // BT.2100-2, table 5: the display brightens what is bright
        const float y = std::max(static_cast<float>(luminance_ * light), 0.0f);
        light *= static_cast<float>(hlg_display_nits / reference_white_nits) *
                 std::pow(y, static_cast<float>(hlg_system_gamma - 1));
    }
    return matrix_ * light;
}

}  // namespace voxtone::io
