// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/decoders/decode_png.h"

#include <array>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <vector>

#include <fmt/format.h>
#include <png.h>

#include "base/error.h"
#include "base/warning.h"
#include "io/decoders/exif.h"
#include "io/decoders/picture_samples.h"

namespace voxtone::io {

namespace {

/// What a picture can do without, and means something else without.
struct PngPart {
    const char *chunk, *name;
};
constexpr std::array<PngPart, 8> png_parts{{{"iCCP", "ICC profile"},
                                            {"sRGB", "colour space"},
                                            {"cHRM", "primaries"},
                                            {"gAMA", "gamma"},
                                            {"cICP", "coding of colours"},
                                            {"tRNS", "transparency"},
                                            {"pHYs", "resolution"},
                                            {"eXIf", "Exif block"}}};
constexpr std::size_t cicp_part = 4;

struct Source {
    std::span<const std::byte> file;
    std::size_t at = 0;
    char fault[200] = "";
    std::array<std::array<char, 100>, png_parts.size()> complaints{};  ///< of libpng, about parts
    // chunks that libpng does not know
    int primaries = -1, transfer = -1;
    bool narrow = false;
    std::uint32_t frames = 0;
};

void on_error(png_structp png, png_const_charp message) {
    auto* const source = static_cast<Source*>(png_get_error_ptr(png));
    std::strncpy(source->fault, message, sizeof source->fault - 1);
    png_longjmp(png, 1);
}
/// libpng begins with the name of the chunk where it leaves one aside, but also where it only dislikes it.
void on_warning(png_structp png, png_const_charp message) {
    auto* const source = static_cast<Source*>(png_get_error_ptr(png));
    for (std::size_t i = 0; i < png_parts.size(); ++i)
        if (std::strncmp(message, png_parts[i].chunk, 4) == 0 && source->complaints[i][0] == 0)
            std::strncpy(source->complaints[i].data(), message, source->complaints[i].size() - 1);
}

void on_read(png_structp png, png_bytep out, png_size_t count) {
    auto* const source = static_cast<Source*>(png_get_io_ptr(png));
    if (count > source->file.size() - source->at) png_error(png, "the file ends too early");
    std::memcpy(out, source->file.data() + source->at, count);
    source->at += count;
}

int on_chunk(png_structp png, png_unknown_chunkp chunk) {
    auto* const source = static_cast<Source*>(png_get_user_chunk_ptr(png));
    const auto is = [&](const char* name) { return std::memcmp(chunk->name, name, 4) == 0; };
    if (is("cICP") && chunk->size == 4 && source->complaints[cicp_part][0] == 0) {
        source->primaries = chunk->data[0];
        source->transfer = chunk->data[1];
        source->narrow = chunk->data[3] == 0;
    }
    if (is("acTL") && chunk->size == 8)
        for (int i = 0; i < 4; ++i) source->frames = source->frames << 8 | chunk->data[i];
    return 1;
}

struct Header {
    std::uint32_t width_px = 0, height_px = 0;
    bool deep = false, has_transparency = false;
};

struct Meanings {
    const std::uint8_t* profile = nullptr;  ///< libpng's
    std::size_t profile_bytes = 0;
    bool says_srgb = false, has_gamma = false, has_chromaticities = false;
    double gamma = 0;  ///< of the file: 1 / 2.2
    std::array<double, 8> chromaticities{};
    double dpi_x = 0, dpi_y = 0, pixel_aspect = 1;
    int orientation = 1;
    bool has_resolution = false, has_exif = false;
};

/// libpng reports faults by longjmp: what calls it holds nothing that would have to be destroyed, gives false, and
/// `Source::fault` says why.
class PngReader {
public:
    explicit PngReader(Source& source)
        : source_(source), png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, on_error, on_warning)) {
        if (png_) info_ = png_create_info_struct(png_);
    }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;
    ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }

    bool read_header(Header& header) {
        if (!png_ || !info_ || setjmp(png_jmpbuf(png_))) return false;
        png_set_read_fn(png_, &source_, on_read);
        png_set_user_limits(png_, 0x7fffffff, 0x7fffffff);  // sizes are checked by who calls
        png_set_chunk_malloc_max(png_, 64 << 20);           // of a profile
        png_set_chunk_cache_max(png_, 64);
        png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
        png_byte needed[] = "PLTE\0tRNS\0pHYs\0iCCP\0sRGB\0gAMA\0cHRM\0eXIf";
        png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_AS_DEFAULT, needed, 8);
        png_byte ours[] = "cICP\0acTL";
        png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_ALWAYS, ours, 2);
        png_set_read_user_chunk_fn(png_, &source_, on_chunk);
        png_read_info(png_, info_);
        header.width_px = png_get_image_width(png_, info_);
        header.height_px = png_get_image_height(png_, info_);
        header.deep = png_get_bit_depth(png_, info_) == 16;
        header.has_transparency = png_get_valid(png_, info_, PNG_INFO_tRNS) != 0;
        return true;
    }

    bool start_rows(bool deep, std::size_t row_bytes) {
        if (setjmp(png_jmpbuf(png_))) return false;
        png_set_expand(png_);
        png_set_gray_to_rgb(png_);
        png_set_add_alpha(png_, deep ? 0xffff : 0xff, PNG_FILLER_AFTER);
        if (deep) png_set_swap(png_);
        passes_ = png_set_interlace_handling(png_);
        png_read_update_info(png_, info_);
        if (png_get_rowbytes(png_, info_) != row_bytes) png_error(png_, "rows of an unexpected length");
        return true;
    }

    bool read_rows(std::uint8_t* pixels, std::size_t row_bytes, std::uint32_t rows) {
        if (setjmp(png_jmpbuf(png_))) return false;
        for (int pass = 0; pass < passes_; ++pass)
            for (std::uint32_t y = 0; y < rows; ++y) png_read_row(png_, pixels + y * row_bytes, nullptr);
        return true;
    }

    /// Chunks may stand behind the pixels; where they are missing, the pixels are there all the same.
    bool read_end() {
        if (setjmp(png_jmpbuf(png_))) return false;
        png_read_end(png_, info_);
        return true;
    }

    bool read_meanings(Meanings& m) {
        if (setjmp(png_jmpbuf(png_))) return false;
        png_charp text = nullptr;
        png_bytep profile = nullptr;
        png_uint_32 size = 0, x = 0, y = 0;
        int compression = 0, unit = 0, intent = 0;
        if (png_get_iCCP(png_, info_, &text, &compression, &profile, &size)) {
            m.profile = profile;
            m.profile_bytes = size;
        }
        m.says_srgb = png_get_sRGB(png_, info_, &intent) != 0;
        m.has_gamma = png_get_gAMA(png_, info_, &m.gamma) != 0;
        double* const c = m.chromaticities.data();
        m.has_chromaticities = png_get_cHRM(png_, info_, c + 6, c + 7, c, c + 1, c + 2, c + 3, c + 4, c + 5) != 0;
        m.has_resolution = png_get_pHYs(png_, info_, &x, &y, &unit) != 0;
        if (x > 0 && y > 0) m.pixel_aspect = double(x) / y;
        if (m.has_resolution && unit == PNG_RESOLUTION_METER) {
            m.dpi_x = 0.0254 * x;
            m.dpi_y = 0.0254 * y;
        }
        png_bytep exif = nullptr;
        png_uint_32 exif_bytes = 0;
        m.has_exif = png_get_eXIf_1(png_, info_, &exif_bytes, &exif) != 0;
        if (m.has_exif) m.orientation = exif_facts({exif, exif_bytes}).orientation;
        return true;
    }

