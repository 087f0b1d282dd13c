// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/decoders/picture_samples.h"

#include <array>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "base/error.h"
#include "base/warning.h"
#include "io/decoders/icc_to_srgb.h"
#include "io/decoders/sample_range.h"

namespace voxtone::io {

namespace {

constexpr float most_word = 65535.0f;

const std::vector<std::uint16_t>& srgb16_to_linear16() {
    static const std::vector<std::uint16_t> table = [] {
        std::vector<std::uint16_t> t(65536);
        for (int i = 0; i < 65536; ++i)
            t[i] = static_cast<std::uint16_t>(srgb_to_linear(static_cast<float>(i) / most_word) * most_word + 0.5f);
        return t;
    }();
    return table;
}

std::uint16_t to_word(float value) { return static_cast<std::uint16_t>(value * most_word + 0.5f); }

class TexelMaker {
public:
    TexelMaker(PictureSamples samples, const std::string& name, const DecodeOptions& options)
        : in_(std::move(samples)), name_(name), use_profile_(options.use_profile), upright_(options.turn_upright) {}

    DecodedImage make() {
        image_.texels.width_px = in_.width_px;
        image_.texels.height_px = in_.height_px;
        image_.dpi_x = in_.dpi_x;
        image_.dpi_y = in_.dpi_y;
        const double aspect = in_.dpi_x > 0 && in_.dpi_y > 0 ? in_.dpi_x / in_.dpi_y : in_.pixel_aspect;
        if (std::isfinite(aspect) && aspect > 0) image_.pixel_aspect = aspect;
        mend_sample_range({in_.bytes, in_.words, in_.floats, in_.colours.curve, in_.warnings}, name_);
        image_.warnings = std::move(in_.warnings);
        image_.lost_colour = std::move(in_.lost_colour);
        if (!use_profile_) {
            in_.icc_profile.clear();
            in_.colours = {};
        }
        check_primaries();
        if (!in_.floats.empty())
            take_floats();
        else if (!in_.words.empty())
            take_words();
        else
            take_bytes();
        if (upright_) turn_upright(in_.orientation);
        return std::move(image_);
    }

private:
    void warn(std::string text) { image_.warnings.push_back(std::move(text)); }

    void check_primaries() {
        if (has_usable_primaries(in_.colours)) return;
        in_.colours.chromaticities = PictureColours{}.chromaticities;
        warn(named_warning(
            "picture-colours",
            fmt::format("The primaries and the white that the picture {} gives make no colours; those of sRGB were "
                        "taken. Save it as sRGB.",
                        name_)));
    }

    [[nodiscard]] bool is_srgb() const {
        return in_.colours.curve == PictureCurve::srgb && !in_.colours.narrow && has_srgb_primaries(in_.colours);
    }
    [[nodiscard]] bool is_linear_srgb() const {
        return in_.colours.curve == PictureCurve::linear && !in_.colours.narrow && has_srgb_primaries(in_.colours);
    }

    template <class Value>
    void take_alpha(std::vector<Value>& rgba, Value opaque) {
        for (std::size_t i = 3; i < rgba.size() && !image_.has_alpha; i += 4) image_.has_alpha = rgba[i] < opaque;
        if (image_.has_alpha && in_.premultiplied) divide_by_alpha(rgba, opaque);
    }

    template <class Value>
    void divide_by_alpha(std::vector<Value>& rgba, Value opaque) const {
        for (std::size_t i = 0; i < rgba.size(); i += 4) {
            const float alpha = float(rgba[i + 3]) / float(opaque);
            if (alpha <= 0 || alpha >= 1) continue;
            for (std::size_t c = i; c < i + 3; ++c)
                rgba[c] = static_cast<Value>(std::min(float(opaque), float(rgba[c]) / alpha + (opaque > 1 ? 0.5f : 0)));
        }
    }

    /// Whether there was one; what it says goes before numbers in the file.
    template <class Value>
    bool apply_profile(std::vector<Value>& rgba) {
        if (in_.icc_profile.empty()) return false;
        const std::string trouble = convert_icc_to_srgb(in_.icc_profile, std::span<Value>(rgba));
        if (!trouble.empty())
            warn(named_warning("picture-colours", fmt::format("The picture {}: {}.", name_, trouble)));
        return true;
    }

    void take_bytes() {
        std::vector<std::uint8_t>& pixels = image_.texels.srgb8 = std::move(in_.bytes);
        take_alpha<std::uint8_t>(pixels, 255);
        if (apply_profile(pixels) || is_srgb()) return;
        if (!is_linear_srgb())
            return convert([&](std::size_t i) { return float(pixels[i]) / 255.0f; },
                           [&](std::size_t i, float v) { pixels[i] = linear_to_srgb8(v); });
        std::vector<std::uint16_t>& linear = image_.texels.linear16;
        linear.resize(pixels.size());
        std::transform(pixels.begin(), pixels.end(), linear.begin(),
                       [](std::uint8_t v) { return static_cast<std::uint16_t>(v * 257); });
        pixels.clear();
        pixels.shrink_to_fit();
    }

    void take_words() {
        std::vector<std::uint16_t>& pixels = image_.texels.linear16 = std::move(in_.words);
        take_alpha<std::uint16_t>(pixels, 65535);
        if (apply_profile(pixels) || is_srgb()) {
            const std::vector<std::uint16_t>& table = srgb16_to_linear16();
            for (std::size_t i = 0; i < pixels.size(); ++i)
                if (i % 4 != 3) pixels[i] = table[pixels[i]];
        } else if (!is_linear_srgb()) {
            convert([&](std::size_t i) { return float(pixels[i]) / most_word; },
                    [&](std::size_t i, float v) { pixels[i] = to_word(v); });
        }
    }

