// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/openimageio/decode_other.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <string_view>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "base/error.h"
#include "base/warning.h"
#include "io/decoders/cmyk_to_srgb.h"
#include "io/decoders/picture_samples.h"
#include "io/openimageio/bmp_masks.h"
#include "io/openimageio/declared_size.h"
#include "io/openimageio/display_window.h"
#include "io/openimageio/image_rows.h"
#include "io/openimageio/lab_to_srgb.h"
#include "io/openimageio/memory_file.h"
#include "io/openimageio/no_threads.h"
#include "io/openimageio/webp_facts.h"

namespace voxtone::io {

namespace {

/// TIFF 6.0 and its supplements.
enum Photometric { separated = 5, cie_lab = 8, icc_lab = 9, itu_lab = 10 };

int photometric_of(const OIIO::ImageSpec& spec) { return spec.get_int_attribute("tiff:PhotometricInterpretation", -1); }

/// What OpenImageIO would convert by rules of its own.
bool is_converted_here(const OIIO::ImageSpec& spec) {
    const int photometric = photometric_of(spec);
    return photometric == separated || photometric == cie_lab || photometric == icc_lab;
}

/// What a reader says, if anything, and what follows from it.
std::string why_not(const std::string& said) {
    if (said.empty()) return "; it is damaged, cut short or of a kind that is not read here: save it as PNG";
    for (const char* const word : {"unsupported", "not supported"})
        if (OIIO::Strutil::icontains(said, word))
            return fmt::format(" ({}); it is of a kind that is not read here: save it as PNG", said);
    return fmt::format(" ({}); it is damaged or cut short", said);
}

/// A file that was opened, with what it is read from.
class OpenPicture {
public:
    /// `raw`: colours of kinds that are converted here stay as they are stored.
    OpenPicture(std::span<const std::byte> bytes, const std::string& format, const std::string& name, bool raw)
        : name_(name), input_(OIIO::ImageInput::create(format)) {
        if (!input_)
            throw InputError(
                fmt::format("pictures of the kind of {} ({}) cannot be read here; save it as PNG", name, format));
        OIIO::ImageSpec config, spec;
        config.attribute("oiio:UnassociatedAlpha", 1);
        if (raw) config.attribute("oiio:RawColor", 1);
        bool opened = false;
        if (input_->supports("ioproxy")) {
            memory_ = std::make_unique<OIIO::Filesystem::IOMemReader>(bytes.data(), bytes.size());
            input_->set_ioproxy(memory_.get());
            opened = input_->open(name, spec, config);
        } else {
            file_ = std::make_unique<MemoryFile>(bytes);
            opened = input_->open(file_->path(), spec, config);
        }
        if (!opened) fail();
    }

    [[nodiscard]] OIIO::ImageInput& input() { return *input_; }
    [[nodiscard]] bool has(int picture) { return input_->seek_subimage(picture, 0); }
    void go_to(int picture) {
        if (picture > 0 && !has(picture)) fail();
    }

private:
    [[noreturn]] void fail() const {
        throw InputError(fmt::format("the picture {} cannot be read{}", name_, why_not(input_->geterror())));
    }

