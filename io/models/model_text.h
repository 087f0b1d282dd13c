// SPDX-License-Identifier: GPL-3.0-or-later
//
// Text of models as the world writes it: with a byte order mark, in UTF-16 or 32, with any line end, with lines that go
// on behind a backslash, with decimal commas.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace voxtone::io {

/// As UTF-8, without a byte order mark. UTF-16 and 32 are known by their marks, UTF-16 also by a zero in every second
/// byte of the beginning; all else stays as it is.
[[nodiscard]] std::string model_text(std::span<const std::byte> bytes);

/// Without blanks (space, tab, CR, LF and their like) at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// Letters of ASCII in lower case.
[[nodiscard]] std::string lower_case(std::string_view text);

/// Statements of a line-based format, one after the other.
class TextLines {
public:
    /// `joins`: a backslash at a line's end, blanks behind it or not, takes the next line to it.
    explicit TextLines(std::string_view text, bool joins = true) : left_(text), joins_(joins) {}
    /// The next line that is not blank, trimmed; nothing at the end. CR, LF and CRLF end a line; a backslash at its
    /// end, blanks behind it or not, joins the next one to it. Stays valid until the next call.
    [[nodiscard]] std::optional<std::string_view> next();
    /// Of the line that came last, from 1.
    [[nodiscard]] std::size_t number() const { return number_; }

private:
    std::string_view left_;
    bool joins_;
    std::size_t number_ = 0, lines_ = 0;
    std::string joined_;
};

/// Cuts the first word off a text.
[[nodiscard]] std::string_view cut_word(std::string_view& text);

/// A number as a whole word, plus sign and "nan" and "inf" too. `comma`: set where its decimal mark is a comma, of
/// which it has one.
[[nodiscard]] std::optional<double> number_of(std::string_view word, bool& comma);

}  // namespace voxtone::io
