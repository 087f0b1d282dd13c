// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/batch_summary.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <string_view>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/counted.h"
#include "base/embedded_file.h"
#include "base/error.h"
#include "base/progress_bar.h"
#include "farm/batch/batch_outlook.h"
#include "io/files/base64.h"
#include "io/files/markup.h"
#include "io/files/whole_file.h"
#include "io/programs/build_identity.h"
#include "slicer/part/report_files.h"

namespace voxtone::embedded {
std::span<const EmbeddedFile> batch_assets();
}

namespace voxtone::farm {

namespace {

namespace fs = std::filesystem;
using io::html_text;
using io::link_text;

std::string style() {
    std::string text(io::page_asset("style"));
    for (const EmbeddedFile& file : embedded::batch_assets()) text += file.text;
    return text;
}

/// Roles of resins that any job takes, in the order in which jobs name them.
std::vector<std::string> roles_of(const std::vector<JobState>& states) {
    std::vector<std::string> roles;
    for (const JobState& state : states)
        if (state.figures)
            for (const auto& [role, ml] : state.figures->resin_ml)
                if (std::find(roles.begin(), roles.end(), role) == roles.end()) roles.push_back(role);
    return roles;
}

std::map<std::string, double> ml_by_role(const JobState& state) {
    std::map<std::string, double> ml;
    if (state.figures)
        for (const auto& [role, of_role] : state.figures->resin_ml) ml[role] += of_role;
    return ml;
}

double total_ml(const JobState& state) {
    double sum = 0;
    for (const auto& [role, ml] : ml_by_role(state)) sum += ml;
    return sum;
}

/// In quotes where it has to be. What a spreadsheet would take for a formula gets a quote before it.
std::string csv_cell(std::string text) {
    if (!text.empty() && std::string_view("=+-@\t\r").find(text[0]) != std::string_view::npos) text.insert(0, "'");
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string cell = "\"";
    for (const char c : text) cell += c == '"' ? "\"\"" : std::string(1, c);
    return cell + "\"";
}

std::string csv_line(const std::vector<std::string>& cells) {
    std::string line;
    for (const std::string& cell : cells) line += (line.empty() ? "" : ",") + csv_cell(cell);
    return line + "\r\n";
}

std::string size_text(const StackFigures& figures) {
    return fmt::format("{:.1f} × {:.1f} × {:.1f}", figures.size_mm[0], figures.size_mm[1], figures.size_mm[2]);
}

/// A small picture of a job as a source of an image; empty: there is none.
std::string picture_source(const BatchFolder& folder, const std::string& name) {
    constexpr std::uint64_t most_bytes = 1 << 20;
    const fs::path file = folder.picture_file(name);
    std::error_code none;
    if (!fs::exists(file, none)) return {};
    try {
        return "data:image/png;base64," + io::base64(io::read_whole_file(file, most_bytes));
    } catch (const Error&) {
        return {};
    }
}

/// Two figures of little, hundredths of more.
std::string ml_text(double ml) {
    constexpr double little = 0.1;
    return ml > 0 && ml < little ? fmt::format("{:.2g}", ml) : fmt::format("{:.2f}", ml);
}

void add_head(std::string& html, const fs::path& out) {
    html += io::page_start(out.filename().string(), style(),
                           fmt::format("<div class=\"soft\">as of {}</div>\n", utc_now()));
}

void add_cards(std::string& html, const std::vector<JobState>& states) {
    std::size_t done = 0, failed = 0;
    double ml = 0, seconds = 0;
    for (const JobState& state : states) {
        done += state.phase == JobPhase::done;
        failed += state.phase == JobPhase::failed;
        ml += total_ml(state);
        if (state.figures) seconds += state.figures->seconds;
    }
    const auto card = [&](const char* what, const std::string& figure) {
        html += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", what, figure);
    };
    html += "<section><dl class=\"cards\">\n";
    card("Jobs", std::to_string(states.size()));
    card("Done", std::to_string(done));
    card("Failed", std::to_string(failed));
    card("Resin", ml_text(ml) + " ml");
    card("Time, all jobs", duration_text(seconds));
    if (const auto outlook = batch_outlook(states, double(std::time(nullptr))))
        card("The rest in", fmt::format("{} to {}", duration_text(outlook->least_s), duration_text(outlook->most_s)));
    html += "</dl></section>\n";
}

void add_name(std::string& html, const BatchFolder& folder, const JobState& state, bool has_report) {
    const std::string picture = picture_source(folder, state.name);
    html +=
        fmt::format("<tr><td class=\"picture\">{}</td>",
                    picture.empty() ? std::string("<span></span>") : fmt::format("<img alt=\"\" src=\"{}\">", picture));
    html += has_report ? fmt::format("<td class=\"name\"><a href=\"{}/{}\">{}</a>", link_text(state.name),
                                     slicer::report_file::page, html_text(state.name))
                       : fmt::format("<td class=\"name\">{}", html_text(state.name));
    if (state.figures) html += fmt::format("<small>{}</small>", html_text(state.figures->printer));
    html += "</td>";
}

void add_warnings(std::string& html, const StackFigures& figures) {
    const std::vector<std::string>& warnings = figures.warnings;
    if (warnings.empty()) {
        html += "<td class=\"n\">0</td>";
        return;
    }
    html += fmt::format("<td class=\"n\"><details><summary>{}{}</summary><ul>", warnings.size(),
                        lost_colours(figures).empty() ? "" : ": colours are LOST");
    for (const std::string& warning : warnings) html += fmt::format("<li>{}</li>", html_text(warning));
    html += "</ul></details></td>";
}

void add_figures(std::string& html, const JobState& state, const std::vector<std::string>& roles) {
    const StackFigures& figures = *state.figures;
    html += fmt::format("<td class=\"n\">{}</td><td class=\"n\">{}</td>", size_text(figures), figures.layers);
    const auto ml = ml_by_role(state);
    for (const std::string& role : roles)
        html += ml.contains(role) ? fmt::format("<td class=\"n\">{}</td>", ml_text(ml.at(role))) : "<td></td>";
    html += figures.seen_de2000 ? fmt::format("<td class=\"n\"><i class=\"mark {}\"></i>{:.1f}</td>",
                                              html_text(figures.verdict), *figures.seen_de2000)
                                : "<td class=\"n\">not predicted</td>";
    add_warnings(html, figures);
    html += fmt::format("<td class=\"n\">{}</td></tr>\n", duration_text(figures.seconds));
}

void add_job(std::string& html, const BatchFolder& folder, const JobState& state,
             const std::vector<std::string>& roles) {
    std::error_code none;
    const bool whole = state.figures && (state.phase == JobPhase::done || state.phase == JobPhase::failed);
    add_name(html, folder, state, whole && fs::exists(folder.job_folder(state.name) / slicer::report_file::page, none));
    if (state.phase == JobPhase::done && whole) return add_figures(html, state, roles);
    html += fmt::format("<td class=\"why\" colspan=\"{}\"><i class=\"mark {}\"></i>{}{}</td></tr>\n", roles.size() + 5,
                        name_of(state.phase), name_of(state.phase),
                        state.message.empty() ? std::string() : ": " + html_text(state.message));
}

}  // namespace

std::string batch_html(const BatchFolder& folder, const std::vector<JobState>& states) {
    const std::vector<std::string> roles = roles_of(states);
    std::string html;
    add_head(html, folder.path());
    add_cards(html, states);
    html +=
        "<section>\n<div class=\"table\"><table>\n<thead><tr><th></th><th>Job</th><th class=\"n\">Size, mm</th>"
        "<th class=\"n\">Layers</th>";
    for (const std::string& role : roles) html += fmt::format("<th class=\"n\">{}, ml</th>", html_text(role));
    html +=
        "<th class=\"n\">CIEDE2000 as seen</th><th class=\"n\">Warnings</th><th class=\"n\">Time</th></tr></thead>\n"
        "<tbody>\n";
    for (const JobState& state : states) add_job(html, folder, state, roles);
    html += fmt::format(
        "</tbody>\n</table></div>\n</section>\n</main>\n<footer>Made by voxtone {}. The same for spreadsheets: "
        "summary.csv.</footer>\n</body>\n</html>\n",
        io::program_version());
    return html;
}

std::string batch_csv(const std::vector<JobState>& states) {
    const std::vector<std::string> roles = roles_of(states);
    std::vector<std::string> header{"name",      "state",     "message", "printer", "size_x_mm",
                                    "size_y_mm", "size_z_mm", "layers",  "ml"};
    for (const std::string& role : roles) header.push_back("ml_" + role);
    for (const char* const more : {"ciede2000_seen", "verdict", "warnings", "lost_colours", "seconds",
                                   "peak_memory_bytes", "output_bytes", "content_sha256", "report"})
        header.emplace_back(more);
    std::string csv = csv_line(header);
    for (const JobState& state : states) {
        std::vector<std::string> cells{state.name, std::string(name_of(state.phase)), state.message};
        if (state.figures && state.phase == JobPhase::done) {
            const StackFigures& f = *state.figures;
            cells.push_back(f.printer);
            for (const double mm : f.size_mm) cells.push_back(fmt::format("{:.3f}", mm));
            cells.push_back(std::to_string(f.layers));
            cells.push_back(fmt::format("{:.4f}", total_ml(state)));
            const auto ml = ml_by_role(state);
            for (const std::string& role : roles)
                cells.push_back(ml.contains(role) ? fmt::format("{:.4f}", ml.at(role)) : std::string());
            cells.push_back(f.seen_de2000 ? fmt::format("{:.3f}", *f.seen_de2000) : std::string());
            cells.insert(
                cells.end(),
                {f.verdict, std::to_string(f.warnings.size()), fmt::format("{}", fmt::join(lost_colours(f), " ")),
                 fmt::format("{:.2f}", f.seconds), std::to_string(f.peak_memory_bytes), std::to_string(f.output_bytes),
                 f.content_sha256, fmt::format("{}/{}", state.name, slicer::report_file::page)});
        }
        cells.resize(header.size());
        csv += csv_line(cells);
    }
    return csv;
}

void write_batch_summary(const BatchFolder& folder) {
    const std::vector<JobState> states = folder.states();
    io::write_whole_file(folder.path() / "summary.csv", batch_csv(states));
    io::write_whole_file(folder.path() / batch_page_name, batch_html(folder, states));
}

}  // namespace voxtone::farm
