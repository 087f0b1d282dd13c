// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/json_writer.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/printable.h"

namespace voxtone::io {

void JsonWriter::break_line() { text_.append("\n").append(depth_ * std::max<std::size_t>(indent_, 1), ' '); }

void JsonWriter::separate() {
    if (!after_key_ && !first_) text_ += ',';
    if (on_new_line_ || (indent_ > 0 && depth_ > 0 && !after_key_))
        break_line();
    else if (!after_key_ && !first_)
        text_ += ' ';
    first_ = after_key_ = on_new_line_ = false;
}

JsonWriter& JsonWriter::begin(char bracket) {
    separate();
    text_ += bracket;
    ++depth_;
    first_ = true;
    return *this;
}

JsonWriter& JsonWriter::end(char bracket) {
    VOXTONE_EXPECT(depth_ > 0 && !after_key_);
    --depth_;
    if (indent_ > 0 && !first_) break_line();
    text_ += bracket;
    first_ = on_new_line_ = false;
    return *this;
}

JsonWriter& JsonWriter::line() {
    on_new_line_ = true;
    return *this;
}

JsonWriter& JsonWriter::key(std::string_view name) {
    separate();
    text_ += json_quoted(name) + ": ";
    after_key_ = true;
    return *this;
}

JsonWriter& JsonWriter::value(std::string_view text) {
    separate();
    text_ += json_quoted(text);
    return *this;
}

JsonWriter& JsonWriter::value(bool truth) {
    separate();
    text_ += truth ? "true" : "false";
    return *this;
}

JsonWriter& JsonWriter::value(double number) {
    separate();
    text_ += std::isfinite(number) ? fmt::format("{}", number) : "null";
    return *this;
}

JsonWriter& JsonWriter::integer(std::int64_t number) {
    separate();
    text_ += std::to_string(number);
    return *this;
}

JsonWriter& JsonWriter::integer(std::uint64_t number) {
    separate();
    text_ += std::to_string(number);
    return *this;
}

}  // namespace voxtone::io
