// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/codecs/decode_image.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "voxtone/base/error.h"
#include "voxtone/io/codecs/icc_to_srgb.h"
#include "voxtone/io/codecs/image_rows.h"
#include "voxtone/io/codecs/jpeg_end.h"
#include "voxtone/io/codecs/no_threads.h"

namespace voxtone::io {

namespace {

struct Magic {
    const char* format;  // as OpenImageIO names it
    std::string_view mark;
    std::size_t at = 0;
};

using namespace std::string_view_literals;
constexpr Magic magics[] = {
    {"png", "\x89PNG\r\n\x1a\n"sv},
    {"jpeg", "\xff\xd8\xff"sv},
    {"tiff", "II*\0"sv},
    {"tiff", "MM\0*"sv},
    {"tiff", "II+\0"sv},
    {"tiff", "MM\0+"sv},
    {"bmp", "BM"sv},
    {"openexr", "\x76\x2f\x31\x01"sv},
    {"hdr", "#?RADIANCE"sv},
    {"hdr", "#?RGBE"sv},
    {"webp", "WEBP"sv, 8},
    {"gif", "GIF8"sv},
    {"pnm", "P1"sv},
    {"pnm", "P2"sv},
    {"pnm", "P3"sv},
    {"pnm", "P4"sv},
    {"pnm", "P5"sv},
    {"pnm", "P6"sv},
    {"pnm", "PF"sv},
    {"pnm", "Pf"sv},
};

void check_pixels(std::uint64_t width, std::uint64_t height, const std::string& name, const DecodeOptions& options) {
    if (width * height > options.max_pixels)
        throw InputError(fmt::format("the picture {} declares {} x {} pixels, more than the {} allowed; scale it down",
                                     name, width, height, options.max_pixels));
}

/// A GIF's canvas, which OpenImageIO takes memory for before it tells its size: two 16-bit numbers behind the mark.
void check_gif_canvas(std::span<const std::byte> bytes, const std::string& name, const DecodeOptions& options) {
    if (bytes.size() < 10) return;  // cut short: opening says so
    const auto number = [&](std::size_t at) { return std::to_integer<std::uint64_t>(bytes[at]); };
    check_pixels(number(6) + 256 * number(7), number(8) + 256 * number(9), name, options);
}

/// The attributes of an OpenEXR header, for which OpenEXR takes as much memory as they declare: a name, a type, each
/// closed by 0, and a 32-bit length.
void check_exr_header(std::span<const std::byte> bytes, const std::string& name) {
    std::size_t at = 8;  // behind the mark and the version
    const auto skip_word = [&] {
        while (at < bytes.size() && bytes[at] != std::byte{}) ++at;
        ++at;
    };
    while (at < bytes.size() && bytes[at] != std::byte{}) {
        skip_word();
        skip_word();
        std::uint64_t length = 0;
        for (std::size_t i = 0; i < 4 && at + i < bytes.size(); ++i)
            length |= std::to_integer<std::uint64_t>(bytes[at + i]) << (8 * i);
        at += 4;
        if (at > bytes.size() || length > bytes.size() - at)
            throw InputError(fmt::format(
                "the picture {} declares more in its header than its {} bytes hold; it is damaged or cut short", name,
                bytes.size()));
        at += length;
    }
}

/// The bytes as an open file without a name on the disk, for readers that want a path.
class MemoryFile {
public:
    explicit MemoryFile(std::span<const std::byte> bytes) : fd_(memfd_create("picture", MFD_CLOEXEC)) {
        for (std::size_t done = 0; fd_ >= 0 && done < bytes.size();) {
            const ssize_t written = write(fd_, bytes.data() + done, bytes.size() - done);
            if (written <= 0) throw std::bad_alloc();
            done += static_cast<std::size_t>(written);
        }
    }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    ~MemoryFile() {
        if (fd_ >= 0) close(fd_);
    }
    [[nodiscard]] std::string path() const { return fmt::format("/proc/self/fd/{}", fd_); }

private:
    int fd_;
};

enum class Coding { srgb, linear };

Coding coding_of(const OIIO::ImageSpec& spec, bool is_float, const DecodeOptions& options,
                 std::vector<std::string>& warnings, const std::string& name) {
    const std::string space = spec.get_string_attribute("oiio:ColorSpace");
    if (!options.use_profile) return Coding::srgb;
    if (OIIO::Strutil::iequals(space, "linear")) return Coding::linear;
    if (space.empty()) return is_float ? Coding::linear : Coding::srgb;
    if (OIIO::Strutil::istarts_with(space, "gamma")) {
        const float gamma = spec.get_float_attribute("oiio:Gamma", 2.2f);
        if (std::abs(gamma - 1) < 0.01f) return Coding::linear;
        if (gamma < 2 || gamma > 2.5f)
            warnings.push_back(
                fmt::format("The picture {} says that it has a gamma of {:.3g}; it was taken as sRGB.", name, gamma));
    }
    return Coding::srgb;
}

/// Spreads 1 to 4 channels to RGBA in place of a buffer of 4 channels; `channels` says what was read.
template <class Value>
void spread_to_rgba(std::vector<Value>& pixels, std::size_t count, int channels, bool second_is_alpha, Value opaque) {
    if (channels == 4) return;
    for (std::size_t i = count; i-- > 0;) {  // from the back, so that nothing is overwritten before it is read
        Value in[3]{};
        for (int c = 0; c < channels; ++c) in[c] = pixels[i * channels + c];
        const bool grey = channels < 3;
        pixels[4 * i] = in[0];
        pixels[4 * i + 1] = grey ? in[0] : in[1];
        pixels[4 * i + 2] = grey ? in[0] : in[2];
        pixels[4 * i + 3] = channels == 2 && second_is_alpha ? in[1] : opaque;
    }
}

const std::vector<std::uint16_t>& srgb16_to_linear16() {
    static const std::vector<std::uint16_t> table = [] {
        std::vector<std::uint16_t> t(65536);
        for (int i = 0; i < 65536; ++i)
            t[i] = static_cast<std::uint16_t>(srgb_to_linear(static_cast<float>(i) / 65535.0f) * 65535.0f + 0.5f);
        return t;
    }();
    return table;
}

class ImageDecoder {
public:
    ImageDecoder(OIIO::ImageInput& input, const std::string& name, const DecodeOptions& options)
        : input_(input), spec_(input.spec()), name_(name), options_(options) {}

