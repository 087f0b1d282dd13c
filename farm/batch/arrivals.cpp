// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/arrivals.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "io/models/model_reader.h"

namespace voxtone::farm {

namespace {

namespace fs = std::filesystem;

/// Where a name in a model leads from its folder, if it stays there.
std::optional<fs::path> place_in(const fs::path& folder, std::string name) {
    std::ranges::replace(name, '\\', '/');
    fs::path place = (folder / name).lexically_normal().lexically_relative(folder.lexically_normal());
    if (place.empty() || *place.begin() == "..") return std::nullopt;
    return place;
}

/// Whether a file came or changed; that some are gone makes no print anew.
bool has_more(const std::map<std::string, io::FileStamp>& now, const std::map<std::string, io::FileStamp>& before) {
    return !std::ranges::all_of(now, [&](const auto& file) {
        const auto then = before.find(file.first);
        return then != before.end() && then->second == file.second;
    });
}

}  // namespace

Arrivals::Arrivals(fs::path folder, ArrivalTimes times, SideFilesOf side_files)
    : folder_(std::move(folder)), times_(std::move(times)), side_files_(std::move(side_files)) {}

/// What lies in the folder, and in those below it that models name files in.
std::map<std::string, Arrivals::Seen> Arrivals::look(double now_s) {
    std::map<std::string, Seen> there;
    const auto look_into = [&](const fs::path& place, bool is_below) {
        std::error_code error;
        for (const fs::directory_entry& entry : fs::directory_iterator(place, error)) {
            const std::string file = entry.path().string();
            if (is_below && io::is_model_name(file)) continue;
            const auto stamp = io::FileStamp::of(file);
            if (!stamp || entry.path().filename().string().starts_with('.')) continue;
            const auto before = seen_.find(file);
            const bool same = before != seen_.end() && before->second.stamp == *stamp;
            there[file] = same ? before->second : Seen{*stamp, now_s, is_below};
            if (!same && !io::is_model_name(file)) ++changes_;
        }
        return error;
    };
    if (const std::error_code error = look_into(folder_, false))
        throw FileError(fmt::format("{}: cannot be looked into ({})", folder_.string(), error.message()));
    for (const fs::path& place : below_) (void)look_into(place, true);  // it may not be there yet
    return there;
}

Arrivals::Arrived Arrivals::poll() {
    const double now_s = times_.now();
    seen_ = look(now_s);
    std::erase_if(models_, [&](const auto& model) { return !seen_.contains(model.first); });
    Arrived arrived;
    const bool others_are_quiet = std::ranges::all_of(
        seen_, [&](const auto& file) { return io::is_model_name(file.first) || is_quiet(file.second, now_s); });
    if (!others_are_quiet) return arrived;
    bool all_are_settled = true;
    for (const auto& [file, seen] : seen_)
        if (io::is_model_name(file)) all_are_settled = take(file, seen, now_s, arrived) && all_are_settled;
    if (!arrived.models.empty())
        for (auto& [file, seen] : seen_) seen.told = true;  // they came with it
    else if (all_are_settled)
        take_strays(now_s, arrived);
    return arrived;
}

std::vector<fs::path> Arrivals::beside(const fs::path& model) const {
    std::vector<fs::path> files;
    if (const auto known = models_.find(model.string()); known != models_.end())
        for (const auto& [file, stamp] : known->second.beside) files.emplace_back(file);
    return files;
}

/// A side file that has changed, or that may be one of the missing, asks for the names anew.
void Arrivals::look_after_side_files(Model& model) const {
    if (model.stage == Stage::named) return;
    const bool changed = std::ranges::any_of(model.beside, [&](const auto& file) {
        const auto now = seen_.find(file.first);
        return now != seen_.end() && now->second.stamp != file.second;
    });
    if (changed || (!model.missing.empty() && model.changes != changes_)) model.stage = Stage::named;
}

bool Arrivals::take(const std::string& file, const Seen& seen, double now_s, Arrived& arrived) {
    Model& model = models_[file];
    if (model.stamp != seen.stamp) {
        model = {};
        model.stamp = seen.stamp;
        model.since_s = seen.since_s;
    }
    if (!is_quiet(seen, now_s)) return false;
    look_after_side_files(model);
    if (model.stage == Stage::named && !take_names(file, model, now_s)) {
        arrived.is_reading = true;
        return false;
    }
    if (model.stage == Stage::told) return true;
    if (!model.missing.empty() && now_s - model.since_s < times_.wait_s) {
        if (!model.said_to_wait) arrived.waits.push_back({file, model.missing});
        model.said_to_wait = true;
        return false;
    }
    tell(file, model, arrived);
    return true;
}

/// False: it is being read.
bool Arrivals::take_names(const std::string& model_file, Model& model, double now_s) {
    if (!model.asked_at) model.asked_at = changes_;
    const auto named = side_files_(model_file);
    if (!named) return false;
    std::map<std::string, io::FileStamp> beside;
    std::vector<std::string> missing;
    for (const io::SideFile& side : *named) {
        const auto place = place_in(folder_, side.name);
        if (place && place->has_parent_path()) below_.insert(folder_ / place->parent_path());
        if (side.sha256.empty()) {
            if (std::ranges::find(missing, side.name) == missing.end()) missing.push_back(side.name);
            continue;
        }
        if (!place) continue;
        const std::string file = (folder_ / *place).string();
        if (const auto stamp = io::FileStamp::of(file)) beside[file] = *stamp;
    }
    model.changes = *std::exchange(model.asked_at, std::nullopt);
    if (model.was_told && !has_more(beside, model.beside)) {
        model.stage = Stage::told;
        return true;
    }
    if (missing != model.missing) {  // what is named has come in part, and the rest may be on its way
        model.since_s = now_s;
        model.said_to_wait = false;
    }
    model.stage = Stage::waits;
    model.beside = std::move(beside);
    model.missing = std::move(missing);
    return true;
}

void Arrivals::tell(const std::string& file, Model& model, Arrived& arrived) {
    model.stage = Stage::told;
    if (std::exchange(model.was_told, true)) arrived.again.emplace_back(file);
    arrived.models.emplace_back(file);
    if (!model.missing.empty()) arrived.lacks.push_back({file, model.missing});
}

bool Arrivals::is_named(const std::string& file) const {
    return std::ranges::any_of(models_, [&](const auto& model) { return model.second.beside.contains(file); });
}

void Arrivals::take_strays(double now_s, Arrived& arrived) {
    for (auto& [file, seen] : seen_) {
        if (seen.told || io::is_model_name(file) || !is_quiet(seen, now_s)) continue;
        seen.told = true;
        if (!is_named(file)) arrived.strays.emplace_back(file);
    }
}

}  // namespace voxtone::farm
