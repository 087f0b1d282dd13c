// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/words.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <span>
#include <system_error>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "base/error.h"
#include "cli/program/parser_message.h"
#include "io/files/json_keys.h"

namespace voxtone::cli {

namespace {

bool is_option_word(const std::string& word) { return word.size() > 1 && word[0] == '-'; }

/// "-o=FOLDER"; CLI11 would take the sign into the value.
bool is_short_with_sign(const std::string& word) {
    return word.size() > 2 && word[0] == '-' && std::isalpha(static_cast<unsigned char>(word[1])) && word[2] == '=';
}

std::vector<std::string> verb_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::App* verb : command.get_subcommands({})) names.push_back(verb->get_name());
    return names;
}

std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_group().empty()) continue;  // an earlier spelling
        for (const std::string& name : option->get_lnames()) names.push_back(name);
    }
    return names;
}

const CLI::App* find_verb(const CLI::App& command, const std::string& name) {
    for (const CLI::App* verb : command.get_subcommands({}))
        if (verb->get_name() == name) return verb;
    return nullptr;
}

std::string did_you_mean(const std::string& nearest, const std::string& before, const std::string& otherwise) {
    return nearest.empty() ? otherwise : fmt::format("did you mean '{}{}'?", before, nearest);
}

[[noreturn]] void refuse_verb(const CLI::App& command, const std::string& word) {
    const std::vector<std::string> names = verb_names(command);
    throw UsageError(fmt::format(
        "'{}' is no verb of `{}`; {}", word, full_name(command),
        did_you_mean(io::nearest_name(word, names), "", fmt::format("there are {}", fmt::join(names, ", ")))));
}

/// The command that the first words name; `words` is left with what follows.
const CLI::App& named_command(const CLI::App& program, std::span<const std::string>& words) {
    const CLI::App* command = &program;
    while (!command->get_subcommands({}).empty() && !words.empty() && !is_option_word(words.front())) {
        const CLI::App* verb = find_verb(*command, words.front());
        if (!verb) refuse_verb(*command, words.front());
        command = verb;
        words = words.subspan(1);
    }
    return *command;
}

/// `-o --json` would make a folder called "--json".
void check_values_follow(const CLI::App& command, std::span<const std::string> words) {
    for (std::size_t i = 0; i + 1 < words.size() && words[i] != "--"; ++i) {
        if (!is_option_word(words[i])) continue;
        const CLI::Option* option = command.get_option_no_throw(words[i]);
        if (!option || option->get_items_expected_min() == 0) continue;
        if (is_option_word(words[i + 1]) && command.get_option_no_throw(words[i + 1]))
            throw UsageError(fmt::format("{}: its value is missing, for '{}' is an option; write {}={} if it is meant",
                                         words[i], words[i + 1], option->get_name(), words[i + 1]));
        ++i;
    }
}

/// The deepest command that was parsed.
const CLI::App& parsed_command(const CLI::App& program) {
    const CLI::App* command = &program;
    while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
    return *command;
}

/// A file whose name begins as options do.
bool may_be_file(const std::string& word) {
    std::error_code none;
    return std::filesystem::exists(word, none) ||
           (word.find('=') == std::string::npos && word.find_first_of("/.") != std::string::npos);
}

std::string unknown_option(const CLI::App& command, const std::string& word) {
    if (may_be_file(word))
        return fmt::format("{}: `{}` has no such option; if it is a file, write ./{}, or put it behind --", word,
                           full_name(command), word);
    const std::size_t begin = std::min(word.find_first_not_of('-'), word.size());
    const std::string name = word.substr(begin, word.find('=') - begin);
    const std::vector<std::string> known = option_names(command);
    return fmt::format("{}: `{}` has no such option; {}", word.substr(0, word.find('=')), full_name(command),
                       did_you_mean(io::nearest_name(name, known), "--",
                                    fmt::format("`{} --help` lists those it has", full_name(command))));
}

std::string one_too_many(const CLI::App& command, const std::string& word) {
    std::string wanted;
    for (const CLI::Option* option : command.get_options())
        if (option->get_positional()) wanted += (wanted.empty() ? "" : " and ") + option->get_name(true);
    return fmt::format(
        "'{}' is one word too many: `{}` takes {} besides its options; put a name with spaces into quotes", word,
        full_name(command), wanted.empty() ? "nothing" : wanted);
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

void check_words(const CLI::App& program, const Words& words) {
    std::span<const std::string> rest = words;
    const CLI::App& command = named_command(program, rest);
    if (!command.get_subcommands({}).empty() && rest.empty())
        throw UsageError(fmt::format("`{}` wants a verb: {}; `{} --help` says what they do", full_name(command),
                                     fmt::join(verb_names(command), ", "), full_name(command)));
    check_values_follow(command, rest);
}

std::string usage_message(const CLI::App& program, const CLI::ParseError& error) {
    const CLI::App& command = parsed_command(program);
    const std::vector<std::string> extras = program.remaining(true);
    for (const std::string& word : extras)
        if (is_option_word(word) && word != "--") return unknown_option(command, word);
    if (dynamic_cast<const CLI::ExtrasError*>(&error) && !extras.empty()) return one_too_many(command, extras.front());
    return fmt::format("{}; `{} --help` tells more", parser_message(command, error), full_name(command));
}

std::string full_name(const CLI::App& command) {
    return command.get_parent() ? full_name(*command.get_parent()) + " " + command.get_name() : command.get_name();
}

}  // namespace voxtone::cli
