// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/pictures/photograph.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "voxtone/base/contracts.h"
#include "voxtone/base/error.h"
#include "voxtone/io/files/isolate.h"
#include "voxtone/io/pictures/srgb_code.h"

namespace voxtone::io {

namespace {

constexpr std::uint64_t most_pixels = std::uint64_t{1} << 28;
constexpr const char* raw_format = "raw";
constexpr double most_seconds = 300;

/// What goes from the child to its parent before the pixels.
struct Header {
    std::uint32_t width_px, height_px;
    std::int32_t coding, bits;
    double exposure_s;
};

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

/// Neither in the child, where no other thread exists, nor in its parent: a child waits for ever for the pool of a
/// parent that wrote an EXR before.
void start_no_threads() {
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", -1);
}

std::vector<std::byte> decode(const std::filesystem::path& file) {
    start_no_threads();
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
    if (spec.nchannels < 3)
        throw InputError(fmt::format("the photograph {} has {} channel(s); red, green and blue are needed",
                                     file.string(), spec.nchannels));
    const bool raw = std::strcmp(input->format_name(), raw_format) == 0;
    const Header header{std::uint32_t(spec.width), std::uint32_t(spec.height),
                        std::int32_t(raw ? SampleCoding::linear : coding_of(spec)),
                        std::int32_t(8 * spec.format.size()), spec.get_float_attribute("ExposureTime", 0)};
    const std::size_t values = std::size_t(spec.width) * std::size_t(spec.height) * 3;
    std::vector<std::byte> bytes(sizeof header + values * sizeof(float));
    std::memcpy(bytes.data(), &header, sizeof header);
    if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, bytes.data() + sizeof header))
        throw InputError(fmt::format("the photograph {} cannot be decoded ({}); it is damaged or cut short",
                                     file.string(), input->geterror()));
    return bytes;
}

}  // namespace

Photograph read_photograph(const std::filesystem::path& file, const Progress* progress) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error))
        throw FileError(fmt::format("the photograph {} is not there or is no file", file.string()));
    IsolationLimits limits;
    limits.memory_bytes = built_with_address_sanitizer() ? 0 : std::uint64_t{12} << 30;
    limits.timeout_s = most_seconds;
    const std::vector<std::byte> bytes = run_isolated(
        file.string(), limits, [&] { return decode(file); }, progress);
    Header header{};
    VOXTONE_EXPECT(bytes.size() >= sizeof header);
    std::memcpy(&header, bytes.data(), sizeof header);
    Photograph photograph{file.filename().string(),
                          header.width_px,
                          header.height_px,
                          SampleCoding(header.coding),
                          header.bits,
                          {},
                          header.exposure_s > 0 && std::isfinite(header.exposure_s) ? header.exposure_s : 0};
    photograph.pixels.resize(std::size_t{header.width_px} * header.height_px);
    VOXTONE_EXPECT(bytes.size() == sizeof header + photograph.pixels.size() * sizeof(Eigen::Vector3f));
    std::memcpy(static_cast<void*>(photograph.pixels.data()), bytes.data() + sizeof header,
                bytes.size() - sizeof header);
    for (Eigen::Vector3f& pixel : photograph.pixels)
        for (float& value : pixel)
            if (!std::isfinite(value)) value = 0;
    return photograph;
}

void make_linear(Photograph& photograph) {
    if (photograph.coding == SampleCoding::linear) return;
    for (Eigen::Vector3f& pixel : photograph.pixels)
        for (float& value : pixel) value = srgb_to_linear(value);
    photograph.coding = SampleCoding::linear;
}

std::vector<std::uint8_t> photograph_bytes(const Photograph& photograph, const std::string& file_name) {
    const std::string extension = std::filesystem::path(file_name).extension().string();
    const bool png = extension == ".png", tiff = extension == ".tif" || extension == ".tiff", exr = extension == ".exr";
    if (!png && !tiff && !exr)
        throw UsageError(fmt::format("{}: photographs are written as .png, .tif or .exr", file_name));
    const bool codes = photograph.bits == 8;
    if (codes && !png) throw UsageError(fmt::format("{}: 8-bit photographs are written as .png", file_name));
    OIIO::ImageSpec spec(int(photograph.width_px), int(photograph.height_px), 3,
                         exr     ? OIIO::TypeDesc::FLOAT
                         : codes ? OIIO::TypeDesc::UINT8
                                 : OIIO::TypeDesc::UINT16);
    spec.attribute("oiio:ColorSpace", codes ? "sRGB" : "Linear");
    spec.attribute("compression", png ? "" : "zip");
    start_no_threads();
    if (exr)
        spec.attribute("DateTime",
                       "2000:01:01 00:00:00");  // else the time of day: no two runs would write the same bits
    if (exr && photograph.exposure_s > 0) spec.attribute("ExposureTime", float(photograph.exposure_s));
    std::vector<Eigen::Vector3f> coded;
    if (codes) {
        coded = photograph.pixels;
        for (Eigen::Vector3f& pixel : coded)
            for (float& value : pixel) value = float(linear_to_srgb8(value)) / 255.0f;
    }
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const std::string kind = tiff ? "photograph.tif" : "photograph" + extension;
    const auto output = OIIO::ImageOutput::create(kind, &memory);
    if (!output || !output->open(kind, spec) ||
        !output->write_image(OIIO::TypeDesc::FLOAT, (codes ? coded : photograph.pixels).data()) || !output->close())
        throw std::logic_error("photograph: " + (output ? output->geterror() : OIIO::geterror()));
    return bytes;
}

}  // namespace voxtone::io
