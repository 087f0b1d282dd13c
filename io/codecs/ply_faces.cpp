// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/codecs/ply_faces.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

#include <fmt/format.h>

#include "voxtone/base/error.h"
#include "voxtone/io/pictures/srgb_code.h"

namespace voxtone::io {

namespace {

static_assert(std::endian::native == std::endian::little);

/// The values behind a header, one after another.
class PlyValues {
public:
    PlyValues(std::span<const std::byte> bytes, const PlyHeader& header, const std::string& name)
        : text_(reinterpret_cast<const char*>(bytes.data()), bytes.size()),
          at_(std::min(header.bytes, text_.size())),
          encoding_(header.encoding),
          name_(name) {}

    double next(PlyType type) { return encoding_ == PlyHeader::Encoding::ascii ? next_word() : next_binary(type); }
    void skip(PlyType type, std::uint64_t values) {
        if (encoding_ == PlyHeader::Encoding::ascii) {
            for (std::uint64_t i = 0; i < values; ++i) skip_word();
            return;
        }
        if (values > (text_.size() - at_) / bytes_of(type)) cut_short();
        at_ += values * bytes_of(type);
    }
    /// The length of a list, which fits into what is left of the file.
    std::uint64_t length(PlyType type) {
        const double n = next(type);
        if (!(n >= 0 && n <= static_cast<double>(text_.size() - at_))) cut_short();
        return static_cast<std::uint64_t>(n);
    }

private:
    [[noreturn]] void cut_short() const {
        throw InputError(
            fmt::format("{} ends before its last face, or a list in it has no length; it is damaged or "
                        "cut short, export it again",
                        name_));
    }

    static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

    void skip_blanks() {
        while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
    }

    /// Whatever it says: some write numbers that are none ("-1.#IND") where nobody looks.
    void skip_word() {
        skip_blanks();
        if (at_ == text_.size()) cut_short();
        while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
    }

    double next_word() {
        skip_blanks();
        double value = 0;
        const char* const first = text_.data() + at_;
        const char* const last = text_.data() + text_.size();
        const auto [end, error] = std::from_chars(first + (first != last && *first == '+'), last, value);
        if (error != std::errc{}) cut_short();
        at_ = static_cast<std::size_t>(end - text_.data());
        return value;
    }

    double next_binary(PlyType type) {
        const std::size_t size = bytes_of(type);
        if (size > text_.size() - at_) cut_short();
        char raw[8] = {};
        std::memcpy(raw, text_.data() + at_, size);
        if (encoding_ == PlyHeader::Encoding::big_endian) std::reverse(raw, raw + size);
        at_ += size;
        static constexpr double (*readers[])(const char*) = {
            value_of<std::int8_t>,  value_of<std::uint8_t>,  value_of<std::int16_t>, value_of<std::uint16_t>,
            value_of<std::int32_t>, value_of<std::uint32_t>, value_of<float>,        value_of<double>};
        return readers[static_cast<std::size_t>(type)](raw);
    }

    template <class Value>
    static double value_of(const char* raw) {
        Value value;
        std::memcpy(&value, raw, sizeof value);
        return static_cast<double>(value);
    }

    std::string_view text_;
    std::size_t at_;
    PlyHeader::Encoding encoding_;
    const std::string& name_;
};

/// In [0, 1].
float scaled(double value, PlyType type) {
    if (is_float(type)) return static_cast<float>(value);
    return static_cast<float>(value / (bytes_of(type) == 1 ? 255.0 : bytes_of(type) == 2 ? 65535.0 : 4294967295.0));
}

void skip_item(const PlyElement& element, PlyValues& values) {
    for (const PlyProperty& p : element.properties) values.skip(p.type, p.is_list ? values.length(p.count_type) : 1);
}

class FaceReader {
public:
    FaceReader(const PlyHeader& header, PlyValues& values) : header_(header), values_(values) {}

