// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/openimageio/decode_other.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string_view>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "base/error.h"
#include "base/warning.h"
#include "io/decoders/cmyk_to_srgb.h"
#include "io/decoders/picture_samples.h"
#include "io/openimageio/bmp_masks.h"
#include "io/openimageio/colour_layer.h"
#include "io/openimageio/declared_size.h"
#include "io/openimageio/display_window.h"
#include "io/openimageio/image_rows.h"
#include "io/openimageio/lab_to_srgb.h"
#include "io/openimageio/memory_file.h"
#include "io/openimageio/no_threads.h"
#include "io/openimageio/psd_facts.h"
#include "io/openimageio/tiff_white.h"

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
std::string why_not(const std::string& all_said) {
    const std::string said = all_said.substr(0, all_said.find('\n'));  // what follows says it again
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
    std::string warning{};               ///< that there are others; empty: there are none
    std::optional<ColourLayer> layer{};  ///< of a picture of layers
};

constexpr int most_pages = 1000;

/// FILETYPE_REDUCEDIMAGE of TIFF 6.0.
bool is_smaller_copy(const OIIO::ImageSpec& spec) {
    const OIIO::ParamValue* const type = spec.find_attribute("tiff:subfiletype");
    return type && (type->get_int() & 1) != 0;
}

/// Pages count where they are not marked as smaller copies of another one.
Choice choose_page(OpenPicture& file, const std::string& name) {
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

/// A few names in a sentence.
std::string listed(const std::vector<std::string>& names, const char* nameless) {
    constexpr std::size_t most = 4;
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), most); ++i)
        text += (i ? ", " : "") + (names[i].empty() ? nameless : names[i]);
    return names.size() > most ? fmt::format("{} and {} more", text, names.size() - most) : text;
}

/// Of all parts; parts are layers, too.
Choice choose_layer(OpenPicture& file, const std::string& name) {
    constexpr const char* nameless = "one without a name";
    const bool several = file.has(1);
    Choice choice{.picture = -1};
    std::vector<std::string> layers, channels;
    for (int i = 0; i < most_pages && file.has(i); ++i) {
        const OIIO::ImageSpec& spec = file.input().spec();
        const std::string part = several ? std::string(spec.get_string_attribute("oiio:subimagename")) : "";
        channels.insert(channels.end(), spec.channelnames.begin(), spec.channelnames.end());
        for (const std::string& layer : layer_names(spec.channelnames)) layers.push_back(layer.empty() ? part : layer);
        const std::optional<ColourLayer> found = find_colour_layer(spec.channelnames, part);
        if (!found || (choice.layer && choice.layer->rank <= found->rank)) continue;
        choice.picture = i;
        choice.layer = found;
    }
    if (!choice.layer)
        throw InputError(
            fmt::format("the picture {} has no layer of red, green and blue, only channels that are no colours ({}); "
                        "save its colours as PNG or EXR",
                        name, listed(channels, "")));
    const std::array<int, 4>& taken = choice.layer->channels;
    const std::size_t count = (taken[0] == taken[1] ? 1 : 3) + (taken[3] >= 0 ? 1 : 0);
    if (layers.size() > 1)
        choice.warning = fmt::format(
            "The picture {} has {} layers ({}); the colours of {} were taken. Save the one that is meant by itself.",
            name, layers.size(), listed(layers, nameless),
            choice.layer->name.empty() ? "the one without a name" : choice.layer->name);
    else if (channels.size() > count)
        choice.warning = fmt::format("The picture {} has {} channels ({}); its colours were taken.", name,
                                     channels.size(), listed(channels, ""));
    return choice;
}

Choice choose_picture(std::span<const std::byte> bytes, const std::string& format, const std::string& name) {
    OpenPicture file(bytes, format, name, format == "tiff");
    if (format == "tiff") return choose_page(file, name);
    if (format == "openexr") return choose_layer(file, name);
    if (format == "psd") return {.raw = psd_facts(bytes).is_cmyk};
    if (file.input().spec().get_int_attribute("oiio:Movie", 0) != 0 && file.has(1))
        return {.warning = fmt::format("The picture {} is an animation; its first frame was taken.", name)};
    return {};
}

class ImageReader {
public:
    /// `white`: of Lab colours, where the file says it, CIE x and y.
    ImageReader(OIIO::ImageInput& input, const std::string& name, const DecodeOptions& options, const Choice& choice,
                std::optional<std::array<double, 2>> white)
        : input_(input), spec_(input.spec()), name_(name), options_(options), choice_(choice), white_(white) {}

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
        if (is_psd() && choice_.raw)
            read_psd_inks();
        else if (!is_converted_here(spec_))
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

