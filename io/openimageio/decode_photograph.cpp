// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/openimageio/decode_photograph.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "base/error.h"
#include "io/decoders/icc_to_srgb.h"
#include "io/openimageio/image_rows.h"
#include "io/openimageio/no_threads.h"
#include "optics/colour/colour.h"

namespace voxtone::io {

namespace {

constexpr std::uint64_t most_pixels = std::uint64_t{1} << 28;
constexpr const char* raw_format = "raw";

SampleCoding coding_of(const OIIO::ImageSpec& spec) {
    const std::string space = spec.get_string_attribute("oiio:ColorSpace");
    if (OIIO::Strutil::iequals(space, "linear") || OIIO::Strutil::iequals(space, "lin_srgb") ||
        spec.format.is_floating_point())
        return SampleCoding::linear;
    return spec.format.size() == 1 ? SampleCoding::srgb : SampleCoding::unknown;
}

/// No white balance of the file's own, no curve, no brightening, no conversion of colours: the checker does all that.
void ask_for_sensor_values(OIIO::ImageSpec& config) {
    config.attribute("raw:ColorSpace", "raw");
    config.attribute("raw:auto_bright", 0);
    config.attribute("raw:use_camera_wb", 0);
    config.attribute("raw:use_auto_wb", 0);
    config.attribute("raw:HighlightMode", 0);
    config.attribute("raw:adjust_maximum_thr", 0.0f);
    constexpr float as_counted[4] = {1, 1, 1, 1};
    config.attribute("raw:user_mul", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 4), as_counted);
}

/// Nothing is cut off at 0 and 1: colours of a wider space than sRGB keep their light. A profile that cannot be used
/// changes nothing.
void apply_profile(const OIIO::ImageSpec& spec, Photograph& photograph) {
    const OIIO::ParamValue* const profile = spec.find_attribute("ICCProfile");
    if (!profile) return;
    std::vector<float> rgba(4 * photograph.pixels.size(), 1.0f);
    for (std::size_t i = 0; i < photograph.pixels.size(); ++i)
        std::copy_n(photograph.pixels[i].data(), 3, &rgba[4 * i]);
    if (!convert_icc_to_srgb({static_cast<const std::uint8_t*>(profile->data()), std::size_t(profile->datasize())},
                             std::span<float>(rgba))
             .empty())
        return;
    // Little CMS 2.14 goes on below no light as a straight line, 12.92 codes to one of light; codes here are odd.
    constexpr double codes_of_light = 12.92;
    for (std::size_t i = 0; i < photograph.pixels.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const float code = rgba[4 * i + c];
            photograph.pixels[i][Eigen::Index(c)] =
                code < 0 ? static_cast<float>(optics::srgb_encode(code / codes_of_light)) : code;
        }
    photograph.coding = SampleCoding::srgb;
}

}  // namespace

Photograph decode_photograph(const std::filesystem::path& file, bool by_profile) {
    use_no_threads();
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    ask_for_sensor_values(config);
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(file.string(), &config);
    if (!input)
        throw InputError(fmt::format(
            "the photograph {} cannot be read ({}); give a 16-bit TIFF or PNG, an EXR, or a camera's RAW file",
            file.string(), OIIO::geterror()));
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.width <= 0 || spec.height <= 0 || spec.depth > 1 ||
        std::uint64_t(spec.width) * std::uint64_t(spec.height) > most_pixels)
        throw InputError(fmt::format(
            "the photograph {} declares an impossible size ({} x {} pixels); it is damaged or larger than {} pixels",
            file.string(), spec.width, spec.height, most_pixels));
    if (has_wide_numbers(spec))
        throw InputError(
            fmt::format("the photograph {} is stored as 64-bit numbers, which are not read; save it with 16 or 32 bits",
                        file.string()));
    if (spec.nchannels < 3)
        throw InputError(fmt::format("the photograph {} has {} channel(s); red, green and blue are needed",
                                     file.string(), spec.nchannels));
    const bool raw = std::strcmp(input->format_name(), raw_format) == 0;
    Photograph photograph{file.filename().string(),
                          std::uint32_t(spec.width),
                          std::uint32_t(spec.height),
                          raw ? SampleCoding::linear : coding_of(spec),
                          int(8 * spec.format.size()),
                          {},
                          spec.get_float_attribute("ExposureTime", 0),
                          raw ? 1 : spec.get_int_attribute("Orientation", 1)};
    photograph.pixels.resize(std::size_t(spec.width) * std::size_t(spec.height));
    if (!read_rows(*input, 3, OIIO::TypeDesc(OIIO::TypeDesc::FLOAT), photograph.pixels.data()))
        throw InputError(fmt::format("the photograph {} cannot be decoded ({}); it is damaged or cut short",
                                     file.string(), input->geterror()));
    if (by_profile && !raw && !spec.format.is_floating_point()) apply_profile(spec, photograph);
    return photograph;
}

}  // namespace voxtone::io