private:
    Source& source_;
    png_structp png_;
    png_infop info_ = nullptr;
    int passes_ = 1;
};

/// What gAMA and cHRM say. A gamma of 1 is linear light; any other is taken for sRGB's curve, as viewers do, and far
/// ones are said.
PictureColours colours_of_chunks(const Meanings& m, const std::string& name, std::vector<std::string>& warnings) {
    PictureColours colours;
    if (m.says_srgb) return colours;
    if (m.has_chromaticities) {
        colours.chromaticities = m.chromaticities;
        if (!has_srgb_primaries(colours)) colours.name = "primaries of its own";
    }
    const double gamma = m.has_gamma && m.gamma > 0 ? 1 / m.gamma : 2.2;
    if (std::abs(gamma - 1) < 0.01)
        colours.curve = PictureCurve::linear;
    else if (gamma < 2 || gamma > 2.5)
        warnings.push_back(named_warning(
            "picture-colours",
            fmt::format("The picture {} says that it has a gamma of {:.3g}; it was taken as sRGB.", name, gamma)));
    return colours;
}

/// Parts that are there, damaged, and that libpng left aside.
void warn_of_lost_parts(PictureSamples& samples, const Header& header, const Meanings& m, const Source& source,
                        const std::string& name, const DecodeOptions& options) {
    const bool has_coding = source.primaries >= 0 || !options.use_profile;
    const bool has_space = has_coding || m.profile || m.says_srgb;  // what stands behind these says nothing more
    const std::array<bool, png_parts.size()> needless{has_space,
                                                      has_space,
                                                      has_space || m.has_chromaticities,
                                                      has_space || m.has_gamma,
                                                      has_coding,
                                                      header.has_transparency,
                                                      m.has_resolution,
                                                      m.has_exif};
    for (std::size_t i = 0; i < png_parts.size(); ++i)
        if (source.complaints[i][0] != 0 && !needless[i])
            samples.warnings.push_back(named_warning(
                "damaged",
                fmt::format("A part of the picture {} is damaged and was left aside, its {} ({}); save it again.", name,
                            png_parts[i].name, source.complaints[i].data())));
}

