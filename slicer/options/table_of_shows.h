// SPDX-License-Identifier: GPL-3.0-or-later
//
// Kinds of print that show something else than colours, as floors above declare them: their options stand in the option
// table (option_table.h) beside `show`, which asks for them; where none is declared, nobody meets one. How such a print
// is opened: part/other_print.h.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "slicer/options/option_spec.h"
#include "slicer/options/resolved_job.h"

namespace voxtone::slicer {

struct OtherShow {
    std::string name;     ///< what --show says
    std::string about;    ///< what it shows, for --help
    std::string heading;  ///< of its options there
    /// Values of all are OptionSpec::Other; group and the kind of print that has them are filled in.
    std::vector<OptionSpec> options;
    /// Their values; of options whose rules hold. Throws UsageError.
    std::function<std::shared_ptr<const OtherOptions>(const SliceOptions&)> resolve;
};

/// For option_table.h: one of the same name takes the place of the first.
void add_show(OtherShow show);

/// Whether --show may say it.
[[nodiscard]] bool is_show(std::string_view name);

/// The entry `show`, and what it asks for. A part of the table.
[[nodiscard]] std::vector<OptionSpec> table_of_shows();

}  // namespace voxtone::slicer
