// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/grant.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string_view>

namespace voxtone {

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
