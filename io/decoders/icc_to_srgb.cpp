// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/decoders/icc_to_srgb.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>

#include <lcms2.h>

namespace voxtone::io {

namespace {

struct CloseProfile {
    void operator()(void* profile) const { cmsCloseProfile(profile); }
};
struct DeleteTransform {
    void operator()(void* transform) const { cmsDeleteTransform(transform); }
};
using Profile = std::unique_ptr<void, CloseProfile>;
using Transform = std::unique_ptr<void, DeleteTransform>;

/// Largest difference of any channel over a grid of 9^3 colours, in codes of 255.
int distance_from_identity(cmsHTRANSFORM transform) {
    int worst = 0;
    for (int i = 0; i < 729; ++i) {
        const std::array<std::uint8_t, 4> in{static_cast<std::uint8_t>(i % 9 * 255 / 8),
                                             static_cast<std::uint8_t>(i / 9 % 9 * 255 / 8),
                                             static_cast<std::uint8_t>(i / 81 * 255 / 8), 255};
        std::array<std::uint8_t, 4> out{};
        cmsDoTransform(transform, in.data(), out.data(), 1);
        for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(in[c] - out[c]));
    }
    return worst;
}

/// In place, four values a pixel.
template <class Value>
void transform_all(const Transform& transform, std::span<Value> values) {
    constexpr std::size_t chunk = 1 << 16;  // pixels; their number may not fit what the library counts in
    for (std::size_t first = 0; first < values.size() / 4; first += chunk) {
        Value* const pixels = values.data() + 4 * first;
        cmsDoTransform(transform.get(), pixels, pixels,
                       static_cast<cmsUInt32Number>(std::min(chunk, values.size() / 4 - first)));
    }
}

/// Of 16 bits the library would look colours up in a table of 33 points an edge that it makes itself (2.14 of Debian
/// 12): the dark ones of ProPhoto come out up to 1.6 CIEDE2000 off. Computed one by one they take some microsecond
/// each.
template <class Value>
constexpr cmsUInt32Number flags_for = cmsFLAGS_NOCACHE | (sizeof(Value) == 2 ? cmsFLAGS_NOOPTIMIZE : 0);

template <class Value>
std::string convert(std::span<const std::uint8_t> bytes, std::span<Value> rgba, cmsUInt32Number type) {
    const Profile profile(cmsOpenProfileFromMem(bytes.data(), static_cast<cmsUInt32Number>(bytes.size())));
    if (!profile) return "its ICC profile is broken; its colours were taken as sRGB";
    if (cmsGetColorSpace(profile.get()) != cmsSigRgbData)
        return "its ICC profile is not for RGB; its colours were taken as sRGB";
    const Profile srgb(cmsCreate_sRGBProfile());
    constexpr cmsUInt32Number flags = cmsFLAGS_COPY_ALPHA | flags_for<Value>;
    const auto make = [&](cmsUInt32Number t) {
        return Transform(cmsCreateTransform(profile.get(), t, srgb.get(), t, INTENT_RELATIVE_COLORIMETRIC, flags));
    };
    const Transform probe = make(TYPE_RGBA_8);
    if (!probe) return "its ICC profile cannot be converted; its colours were taken as sRGB";
    if (distance_from_identity(probe.get()) <= 2) return {};
    const Transform transform = make(type);
    if (!transform) return "its ICC profile cannot be converted; its colours were taken as sRGB";
    transform_all(transform, rgba);
    return {};
}

/// As lcms counts: 8 and 16 bits of CMYK are 0 for no ink.
template <class Value>
std::string convert_inks(std::span<const std::uint8_t> bytes, std::span<Value> pixels, cmsUInt32Number in,
                         cmsUInt32Number out) {
    const Profile profile(cmsOpenProfileFromMem(bytes.data(), static_cast<cmsUInt32Number>(bytes.size())));
    if (!profile || cmsGetColorSpace(profile.get()) != cmsSigCmykData) return "its ICC profile is not for CMYK";
    const Profile srgb(cmsCreate_sRGBProfile());
    const Transform transform(
        cmsCreateTransform(profile.get(), in, srgb.get(), out, INTENT_RELATIVE_COLORIMETRIC, flags_for<Value>));
    if (!transform) return "its ICC profile cannot be converted";
    transform_all(transform, pixels);
    return {};
}

}  // namespace

std::string convert_icc_to_srgb(std::span<const std::uint8_t> profile, std::span<std::uint8_t> rgba) {
    return convert(profile, rgba, TYPE_RGBA_8);
}

std::string convert_icc_to_srgb(std::span<const std::uint8_t> profile, std::span<std::uint16_t> rgba) {
    return convert(profile, rgba, TYPE_RGBA_16);
}

std::string convert_icc_to_srgb(std::span<const std::uint8_t> profile, std::span<float> rgba) {
    return convert(profile, rgba, TYPE_RGBA_FLT);
}

std::string convert_cmyk_icc_to_srgb(std::span<const std::uint8_t> profile, std::span<std::uint8_t> pixels) {
    return convert_inks(profile, pixels, TYPE_CMYK_8, TYPE_RGBA_8);
}

std::string convert_cmyk_icc_to_srgb(std::span<const std::uint8_t> profile, std::span<std::uint16_t> pixels) {
    return convert_inks(profile, pixels, TYPE_CMYK_16, TYPE_RGBA_16);
}

}  // namespace voxtone::io
