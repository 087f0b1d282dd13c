// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/job_weight.h"

#include <filesystem>
#include <limits>
#include <optional>
#include <system_error>

#include "base/error.h"
#include "io/files/json_object.h"
#include "io/files/zip_reader.h"
#include "slicer/options/option_values.h"
#include "slicer/part/phase_estimates.h"

namespace voxtone::farm {

namespace {

constexpr std::uint64_t beyond_every_machine = std::uint64_t{1} << 60;

/// The program and the model as it is read: textures are decoded, meshes get their trees.
std::uint64_t bytes_of_model(const std::string& model) {
    constexpr std::uint64_t least_bytes = std::uint64_t{1} << 30, bytes_of_each = 24;
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(io::path_in_zip(model).file, error);
    return least_bytes + (error ? 0 : size * bytes_of_each);
}

/// Nothing where the options do not say the size. Of a body: that of a box around it; of a picture: four times as high
/// as wide.
std::optional<double> most_surface_mm2(const slicer::SliceOptions& options) {
    constexpr double faces = 6, highest = 4;
    if (options.size_mm > 0) return faces * options.size_mm * options.size_mm;
    if (options.width_mm > 0) return highest * options.width_mm * options.width_mm;
    if (options.height_mm > 0) return highest * options.height_mm * options.height_mm;
    return std::nullopt;
}

}  // namespace

bool JobWeight::is_known() const { return memory_bytes < beyond_every_machine; }

JobWeight weigh(const slicer::SliceOptions& options, const std::vector<std::string>& command, const JobState* known) {
    constexpr double allowance = 1.25;  // the peak of one job differs by a few percent from run to run
    if (known && known->command == command && known->figures && known->figures->peak_memory_bytes > 0)
        return {static_cast<std::uint64_t>(allowance * double(known->figures->peak_memory_bytes)), options.threads, 0,
                false};
    if (slicer::model_kind(options.model) == slicer::ModelKind::tray_plan)
        return {beyond_every_machine, options.threads, 0, true};  // its models are known to it alone
    const std::uint64_t model = bytes_of_model(options.model);
    if (options.iterations == "0" && options.predict == "none") return {model, options.threads, 0, true};
    const std::optional<double> area_mm2 = most_surface_mm2(options);
    if (!area_mm2) return {beyond_every_machine, options.threads, 0, true};
    return {model + static_cast<std::uint64_t>(slicer::most_bytes_of_surface(*area_mm2, options.predict_cell_mm)),
            options.threads, 0, true};
}

std::vector<std::string> estimate_words(const std::vector<std::string>& slice_words) {
    std::vector<std::string> arguments = slice_words;
    arguments.front() = "estimate";
    arguments.insert(arguments.end(), {"--quick", "--json"});
    return arguments;
}

JobWeight with_more_memory(const JobWeight& before) {
    constexpr std::uint64_t times = 2;
    JobWeight more = before;
    if (before.is_known()) more.memory_bytes *= times;
    return more;
}

JobWeight weigh_by_estimate(const JobWeight& before, const std::string& rest_of_line) {
    JobWeight weight = before;
    weight.bound = false;
    try {
        const auto event = io::JsonObject::parse(estimate_begin + rest_of_line, "estimate");
        const auto estimate = event.object("result");
        const std::uint64_t bytes = estimate.integer("memory_bytes", 0, std::numeric_limits<std::uint64_t>::max());
        weight.cpu_s = estimate.number("cpu_seconds", 0, 1e12);
        if (before.bound) weight.memory_bytes = bytes;  // else it is known from its last run
    } catch (const Error&) {
        // The job itself will say what is wrong with it.
    }
    return weight;
}

}  // namespace voxtone::farm
