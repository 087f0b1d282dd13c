// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the samples of a picture mean where its file says so by numbers and not by an ICC profile: primaries, white and
// curve (PNG's cICP, cHRM and gAMA; OpenEXR's chromaticities).
//
// linear sRGB = M curve(sample), with M from the primaries (CIE xy) to those of sRGB; another white is adapted to D65
// (Bradford). Pictures of high dynamic range are laid so that their reference white, 203 cd/m2, is paper white; what is
// brighter is clamped. Colours that sRGB does not have are clamped, too.
// Source: ITU-T H.273 (code points), ITU-R BT.2100-2 (PQ, HLG), BT.2408-7 (reference white), W3C PNG 3 (cICP).
#pragma once

#include <array>
#include <optional>
#include <string>

#include <Eigen/Core>

namespace voxtone::io {

enum class PictureCurve { srgb, linear, gamma, pq, hlg };

struct PictureColours {
    /// x and y of red, green, blue, white; those of sRGB.
    std::array<double, 8> chromaticities{0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329};
    PictureCurve curve = PictureCurve::srgb;
    double gamma = 2.2;   ///< PictureCurve::gamma: linear = sample^gamma; > 0
    std::string name{};   ///< in words, for messages: "Display P3"
    bool narrow = false;  ///< black is 16 and white 235 of 255, as in video
    bool known = true;    ///< false: sRGB's stand for numbers that are not known
};

/// Of H.273's numbers. Where one of them is not known, sRGB's stand in its place, and `name` says which were not known.
[[nodiscard]] PictureColours colours_of_code_points(int primaries, int transfer);

/// Whether the primaries are those of sRGB, within what files round them to.
[[nodiscard]] bool has_srgb_primaries(const PictureColours& colours);

/// Whether there is a body of colours between black, the primaries and white; without one nothing can be converted.
[[nodiscard]] bool has_usable_primaries(const PictureColours& colours);

/// From samples, 0 to 1, to linear sRGB, not clamped.
class ColourConversion {
public:
    /// Expects usable primaries.
    explicit ColourConversion(const PictureColours& colours);
    [[nodiscard]] Eigen::Vector3f operator()(const Eigen::Vector3f& samples) const;

private:
    [[nodiscard]] float decoded(float sample) const;

    PictureColours colours_;
    Eigen::Matrix3f matrix_;        ///< from its own linear light to that of sRGB
    Eigen::RowVector3f luminance_;  ///< Y of its own linear light
};

}  // namespace voxtone::io