    DecodedImage decode() {
        check_size();
        image_.texels.width_px = static_cast<std::uint32_t>(spec_.width);
        image_.texels.height_px = static_cast<std::uint32_t>(spec_.height);
        count_ = image_.texels.pixels();
        channels_ = std::min(spec_.nchannels, 4);
        if (spec_.nchannels > 4)
            warn(fmt::format("The picture {} has {} channels; the first four were taken as red, green, blue and alpha.",
                             name_, spec_.nchannels));
        if (OIIO::Strutil::icontains(spec_.get_string_attribute("oiio:ColorSpace"), "cmyk") ||
            OIIO::Strutil::icontains(spec_.get_string_attribute("jpeg:ColorSpace"), "cmyk"))
            warn(fmt::format(
                "The picture {} is CMYK; it was converted without its profile, so that its colours are rough. "
                "Save it as RGB to be exact.",
                name_));
        const bool is_float = spec_.format.is_floating_point();
        const Coding coding = coding_of(spec_, is_float, options_, image_.warnings, name_);
        if (is_float)
            read_float(coding);
        else if (spec_.format.size() > 1)
            read_16(coding);
        else
            read_8(coding);
        read_resolution();
        if (options_.turn_upright) turn_upright(spec_.get_int_attribute("Orientation", 1));
        return std::move(image_);
    }

private:
    void warn(std::string text) { image_.warnings.push_back(std::move(text)); }

    void check_size() const {
        if (spec_.width <= 0 || spec_.height <= 0 || spec_.nchannels <= 0 || spec_.depth > 1)
            throw InputError(fmt::format(
                "the picture {} declares an impossible size ({} x {} x {} pixels, {} channels); it is damaged", name_,
                spec_.width, spec_.height, spec_.depth, spec_.nchannels));
        check_pixels(std::uint64_t(spec_.width), std::uint64_t(spec_.height), name_, options_);
    }