    /// `count` channels from `first`, in a buffer of as many as are wanted of each pixel.
    template <class Value>
    void read_channels(std::vector<Value>& pixels, int wanted, int count, OIIO::TypeDesc type, int first = 0) {
        pixels.resize(std::size_t(wanted) * samples_.pixels());
        if (!read_rows(input_, count, type, pixels.data(), first))
            throw InputError(fmt::format("the picture {} cannot be decoded{}", name_, why_not(input_.geterror())));
    }

    /// Which channels are red, green, blue (thrice the same one: grey) and alpha, of all but many-layered pictures.
    [[nodiscard]] std::array<int, 4> usual_channels() const {
        const bool grey = spec_.nchannels < 3;
        int alpha = spec_.alpha_channel;
        // OpenImageIO 2.4 numbers a GIF's channels from 1 where it says which is alpha.
        if (alpha >= 0 && spec_.nchannels >= 4 && spec_.channel_name(3) == "A") alpha = 3;
        if (alpha < (grey ? 1 : 3) || alpha >= spec_.nchannels) alpha = -1;
        return {0, grey ? 0 : 1, grey ? 0 : 2, alpha};
    }

    template <class Value>
    void read_rgba(std::vector<Value>& pixels, OIIO::TypeDesc type, Value opaque, const std::array<int, 4>& from) {
        const bool grey = from[0] == from[1];
        const int colours = grey ? 1 : 3, count = colours + (from[3] >= 0 ? 1 : 0);
        bool in_a_row = grey || (from[1] == from[0] + 1 && from[2] == from[0] + 2);
        if (from[3] >= 0) in_a_row = in_a_row && from[3] == from[0] + colours;
        if (in_a_row) {
            read_channels(pixels, 4, count, type, from[0]);
            return spread_to_rgba(pixels, samples_.pixels(), count, true, opaque);
        }
        pixels.assign(4 * samples_.pixels(), opaque);
        std::vector<Value> plane;
        for (std::size_t c = 0; c < 4; ++c) {
            if (from[c] < 0) continue;
            read_channels(plane, 1, 1, type, from[c]);
            for (std::size_t i = 0; i < plane.size(); ++i) pixels[4 * i + c] = plane[i];
        }
    }

    /// What is in a file of one picture beside its colours, and what becomes of it.
    template <class Value>
    void say_left_aside(const std::vector<Value>& pixels, OIIO::TypeDesc type, const std::array<int, 4>& from) {
        const int colours = from[0] == from[1] ? 1 : 3, taken = colours + (from[3] >= 0 ? 1 : 0);
        if (spec_.nchannels == taken || choice_.layer) return;
        if (spec_.nchannels > taken + 1 || from[3] >= 0)
            return warn(
                named_warning("several-pictures",
                              fmt::format("The picture {} has {} channels; {}{} were taken, the others left aside.",
                                          name_, spec_.nchannels, colours == 1 ? "grey" : "red, green, blue",
                                          from[3] >= 0 ? " and alpha" : "")));
        if (!is_tiff()) return;
        warn(named_warning(
            "several-pictures",
            fmt::format("The picture {} has a channel beside its colours and does not say what it means; it was left "
                        "aside{}.",
                        name_,
                        is_like_alpha(pixels, type, colours)
                            ? ". It is 0 where the picture is black, as transparency is: if it is that, save the "
                              "picture as PNG"
                            : "")));
    }

    /// Whether a channel is 0 here and there, and nothing but black lies there.
    template <class Value>
    [[nodiscard]] bool is_like_alpha(const std::vector<Value>& pixels, OIIO::TypeDesc type, int channel) {
        std::vector<Value> plane;
        read_channels(plane, 1, 1, type, channel);
        bool some = false, others = false;
        for (std::size_t i = 0; i < plane.size(); ++i) {
            if (plane[i] != 0) {
                others = true;
                continue;
            }
            if (pixels[4 * i] != 0 || pixels[4 * i + 1] != 0 || pixels[4 * i + 2] != 0) return false;
            some = true;
        }
        return some && others;
    }

    template <class Value>
    void read_colours(std::vector<Value>& pixels, OIIO::TypeDesc type, Value opaque) {
        const std::array<int, 4> from = choice_.layer ? choice_.layer->channels : usual_channels();
        read_rgba(pixels, type, opaque, from);
        say_left_aside(pixels, type, from);
    }

    void read_rgb() {
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
            read_colours<float>(samples_.floats, OIIO::TypeDesc::FLOAT, 1.0f);
        else if (spec_.format.size() > 2)
            read_long_numbers();
        else if (spec_.format.size() > 1)
            read_colours<std::uint16_t>(samples_.words, OIIO::TypeDesc::UINT16, 65535);
        else
            read_colours<std::uint8_t>(samples_.bytes, OIIO::TypeDesc::UINT8, 255);
        if (!is_openexr()) samples_.icc_profile = profile();
    }

