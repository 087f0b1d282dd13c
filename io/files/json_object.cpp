// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/json_object.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <utility>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/printable.h"
#include "io/files/json_keys.h"
#include "io/files/json_lines.h"
#include "io/files/utf8.h"

namespace voxtone::io {

using nlohmann::json;

namespace {

std::string shown(const json& value) {
    if (value.is_structured()) return value.is_array() ? "a list" : "an object";  // may be nested without end
    std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
    if (text.size() > 60) text = text.substr(0, 57) + "...";
    return text;
}

std::string raw_text(const json& text) { return unescaped_bytes(text.get_ref<const std::string&>()); }

/// "rows[3][1]" is the key "rows" and two places in lists.
std::vector<JsonStep> steps_of(std::string_view key, const json& object) {
    std::vector<JsonStep> places;
    while (!object.contains(std::string(key)) && key.ends_with(']')) {
        const std::size_t bracket = key.rfind('[');
        if (bracket == std::string_view::npos) break;
        std::size_t place = 0;
        std::from_chars(key.data() + bracket + 1, key.data() + key.size() - 1, place);
        places.emplace_back(place);
        key = key.substr(0, bracket);
    }
    std::vector<JsonStep> steps{std::string(key)};
    steps.insert(steps.end(), places.rbegin(), places.rend());
    return steps;
}

}  // namespace

struct JsonObject::Document {
    std::string source, text;
    json root;
    bool has_lines = true;
};

struct JsonObject::Node {
    std::shared_ptr<const Document> document;  // keeps `value` alive
    const json* value;
    std::string path;
    std::vector<JsonStep> steps;  // the same from the root

    /// "FILE: " or, where the text has this key, "FILE: line N: ".
    [[nodiscard]] std::string place_of(std::string_view key) const {
        if (!document->has_lines) return document->source + ": ";
        std::vector<JsonStep> there = steps;
        for (JsonStep& step : steps_of(key, *value)) there.push_back(std::move(step));
        std::size_t line = line_in_json(document->text, there);
        if (line == 0 && !steps.empty()) line = line_in_json(document->text, steps);  // of what it is missing in
        return line == 0 ? document->source + ": " : fmt::format("{}: line {}: ", document->source, line);
    }
    /// An object within.
    [[nodiscard]] std::shared_ptr<const Node> within(const json& object, std::string_view key) const {
        std::vector<JsonStep> there = steps;
        for (JsonStep& step : steps_of(key, *value)) there.push_back(std::move(step));
        return std::make_shared<const Node>(Node{document, &object, name(key), std::move(there)});
    }

    [[nodiscard]] std::string name(std::string_view key) const {
        return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
    }
    const json& at(const JsonObject& object, std::string_view key) const {
        const auto found = value->find(std::string(key));
        if (found == value->end()) object.fail(key, "is missing");
        return *found;
    }
};

JsonObject::JsonObject(std::shared_ptr<const Node> node) : node_(std::move(node)) {}

JsonObject JsonObject::parse(std::string_view text, std::string source) {
    return parsed(text, std::move(source), true);
}

JsonObject JsonObject::of_line(std::string_view text, std::string source) {
    return parsed(text, std::move(source), false);
}

JsonObject JsonObject::parsed(std::string_view text, std::string source, bool has_lines) {
    auto document = std::make_shared<Document>();
    try {
        document->root = json::parse(text);
    } catch (const json::parse_error& error) {
        const std::size_t end = std::min(error.byte, text.size());
        const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), '\n');
        throw InputError(
            fmt::format("{}: line {}: this is no valid JSON ({} bytes in); the file may be cut short or "
                        "edited by hand: mend it or make it anew",
                        source, line, end));
    } catch (const json::out_of_range&) {
        throw InputError(fmt::format("{}: holds a number that is too large for any computer", source));
    }
    if (!document->root.is_object())
        throw InputError(
            fmt::format("{}: expected a JSON object, {{...}}, found {}", source, document->root.type_name()));
    if (const auto repeated = repeated_key(text))
        throw InputError(
            fmt::format("{}: line {}: key `{}` stands here a second time, and only one of the two could "
                        "count; leave one out",
                        source, repeated->line, repeated->key));
    document->text = text;
    document->source = std::move(source);
    document->has_lines = has_lines;
    const json* const value = &document->root;
    return JsonObject(std::make_shared<const Node>(Node{std::move(document), value, {}, {}}));
}

