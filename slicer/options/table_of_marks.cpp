// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/table_of_marks.h"

#include "slicer/options/table_parts.h"

namespace voxtone::slicer {

namespace {

using O = SliceOptions;
using Names = OptionSpec::Names;

/// What becomes of them, resolve_job.cpp says: names in braces want all of the job.
void left_to_all(const SliceOptions&, ResolvedJob&) {}

}  // namespace

std::vector<OptionSpec> table_of_marks() {
    const std::string group = "Labels and decals";
    return {
        {.key = "label",
         .metavar = "TEXT",
         .group = group,
         .help =
             "a text, or a code, on the surface; may be said several times. Words about it stand behind semicolons: "
             "'{job}-{copy:03}; place=bottom; size=6pt' or 'qr=https://example.org/{job}; size=8mm' (docs/labels.md)",
         .member = OptionSpec::Texts{&O::labels},
         .names = Names::inputs_of_labels,
         .only_for = colour_show,
         .resolve = left_to_all},
        {.key = "decal",
         .metavar = "FILE",
         .group = group,
         .help = "a picture on the surface, its alpha counts; may be said several times. Words about it stand behind "
                 "semicolons: 'logo.png; place=front; size=20mm; at=5,-2; turn=15' (docs/labels.md)",
         .member = OptionSpec::Texts{&O::decals},
         .names = Names::inputs_of_decals,
         .only_for = colour_show,
         .resolve = left_to_all},
    };
}

}  // namespace voxtone::slicer
