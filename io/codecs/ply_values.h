// SPDX-License-Identifier: GPL-3.0-or-later
//
// The values behind the header of a PLY file, one after another, text or binary. Throws InputError where the file ends
// before them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "io/codecs/ply_header.h"

namespace voxtone::io {

class PlyValues {
public:
    /// Keeps references.
    PlyValues(std::span<const std::byte> bytes, const PlyHeader& header, const std::string& name);

    [[nodiscard]] double next(PlyType type) {
        return encoding_ == PlyHeader::Encoding::ascii ? next_word() : next_binary(type);
    }
    void skip(PlyType type, std::uint64_t values);
    /// The length of a list, which fits into what is left of the file.
    [[nodiscard]] std::uint64_t length(PlyType type);

    /// Whether text goes on with a number: the header told fewer items than there are.
    [[nodiscard]] bool has_number_left();
    /// Whether any number that was read had a decimal comma.
    [[nodiscard]] bool commas() const { return commas_; }

private:
    [[noreturn]] void cut_short() const;
    void skip_blanks();
    void skip_word();
    double next_word();
    double next_binary(PlyType type);

    std::string_view text_;
    std::size_t at_;
    PlyHeader::Encoding encoding_;
    const std::string& name_;
    bool commas_ = false;
};

void skip_item(const PlyElement& element, PlyValues& values);

/// Throws InputError where a list is longer than what is left of the file: a parser would take memory for it.
void expect_lists_to_fit(std::span<const std::byte> bytes, const PlyHeader& header, const std::string& name);

}  // namespace voxtone::io
