// SPDX-License-Identifier: GPL-3.0-or-later
//
// Models that arrive in a folder, each told once it is complete: no size and no time has changed for some seconds, not
// of the model, nor of any file beside it that is no model (its material library, its textures). A model that is
// written anew arrives again. Other files are told too, unless a model arrived with them, whose they may be.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "slicer/batch/input_digests.h"

namespace voxtone::slicer {

class Arrivals {
public:
    /// `quiet_s`: how long files have to be unchanged. `clock_s`: seconds since some fixed moment.
    Arrivals(std::filesystem::path folder, double quiet_s, std::function<double()> clock_s);

    /// By name.
    struct Arrived {
        std::vector<std::filesystem::path> models;
        std::vector<std::filesystem::path> strays;  ///< no models, and none arrived with them
    };
    /// Looks at the folder: what has become complete since the last time. Throws FileError where the folder cannot be
    /// looked into.
    [[nodiscard]] Arrived poll();

private:
    struct Seen {
        FileStamp stamp;
        double since_s = 0;
        bool told = false;
    };
    std::filesystem::path folder_;
    double quiet_s_;
    std::function<double()> clock_s_;
    std::map<std::string, Seen> seen_;
};

}  // namespace voxtone::slicer
