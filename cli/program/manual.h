// SPDX-License-Identifier: GPL-3.0-or-later
//
// Manual pages (man 7 groff_man) from the same table of options as --help: voxtone(1) and one page for each verb, with
// the steps of a family on its page. The build has the program write them (cmake/documentation.cmake).
#pragma once

#include <string>
#include <vector>

#include "cli/program/verb.h"

namespace voxtone::cli {

struct ManualPage {
    std::string file;  ///< "voxtone-slice.1"
    std::string text;
};

/// Of the program itself.
[[nodiscard]] ManualPage program_page(const Verb& program);
/// Of a verb.
[[nodiscard]] ManualPage verb_page(const Verb& verb);

/// Writes them into this folder, which is made. Throws FileError.
void write_manual(const std::vector<ManualPage>& pages, const std::string& folder);

}  // namespace voxtone::cli
