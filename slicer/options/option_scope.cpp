// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/option_scope.h"

#include <algorithm>
#include <string>

#include <fmt/core.h>

#include "base/error.h"
#include "slicer/options/option_table.h"
#include "slicer/options/option_values.h"

namespace voxtone::slicer {

namespace {

/// Empty: it does something.
std::string why_idle(const OptionSpec& spec, const SliceOptions& o, bool is_picture) {
    for (const OptionSpec::Idle& why : spec.idle)
        if (const std::string_view reason = why(o, is_picture); !reason.empty()) return std::string(reason);
    return spec.belongs_to(o.show) ? std::string() : fmt::format("it only goes with --show {}", spec.only_for);
}

}  // namespace

void check_scope(const SliceOptions& options) {
    const ModelKind kind = model_kind(options.model);
    if (kind == ModelKind::tray_plan) return;
    for (const OptionSpec& spec : slice_option_table()) {
        // For who writes options in code, too, nobody looks at what another kind of print wants.
        const bool is_named = std::ranges::find(options.named, spec.key) != options.named.end();
        if (!is_named && !(spec.is_of_another(options) && options.other.contains(spec.key))) continue;
        if (const std::string why = why_idle(spec, options, kind == ModelKind::picture); !why.empty())
            throw UsageError(fmt::format("--{} {} would be ignored: {}", spec.key, spec.get(options), why));
    }
}

bool decides_scope(std::string_view key) {
    const OptionSpec* const spec = find_option(key);
    return spec && spec->decides_scope;
}

}  // namespace voxtone::slicer