    const std::string& name_;
    std::unique_ptr<OIIO::Filesystem::IOMemReader> memory_;
    std::unique_ptr<MemoryFile> file_;
    std::unique_ptr<OIIO::ImageInput> input_;
};

/// Which of the pictures in a file is taken.
struct Choice {
    int picture = 0;
    bool raw = false;
    std::string warning{};  ///< that there are others; empty: there are none
};

/// FILETYPE_REDUCEDIMAGE of TIFF 6.0.
bool is_smaller_copy(const OIIO::ImageSpec& spec) {
    const OIIO::ParamValue* const type = spec.find_attribute("tiff:subfiletype");
    return type && (type->get_int() & 1) != 0;
}

/// Pages count where they are not marked as smaller copies of another one.
Choice choose_page(OpenPicture& file, const std::string& name) {
    constexpr int most_pages = 1000;
    Choice choice{.picture = -1};
    int pages = 0;
    for (int i = 0; i < most_pages && file.has(i); ++i) {
        if (is_smaller_copy(file.input().spec())) continue;
        ++pages;
        if (choice.picture >= 0) continue;
        choice.picture = i;
        choice.raw = is_converted_here(file.input().spec());
    }
    if (choice.picture < 0) {  // all are: the first is what there is
        choice.picture = 0;
        choice.raw = file.has(0) && is_converted_here(file.input().spec());
        choice.warning = fmt::format(
            "The picture {} holds only what it calls a smaller copy, as cameras' raw files do; that was taken. Develop "
            "the picture and save it as TIFF or PNG.",
            name);
    }
    if (pages > 1)
        choice.warning = fmt::format(
            "The picture {} has {} pages; the first was taken. Save the others as files of their own.", name, pages);
    return choice;
}

Choice choose_picture(std::span<const std::byte> bytes, const std::string& format, const std::string& name) {
    OpenPicture file(bytes, format, name, format == "tiff");
    if (format == "tiff") return choose_page(file, name);
    if (file.input().spec().get_int_attribute("oiio:Movie", 0) != 0 && file.has(1))
        return {.warning = fmt::format("The picture {} is an animation; its first frame was taken.", name)};
    if (format == "openexr" && file.has(1))
        return {.warning = fmt::format("The picture {} has several parts; the first was taken.", name)};
    return {};
}

class ImageReader {
public:
    ImageReader(OIIO::ImageInput& input, const std::string& name, const DecodeOptions& options)
        : input_(input), spec_(input.spec()), name_(name), options_(options) {}

    PictureSamples read() {
        if (spec_.nchannels <= 0 || spec_.depth > 1 || spec_.width <= 0 || spec_.height <= 0)
            throw InputError(fmt::format(
                "the picture {} declares an impossible size ({} x {} x {} pixels, {} channels); it is damaged", name_,
                spec_.width, spec_.height, spec_.depth, spec_.nchannels));
        if (has_wide_numbers(spec_))
            throw InputError(fmt::format(
                "the picture {} is stored as 64-bit numbers, which are not read; save it with 16 or 32 bits", name_));
        check_picture_size(std::uint64_t(spec_.width), std::uint64_t(spec_.height), name_, options_);
        samples_.width_px = static_cast<std::uint32_t>(spec_.width);
        samples_.height_px = static_cast<std::uint32_t>(spec_.height);
        if (!is_converted_here(spec_))
            read_rgb();
        else if (photometric_of(spec_) == separated)
            read_inks();
        else
            read_lab();
        if (is_openexr()) lay_into_display();
        samples_.orientation = spec_.get_int_attribute("Orientation", 1);
        read_resolution();
        return std::move(samples_);
    }

private:
    void warn(std::string text) { samples_.warnings.push_back(std::move(text)); }

    template <class Value>
    void read_channels(std::vector<Value>& pixels, int channels, OIIO::TypeDesc type) {
        pixels.resize(std::size_t(std::max(channels, 4)) * samples_.pixels());
        if (!read_rows(input_, channels, type, pixels.data()))
            throw InputError(fmt::format("the picture {} cannot be decoded{}", name_, why_not(input_.geterror())));
    }

    /// Grey, RGB, with alpha.
    template <class Value>
    void read_rgba(std::vector<Value>& pixels, OIIO::TypeDesc type, Value opaque) {
        const int channels = std::min(spec_.nchannels, 4);
        read_channels(pixels, channels, type);
        spread_to_rgba(pixels, samples_.pixels(), channels, spec_.alpha_channel == 1, opaque);
        if (channels == 4 && !fourth_is_alpha())
            for (std::size_t i = 3; i < pixels.size(); i += 4) pixels[i] = opaque;
    }

    /// OpenImageIO 2.4 numbers a GIF's channels from 1 where it says which is alpha.
    [[nodiscard]] bool fourth_is_alpha() const {
        return spec_.alpha_channel == 3 || (spec_.alpha_channel >= 0 && spec_.channel_name(3) == "A");
    }

