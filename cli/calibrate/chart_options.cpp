// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/calibrate/chart_options.h"

#include <charconv>

#include "base/error.h"

namespace voxtone::cli {

namespace {

int channels_of(const std::string& word) {
    if (word == "auto") return 0;
    int channels = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), channels);
    if (error != std::errc() || end != word.data() + word.size() || channels < 3 || channels > 12)
        throw UsageError("--channels is " + word + "; give auto or a number from 3 to 12");
    return channels;
}

}  // namespace

void add_chart_options(Verb& command, ChartOptions& options, calibration::FitJob& job) {
    constexpr const char* group = "Charts of mixtures";
    command.add("--channels", options.channels,
                "channels of the set: as many as cross-validation finds best, or a number from 3 to 12",
                {.unit = "auto|N", .group = group});
    command.add("--no-residual", options.no_residual, "leave out what physics leaves: no residual in the set",
                {.group = group});
    command.add("--lengths-from", job.lengths_from,
                "set or file whose white's scattering gives mm, which thick mixtures do not tell", {.group = group});
    command.add("--squares", job.squares,
                "thin squares of the same resins (a target's table): they tell mm in place of --lengths-from, in "
                "one fit with the chart. Rows of the chart with a thickness_mm and a backing do so too",
                {.unit = "FILE", .group = group});
    command.add("--geometry", options.geometry, "how the instrument looks",
                {.choices = {"45/0", "d/8"}, .group = group});
}

void set_chart_fit(const ChartOptions& options, calibration::ChartFitOptions& chart) {
    chart.channels = channels_of(options.channels);
    chart.residual = !options.no_residual;
    if (options.geometry == "d/8") chart.geometry = optics::MeasuringGeometry::diffuse_8;
}

}  // namespace voxtone::cli