    /// Whole numbers of 32 bits are often codes of fewer: NumPy's are saved so.
    void read_long_numbers() {
        constexpr std::uint32_t most_byte = 255, most_word = 65535;
        std::vector<std::uint32_t> numbers;
        const bool is_signed = spec_.format.is_signed();
        const std::uint32_t white = is_signed ? 0x7fffffff : 0xffffffff;
        read_colours<std::uint32_t>(numbers, spec_.format, white);
        std::uint32_t brightest = 0;
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            if (is_signed && numbers[i] > white) numbers[i] = 0;  // negative
            if (i % 4 != 3) brightest = std::max(brightest, numbers[i]);
        }
        const std::uint32_t most = brightest <= most_byte ? most_byte : brightest <= most_word ? most_word : white;
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            const double share = std::min(1.0, double(numbers[i]) / (i % 4 == 3 && numbers[i] > most ? white : most));
            samples_.words.push_back(static_cast<std::uint16_t>(share * most_word + 0.5));
        }
        if (most != white && brightest > 0)
            warn(named_warning("colour-range",
                               fmt::format("No sample of the picture {} is above {}, of 32 bits: they were taken as "
                                           "codes of {} bits.",
                                           name_, most, most == most_byte ? 8 : 16)));
    }

    [[nodiscard]] std::vector<std::uint8_t> profile() const {
        const OIIO::ParamValue* const found = spec_.find_attribute("ICCProfile");
        if (!found) return {};
        const auto* const bytes = static_cast<const std::uint8_t*>(found->data());
        return {bytes, bytes + found->datasize()};
    }

    [[nodiscard]] bool is(std::string_view format) const { return input_.format_name() == format; }
    [[nodiscard]] bool is_openexr() const { return is("openexr"); }
    [[nodiscard]] bool is_tiff() const { return is("tiff"); }
    [[nodiscard]] bool is_psd() const { return is("psd"); }

    void lay_into_display() {
        const PixelWindow data{spec_.x, spec_.y, spec_.width, spec_.height};
        const PixelWindow display{spec_.full_x, spec_.full_y, spec_.full_width, spec_.full_height};
        if (data == display) return;
        check_picture_size(std::uint64_t(std::max<std::int64_t>(display.width, 0)),
                           std::uint64_t(std::max<std::int64_t>(display.height, 0)), name_, options_);
        const bool clear = choice_.layer && choice_.layer->channels[3] >= 0;
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
        read_channels(pixels, 4, 4, type);
        cmyk_to_srgb<Value>(pixels, profile(), name_, samples_.warnings);
    }

    void read_psd_inks() {
        if (spec_.nchannels < 4)
            throw InputError(fmt::format("the picture {} is CMYK and lacks one of its inks; it is damaged", name_));
        if (spec_.format.size() > 1)
            convert_stored_paper<std::uint16_t>(samples_.words, OIIO::TypeDesc::UINT16);
        else
            convert_stored_paper<std::uint8_t>(samples_.bytes, OIIO::TypeDesc::UINT8);
    }

    /// Photoshop stores what is left of the paper: 0 is full ink.
    template <class Value>
    void convert_stored_paper(std::vector<Value>& pixels, OIIO::TypeDesc type) {
        read_channels(pixels, 4, 4, type);
        for (Value& value : pixels) value = static_cast<Value>(std::numeric_limits<Value>::max() - value);
        cmyk_to_srgb<Value>(pixels, profile(), name_, samples_.warnings);
    }

    /// L* has no sign in a TIFF, whatever the file says of its samples, and a* and b* have one or lie around the middle
    /// of their range: the bits are taken as they are, where OpenImageIO would make 0 of all that it calls negative.
    void read_lab() {
        if (spec_.nchannels < 3 || spec_.format.is_floating_point() || spec_.format.size() > 2)
            throw InputError(fmt::format("the picture {} is in Lab colours of an unusual form; save it as RGB", name_));
        LabCoding coding{.offset = photometric_of(spec_) == icc_lab, .bits = spec_.format.size() > 1 ? 16 : 8};
        coding.white = lab_white(coding);
        if (coding.bits == 16) {
            read_channels(samples_.words, 4, 3, spec_.format);
        } else {
            std::vector<std::uint8_t> bytes;
            read_channels(bytes, 3, 3, spec_.format);
            samples_.words.resize(4 * samples_.pixels());
            std::transform(bytes.begin(), bytes.end(), samples_.words.begin(),
                           [](std::uint8_t v) { return static_cast<std::uint16_t>(v * 257); });
        }
        spread_to_rgba<std::uint16_t>(samples_.words, samples_.pixels(), 3, false, 65535);
        lab_to_srgb(samples_.words, coding);
    }

    /// As the file says; D50 where it says none (Adobe's notes to TIFF). Who calls L* signed is libvips, whose Lab is
    /// that of D65.
    [[nodiscard]] Eigen::Vector3d lab_white(const LabCoding& coding) {
        if (coding.offset) return optics::d50_white();  // ICC's Lab has no other
        if (white_) return {(*white_)[0] / (*white_)[1], 1, (1 - (*white_)[0] - (*white_)[1]) / (*white_)[1]};
        if (!spec_.format.is_signed()) return optics::d50_white();
        warn(named_warning(
            "picture-colours",
            fmt::format("The picture {} is in Lab colours, stored as libvips does, and does not say their white; that "
                        "of libvips was taken, D65. Save it as RGB to be sure.",
                        name_)));
        return optics::d65_white();
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
    const Choice& choice_;
    const std::optional<std::array<double, 2>> white_;
    PictureSamples samples_;
};