    template <class Value>
    void read(std::vector<Value>& pixels, OIIO::TypeDesc type, Value opaque) {
        pixels.resize(4 * count_);
        if (!read_rows(input_, channels_, type, pixels.data()))
            throw InputError(fmt::format("the picture {} cannot be decoded ({}); it is damaged or cut short", name_,
                                         input_.geterror()));
        const bool second_is_alpha = spec_.alpha_channel == 1;
        spread_to_rgba(pixels, count_, channels_, second_is_alpha, opaque);
        if (channels_ == 4 && spec_.nchannels == 4 && spec_.alpha_channel < 0)
            for (std::size_t i = 0; i < count_; ++i) pixels[4 * i + 3] = opaque;
        for (std::size_t i = 0; i < count_ && !image_.has_alpha; ++i) image_.has_alpha = pixels[4 * i + 3] < opaque;
    }

    /// RGB of pixels that were stored multiplied by their alpha.
    template <class Value>
    void divide_by_alpha(std::vector<Value>& pixels, Value opaque) const {
        if (!image_.has_alpha || spec_.get_int_attribute("oiio:UnassociatedAlpha", 0) != 0) return;
        for (std::size_t i = 0; i < count_; ++i) {
            const float alpha = float(pixels[4 * i + 3]) / float(opaque);
            if (alpha <= 0 || alpha >= 1) continue;
            for (int c = 0; c < 3; ++c)
                pixels[4 * i + c] = static_cast<Value>(
                    std::min(float(opaque), float(pixels[4 * i + c]) / alpha + (opaque > 1 ? 0.5f : 0)));
        }
    }

    template <class Value>
    void apply_profile(std::vector<Value>& rgba) {
        const OIIO::ParamValue* profile = spec_.find_attribute("ICCProfile");
        if (!profile || !options_.use_profile) return;
        const auto* bytes = static_cast<const std::uint8_t*>(profile->data());
        const std::string trouble =
            convert_icc_to_srgb({bytes, static_cast<std::size_t>(profile->datasize())}, std::span<Value>(rgba));
        if (!trouble.empty()) warn(fmt::format("The picture {}: {}.", name_, trouble));
    }

    void read_8(Coding coding) {
        std::vector<std::uint8_t>& pixels = image_.texels.srgb8;
        read<std::uint8_t>(pixels, OIIO::TypeDesc::UINT8, 255);
        divide_by_alpha<std::uint8_t>(pixels, 255);
        if (coding == Coding::srgb) return apply_profile(pixels);
        std::vector<std::uint16_t>& linear = image_.texels.linear16;
        linear.resize(pixels.size());
        std::transform(pixels.begin(), pixels.end(), linear.begin(),
                       [](std::uint8_t v) { return static_cast<std::uint16_t>(v * 257); });
        pixels.clear();
        pixels.shrink_to_fit();
    }

    void read_16(Coding coding) {
        std::vector<std::uint16_t>& pixels = image_.texels.linear16;
        read<std::uint16_t>(pixels, OIIO::TypeDesc::UINT16, 65535);
        divide_by_alpha<std::uint16_t>(pixels, 65535);
        if (coding == Coding::linear) return;
        apply_profile(pixels);
        const std::vector<std::uint16_t>& table = srgb16_to_linear16();
        for (std::size_t i = 0; i < count_; ++i)
            for (int c = 0; c < 3; ++c) pixels[4 * i + c] = table[pixels[4 * i + c]];
    }

