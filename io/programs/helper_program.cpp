// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/programs/helper_program.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"

namespace voxtone::io {

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> helper_folders() {
    if (const char* only = std::getenv(helpers_variable); only && *only) return {only};
    std::vector<fs::path> folders;
    std::error_code error;
    if (const fs::path program = fs::read_symlink("/proc/self/exe", error); !error)
        folders = {program.parent_path().parent_path() / "libexec" / "voxtone", program.parent_path()};
    folders.emplace_back(VOXTONE_INSTALLED_HELPERS);
    return folders;
}

/// What brings a helper that an installation or a build may be without.
struct Source {
    std::string_view helper, package, part;  ///< Debian's package; part of packages.txt
};
constexpr std::array sources{Source{"voxtone-read-pictures", "voxtone-pictures", "pictures"},
                             Source{"voxtone-photographs.so", "voxtone-pictures", "pictures"},
                             Source{"voxtone-read-drawings", "voxtone-drawings", "drawings"},
                             Source{"voxtone-calibrate", "voxtone-calibrate", "calibration"},
                             Source{"voxtone-vdb.so", "voxtone-vdb", "vdb"},
                             Source{"voxtone-layer-surfaces.so", "voxtone-vdb", "vdb"}};

std::string remedy(const std::string& helper) {
    const auto source = std::ranges::find(sources, helper, &Source::helper);
    if (source == sources.end()) return "install voxtone again";
    return fmt::format("install the package {}, or build voxtone where `tools/install-packages {}` was run",
                       source->package, source->part);
}

}  // namespace

fs::path find_helper(const std::string& name) {
    std::vector<std::string> places;
    for (const fs::path& folder : helper_folders()) {
        std::error_code error;
        if (fs::path program = folder / name; fs::is_regular_file(program, error) && access(program.c_str(), X_OK) == 0)
            return program;
        places.push_back(folder.string());
    }
    throw FileError(
        fmt::format("{}, a program that belongs to voxtone, is not in {}; {}, or name the folder that holds it in {}",
                    name, fmt::join(places, ", "), remedy(name), helpers_variable));
}

}  // namespace voxtone::io
