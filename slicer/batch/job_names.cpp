// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/batch/job_names.h"

#include <algorithm>
#include <array>

#include <fmt/core.h>

#include "base/error.h"
#include "base/printable.h"

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

std::string name_fault(std::string_view name) {
    constexpr std::size_t longest = 120;  // of 255 bytes that a file may have; temporary names are longer
    constexpr std::string_view refused = "/\\:*?\"<>|";
    // What a batch keeps beside its jobs' folders.
    constexpr std::array<std::string_view, 4> taken{"batch", "batch.json", "index.html", "summary.csv"};
    if (name.empty()) return "is empty";
    if (name.size() > longest) return fmt::format("is longer than {} bytes", longest);
    if (name.front() == '.' || name.front() == '-') return fmt::format("begins with '{}'", name.front());
    if (name.front() == ' ' || name.back() == ' ' || name.back() == '.') return "begins or ends with a blank or a dot";
    if (const std::size_t bad = name.find_first_of(refused); bad != std::string_view::npos)
        return fmt::format("has a '{}'", name[bad]);
    if (printable(name) != name || name.find_first_of("\n\t") != std::string_view::npos)
        return "has a control character or is no UTF-8";
    if (std::find(taken.begin(), taken.end(), name) != taken.end()) return "is that of a file of the batch itself";
    return {};
}

}  // namespace voxtone::slicer