JsonObject JsonObject::read(const std::filesystem::path& file, std::size_t most_bytes) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream)
        throw FileError(fmt::format("{}: cannot be opened for reading ({})", file.string(), std::strerror(errno)));
    std::string text, piece(std::size_t{1} << 16, '\0');
    while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())), stream.gcount() > 0) {
        text.append(piece, 0, static_cast<std::size_t>(stream.gcount()));
        if (text.size() > most_bytes)
            throw InputError(
                fmt::format("{}: larger than {} MiB, which no file of this kind is", file.string(), most_bytes >> 20));
    }
    if (std::error_code none; stream.bad() && std::filesystem::is_directory(file, none))
        throw FileError(fmt::format("{}: is a folder; name the file in it", file.string()));
    if (stream.bad()) throw FileError(fmt::format("{}: reading failed", file.string()));
    return parse(text_as_utf8(text), file.string());
}

void JsonObject::fail(std::string_view key, std::string_view rule) const {
    throw InputError(fmt::format("{}key `{}`: {}", node_->place_of(key), node_->name(key), rule));
}

void JsonObject::allow_only(std::initializer_list<std::string_view> known) const {
    allow_only(std::vector<std::string>(known.begin(), known.end()));
}

void JsonObject::allow_only(std::span<const std::string> known) const {
    for (const auto& item : node_->value->items())
        if (std::find(known.begin(), known.end(), item.key()) == known.end())
            throw InputError(fmt::format("{}{}{}", node_->place_of(item.key()),
                                         node_->path.empty() ? "" : node_->path + ": ",
                                         unknown_key_message(item.key(), known)));
}

bool JsonObject::has(std::string_view key) const { return node_->value->contains(std::string(key)); }

bool JsonObject::is_text(std::string_view key) const {
    const auto found = node_->value->find(std::string(key));
    return found != node_->value->end() && found->is_string();
}

bool JsonObject::is_object(std::string_view key) const {
    const auto found = node_->value->find(std::string(key));
    return found != node_->value->end() && found->is_object();
}

std::vector<std::string> JsonObject::keys() const {
    std::vector<std::string> result;
    for (const auto& item : node_->value->items()) result.push_back(item.key());
    return result;
}

std::string JsonObject::any_text(std::string_view key) const {
    const json& value = node_->at(*this, key);
    if (value.is_string()) return raw_text(value);
    if (value.is_boolean() || value.is_number()) return value.dump();
    if (!value.is_array())
        fail(key, fmt::format("is {}, expected a text, a number, true, false or a list of texts", shown(value)));
    return fmt::format("{}", fmt::join(texts(key), ","));
}

std::string JsonObject::text(std::string_view key) const {
    const json& value = node_->at(*this, key);
    if (!value.is_string()) fail(key, fmt::format("is {}, expected a text in quotes", shown(value)));
    return raw_text(value);
}

bool JsonObject::boolean(std::string_view key) const {
    const json& value = node_->at(*this, key);
    if (!value.is_boolean()) fail(key, fmt::format("is {}, expected true or false", shown(value)));
    return value.get<bool>();
}

double JsonObject::number(std::string_view key, double least, double most) const {
    const json& value = node_->at(*this, key);
    if (!value.is_number()) fail(key, fmt::format("is {}, expected a number", shown(value)));
    const double number = value.get<double>();
    if (!(number >= least && number <= most))
        fail(key, fmt::format("is {}, expected a number from {} to {}", shown(value), least, most));
    return number;
}

namespace {

std::uint64_t checked_integer(const JsonObject& object, std::string_view key, const json& value, std::uint64_t least,
                              std::uint64_t most) {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() < least || value.get<std::uint64_t>() > most)
        object.fail(key, fmt::format("holds {}, expected a whole number from {} to {}", shown(value), least, most));
    return value.get<std::uint64_t>();
}

