// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/manual.h"

#include <algorithm>
#include <filesystem>
#include <sstream>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "io/files/whole_file.h"
#include "io/programs/build_identity.h"

namespace voxtone::cli {

namespace {

/// Text that roff takes as it is: no escapes, no requests at the start of a line, hyphens that can be copied.
std::string roff(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '\\')
            result += "\\e";
        else if (c == '-')
            result += "\\-";
        else if (c == '`' || c == '\'')
            result += c == '`' ? "\\(ga" : "\\(aq";
        else
            result += c;
        if (c == '\n') result += "\\&";
    }
    return (text.starts_with('.') ? "\\&" : "") + result;
}

std::string page_name(const Verb& verb) {
    std::string name = verb.full_name;
    std::replace(name.begin(), name.end(), ' ', '-');
    return name;
}

std::string title(const Verb& verb) {
    std::string upper = page_name(verb);
    std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return char(std::toupper(c)); });
    return fmt::format(".TH \"{}\" 1 \"\" \"voxtone {}\" \"voxtone\"\n.SH NAME\n{} \\- {}\n", roff(upper),
                       io::program_version(), roff(page_name(verb)), roff(verb.help.substr(0, verb.help.find('\n'))));
}

std::string synopsis(const Verb& verb) {
    std::string text = ".B " + roff(verb.full_name) + "\n[\\fIOPTIONS\\fR]";
    for (const Option& option : verb.options)
        if (!option.standing().empty()) text += " \\fI" + roff(option.standing()) + "\\fR";
    return text + (verb.steps.empty() ? "\n" : " \\fIVERB\\fR\n");
}

std::string options(const Verb& verb) {
    std::string text;
    for (const OptionGroup& group : verb.groups()) {
        text += ".SS " + roff(group.heading) + "\n";
        for (const Option* option : group.options) {
            const std::string value = option->value_text();
            const std::string names =
                group.standing ? option->standing() : fmt::format("{}", fmt::join(option->dashed(), ", "));
            text +=
                fmt::format(".TP\n\\fB{}\\fR{}\n{}\n", roff(names), value.empty() ? "" : " \\fI" + roff(value) + "\\fR",
                            roff(option->told(group.standing)));
        }
    }
    return text;
}

std::string example(const Verb& verb) {
    return ".PP\nExample:\n.PP\n.EX\n" + roff(verb.full_name + " " + verb.example) + "\n.EE\n";
}

/// The steps of a family, and those of families among them.
std::string steps(const Verb& verb) {
    std::string text;
    for (const Verb& step : verb.steps) {
        text += fmt::format(".SH \"{}\"\n", roff(step.full_name));
        text += roff(step.help) + "\n.PP\n" + synopsis(step) + options(step) + example(step);
        text += steps(step);
    }
    return text;
}

/// What every page ends with.
constexpr const char* ending =
    ".SH \"EXIT STATUS\"\n"
    "0 done; 1 a bug; 2 usage; 3 invalid input or job; 4 a file could not be read or written; 5 could not finish; 6 a "
    "check found faults; 75 nothing is wrong with the job, try again; 85 stopped on request, "
    "progress saved, run it again.\n"
    ".SH ENVIRONMENT\n.TP\n\\fBVOXTONE_HELPERS\\fR\nfolder of the programs that voxtone runs for parts of its work; "
    "empty: libexec/voxtone beside its own folder\n";

}  // namespace

ManualPage program_page(const Verb& program) {
    std::string text = title(program) + ".SH SYNOPSIS\n" + synopsis(program);
    text += ".SH DESCRIPTION\n" + roff(program.help) + "\n.SH VERBS\n";
    std::vector<std::string> pages;
    for (const Verb& verb : program.steps) {
        text += fmt::format(".TP\n\\fB{}\\fR\n{}\n", roff(verb.name), roff(verb.help));
        pages.push_back(fmt::format(".BR {} (1)", roff(page_name(verb))));
    }
    text += ".SH OPTIONS\n" + options(program) + example(program) + ending;
    return {"voxtone.1", text + fmt::format(".SH \"SEE ALSO\"\n{}\n", fmt::join(pages, "\n"))};
}

ManualPage verb_page(const Verb& verb) {
    std::string text = title(verb) + ".SH SYNOPSIS\n" + synopsis(verb);
    text += ".SH DESCRIPTION\n" + roff(verb.help) + "\n" + example(verb);
    text += ".SH OPTIONS\n" + options(verb);
    text += steps(verb);
    return {page_name(verb) + ".1", text + ending + ".SH \"SEE ALSO\"\n.BR voxtone (1)\n"};
}

void write_manual(const std::vector<ManualPage>& pages, const std::string& folder) {
    std::filesystem::create_directories(folder);
    for (const ManualPage& page : pages) io::write_whole_file(std::filesystem::path(folder) / page.file, page.text);
}

}  // namespace voxtone::cli
