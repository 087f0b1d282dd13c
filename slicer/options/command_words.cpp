// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/command_words.h"

#include <algorithm>

#include "base/error.h"
#include "slicer/options/option_scope.h"
#include "slicer/options/option_table.h"

namespace voxtone::slicer {

namespace {

const SliceOptions defaults;

bool would_be_ignored(const SliceOptions& options, const std::string& key) {
    SliceOptions named = options;
    named.named = {key};
    try {
        check_scope(named);
        return false;
    } catch (const UsageError&) {
        return true;
    }
}

bool is_plain(const std::string& word) {
    constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./@%";
    return !word.empty() && word.find_first_not_of(plain) == std::string::npos;
}

std::string quoted(const std::string& word) {
    if (is_plain(word)) return word;
    std::string text = "'";
    for (const char c : word) {
        if (c == '\'')
            text += "'\\''";
        else
            text += c;
    }
    return text + "'";
}

}  // namespace

std::vector<std::string> command_words(const SliceOptions& options) {
    std::vector<std::string> arguments{"slice"};
    for (const OptionSpec& spec : slice_option_table()) {
        const std::string value = spec.get(options);
        if (spec.is_preset() || value == spec.get(defaults)) continue;
        if (spec.kind() == OptionSpec::Kind::flag) {
            arguments.push_back((value == "true" ? "--" : "--no-") + spec.key);
        } else if (value.starts_with('-')) {
            arguments.push_back("--" + spec.key + "=" + value);
        } else {
            if (!spec.positional) arguments.push_back("--" + spec.key);
            arguments.push_back(value);
        }
    }
    return arguments;
}

std::string shell_line(std::span<const std::string> arguments) {
    std::string line;
    for (const std::string& word : arguments) line += (line.empty() ? "" : " ") + quoted(word);
    return line;
}

void drop_idle(SliceOptions& options, std::span<const std::string> kept) {
    options.named.assign(kept.begin(), kept.end());
    for (const OptionSpec& spec : slice_option_table()) {
        if (spec.is_preset() || spec.get(options) == spec.get(defaults) ||
            std::find(kept.begin(), kept.end(), spec.key) != kept.end())
            continue;
        if (would_be_ignored(options, spec.key))
            spec.set(options, spec.get(defaults));
        else
            options.named.push_back(spec.key);
    }
}

}  // namespace voxtone::slicer