void check_array(const JsonObject& object, std::string_view key, const json& value, std::size_t count) {
    if (!value.is_array()) object.fail(key, fmt::format("is {}, expected a list, [...]", shown(value)));
    if (count > 0 && value.size() != count)
        object.fail(key, fmt::format("has {} entries, expected {}", value.size(), count));
}

std::vector<double> checked_numbers(const JsonObject& object, std::string_view key, const json& value,
                                    std::size_t count, double least, double most) {
    check_array(object, key, value, count);
    std::vector<double> result;
    result.reserve(value.size());
    for (const json& entry : value) {
        if (!entry.is_number() || !(entry.get<double>() >= least && entry.get<double>() <= most))
            object.fail(key, fmt::format("holds {}, expected numbers from {} to {}", shown(entry), least, most));
        result.push_back(entry.get<double>());
    }
    return result;
}

}  // namespace

std::uint64_t JsonObject::integer(std::string_view key, std::uint64_t least, std::uint64_t most) const {
    return checked_integer(*this, key, node_->at(*this, key), least, most);
}

std::vector<double> JsonObject::numbers(std::string_view key, std::size_t count, double least, double most) const {
    return checked_numbers(*this, key, node_->at(*this, key), count, least, most);
}

std::vector<std::vector<double>> JsonObject::number_lists(std::string_view key, std::size_t lists, double least,
                                                          double most) const {
    const json& value = node_->at(*this, key);
    check_array(*this, key, value, lists);
    std::vector<std::vector<double>> result;
    for (std::size_t i = 0; i < value.size(); ++i)
        result.push_back(checked_numbers(*this, fmt::format("{}[{}]", key, i), value[i], 0, least, most));
    return result;
}

std::vector<std::vector<std::vector<double>>> JsonObject::tables(std::string_view key, std::size_t rows, double least,
                                                                 double most) const {
    const json& value = node_->at(*this, key);
    check_array(*this, key, value, 0);
    std::vector<std::vector<std::vector<double>>> result;
    for (std::size_t i = 0; i < value.size(); ++i) {
        check_array(*this, fmt::format("{}[{}]", key, i), value[i], rows);
        auto& table = result.emplace_back();
        for (std::size_t j = 0; j < value[i].size(); ++j)
            table.push_back(checked_numbers(*this, fmt::format("{}[{}][{}]", key, i, j), value[i][j], 0, least, most));
    }
    return result;
}

std::vector<std::uint64_t> JsonObject::integers(std::string_view key, std::size_t count, std::uint64_t least,
                                                std::uint64_t most) const {
    const json& value = node_->at(*this, key);
    check_array(*this, key, value, count);
    std::vector<std::uint64_t> result;
    for (const json& entry : value) result.push_back(checked_integer(*this, key, entry, least, most));
    return result;
}

std::vector<std::string> JsonObject::texts(std::string_view key) const {
    const json& value = node_->at(*this, key);
    check_array(*this, key, value, 0);
    std::vector<std::string> result;
    for (const json& entry : value) {
        if (!entry.is_string()) fail(key, fmt::format("holds {}, expected texts in quotes", shown(entry)));
        result.push_back(raw_text(entry));
    }
    return result;
}

JsonObject JsonObject::object(std::string_view key) const {
    const json& value = node_->at(*this, key);
    if (!value.is_object()) fail(key, fmt::format("is {}, expected an object, {{...}}", shown(value)));
    return JsonObject(node_->within(value, key));
}

std::vector<JsonObject> JsonObject::objects(std::string_view key) const {
    const json& value = node_->at(*this, key);
    check_array(*this, key, value, 0);
    std::vector<JsonObject> result;
    for (std::size_t i = 0; i < value.size(); ++i) {
        if (!value[i].is_object()) fail(key, fmt::format("holds {}, expected objects, {{...}}", shown(value[i])));
        result.push_back(JsonObject(node_->within(value[i], fmt::format("{}[{}]", key, i))));
    }
    return result;
}

}  // namespace voxtone::io
