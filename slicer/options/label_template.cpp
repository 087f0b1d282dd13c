// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/label_template.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <optional>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "io/files/json_keys.h"
#include "slicer/options/mark_words.h"

namespace voxtone::slicer {

namespace {

bool has_template(const std::string& key) { return is_mark_subject(key) && key != "file"; }

/// Where a name in braces begins and ends, and what is in it.
struct NameInBraces {
    std::size_t begin, end;
    std::string name, format;
};

/// The next one from there on; doubled braces are passed over.
std::optional<NameInBraces> next_name(const std::string& text, std::size_t from) {
    for (std::size_t i = from; i < text.size(); ++i) {
        if (text[i] != '{') continue;
        if (i + 1 < text.size() && text[i + 1] == '{') {
            ++i;
            continue;
        }
        const std::size_t end = text.find('}', i);
        if (end == std::string::npos) return std::nullopt;
        const std::string inside = text.substr(i + 1, end - i - 1);
        const std::size_t colon = inside.find(':');
        return NameInBraces{i, end + 1, inside.substr(0, colon),
                            colon == std::string::npos ? "" : inside.substr(colon + 1)};
    }
    return std::nullopt;
}

std::string doubled_braces(const std::string& text) {
    std::string doubled;
    for (const char c : text) doubled += c == '{' || c == '}' ? std::string(2, c) : std::string(1, c);
    return doubled;
}

/// "03": a number of at least three digits.
std::string padded_value(const std::string& value, const std::string& format) {
    if (format.empty()) return value;
    const bool padded = format.size() > 1 && format[0] == '0';
    std::size_t width = 0;
    const char* const end = format.data() + format.size();
    if (!padded || std::from_chars(format.data(), end, width).ptr != end || width > 99)
        throw UsageError(
            fmt::format("{{...:{}}}: what stands behind a colon is a number of digits, such as {{copy:03}}", format));
    return std::string(value.size() < width ? width - value.size() : 0, '0') + value;
}

}  // namespace

bool is_value_key(std::string_view key) { return key.size() > 2 && key.starts_with('{') && key.ends_with('}'); }

std::vector<std::string> own_words(const io::JsonObject& row, std::span<const std::string> known) {
    std::vector<std::string> own;
    for (const std::string& key : row.keys())
        if (key.find_first_of("{}") == std::string::npos && std::ranges::find(known, key) == known.end() &&
            io::nearest_name(key, known).empty())
            own.push_back(key);
    return own;
}

std::string own_words_note(const std::set<std::string>& own) {
    return fmt::format("{} {} no key of a plan: taken as {} of your own, which labels have in braces ({{{}}})",
                       fmt::join(own, ", "), own.size() == 1 ? "is" : "are", own.size() == 1 ? "a text" : "texts",
                       *own.begin());
}

TemplateValues values_of_row(const io::JsonObject& row, std::span<const std::string> known) {
    TemplateValues values;
    for (const std::string& key : row.keys())
        if (is_value_key(key)) values[key.substr(1, key.size() - 2)] = row.any_text(key);
    const std::vector<std::string> own = own_words(row, known);
    for (const std::string& key : own)
        if (!values.emplace(key, row.any_text(key)).second) row.fail(key, "is here in braces, too: leave one out");
    std::vector<std::string> allowed(known.begin(), known.end());
    allowed.insert(allowed.end(), own.begin(), own.end());
    std::ranges::copy_if(row.keys(), std::back_inserter(allowed), is_value_key);
    try {
        row.allow_only(allowed);
    } catch (const InputError& error) {
        throw InputError(
            fmt::format("{} A text of your own by that name is written in braces, such as {{serial}}", error.what()));
    }
    return values;
}

std::string with_values(const std::string& spelled, const TemplateValues& values) {
    MarkWords words = split_mark(MarkFamily::label, spelled);
    for (auto& [key, value] : words) {
        if (!has_template(key)) continue;
        for (std::size_t from = 0;;) {
            const std::optional<NameInBraces> name = next_name(value, from);
            if (!name) break;
            from = name->end;
            const auto found = values.find(name->name);
            if (found == values.end()) continue;
            const std::string text = doubled_braces(padded_value(found->second, name->format));
            value.replace(name->begin, name->end - name->begin, text);
            from = name->begin + text.size();
        }
    }
    return spell_mark(words);
}

bool names_value(const std::string& spelled, std::string_view wanted) {
    for (const auto& [key, value] : split_mark(MarkFamily::label, spelled))
        for (std::optional<NameInBraces> name = next_name(value, 0); name; name = next_name(value, name->end))
            if (name->name == wanted) return true;
    return false;
}

std::string settled_text(const std::string& text, const std::string& said) {
    if (const std::optional<NameInBraces> name = next_name(text, 0))
        throw UsageError(fmt::format(
            "{}: {}", said,
            fmt::format("{{{}}} stands for nothing: {{job}}, {{part}} and {{copy}} do, and columns of a plan "
                        "by their headers; braces themselves are doubled",
                        name->name)));
    std::string settled;
    for (std::size_t i = 0; i < text.size(); ++i) {
        settled += text[i];
        if ((text[i] == '{' || text[i] == '}') && i + 1 < text.size() && text[i + 1] == text[i]) ++i;
    }
    return settled;
}

}  // namespace voxtone::slicer
