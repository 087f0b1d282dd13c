// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/batch/arrivals.h"

#include <algorithm>
#include <system_error>

#include <fmt/core.h>

#include "base/error.h"
#include "io/models/model_reader.h"

namespace voxtone::slicer {

namespace fs = std::filesystem;

Arrivals::Arrivals(fs::path folder, double quiet_s, std::function<double()> clock_s)
    : folder_(std::move(folder)), quiet_s_(quiet_s), clock_s_(std::move(clock_s)) {}

Arrivals::Arrived Arrivals::poll() {
    const double now_s = clock_s_();
    std::map<std::string, Seen> there;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_, error)) {
        const std::string file = entry.path().string();
        const auto stamp = FileStamp::of(file);
        if (!stamp || entry.path().filename().string().starts_with('.')) continue;
        const auto before = seen_.find(file);
        const bool same = before != seen_.end() && before->second.stamp == *stamp;
        there[file] = same ? before->second : Seen{*stamp, now_s, false};
    }
    if (error) throw FileError(fmt::format("{}: cannot be looked into ({})", folder_.string(), error.message()));
    seen_ = std::move(there);
    const auto is_quiet = [&](const Seen& seen) { return now_s - seen.since_s >= quiet_s_; };
    const bool others_are_quiet = std::all_of(seen_.begin(), seen_.end(), [&](const auto& file) {
        return io::is_model_name(file.first) || is_quiet(file.second);
    });
    Arrived arrived;
    if (!others_are_quiet) return arrived;
    for (auto& [file, seen] : seen_) {
        if (seen.told || !is_quiet(seen)) continue;
        seen.told = true;
        (io::is_model_name(file) ? arrived.models : arrived.strays).emplace_back(file);
    }
    if (!arrived.models.empty()) arrived.strays.clear();
    return arrived;
}

}  // namespace voxtone::slicer