/// All pixels of a Photoshop file's picture or layer, with 255 for opaque where it has no alpha.
std::vector<std::uint8_t> pixels_of_layer(OpenPicture& file, int layer, const std::string& name,
                                          const DecodeOptions& options) {
    if (!file.has(layer)) return {};
    const OIIO::ImageSpec spec = file.input().spec();
    if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0) return {};
    check_picture_size(std::uint64_t(spec.width), std::uint64_t(spec.height), name, options);
    const std::size_t count = std::size_t(spec.width) * std::size_t(spec.height);
    const int channels = std::min(spec.nchannels, 4);
    std::vector<std::uint8_t> pixels(4 * count);
    if (!read_rows(file.input(), channels, OIIO::TypeDesc(OIIO::TypeDesc::UINT8), pixels.data())) return {};
    spread_to_rgba<std::uint8_t>(pixels, count, channels, true, 255);
    return pixels;
}

/// Whether a layer that is shown has other colours than a picture of one colour.
bool shows_more(OpenPicture& file, const PsdFacts& facts, const std::string& name, const DecodeOptions& options) {
    const std::vector<std::uint8_t> merged = pixels_of_layer(file, 0, name, options);
    for (int layer = 1; layer < most_pages && file.has(layer) && !merged.empty(); ++layer) {
        const auto index = static_cast<std::size_t>(layer - 1);
        if (index < facts.hidden.size() && facts.hidden[index]) continue;
        constexpr int seen = 128, other = 8;  // codes
        const std::vector<std::uint8_t> pixels = pixels_of_layer(file, layer, name, options);
        for (std::size_t i = 0; i < pixels.size(); i += 4)
            for (std::size_t c = 0; c < 3 && pixels[i + 3] >= seen; ++c)
                if (std::abs(int{pixels[i + c]} - int{merged[c]}) > other) return true;
    }
    return false;
}

template <class Value>
bool is_of_one_colour(const std::vector<Value>& rgba) {
    for (std::size_t i = 4; i < rgba.size(); ++i)
        if (rgba[i] != rgba[i - 4]) return false;
    return true;
}

/// A Photoshop file may lack the picture of all layers together: its place is black or white then.
void look_for_layers(PictureSamples& samples, std::span<const std::byte> bytes, const std::string& name,
                     const DecodeOptions& options) {
    const PsdFacts facts = psd_facts(bytes);
    if (!is_of_one_colour(samples.bytes) || !is_of_one_colour(samples.words) || !is_of_one_colour(samples.floats))
        return;
    OpenPicture file(bytes, "psd", name, false);
    if (!facts.says_unmerged && !shows_more(file, facts, name, options)) return;
    samples.lost_colour = fmt::format(
        "The picture {} was saved as layers without a picture of all of them together, and that alone is read: what it "
        "shows is LOST. Save it once more with maximal compatibility, or as PNG.",
        name);
}

}  // namespace

DecodedImage decode_other(std::span<const std::byte> bytes, const std::string& format, const std::string& name,
                          const DecodeOptions& options) {
    check_declared_size(bytes, format, name, options);
    use_no_threads();
    const std::vector<std::byte> told = format == "psd" ? with_transparent_index(bytes) : std::vector<std::byte>();
    if (!told.empty()) bytes = told;
    try {
        const Choice choice = choose_picture(bytes, format, name);
        OpenPicture file(bytes, format, name, choice.raw);  // anew: not every reader finds its way back
        file.go_to(choice.picture);
        const auto white = format == "tiff" ? tiff_white(bytes, choice.picture) : std::nullopt;
        PictureSamples samples = ImageReader(file.input(), name, options, choice, white).read();
        if (format == "bmp") {
            apply_bmp_masks(samples.bytes, bytes, name);
            samples.premultiplied = false;  // OpenImageIO hands alpha over as it is in the file, and does not say so
        }
        if (format == "psd") look_for_layers(samples, bytes, name, options);
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
