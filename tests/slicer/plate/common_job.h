// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "slicer/part/opened_job.h"
#include "tests/io/files/temporary_folder.h"

namespace voxtone::test {

/// A tray's own job: of no part.
inline slicer::OpenedJob common_of(const std::string& resins = {}, std::vector<std::string> load = {}) {
    static const io::TemporaryFolder folder;
    std::ofstream(folder.path() / "tray.json") << "{}";
    slicer::SliceOptions options;
    options.model = (folder.path() / "tray.json").string();
    options.out = "unused";
    options.resins = resins;
    options.load = std::move(load);
    return slicer::open_job(options);
}

}  // namespace voxtone::test
