// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/json_lines.h"

#include <algorithm>
#include <optional>

#include <nlohmann/json.hpp>

namespace voxtone::io {

namespace {

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
        const auto name = nlohmann::json::parse(quoted, nullptr, false);
        return name.is_string() && name.get<std::string>() == key;
    }

    std::string_view text_;
    std::size_t at_ = 0;
};

}  // namespace

std::size_t line_in_json(std::string_view text, std::span<const JsonStep> path) {
    JsonWalk walk(text);
    std::size_t place = walk.at();
    for (const JsonStep& step : path) {
        const auto found = std::visit([&](const auto& where) { return walk.enter(where); }, step);
        if (!found) return 0;
        place = *found;
    }
    return 1 + static_cast<std::size_t>(std::count(
                   text.begin(), text.begin() + static_cast<std::ptrdiff_t>(std::min(place, text.size())), '\n'));
}

}  // namespace voxtone::io
