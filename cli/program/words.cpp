// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/words.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <span>
#include <string_view>
#include <system_error>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "cli/program/verb.h"
#include "io/files/json_keys.h"

namespace voxtone::cli {

namespace {

bool is_option_word(const std::string& word) { return word.size() > 1 && word[0] == '-'; }

/// "-o=FOLDER"; CLI11 would take the sign into the value.
bool is_short_with_sign(const std::string& word) {
    return word.size() > 2 && word[0] == '-' && std::isalpha(static_cast<unsigned char>(word[1])) && word[2] == '=';
}

std::vector<std::string> verb_names(const Verb& verb) {
    std::vector<std::string> names;
    for (const Verb& step : verb.steps) names.push_back(step.name);
    return names;
}

std::string did_you_mean(const std::string& nearest, const std::string& before, const std::string& otherwise) {
    return nearest.empty() ? otherwise : fmt::format("did you mean '{}{}'?", before, nearest);
}

[[noreturn]] void refuse_verb(const Verb& verb, const std::string& word) {
    const std::vector<std::string> names = verb_names(verb);
    throw UsageError(fmt::format(
        "'{}' is no verb of `{}`; {}", word, verb.full_name,
        did_you_mean(io::nearest_name(word, names), "", fmt::format("there are {}", fmt::join(names, ", ")))));
}

/// The verb that the first words name; `words` is left with what follows.
const Verb& named_verb(const Verb& program, std::span<const std::string>& words) {
    const Verb* verb = &program;
    while (!verb->steps.empty() && !words.empty() && !is_option_word(words.front())) {
        const Verb* const step = verb->step(words.front());
        if (!step) refuse_verb(*verb, words.front());
        verb = step;
        words = words.subspan(1);
    }
    return *verb;
}

/// `-o --json` would make a folder called "--json".
void check_values_follow(const Verb& verb, std::span<const std::string> words) {
    for (std::size_t i = 0; i + 1 < words.size() && words[i] != "--"; ++i) {
        if (!is_option_word(words[i])) continue;
        const Option* option = verb.find(words[i]);
        if (!option || option->is_flag() || option->rules.bare) continue;
        if (is_option_word(words[i + 1]) && verb.find(words[i + 1]))
            throw UsageError(fmt::format("{}: its value is missing, for '{}' is an option; write {}={} if it is meant",
                                         words[i], words[i + 1], option->shown(), words[i + 1]));
        ++i;
    }
}

/// A file whose name begins as options do.
bool may_be_file(const std::string& word) {
    std::error_code none;
    return std::filesystem::exists(word, none) ||
           (word.find('=') == std::string::npos && word.find_first_of("/.") != std::string::npos);
}

/// What is looked for here and lies elsewhere.
constexpr std::array<std::string_view, 6> names_of_finish{"--gloss", "--glossy", "--matte",
                                                          "--matt",  "--mat",    "--finish"};

std::string unknown_option(const Verb& verb, const std::string& word) {
    if (std::ranges::find(names_of_finish, word.substr(0, word.find('='))) != names_of_finish.end())
        return fmt::format(
            "{}: `{}` has no such option; glossy or matt is set at the printer (HOW-TO-PRINT), and seen by "
            "`voxtone proof --finish`",
            word.substr(0, word.find('=')), verb.full_name);
    if (may_be_file(word))
        return fmt::format("{}: `{}` has no such option; if it is a file, write ./{}, or put it behind --", word,
                           verb.full_name, word);
    const std::size_t begin = std::min(word.find_first_not_of('-'), word.size());
    std::vector<std::string> known;
    for (const Option& option : verb.options)
        for (const std::string& name : option.dashed())
            if (name.starts_with("--")) known.push_back(name.substr(2));
    return fmt::format("{}: `{}` has no such option; {}", word.substr(0, word.find('=')), verb.full_name,
                       did_you_mean(io::nearest_name(word.substr(begin, word.find('=') - begin), known), "--",
                                    fmt::format("`{} --help` lists those it has", verb.full_name)));
}

std::string one_too_many(const Verb& verb, const std::string& word) {
    std::string wanted;
    for (const Option& option : verb.options)
        if (const std::string name = option.standing(); !name.empty()) wanted += (wanted.empty() ? "" : " and ") + name;
    return fmt::format(
        "'{}' is one word too many: `{}` takes {} besides its options; put a name with spaces into quotes", word,
        verb.full_name, wanted.empty() ? "nothing" : wanted);
}

}  // namespace

Words command_words(int argc, char* const* argv) {
    Words words;
    for (int i = 1; i < argc; ++i) words.emplace_back(argv[i]);
    if (!words.empty() && words.front() == "help") {
        words.erase(words.begin());
        words.emplace_back("--help");
    }
    const auto end = std::find(words.begin(), words.end(), "--");
    for (auto word = words.begin(); word != end; ++word)
        if (is_short_with_sign(*word)) word->erase(2, 1);
    return words;
}

Messages asked_messages(const Words& words) {
    const auto end = std::find(words.begin(), words.end(), "--");
    if (std::find(words.begin(), end, "--json") != end) return Messages::events;
    for (auto word = words.begin(); word != end; ++word)
        if (*word == "--progress=openjd" || (*word == "openjd" && word != words.begin() && *(word - 1) == "--progress"))
            return Messages::openjd;
    return Messages::text;
}

void check_words(const Verb& program, const Words& words) {
    std::span<const std::string> rest = words;
    const Verb& verb = named_verb(program, rest);
    if (!verb.steps.empty() && rest.empty())
        throw UsageError(fmt::format("`{}` wants a verb: {}; `{} --help` says what they do", verb.full_name,
                                     fmt::join(verb_names(verb), ", "), verb.full_name));
    check_values_follow(verb, rest);
}

std::string unknown_words(const Verb& verb, const Words& words, bool too_many) {
    for (const std::string& word : words)
        if (is_option_word(word) && word != "--") return unknown_option(verb, word);
    return too_many && !words.empty() ? one_too_many(verb, words.front()) : std::string();
}

}  // namespace voxtone::cli
