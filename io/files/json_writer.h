// SPDX-License-Identifier: GPL-3.0-or-later
//
// JSON as this program writes it, all of it: keys in the order given, ", " and ": " between, line breaks where the
// writer of a file wants them, numbers as short as they can be and still read back as the same.
//
// Texts may hold any bytes, as names of files do: what is no UTF-8 is escaped so that JsonObject gives it back
// (escaped_bytes in base/printable.h).
//
// Why not nlohmann-json, which reads ours: its `dump` sets tables of numbers either in one line or one number a line,
// takes ten times as long to compile, and the whole document would be in memory twice.
#pragma once

#include <concepts>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>

namespace voxtone::io {

class JsonWriter {
public:
    JsonWriter() = default;
    /// With a line for every value, indented by so many blanks a level.
    explicit JsonWriter(std::size_t indent) : indent_(indent) {}

    JsonWriter& begin_object() { return begin('{'); }
    JsonWriter& end_object() { return end('}'); }
    JsonWriter& begin_list() { return begin('['); }
    JsonWriter& end_list() { return end(']'); }
    /// What comes next begins a line of its own, indented by as many blanks as it is deep.
    JsonWriter& line();
    /// Within an object, before each value.
    JsonWriter& key(std::string_view name);

    JsonWriter& value(std::string_view text);
    JsonWriter& value(const char* text) { return value(std::string_view(text)); }
    JsonWriter& value(const std::string& text) { return value(std::string_view(text)); }
    JsonWriter& value(bool truth);
    JsonWriter& value(double number);  ///< null where it is not finite: JSON has no other word for that
    template <std::integral Integer>
    JsonWriter& value(Integer number) {
        if constexpr (std::signed_integral<Integer>)
            return integer(std::int64_t{number});
        else
            return integer(std::uint64_t{number});
    }
    /// A list in one line.
    template <class List>
    requires requires(const List& list) { std::begin(list); }
    JsonWriter& value(const List& list) {
        begin_list();
        for (const auto& entry : list) value(entry);
        return end_list();
    }
    template <class Value>
    JsonWriter& add(std::string_view name, const Value& of) {
        return key(name).value(of);
    }

    /// The text so far.
    [[nodiscard]] const std::string& text() const { return text_; }

private:
    JsonWriter& begin(char bracket);
    JsonWriter& end(char bracket);
    JsonWriter& integer(std::int64_t number);
    JsonWriter& integer(std::uint64_t number);
    void separate();
    void break_line();

    std::string text_;
    std::size_t depth_ = 0, indent_ = 0;
    bool first_ = true, after_key_ = false, on_new_line_ = false;
};

}  // namespace voxtone::io
