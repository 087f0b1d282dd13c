// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plans/job_names.h"

#include <algorithm>
#include <array>

#include <fmt/core.h>

#include "base/error.h"
#include "base/printable.h"
#include "io/files/xxh64.h"
#include "slicer/options/option_table.h"

namespace voxtone::slicer {

namespace {

/// Of a counter within braces, "n" or "n:03": how many digits it has at least, and whether zeros fill them; -1: it is
/// none.
int digits_of_counter(std::string_view field) {
    if (field == "n") return 1;
    if (field.size() == 4 && field.starts_with("n:0") && field[3] >= '1' && field[3] <= '9') return field[3] - '0';
    return -1;
}

/// Whether the option's value says nothing about where files lie.
bool is_value(const OptionSpec* spec) {
    return spec && (spec->names == OptionSpec::Names::nothing || spec->names == OptionSpec::Names::input_or_known);
}

/// Calls `piece(text)` and `field(name)` for the parts of a template. Throws UsageError.
template <class Piece, class Field>
void take_apart(const std::string& text, const Piece& piece, const Field& field) {
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t open = text.find_first_of("{}", at);
        if (open == std::string::npos) return piece(text.substr(at));
        piece(text.substr(at, open - at));
        const std::size_t close = text.find('}', open);
        if (text[open] == '}' || close == std::string::npos)
            throw UsageError(fmt::format("--name '{}': a brace stands alone; a field is {{name}} or {{n:03}}", text));
        field(text.substr(open + 1, close - open - 1));
        at = close + 1;
    }
}

}  // namespace

NameTemplate::NameTemplate(std::string text) : text_(std::move(text)) {
    take_apart(
        text_, [](const std::string&) {},
        [&](const std::string& field) {
            if (field == "name" || digits_of_counter(field) >= 0 || is_value(find_option(field))) return;
            throw UsageError(
                fmt::format("--name '{}': {{{}}} is no field; there are {{name}}, {{n}}, {{n:03}} and the keys of "
                            "options whose value is no path, such as {{size}}",
                            text_, field));
        });
    if (text_.empty()) throw UsageError("--name '': a template of names is not empty; {name}-{n:03} is one");
}

std::string NameTemplate::fill(std::string_view name, std::size_t n, const SliceOptions& options) const {
    std::string filled;
    take_apart(
        text_, [&](const std::string& piece) { filled += piece; },
        [&](const std::string& field) {
            if (const int digits = digits_of_counter(field); digits >= 0)
                filled += fmt::format("{:0{}}", n, digits);
            else
                filled += field == "name" ? std::string(name) : find_option(field)->get(options);
        });
    return filled;
}

namespace {

constexpr std::size_t longest_name = 120;  // of 255 bytes that a file may have; temporary names are longer
constexpr std::string_view refused_in_names = "/\\:*?\"<>|";

/// What a batch keeps beside its jobs' folders, and a tray beside its parts'.
bool is_taken(std::string_view name) {
    constexpr std::array<std::string_view, 6> taken{"batch",       "batch.json",     "index.html",
                                                    "summary.csv", "tray-plan.json", "earlier"};
    return std::find(taken.begin(), taken.end(), name) != taken.end();
}

/// Whether the character of these bytes, or what is no character, can stand in a name, there where it stands.
bool may_stand(std::string_view character, bool is_first, bool is_last) {
    if (printable(character) != character || character == "\n" || character == "\t") return false;
    if (character.size() > 1) return true;
    const char c = character[0];
    if (refused_in_names.find(c) != std::string_view::npos) return false;
    return !(is_first && (c == '.' || c == '-' || c == ' ')) && !(is_last && (c == ' ' || c == '.'));
}

std::size_t bytes_of_character(std::string_view text) {
    constexpr std::size_t most = 4;
    for (std::size_t length = 1; length <= std::min(most, text.size()); ++length)
        if (valid_utf8(text.substr(0, length)) == text.substr(0, length)) return length;
    return 1;  // no character
}

std::string shortened(const std::string& name) {
    if (name.size() <= longest_name) return name;
    constexpr std::size_t digits = 8;
    std::string begin = name.substr(0, longest_name - digits - 1);
    while (valid_utf8(begin) != begin) begin.pop_back();
    io::Xxh64 digest;
    digest.update(name.data(), name.size());
    return begin + "~" + fmt::format("{:016x}", digest.digest()).substr(0, digits);
}

}  // namespace

std::string name_fault(std::string_view name) {
    if (name.empty()) return "is empty";
    if (name.size() > longest_name) return fmt::format("is longer than {} bytes", longest_name);
    if (name.front() == '.' || name.front() == '-') return fmt::format("begins with '{}'", name.front());
    if (name.front() == ' ' || name.back() == ' ' || name.back() == '.') return "begins or ends with a blank or a dot";
    if (const std::size_t bad = name.find_first_of(refused_in_names); bad != std::string_view::npos)
        return fmt::format("has a '{}'", name[bad]);
    if (printable(name) != name || name.find_first_of("\n\t") != std::string_view::npos)
        return "has a control character or is no UTF-8";
    if (is_taken(name)) return "is that of a file of the batch or tray itself";
    return {};
}

std::string name_after(std::string_view model) {
    std::string name;
    for (std::size_t i = 0; i < model.size();) {
        const std::size_t length = bytes_of_character(model.substr(i));
        const std::string_view character = model.substr(i, length);
        if (may_stand(character, i == 0, i + length == model.size()))
            name += character;
        else
            for (const char c : character) name += fmt::format("%{:02X}", static_cast<unsigned char>(c));
        i += length;
    }
    if (is_taken(name)) name += '_';
    return shortened(name);
}

}  // namespace voxtone::slicer