void take_meanings(PictureSamples& samples, const Meanings& m, const Source& source, const std::string& name) {
    samples.dpi_x = m.dpi_x;
    samples.dpi_y = m.dpi_y;
    samples.pixel_aspect = m.pixel_aspect;
    samples.orientation = m.orientation;
    if (source.primaries >= 0) {
        samples.colours = colours_of_code_points(source.primaries, source.transfer);
        samples.colours.narrow = source.narrow;
    } else if (m.profile) {
        samples.icc_profile.assign(m.profile, m.profile + m.profile_bytes);
    } else {
        samples.colours = colours_of_chunks(m, name, samples.warnings);
    }
    if (!samples.colours.known)
        samples.warnings.push_back(named_warning(
            "picture-colours", fmt::format("The picture {} is coded in {}; sRGB's were taken in their place.", name,
                                           samples.colours.name)));
    if (source.frames > 1)
        samples.warnings.push_back(named_warning(
            "several-pictures",
            fmt::format("The picture {} is an animation of {} frames; the one that still viewers show was taken.", name,
                        source.frames)));
}

}  // namespace

DecodedImage decode_png(std::span<const std::byte> bytes, const std::string& name, const DecodeOptions& options) {
    Source source{bytes};
    PngReader reader(source);
    const auto fail = [&](const char* what) {
        throw InputError(fmt::format("the picture {} cannot be {} ({}); it is damaged or cut short", name, what,
                                     source.fault[0] ? source.fault : "no memory"));
    };
    Header header;
    if (!reader.read_header(header)) fail("read");
    check_picture_size(header.width_px, header.height_px, name, options);
    PictureSamples samples{.width_px = header.width_px, .height_px = header.height_px};
    const std::size_t row_bytes = std::size_t{header.width_px} * (header.deep ? 8 : 4);
    if (header.deep)
        samples.words.resize(4 * samples.pixels());
    else
        samples.bytes.resize(4 * samples.pixels());
    auto* const pixels = header.deep ? reinterpret_cast<std::uint8_t*>(samples.words.data()) : samples.bytes.data();
    if (!reader.start_rows(header.deep, row_bytes) || !reader.read_rows(pixels, row_bytes, header.height_px))
        fail("decoded");
    (void)reader.read_end();
    Meanings meanings;
    if (reader.read_meanings(meanings)) {
        take_meanings(samples, meanings, source, name);
        warn_of_lost_parts(samples, header, meanings, source, name, options);
    }
    return to_texels(std::move(samples), name, options);
}

}  // namespace voxtone::io
