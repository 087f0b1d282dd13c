// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/resolve_job.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "io/models/foreign_kind.h"
#include "io/models/model_reader.h"
#include "slicer/options/label_template.h"
#include "slicer/options/mark_words.h"
#include "slicer/options/option_scope.h"
#include "slicer/options/option_table.h"

namespace voxtone::slicer {

namespace {

void check_rules(const SliceOptions& o) {
    find_option("show")->expect_choice(o.show);
    for (const OptionSpec& spec : slice_option_table()) {
        if (!spec.rule || !spec.belongs_to(o.show)) continue;
        const std::string_view broken = spec.rule(o);
        if (broken.empty()) continue;
        const std::string value = spec.get(o);
        throw UsageError(fmt::format("--{} {}: {}", spec.key, value.empty() ? "(none)" : value, broken));
    }
}

/// What a file is that cannot be read is more than that an option does not go with its name.
void refuse_foreign_files(const SliceOptions& o) {
    if (model_kind(o.model) == ModelKind::tray_plan) return;
    if (const std::string why = io::foreign_kind(o.model); !why.empty()) throw InputError(why);
    const bool is_named = io::is_model_name(o.model) || io::is_picture_name(o.model);
    if (!is_named && std::ranges::find(o.named, "size") != o.named.end())
        throw InputError(
            fmt::format("{} has no name of a model ({}), by which models are known, so that it is taken for a picture: "
                        "export a model as one of these, and give a picture of such a name --width in place of --size",
                        o.model, io::model_name_endings));
    if (o.texture.empty()) return;
    if (const std::string why = io::foreign_kind(o.texture, io::Wanted::texture); !why.empty())
        throw InputError("--texture: " + why);
}

/// Names in braces get the values that they have where no tray or plan gave others; the job's identity and job.json
/// have the texts as they are printed.
void settle_labels(ResolvedJob& job) {
    const std::filesystem::path out = std::filesystem::path(job.raw.out).lexically_normal();
    const TemplateValues values{{"job", (out.has_filename() ? out : out.parent_path()).filename().string()},
                                {"part", std::filesystem::path(job.raw.model).stem().string()},
                                {"copy", "1"}};
    for (const std::string& decal : job.raw.decals) {
        const MarkOptions& mark = job.marks.emplace_back(parse_mark(MarkFamily::decal, decal));
        if (mark.kind != MarkKind::picture) continue;
        if (const std::string why = io::foreign_kind(mark.file, io::Wanted::picture); !why.empty())
            throw InputError(fmt::format("{}: {}", mark.said, why));
    }
    for (std::string& label : job.raw.labels) {
        label = with_values(label, values);
        MarkOptions& mark = job.marks.emplace_back(parse_mark(MarkFamily::label, label));
        mark.text = settled_text(mark.text, mark.said);
    }
}

}  // namespace

ResolvedJob resolve(const SliceOptions& options) {
    check_rules(options);
    refuse_foreign_files(options);
    check_scope(options);
    ResolvedJob job;
    job.raw = options;
    for (const OptionSpec& spec : slice_option_table())
        if (spec.resolve && spec.belongs_to(options.show)) spec.resolve(options, job);
    if (job.is_picture()) job.picture.size_mm = std::exchange(job.placement.size_mm, 0);  // without its thickness
    // Nothing that scatters need lie behind a picture that light comes through.
    if (job.picture.is_lit_from_behind() && std::ranges::find(options.named, "core") == options.named.end())
        job.colour.core = job.raw.core = "T";
    settle_labels(job);
    return job;
}

}  // namespace voxtone::slicer
