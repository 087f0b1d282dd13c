// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/json_lines.h"

#include <algorithm>
#include <unordered_set>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace voxtone::io {

namespace {

std::size_t line_of(std::string_view text, std::size_t at) {
    const auto end = static_cast<std::ptrdiff_t>(std::min(at, text.size()));
    return 1 + static_cast<std::size_t>(std::count(text.begin(), text.begin() + end, '\n'));
}

/// What stands between these quotes, escapes undone.
std::string text_of_string(std::string_view quoted) {
    if (quoted.find('\\') == std::string_view::npos) return std::string(quoted.substr(1, quoted.size() - 2));
    const auto text = nlohmann::json::parse(quoted, nullptr, false);
    return text.is_string() ? text.get<std::string>() : std::string(quoted);
}

/// Behind the string that begins here.
std::size_t end_of_string(std::string_view text, std::size_t begin) {
    std::size_t at = begin + 1;
    while (at < text.size() && text[at] != '"') at += text[at] == '\\' ? 2 : 1;
    return std::min(at + 1, text.size());
}

/// Walks valid JSON; never past its end, whatever the text.
class JsonWalk {
public:
    explicit JsonWalk(std::string_view text) : text_(text) {
        if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;
        skip_blanks();
    }

    [[nodiscard]] std::size_t at() const { return at_; }

    /// From an object to where the value of a key begins; the place of the key. It has to be looked for to the end.
    std::optional<std::size_t> enter(const std::string& key) {
        if (!take('{')) return std::nullopt;
        std::optional<std::size_t> found;
        std::size_t value = at_;
        while (peek() == '"') {
            const std::size_t begin = at_;
            skip_string();
            const bool same = is_key(text_.substr(begin, at_ - begin), key);
            skip_blanks();
            if (!take(':')) break;
            if (same) {
                found = begin;
                value = at_;
            }
            skip_value();
            if (!take(',')) break;
        }
        at_ = value;
        return found;
    }
    /// From a list to one of its entries; its place.
    std::optional<std::size_t> enter(std::size_t index) {
        if (!take('[') || peek() == ']') return std::nullopt;
        for (; index > 0; --index) {
            skip_value();
            if (!take(',')) return std::nullopt;
        }
        return at_;
    }

private:
    [[nodiscard]] char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
    void skip_blanks() { at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size()); }
    /// And the blanks behind it.
    bool take(char c) {
        if (peek() != c) return false;
        ++at_;
        skip_blanks();
        return true;
    }
    void skip_string() {
        for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_)
            if (text_[at_] == '\\') ++at_;
        at_ = std::min(at_ + 1, text_.size());
    }
    /// And the blanks behind it. No recursion: a text may be nested without end.
    void skip_value() {
        std::size_t depth = 0;
        do {
            const char c = peek();
            if (c == '"') {
                skip_string();
            } else {
                depth += c == '{' || c == '[';
                depth -= depth > 0 && (c == '}' || c == ']');
                ++at_;
                if (depth == 0 && c != '}' && c != ']')
                    at_ = std::min(text_.find_first_of(",]} \t\r\n", at_), text_.size());
            }
            skip_blanks();
        } while (depth > 0 && at_ < text_.size());
    }
    static bool is_key(std::string_view quoted, const std::string& key) {
        if (quoted.find('\\') == std::string_view::npos) return quoted.substr(1, quoted.size() - 2) == key;
        return text_of_string(quoted) == key;
    }

    std::string_view text_;
    std::size_t at_ = 0;
};

}  // namespace

std::optional<RepeatedKey> repeated_key(std::string_view text) {
    std::vector<bool> is_object;                        // of all that is open here
    std::vector<std::unordered_set<std::string>> keys;  // of the objects among it
    for (std::size_t at = text.find_first_of("\"{}[]"); at < text.size(); at = text.find_first_of("\"{}[]", at)) {
        const char c = text[at];
        if (c != '"') {
            if (c == '{') keys.emplace_back();
            if (c == '{' || c == '[') {
                is_object.push_back(c == '{');
            } else if (!is_object.empty()) {
                if (is_object.back()) keys.pop_back();
                is_object.pop_back();
            }
            ++at;
            continue;
        }
        const std::size_t begin = at;
        at = end_of_string(text, begin);
        const std::size_t next = text.find_first_not_of(" \t\r\n", at);
        if (keys.empty() || next == std::string_view::npos || text[next] != ':') continue;  // a value
        std::string key = text_of_string(text.substr(begin, at - begin));
        if (!keys.back().insert(key).second) return RepeatedKey{std::move(key), line_of(text, begin)};
    }
    return std::nullopt;
}

std::size_t line_in_json(std::string_view text, std::span<const JsonStep> path) {
    JsonWalk walk(text);
    std::size_t place = walk.at();
    for (const JsonStep& step : path) {
        const auto found = std::visit([&](const auto& where) { return walk.enter(where); }, step);
        if (!found) return 0;
        place = *found;
    }
    return line_of(text, place);
}

}  // namespace voxtone::io
