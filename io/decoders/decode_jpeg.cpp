// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/decoders/decode_jpeg.h"

#include <algorithm>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include <fmt/format.h>
// after <cstdio>
#include <jpeglib.h>

// after <jpeglib.h>, whose settings its numbers follow
#include <jerror.h>

#include "base/error.h"
#include "base/warning.h"
#include "io/decoders/cmyk_to_srgb.h"
#include "io/decoders/exif.h"
#include "io/decoders/jpeg_end.h"
#include "io/decoders/picture_samples.h"

namespace voxtone::io {

namespace {

struct JpegErrors {
    jpeg_error_mgr base;
    std::jmp_buf out;
    char fault[JMSG_LENGTH_MAX] = "";
    bool unknown_kind = false;  ///< and not damaged
    bool ran_out = false;       ///< of codes, amid a scan
    bool bad_profile = false;   ///< pieces of the ICC profile are missing or contradict each other
};

void on_error(j_common_ptr info) {
    auto* const errors = reinterpret_cast<JpegErrors*>(info->err);
    info->err->format_message(info, errors->fault);
    const int code = info->err->msg_code;
    errors->unknown_kind = code == JERR_SOF_UNSUPPORTED || code == JERR_BAD_PRECISION || code == JERR_NOT_COMPILED ||
                           code == JERR_ARITH_NOTIMPL || code == JERR_CONVERSION_NOTIMPL;
    std::longjmp(errors->out, 1);
}
void on_message(j_common_ptr info, int level) {
    if (level >= 0) return;
    auto* const errors = reinterpret_cast<JpegErrors*>(info->err);
    if (info->err->msg_code == JWRN_HIT_MARKER) errors->ran_out = true;
    if (info->err->msg_code == JWRN_BOGUS_ICC) errors->bad_profile = true;
}

struct JpegFacts {
    std::uint32_t width_px = 0, height_px = 0;
    int channels = 0;
    bool inverted = false;  ///< CMYK as Adobe's programs store it: 255 is no ink
    double dpi_x = 0, dpi_y = 0, pixel_aspect = 1;
    ExifFacts exif;
    JOCTET* profile = nullptr;
    unsigned profile_bytes = 0;
};

/// libjpeg reports faults by longjmp: what calls it holds nothing that would have to be destroyed, gives false, and
/// `fault()` says why.
class JpegReader {
public:
    explicit JpegReader(std::span<const std::byte> file) : file_(file) {
        info_.err = jpeg_std_error(&errors_.base);
        errors_.base.error_exit = on_error;
        errors_.base.emit_message = on_message;
        if (setjmp(errors_.out)) return;
        jpeg_create_decompress(&info_);
        created_ = true;
    }
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;
    ~JpegReader() {
        std::free(profile_);
        if (created_) jpeg_destroy_decompress(&info_);
    }

    [[nodiscard]] const char* fault() const { return errors_.fault[0] ? errors_.fault : "no memory"; }

    [[nodiscard]] const char* advice() const {
        return errors_.unknown_kind ? "it is a JPEG of a kind that is not read here; save it as PNG"
                                    : "it is damaged or cut short";
    }

    bool read_header(JpegFacts& facts) {
        if (!created_ || setjmp(errors_.out)) return false;
        jpeg_mem_src(&info_, reinterpret_cast<const unsigned char*>(file_.data()),
                     static_cast<unsigned long>(file_.size()));
        jpeg_save_markers(&info_, JPEG_APP0 + 1, 0xffff);
        jpeg_save_markers(&info_, JPEG_APP0 + 2, 0xffff);
        jpeg_read_header(&info_, TRUE);
        const bool inks = info_.jpeg_color_space == JCS_CMYK || info_.jpeg_color_space == JCS_YCCK;
        info_.out_color_space = inks ? JCS_CMYK : info_.num_components == 1 ? JCS_GRAYSCALE : JCS_RGB;
        facts.width_px = info_.image_width;
        facts.height_px = info_.image_height;
        facts.channels = inks ? 4 : info_.num_components == 1 ? 1 : 3;
        facts.inverted = info_.saw_Adobe_marker;
        read_facts(facts);
        return true;
    }

    bool start() {
        if (setjmp(errors_.out)) return false;
        jpeg_start_decompress(&info_);
        return true;
    }
    bool read_rows(std::uint8_t* pixels, std::size_t row_bytes) {
        if (setjmp(errors_.out)) return false;
        while (info_.output_scanline < info_.output_height) {
            JSAMPROW row = pixels + info_.output_scanline * row_bytes;
            jpeg_read_scanlines(&info_, &row, 1);
        }
        return true;
    }

