// SPDX-License-Identifier: GPL-3.0-or-later
//
// Models that arrive in a folder, each told once it is complete: no size and no time has changed for some seconds, not
// of the model, nor of any file beside it that is no model (its material library, its textures), and what it names
// beside itself is there. For that it is waited a while; then the model is told all the same, with what is missing.
//
// A model that is written anew arrives again, and so does one whose side files change, or come at last. Other files are
// told too, unless a model arrived with them or names them, whose they may be.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "io/files/file_digest.h"
#include "io/models/side_file.h"

namespace voxtone::farm {

/// The files beside it that a model names; nothing while it is being read: asked again. Where that cannot be found out,
/// none.
using SideFilesOf = std::function<std::optional<std::vector<io::SideFile>>(const std::filesystem::path& model)>;

struct ArrivalTimes {
    double quiet_s = 3;           ///< how long files have to be unchanged
    double wait_s = 60;           ///< for side files, since the last change of what the model names, or of itself
    std::function<double()> now;  ///< seconds since some fixed moment
};

class Arrivals {
public:
    Arrivals(std::filesystem::path folder, ArrivalTimes times, SideFilesOf side_files);

    struct Lacks {
        std::filesystem::path model;
        std::vector<std::string> names;  ///< as the model has them
    };
    /// By name.
    struct Arrived {
        std::vector<std::filesystem::path> models;
        std::vector<std::filesystem::path> strays;  ///< no models, none arrived with them, and none names them
        std::vector<Lacks> waits;                   ///< models that begin to wait
        std::vector<Lacks> lacks;                   ///< among `models`: those that have waited long enough
        std::vector<std::filesystem::path> again;  ///< among `models`: those told before, whose side files have changed
        bool is_reading = false;                   ///< names are being found out: look again soon
    };
    /// Looks at the folder: what has become complete since the last time. Throws FileError where the folder cannot be
    /// looked into.
    [[nodiscard]] Arrived poll();
    /// The files of the folder that a model which was told names, by name.
    [[nodiscard]] std::vector<std::filesystem::path> beside(const std::filesystem::path& model) const;

private:
    struct Seen {
        io::FileStamp stamp;
        double since_s = 0;
        bool told = false;  ///< of strays
    };
    enum class Stage { named, waits, told };  ///< what it names is to be found out; is not all there; it was told
    struct Model {
        io::FileStamp stamp;
        Stage stage = Stage::named;
        std::map<std::string, io::FileStamp> beside;  ///< files that are there, as they were when it was told
        std::vector<std::string> missing;
        double since_s = 0;                     ///< when it, or what it lacks, last changed
        std::uint64_t changes = 0;              ///< of the folder, when its names were asked for
        std::optional<std::uint64_t> asked_at;  ///< the same of names that are not known yet
        bool was_told = false, said_to_wait = false;
    };

    [[nodiscard]] std::map<std::string, Seen> look(double now_s);
    [[nodiscard]] bool is_quiet(const Seen& seen, double now_s) const { return now_s - seen.since_s >= times_.quiet_s; }
    void look_after_side_files(Model& model) const;
    /// Whether it is settled for now: it was told, now or before.
    bool take(const std::string& file, const Seen& seen, double now_s, Arrived& arrived);
    [[nodiscard]] bool take_names(const std::string& model_file, Model& model, double now_s);
    void tell(const std::string& file, Model& model, Arrived& arrived);
    void take_strays(double now_s, Arrived& arrived);
    [[nodiscard]] bool is_named(const std::string& file) const;

    std::filesystem::path folder_;
    ArrivalTimes times_;
    SideFilesOf side_files_;
    std::set<std::filesystem::path> below_;  ///< folders in it that models name files in
    std::map<std::string, Seen> seen_;
    std::map<std::string, Model> models_;
    std::uint64_t changes_ = 0;  ///< of files that are no models
};

}  // namespace voxtone::farm