    void take_floats() {
        std::vector<float>& pixels = in_.floats;
        take_alpha<float>(pixels, 1.0f);
        std::size_t not_numbers = 0, clamped = 0;
        float most = 0;
        for (float& value : pixels) {
            most = std::max(most, value);
            not_numbers += std::isnan(value);
            clamped += value > 1 || value < 0;
            if (std::isnan(value)) value = 0;
        }
        if (not_numbers)
            warn(named_warning("damaged",
                               fmt::format("The picture {} has {} samples that are not numbers; they were taken as 0.",
                                           name_, not_numbers)));
        const bool profiled = apply_profile(pixels);
        if (profiled)
            for (std::size_t i = 0; i < pixels.size(); ++i)
                if (i % 4 != 3) pixels[i] = srgb_to_linear(std::clamp(pixels[i], 0.0f, 1.0f));
        if (!profiled && !is_linear_srgb())
            convert([&](std::size_t i) { return pixels[i]; }, [&](std::size_t i, float v) { pixels[i] = v; });
        else if (clamped)
            warn(named_warning("colour-range", fmt::format("The picture {} has {} samples outside the range 0 to 1; a "
                                                           "print cannot be brighter than white, they "
                                                           "were clamped.{}",
                                                           name_, clamped, more_if_codes(most))));
        std::vector<std::uint16_t>& linear = image_.texels.linear16;
        linear.resize(pixels.size());
        for (std::size_t i = 0; i < pixels.size(); ++i)
            linear[i] = to_word(pixels[i] > 0 ? std::min(pixels[i], 1.0f) : 0.0f);
    }

    static const char* more_if_codes(float most) {
        constexpr float bright = 16;
        return most > bright ? " If they are codes of 0 to 255, divide them by 255." : "";
    }

    /// Of all pixels: `get` a sample, 0 to 1; `set` a value of linear sRGB, clamped.
    template <class Get, class Set>
    void convert(const Get& get, const Set& set) {
        const ColourConversion conversion(in_.colours);
        constexpr float rounding = 1e-3f;
        std::size_t brighter = 0;
        for (std::size_t i = 0; i < 4 * in_.pixels(); i += 4) {
            const Eigen::Vector3f rgb = conversion({get(i), get(i + 1), get(i + 2)});
            brighter += rgb.maxCoeff() > 1 + rounding && rgb.minCoeff() > -rounding;
            for (std::size_t c = 0; c < 3; ++c) set(i + c, std::clamp(rgb[Eigen::Index(c)], 0.0f, 1.0f));
        }
        const std::string& coding = in_.colours.name.empty() ? "floating point by sRGB's curve" : in_.colours.name;
        warn(named_warning("picture-colours",
                           fmt::format("The picture {} is coded in {}; it was converted to sRGB.", name_, coding)));
        if (brighter && (in_.colours.curve == PictureCurve::pq || in_.colours.curve == PictureCurve::hlg))
            warn(named_warning("colour-range", fmt::format("{} pixels of the picture {} are brighter than its "
                                                           "reference white (203 cd/m2), which is laid on the "
                                                           "white of the print; they were clamped.",
                                                           brighter, name_)));
    }

    /// EXIF orientations 1 to 8: bit by bit a flip in x, a flip in y, a transposition.
    void turn_upright(int orientation) {
        if (orientation < 2 || orientation > 8) return;
        const bool transpose = orientation >= 5;
        const bool flip_x = orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7;
        const bool flip_y = orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8;
        TexelImage& in = image_.texels;
        TexelImage out;
        out.width_px = transpose ? in.height_px : in.width_px;
        out.height_px = transpose ? in.width_px : in.height_px;
        out.srgb8.resize(in.srgb8.size());
        out.linear16.resize(in.linear16.size());
        for (std::size_t y = 0; y < out.height_px; ++y)
            for (std::size_t x = 0; x < out.width_px; ++x) {
                const std::size_t u = flip_x ? out.width_px - 1 - x : x, v = flip_y ? out.height_px - 1 - y : y;
                const std::size_t from = transpose ? u * in.width_px + v : v * in.width_px + u,
                                  to = y * out.width_px + x;
                if (in.is_8_bit())
                    std::copy_n(in.srgb8.begin() + std::ptrdiff_t(4 * from), 4,
                                out.srgb8.begin() + std::ptrdiff_t(4 * to));
                else
                    std::copy_n(in.linear16.begin() + std::ptrdiff_t(4 * from), 4,
                                out.linear16.begin() + std::ptrdiff_t(4 * to));
            }
        in = std::move(out);
        if (!transpose) return;
        std::swap(image_.dpi_x, image_.dpi_y);
        image_.pixel_aspect = 1 / image_.pixel_aspect;
    }

    PictureSamples in_;
    const std::string& name_;
    const bool use_profile_, upright_;
    DecodedImage image_;
};

}  // namespace

void check_picture_size(std::uint64_t width_px, std::uint64_t height_px, const std::string& name,
                        const DecodeOptions& options) {
    if (width_px == 0 || height_px == 0)
        throw InputError(fmt::format("the picture {} declares an impossible size ({} x {} pixels); it is damaged", name,
                                     width_px, height_px));
    if (height_px > options.max_pixels / width_px)
        throw InputError(fmt::format("the picture {} declares {} x {} pixels, more than the {} allowed; scale it down",
                                     name, width_px, height_px, options.max_pixels));
}

DecodedImage to_texels(PictureSamples samples, const std::string& name, const DecodeOptions& options) {
    return TexelMaker(std::move(samples), name, options).make();
}

}  // namespace voxtone::io
