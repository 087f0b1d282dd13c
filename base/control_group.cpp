// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/control_group.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace voxtone {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();
constexpr double no_quota = std::numeric_limits<double>::infinity();

/// A group's limit holds for those below it; in a container the mount is often the group itself.
template <class Value>
Value least_up_to(const fs::path& mount, const std::string& group, const std::function<Value(const fs::path&)>& limit) {
    Value least = limit(mount);
    for (fs::path path = fs::path(group).relative_path(); !path.empty(); path = path.parent_path())
        least = std::min(least, limit(mount / path));
    return least;
}

/// Calls `second(group)` for the group of version 2 that the file names, `first(group)` for that of one controller of
/// version 1, which has a mount of its own.
template <class Second, class First>
void for_groups(const fs::path& cgroup, const std::string& controller, const Second& second, const First& first) {
    std::ifstream in(cgroup);
    for (std::string line; std::getline(in, line);) {  // NUMBER:CONTROLLERS:/GROUP
        const std::size_t left = line.find(':'), right = line.find(':', left + 1);
        if (left == std::string::npos || right == std::string::npos) continue;
        std::string controllers(",");
        controllers.append(line, left + 1, right - left - 1).append(",");
        const std::string group = line.substr(right + 1);
        if (controllers == ",,") second(group);
        if (controllers.find("," + controller + ",") != std::string::npos) first(group);
    }
}

template <class Value>
Value least_of_groups(const fs::path& cgroup, const fs::path& mount, const std::string& controller, Value none,
                      const std::function<Value(const fs::path&)>& second,
                      const std::function<Value(const fs::path&)>& first) {
    Value least = none;
    for_groups(
        cgroup, controller,
        [&](const std::string& group) { least = std::min(least, least_up_to<Value>(mount, group, second)); },
        [&](const std::string& group) {
            least = std::min(least, least_up_to<Value>(mount / controller, group, first));
        });
    return least;
}

/// The number behind "oom_kill" in a file of the group, or of the mount where that is the group itself.
std::uint64_t oom_kills_in(const fs::path& mount, const std::string& group, const char* name) {
    std::ifstream in(mount / fs::path(group).relative_path() / name);
    if (!in) in.open(mount / name);
    std::string key;
    std::uint64_t count = 0;
    while (in >> key >> count)
        if (key == "oom_kill") return count;
    return 0;
}

/// The number in a file; "max", and what is no file, are no limit.
std::uint64_t bytes_in(const fs::path& file) {
    std::ifstream in(file);
    std::uint64_t bytes = 0;
    return in >> bytes && bytes > 0 ? bytes : unlimited;
}

double share(double quota_us, double period_us) {
    return quota_us > 0 && period_us > 0 ? quota_us / period_us : no_quota;
}

}  // namespace

std::uint64_t cgroup_memory_bytes(const fs::path& cgroup, const fs::path& mount) {
    return least_of_groups<std::uint64_t>(
        cgroup, mount, "memory", unlimited,
        [](const fs::path& group) { return std::min(bytes_in(group / "memory.max"), bytes_in(group / "memory.high")); },
        [](const fs::path& group) { return bytes_in(group / "memory.limit_in_bytes"); });
}

double cgroup_cores(const fs::path& cgroup, const fs::path& mount) {
    return least_of_groups<double>(
        cgroup, mount, "cpu", no_quota,
        [](const fs::path& group) {
            std::ifstream in(group / "cpu.max");  // "200000 100000", or "max 100000"
            double quota = 0, period = 0;
            return in >> quota >> period ? share(quota, period) : no_quota;
        },
        [](const fs::path& group) {
            std::ifstream quota_file(group / "cpu.cfs_quota_us"), period_file(group / "cpu.cfs_period_us");
            double quota = 0, period = 0;
            return quota_file >> quota && period_file >> period ? share(quota, period) : no_quota;  // -1: none
        });
}

std::uint64_t cgroup_oom_kills(const fs::path& cgroup, const fs::path& mount) {
    std::uint64_t kills = 0;
    for_groups(
        cgroup, "memory", [&](const std::string& group) { kills += oom_kills_in(mount, group, "memory.events"); },
        [&](const std::string& group) { kills += oom_kills_in(mount / "memory", group, "memory.oom_control"); });
    return kills;
}

namespace {

/// A whole number above 0 in the environment; nothing where there is none, or something else.
std::optional<std::uint64_t> number_in(const char* variable) {
    const char* const text = std::getenv(variable);
    if (!text) return std::nullopt;
    const std::string_view digits = text;
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || value == 0) return std::nullopt;
    return value;
}

}  // namespace

std::size_t granted_cores(std::size_t seen) {
    auto said = number_in("SLURM_CPUS_PER_TASK");
    if (!said) said = number_in("SLURM_CPUS_ON_NODE");
    return std::max<std::size_t>(1, std::min<std::size_t>(seen, said.value_or(seen)));
}

std::uint64_t granted_memory_bytes() {
    constexpr std::uint64_t mib = std::uint64_t{1} << 20, no_end = std::numeric_limits<std::uint64_t>::max();
    constexpr std::uint64_t most_mib = no_end / mib, most_cores = std::uint64_t{1} << 16;
    const auto per_core = number_in("SLURM_MEM_PER_CPU");
    auto given = number_in("SLURM_MEM_PER_NODE");
    if (!given && per_core && *per_core <= most_mib / most_cores)
        given = *per_core * std::min(number_in("SLURM_CPUS_ON_NODE").value_or(1), most_cores);
    return given && *given <= most_mib ? *given * mib : no_end;
}

}  // namespace voxtone