    void read_rgb() {
        if (spec_.nchannels > 4)
            warn(named_warning(
                "several-pictures",
                fmt::format("The picture {} has {} channels; the first four were taken as red, green, blue and alpha.",
                            name_, spec_.nchannels)));
        if (OIIO::Strutil::icontains(spec_.get_string_attribute("oiio:ColorSpace"), "cmyk"))
            warn(named_warning(
                "picture-colours",
                fmt::format(
                    "The picture {} is CMYK; it was converted without its profile, so that its colours are rough. "
                    "Save it as RGB to be exact.",
                    name_)));
        samples_.premultiplied = spec_.get_int_attribute("oiio:UnassociatedAlpha", 0) == 0;
        const bool is_float = spec_.format.is_floating_point();
        take_colours(is_float);
        if (is_float)
            read_rgba<float>(samples_.floats, OIIO::TypeDesc::FLOAT, 1.0f);
        else if (spec_.format.size() > 1)
            read_rgba<std::uint16_t>(samples_.words, OIIO::TypeDesc::UINT16, 65535);
        else
            read_rgba<std::uint8_t>(samples_.bytes, OIIO::TypeDesc::UINT8, 255);
        if (!is_openexr()) samples_.icc_profile = profile();
    }

    [[nodiscard]] std::vector<std::uint8_t> profile() const {
        const OIIO::ParamValue* const found = spec_.find_attribute("ICCProfile");
        if (!found) return {};
        const auto* const bytes = static_cast<const std::uint8_t*>(found->data());
        return {bytes, bytes + found->datasize()};
    }

    [[nodiscard]] bool is_openexr() const { return std::string_view(input_.format_name()) == "openexr"; }

    void lay_into_display() {
        const PixelWindow data{spec_.x, spec_.y, spec_.width, spec_.height};
        const PixelWindow display{spec_.full_x, spec_.full_y, spec_.full_width, spec_.full_height};
        if (data == display) return;
        check_picture_size(std::uint64_t(std::max<std::int64_t>(display.width, 0)),
                           std::uint64_t(std::max<std::int64_t>(display.height, 0)), name_, options_);
        const bool clear = spec_.alpha_channel >= 0;
        if (!samples_.floats.empty()) samples_.floats = in_window(samples_.floats, data, display, clear ? 0.0f : 1.0f);
        if (!samples_.words.empty())
            samples_.words = in_window<std::uint16_t>(samples_.words, data, display, clear ? 0 : 65535);
        samples_.width_px = std::uint32_t(display.width);
        samples_.height_px = std::uint32_t(display.height);
    }

    void take_colours(bool is_float) {
        const std::string space = spec_.get_string_attribute("oiio:ColorSpace");
        PictureColours& colours = samples_.colours;
        const std::string_view format = input_.format_name();
        if (OIIO::Strutil::iequals(space, "linear") || (is_float && (space.empty() || format == "pnm")))
            colours.curve = PictureCurve::linear;
        if (OIIO::Strutil::istarts_with(space, "gamma")) {
            const float said = spec_.get_float_attribute("oiio:Gamma", 2.2f);
            const float gamma = format == "hdr" ? 1 / said : said;
            if (std::abs(gamma - 1) < 0.01f) colours.curve = PictureCurve::linear;
            if (gamma < 2 || gamma > 2.5f)
                warn(named_warning(
                    "picture-colours",
                    fmt::format("The picture {} says that it has a gamma of {:.3g}; it was taken as sRGB.", name_,
                                gamma)));
        }
        float stored[8];
        if (!spec_.getattribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), stored)) return;
        std::copy(std::begin(stored), std::end(stored), colours.chromaticities.begin());
        colours.name = "primaries of its own";
    }

