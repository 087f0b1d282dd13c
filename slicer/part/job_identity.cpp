// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/job_identity.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <system_error>

#include <fmt/core.h>

#include "base/error.h"
#include "io/files/file_digest.h"
#include "io/files/sha256.h"
#include "io/files/zip_reader.h"
#include "io/lettering/font_file.h"
#include "io/models/model_reader.h"
#include "io/profiles/resin_file.h"
#include "io/programs/build_identity.h"
#include "optics/colour/lamp.h"
#include "slicer/options/job_file.h"
#include "slicer/options/option_table.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view model_input = "model", program_key = "program";

std::string text_sha256(std::string_view text) {
    return io::sha256({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

JobInput file_input(std::string key, const std::string& file, const Progress* progress) {
    return {std::move(key), file, io::file_sha256(file, progress)};
}

JobInput file_or_known(std::string key, const std::string& name, std::optional<std::string_view> known,
                       const Progress* progress) {
    if (known) return {std::move(key), {}, text_sha256(*known)};
    return file_input(std::move(key), name, progress);
}

/// All inputs but those beside the model.
std::vector<JobInput> named_inputs(const OpenedJob& job, const Progress* progress) {
    const ResolvedJob& options = job.options;
    std::vector<JobInput> inputs{
        file_input(std::string(model_input), io::path_in_zip(options.model).file.string(), progress),
        file_or_known("printer", options.printer, known_printer_text(options.printer), progress),
        file_or_known("resins", options.resins, io::known_resin_set_text(options.resins), progress),
        {std::string(program_key), {}, text_sha256(io::build_digest())}};
    for (std::size_t m = 0; m < options.marks.size(); ++m) {
        const MarkOptions& mark = options.marks[m];
        if (!mark.file.empty()) inputs.push_back(file_input(fmt::format("mark:{}", m + 1), mark.file, progress));
        if (!mark.font.empty())
            inputs.push_back(file_input(fmt::format("font:{}", m + 1), io::find_font(mark.font).string(), progress));
    }
    // A word or a file: what it is counts, whichever it is.
    if (options.picture.has_night()) inputs.push_back(file_input("night", options.picture.night, progress));
    if (const BackingChoice& backing = options.picture.backing; !backing.picture.empty())
        inputs.push_back(file_input("backing", backing.picture, progress));
    else if (backing != optics::Backing::black)
        inputs.push_back({"backing", {}, text_sha256(backing.words)});
    if (!options.illuminant.empty() && !optics::known_lamp(options.illuminant))
        inputs.push_back(file_input("illuminant", options.illuminant, progress));
    if (!options.texture.empty()) inputs.push_back(file_input("texture", options.texture, progress));
    if (job.other)
        for (const JobInput& input : job.other->inputs()) inputs.push_back(file_input(input.key, input.file, progress));
    return inputs;
}

void sort(std::vector<JobInput>& inputs) {
    std::stable_sort(inputs.begin(), inputs.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
    const auto same = [](const auto& a, const auto& b) { return a.key == b.key; };
    inputs.erase(std::unique(inputs.begin(), inputs.end(), same), inputs.end());
}

/// Of options that decide so much of the result, as text, and of what the inputs hold.
std::string digest_of(std::string_view title, const SliceOptions& options, std::span<const JobInput> inputs,
                      Decides least) {
    std::string text = fmt::format("voxtone {} 2\n{}", title, deciding_lines(options, least));
    // How a model is read goes by the end of its name; the printer's name goes into the manifest.
    text += fmt::format("extension={}\nprinter={}\n", io::extension_of(options.model),
                        fs::path(options.printer).stem().string());
    if (const std::string inner = io::path_in_zip(options.model).inner; !inner.empty())
        text += fmt::format("part={}\n", inner);
    for (const JobInput& input : inputs) text += fmt::format("{}: {}\n", input.key, input.sha256);
    return text_sha256(text);
}

JobIdentity identity_of(const SliceOptions& options, std::vector<JobInput> inputs) {
    sort(inputs);
    JobIdentity identity;
    identity.job = digest_of("job", options, inputs, Decides::looks);
    identity.loop = digest_of("loop", options, inputs, Decides::bits);
    identity.inputs = std::move(inputs);
    return identity;
}

std::optional<SliceOptions> record_in(const fs::path& folder) {
    const fs::path file = folder / job_file_name;
    if (std::error_code none; !fs::is_regular_file(file, none)) return std::nullopt;
    SliceOptions recorded;
    try {
        read_job(file.string(), recorded);
    } catch (const Error&) {
        return std::nullopt;
    }
    if (recorded.recorded_inputs.empty()) return std::nullopt;
    return recorded;
}

bool same_file(const std::string& a, const std::string& b) {
    std::error_code none;
    return a == b || fs::weakly_canonical(a, none) == fs::weakly_canonical(b, none);
}

}  // namespace

JobIdentity identify(const OpenedJob& job, std::span<const io::SideFile> beside_model, const Progress* progress) {
    std::vector<JobInput> inputs = named_inputs(job, progress);
    std::string opened_loop = identity_of(job.options.raw, inputs).loop;
    const fs::path folder = fs::path(job.options.model).parent_path();
    for (const io::SideFile& file : beside_model)
        inputs.push_back({fmt::format("{}:{}", model_input, file.name), (folder / file.name).string(), file.sha256});
    JobIdentity identity = identity_of(job.options.raw, std::move(inputs));
    identity.opened_loop = std::move(opened_loop);
    return identity;
}

std::string opened_loop_identity(const OpenedJob& job, const Progress* progress) {
    return identity_of(job.options.raw, named_inputs(job, progress)).loop;
}

bool is_same_job(const fs::path& folder, const OpenedJob& job, const Progress* progress) {
    const auto recorded = record_in(folder);
    if (!recorded) return false;
    // The same model names the same files: what is beside it is looked up by the names that were noted then.
    std::vector<JobInput> inputs = named_inputs(job, progress);
    const std::string beside = fmt::format("{}:", model_input);
    for (const JobInput& then : recorded->recorded_inputs) {
        if (!then.key.starts_with(beside)) continue;
        if (then.sha256.empty()) return false;
        const fs::path file = fs::path(job.options.model).parent_path() / then.key.substr(beside.size());
        inputs.push_back(file_input(then.key, file.string(), progress));
    }
    return identity_of(*recorded, recorded->recorded_inputs).job == identity_of(job.options.raw, std::move(inputs)).job;
}

std::optional<std::string> recorded_identity(const fs::path& folder) {
    const auto recorded = record_in(folder);
    if (!recorded) return std::nullopt;
    return identity_of(*recorded, recorded->recorded_inputs).job;
}

std::vector<std::string> changed_inputs(std::span<const JobInput> recorded, std::span<const JobInput> now) {
    std::vector<std::string> sentences;
    for (const JobInput& then : recorded) {
        const auto found =
            std::find_if(now.begin(), now.end(), [&](const auto& input) { return input.key == then.key; });
        if (found == now.end()) continue;
        if (!same_file(found->file, then.file) || found->sha256 == then.sha256) continue;
        if (then.key == program_key) {
            sentences.emplace_back("the job file was written by another build of voxtone: another stack may come out");
            continue;
        }
        const std::string what =
            then.file.empty() ? fmt::format("the {} of this version of the program", then.key) : then.file;
        const char* const how = then.sha256.empty()     ? "was not there when the job file was written and is now"
                                : found->sha256.empty() ? "was there when the job file was written and is gone"
                                                        : "holds something else than when the job file was written";
        sentences.push_back(fmt::format("{}: {} (SHA-256 {:.12} then, {:.12} now): another stack comes out", what, how,
                                        then.sha256.empty() ? "none" : then.sha256,
                                        found->sha256.empty() ? "none" : found->sha256));
    }
    return sentences;
}

}  // namespace voxtone::slicer