    void read_float(Coding coding) {
        std::vector<float> pixels;
        read<float>(pixels, OIIO::TypeDesc::FLOAT, 1.0f);
        divide_by_alpha<float>(pixels, 1.0f);
        std::vector<std::uint16_t>& linear = image_.texels.linear16;
        linear.resize(pixels.size());
        std::size_t clamped = 0, not_numbers = 0;
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            float value = pixels[i];
            not_numbers += std::isnan(value);
            clamped += value > 1 || value < 0;
            value = value > 0 ? std::min(value, 1.0f) : 0.0f;  // NaN to 0
            if (coding == Coding::srgb && i % 4 != 3) value = srgb_to_linear(value);
            linear[i] = static_cast<std::uint16_t>(value * 65535.0f + 0.5f);
        }
        if (clamped)
            warn(fmt::format(
                "The picture {} has {} samples outside the range 0 to 1; a print cannot be brighter than white, they "
                "were clamped.",
                name_, clamped));
        if (not_numbers)
            warn(fmt::format("The picture {} has {} samples that are not numbers; they were taken as 0.", name_,
                             not_numbers));
    }

    void read_resolution() {
        const float x = spec_.get_float_attribute("XResolution", 0), y = spec_.get_float_attribute("YResolution", x);
        const std::string unit = spec_.get_string_attribute("ResolutionUnit");
        double per_inch = 0;
        if (OIIO::Strutil::istarts_with(unit, "in")) per_inch = 1;
        if (OIIO::Strutil::istarts_with(unit, "cm")) per_inch = 2.54;
        if (OIIO::Strutil::iequals(unit, "m")) per_inch = 0.0254;
        if (!std::isfinite(x) || !std::isfinite(y) || x <= 0 || y <= 0) return;
        image_.dpi_x = x * per_inch;
        image_.dpi_y = y * per_inch;
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
        if (transpose) std::swap(image_.dpi_x, image_.dpi_y);
    }

    OIIO::ImageInput& input_;
    const OIIO::ImageSpec spec_;
    const std::string& name_;
    const DecodeOptions& options_;
    DecodedImage image_;
    std::size_t count_ = 0;
    int channels_ = 0;
};

}  // namespace

std::string picture_format(std::span<const std::byte> bytes, const std::string& name) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    for (const Magic& magic : magics)
        if (text.size() >= magic.at + magic.mark.size() && text.substr(magic.at, magic.mark.size()) == magic.mark)
            return magic.format;
    return OIIO::Strutil::iends_with(name, ".tga") ? "targa" : "";
}

DecodedImage decode_image(std::span<const std::byte> bytes, const std::string& name, const DecodeOptions& options) {
    const std::string format = picture_format(bytes, name);
    if (format.empty())
        throw InputError(fmt::format(
            "{} is no picture of a known kind (PNG, JPEG, TIFF, BMP, TGA, GIF, WebP, EXR, HDR, PNM); save it "
            "as PNG",
            name));
    if (format == "gif") check_gif_canvas(bytes, name, options);
    if (format == "openexr") check_exr_header(bytes, name);
    if (format == "jpeg" && !jpeg_has_its_end(bytes))
        throw InputError(
            fmt::format("the picture {} ends before its end mark: it is cut short, and rows of it are missing; copy or "
                        "save it again",
                        name));
    use_no_threads();
    try {
        const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create(format);
        if (!input)
            throw InputError(
                fmt::format("pictures of the kind of {} ({}) cannot be read here; save it as PNG", name, format));
        OIIO::ImageSpec config, spec;
        config.attribute("oiio:UnassociatedAlpha", 1);
        OIIO::Filesystem::IOMemReader memory(bytes.data(), bytes.size());
        std::unique_ptr<MemoryFile> file;
        bool opened;
        if (input->supports("ioproxy")) {
            input->set_ioproxy(&memory);
            opened = input->open(name, spec, config);
        } else {
            file = std::make_unique<MemoryFile>(bytes);
            opened = input->open(file->path(), spec, config);
        }
        if (!opened)
            throw InputError(
                fmt::format("the picture {} cannot be read ({}); it is damaged or cut short", name, input->geterror()));
        DecodedImage image = ImageDecoder(*input, name, options).decode();
        input->close();
        return image;
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;  // the file's colours are not lost for that: the whole is read again with more
    } catch (const std::exception& error) {
        throw InputError(fmt::format("the picture {} cannot be read ({}); it is damaged", name, error.what()));
    }
}

}  // namespace voxtone::io