    PlyFaces read(const PlyElement& element) {
        faces_.first_corner.push_back(0);
        for (std::uint64_t f = 0; f < element.count; ++f) {
            read_face(element);
            faces_.first_corner.push_back(faces_.vertex.size());
        }
        return std::move(faces_);
    }

private:
    void read_face(const PlyElement& element) {
        Eigen::Vector4f rgba = Eigen::Vector4f::Ones();
        bool integers = true;
        std::vector<float> uv;
        for (const PlyProperty& p : element.properties) {
            const int channel = ply_colour_channel(p.name);
            if (p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index")) {
                for (std::uint64_t n = values_.length(p.count_type); n-- > 0;) add_corner(values_.next(p.type));
            } else if (p.is_list && p.name == "texcoord") {
                for (std::uint64_t n = values_.length(p.count_type); n-- > 0;)
                    uv.push_back(static_cast<float>(values_.next(p.type)));
            } else if (!p.is_list && channel >= 0) {
                rgba[channel] = scaled(values_.next(p.type), p.type);
                integers = !is_float(p.type);
            } else {
                values_.skip(p.type, p.is_list ? values_.length(p.count_type) : 1);
            }
        }
        if (header_.face_colours) add_colour(rgba, integers);
        if (header_.corner_coordinates) add_coordinates(uv);
    }

    void add_corner(double index) {
        faces_.vertex.push_back(index >= 0 && index < 4294967295.0 ? static_cast<std::uint32_t>(index) : 4294967295u);
    }

    void add_colour(Eigen::Vector4f rgba, bool integers) {
        const Eigen::Vector3f code = rgba.head<3>().cwiseMax(0).cwiseMin(1);
        if (integers) rgba.head<3>() = srgb_to_linear(code);
        faces_.rgba.push_back(rgba);
    }

    void add_coordinates(const std::vector<float>& uv) {
        faces_.uv.resize(faces_.vertex.size(), Eigen::Vector2f::Zero());
        const std::size_t first = faces_.first_corner.back();
        for (std::size_t c = first; c < faces_.vertex.size() && 2 * (c - first) + 1 < uv.size(); ++c)
            faces_.uv[c] = {uv[2 * (c - first)], uv[2 * (c - first) + 1]};
    }

    const PlyHeader& header_;
    PlyValues& values_;
    PlyFaces faces_;
};

}  // namespace

void expect_lists_to_fit(std::span<const std::byte> bytes, const PlyHeader& header, const std::string& name) {
    PlyValues values(bytes, header, name);
    for (const PlyElement& element : header.elements)
        for (std::uint64_t i = 0; i < element.count; ++i) skip_item(element, values);
}

bool PlyFaces::has_several_colours() const {
    return std::adjacent_find(rgba.begin(), rgba.end(), std::not_equal_to<>()) != rgba.end();
}

bool PlyFaces::has_corners(std::size_t face, const std::array<std::uint32_t, 3>& triangle) const {
    const auto first = vertex.begin() + static_cast<std::ptrdiff_t>(first_corner[face]),
               last = vertex.begin() + static_cast<std::ptrdiff_t>(first_corner[face + 1]);
    return std::all_of(triangle.begin(), triangle.end(),
                       [&](std::uint32_t v) { return std::find(first, last, v) != last; });
}

Eigen::Vector2f PlyFaces::uv_at(std::size_t face, std::uint32_t wanted) const {
    for (std::size_t c = first_corner[face]; c < first_corner[face + 1]; ++c)
        if (vertex[c] == wanted) return uv[c];
    return Eigen::Vector2f::Zero();
}

PlyFaces read_ply_faces(std::span<const std::byte> bytes, const PlyHeader& header, const std::string& name) {
    PlyValues values(bytes, header, name);
    for (const PlyElement& element : header.elements) {
        if (element.name == "face") return FaceReader(header, values).read(element);
        for (std::uint64_t i = 0; i < element.count; ++i) skip_item(element, values);
    }
    return {};
}

}  // namespace voxtone::io
