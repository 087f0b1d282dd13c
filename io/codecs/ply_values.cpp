// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/ply_values.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include <fmt/format.h>

#include "base/error.h"
#include "io/models/model_text.h"

namespace voxtone::io {

namespace {

static_assert(std::endian::native == std::endian::little);

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

template <class Value>
double value_of(const char* raw) {
    Value value;
    std::memcpy(&value, raw, sizeof value);
    return static_cast<double>(value);
}

}  // namespace

PlyValues::PlyValues(std::span<const std::byte> bytes, const PlyHeader& header, const std::string& name)
    : text_(reinterpret_cast<const char*>(bytes.data()), bytes.size()),
      at_(std::min(header.bytes, text_.size())),
      encoding_(header.encoding),
      name_(name) {}

void PlyValues::cut_short() const {
    throw InputError(
        fmt::format("{} ends before its last face, or a list in it has no length; it is damaged or "
                    "cut short, export it again",
                    name_));
}

void PlyValues::skip(PlyType type, std::uint64_t values) {
    if (encoding_ == PlyHeader::Encoding::ascii) {
        for (std::uint64_t i = 0; i < values; ++i) skip_word();
        return;
    }
    if (values > (text_.size() - at_) / bytes_of(type)) cut_short();
    at_ += values * bytes_of(type);
}

std::uint64_t PlyValues::length(PlyType type) {
    const double n = next(type);
    if (!(n >= 0 && n <= static_cast<double>(text_.size() - at_))) cut_short();
    return static_cast<std::uint64_t>(n);
}

void PlyValues::skip_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
}

/// Whatever it says: some write numbers that are none ("-1.#IND") where nobody looks.
void PlyValues::skip_word() {
    skip_blanks();
    if (at_ == text_.size()) cut_short();
    while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
}

bool PlyValues::has_number_left() {
    if (encoding_ != PlyHeader::Encoding::ascii) return false;
    skip_blanks();
    const std::string_view rest = text_.substr(at_);
    bool comma = false;
    return number_of(rest.substr(0, rest.find_first_of(" \t\r\n")), comma).has_value();
}

double PlyValues::next_word() {
    skip_blanks();
    const std::size_t first = at_;
    while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
    const auto value = number_of(text_.substr(first, at_ - first), commas_);
    if (!value) cut_short();
    return *value;
}

double PlyValues::next_binary(PlyType type) {
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

void skip_item(const PlyElement& element, PlyValues& values) {
    for (const PlyProperty& p : element.properties) values.skip(p.type, p.is_list ? values.length(p.count_type) : 1);
}

void expect_lists_to_fit(std::span<const std::byte> bytes, const PlyHeader& header, const std::string& name) {
    PlyValues values(bytes, header, name);
    for (const PlyElement& element : header.elements)
        for (std::uint64_t i = 0; i < element.count; ++i) skip_item(element, values);
}

}  // namespace voxtone::io