    [[nodiscard]] bool has_bad_profile() const { return errors_.bad_profile; }

    /// Whether every code of every coefficient was there.
    [[nodiscard]] bool is_whole(bool has_end) const {
        if (errors_.ran_out) return false;
        if (has_end || !jpeg_has_multiple_scans(const_cast<jpeg_decompress_struct*>(&info_))) return true;
        if (!info_.progressive_mode) return false;  // whole scans may be missing, and nothing would tell
        for (int c = 0; c < info_.num_components; ++c)
            for (int k = 0; k < DCTSIZE2; ++k)
                if (info_.coef_bits[c][k] != 0) return false;
        return true;
    }

private:
    void read_facts(JpegFacts& facts) {
        if (info_.saw_JFIF_marker && info_.X_density > 0 && info_.Y_density > 0)
            facts.pixel_aspect = double(info_.X_density) / info_.Y_density;
        if (info_.saw_JFIF_marker && info_.density_unit > 0) {
            const double per_inch = info_.density_unit == 2 ? 2.54 : 1;
            facts.dpi_x = per_inch * info_.X_density;
            facts.dpi_y = per_inch * info_.Y_density;
        }
        constexpr char exif_mark[] = "Exif\0";  // and the 0 that ends the literal
        for (const jpeg_marker_struct* m = info_.marker_list; m; m = m->next)
            if (m->marker == JPEG_APP0 + 1 && m->data_length > sizeof exif_mark &&
                std::memcmp(m->data, exif_mark, sizeof exif_mark) == 0)
                facts.exif = exif_facts({m->data + sizeof exif_mark, m->data_length - sizeof exif_mark});
        if (jpeg_read_icc_profile(&info_, &profile_, &facts.profile_bytes)) facts.profile = profile_;
    }

    std::span<const std::byte> file_;
    JpegErrors errors_{};
    jpeg_decompress_struct info_{};
    JOCTET* profile_ = nullptr;
    bool created_ = false;
};

void invert(std::vector<std::uint8_t>& inks) {
    for (std::uint8_t& ink : inks) ink = static_cast<std::uint8_t>(255 - ink);
}

}  // namespace

DecodedImage decode_jpeg(std::span<const std::byte> bytes, const std::string& name, const DecodeOptions& options) {
    JpegReader reader(bytes);
    const auto fail = [&](const char* what) {
        throw InputError(
            fmt::format("the picture {} cannot be {} ({}); {}", name, what, reader.fault(), reader.advice()));
    };
    JpegFacts facts;
    if (!reader.read_header(facts)) fail("read");
    check_picture_size(facts.width_px, facts.height_px, name, options);
    PictureSamples samples{.width_px = facts.width_px, .height_px = facts.height_px};
    samples.bytes.resize(4 * samples.pixels());
    if (!reader.start() ||
        !reader.read_rows(samples.bytes.data(), std::size_t{facts.width_px} * std::size_t(facts.channels)))
        fail("decoded");
    const bool has_end = jpeg_has_its_end(bytes);
    if (!reader.is_whole(has_end))
        throw InputError(fmt::format(
            "the picture {} is cut short, and rows or details of it are missing; copy or save it again", name));
    if (!has_end)
        samples.warnings.push_back(named_warning(
            "damaged",
            fmt::format("The picture {} lacks its end mark; all of its rows are there and were read.", name)));
    if (reader.has_bad_profile() && (options.use_profile || facts.channels == 4))
        samples.warnings.push_back(named_warning(
            "damaged", fmt::format("The ICC profile of the picture {} is damaged (pieces are missing or out of order) "
                                   "and was left aside; save it again.",
                                   name)));
    const std::span<const std::uint8_t> profile(facts.profile, facts.profile_bytes);
    if (facts.channels == 4) {
        if (facts.inverted) invert(samples.bytes);
        cmyk_to_srgb<std::uint8_t>(samples.bytes, profile, name, samples.warnings);
    } else {
        spread_to_rgba<std::uint8_t>(samples.bytes, samples.pixels(), facts.channels, false, 255);
        samples.icc_profile.assign(profile.begin(), profile.end());
    }
    samples.orientation = facts.exif.orientation;
    samples.dpi_x = facts.dpi_x > 0 ? facts.dpi_x : facts.exif.dpi_x;
    samples.dpi_y = facts.dpi_y > 0 ? facts.dpi_y : facts.exif.dpi_y;
    samples.pixel_aspect = facts.pixel_aspect;
    return to_texels(std::move(samples), name, options);
}

}  // namespace voxtone::io