    /// Inks beyond the four are spot colours or masks, for which there is no rule.
    void read_inks() {
        if (spec_.nchannels < 4 || OIIO::Strutil::icontains(spec_.get_string_attribute("tiff:ColorSpace"), "multi"))
            throw InputError(fmt::format(
                "the picture {} is separated into {} inks that are not cyan, magenta, yellow and black; save it as RGB",
                name_, spec_.nchannels));
        if (spec_.nchannels > 4)
            warn(named_warning(
                "several-pictures",
                fmt::format(
                    "The picture {} has {} channels beyond cyan, magenta, yellow and black; they were left aside.",
                    name_, spec_.nchannels - 4)));
        if (spec_.format.size() > 1)
            convert_inks(samples_.words, OIIO::TypeDesc::UINT16);
        else
            convert_inks(samples_.bytes, OIIO::TypeDesc::UINT8);
    }

    template <class Value>
    void convert_inks(std::vector<Value>& pixels, OIIO::TypeDesc type) {
        read_channels(pixels, 4, type);
        cmyk_to_srgb<Value>(pixels, profile(), name_, samples_.warnings);
    }

    void read_lab() {
        if (spec_.nchannels < 3 || spec_.format.is_floating_point())
            throw InputError(fmt::format("the picture {} is in Lab colours of an unusual form; save it as RGB", name_));
        const LabCoding coding{.offset = photometric_of(spec_) == icc_lab, .bits = spec_.format.size() > 1 ? 16 : 8};
        read_channels(samples_.words, 3, OIIO::TypeDesc::UINT16);
        spread_to_rgba<std::uint16_t>(samples_.words, samples_.pixels(), 3, false, 65535);
        lab_to_srgb(samples_.words, coding);
    }

    /// Floating point or, in BMP, whole.
    [[nodiscard]] float number(const char* name, float unsaid) const {
        const int whole = spec_.get_int_attribute(name, 0);
        return spec_.get_float_attribute(name, whole != 0 ? float(whole) : unsaid);
    }

    void read_resolution() {
        const float x = number("XResolution", 0), y = number("YResolution", x);
        const std::string unit = spec_.get_string_attribute("ResolutionUnit");
        double per_inch = 0;
        if (OIIO::Strutil::istarts_with(unit, "in")) per_inch = 1;
        if (OIIO::Strutil::istarts_with(unit, "cm")) per_inch = 2.54;
        if (OIIO::Strutil::iequals(unit, "m")) per_inch = 0.0254;
        const double width_to_height = number("PixelAspectRatio", 1);
        if (width_to_height > 0) samples_.pixel_aspect = 1 / width_to_height;
        if (!std::isfinite(x) || !std::isfinite(y) || x <= 0 || y <= 0) return;
        samples_.pixel_aspect = double(x) / y;
        samples_.dpi_x = x * per_inch;
        samples_.dpi_y = y * per_inch;
    }

    OIIO::ImageInput& input_;
    const OIIO::ImageSpec spec_;
    const std::string& name_;
    const DecodeOptions& options_;
    PictureSamples samples_;
};

void take_webp_facts(PictureSamples& samples, const WebpFacts& facts) {
    samples.icc_profile.assign(facts.icc_profile.begin(), facts.icc_profile.end());
    samples.orientation = facts.exif.orientation;
    samples.dpi_x = facts.exif.dpi_x;
    samples.dpi_y = facts.exif.dpi_y;
}

}  // namespace

DecodedImage decode_other(std::span<const std::byte> bytes, const std::string& format, const std::string& name,
                          const DecodeOptions& options) {
    check_declared_size(bytes, format, name, options);
    use_no_threads();
    try {
        const Choice choice = choose_picture(bytes, format, name);
        OpenPicture file(bytes, format, name, choice.raw);  // anew: not every reader finds its way back
        file.go_to(choice.picture);
        PictureSamples samples = ImageReader(file.input(), name, options).read();
        if (format == "bmp") apply_bmp_masks(samples.bytes, bytes, name);
        if (format == "webp") take_webp_facts(samples, webp_facts(bytes));
        if (!choice.warning.empty()) samples.warnings.push_back(named_warning("several-pictures", choice.warning));
        return to_texels(std::move(samples), name, options);
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;  // the file's colours are not lost for that: the whole is read again with more
    } catch (const std::exception& error) {
        throw InputError(fmt::format("the picture {} cannot be read ({}); it is damaged", name, error.what()));
    }
}

}  // namespace voxtone::io
