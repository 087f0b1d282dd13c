// SPDX-License-Identifier: GPL-3.0-or-later
//
// Checks a layer stack as the printer's software would before it takes it: kind, size and numbering of the bitmaps,
// number of colours, stray colours, transparency, resolution, and for our own stacks and GCVF containers the counts and
// the digest that they announce, the manifest's own, and the sheet that resins are assigned by. Every fault is named
// with its place and what to do; repeats are counted. What it cannot see: whether the resins are loaded, and whether
// the body is what was meant.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "io/layers/stack_reader.h"

namespace voxtone::io {

struct VerifyRules {
    std::uint32_t most_colours = 6;  ///< besides the background
    std::uint32_t least_layers = 30;
    /// Of columns, rows and layers; absent: that of the manifest or container, else only that all bitmaps say the same.
    std::optional<std::array<double, 3>> pitch_um;
    /// Whose these are, for the report ("stratasys-j750-hm"); empty: nobody's, they are usual ones.
    std::string printer;
    /// What else there is to say of the rules: what could not be checked, and why.
    std::vector<std::string> notes;
    /// Faults of one kind that are named; the rest are counted.
    std::size_t most_named = 5;
};

struct StackFault {
    std::string rule;    ///< short and stable, for programs: "colour-type", "stray-colour", ...
    std::string where;   ///< file or entry
    std::string what;    ///< what is wrong
    std::string remedy;  ///< what to do
};

struct StackReport {
    StackReader::Kind kind = StackReader::Kind::folder;
    std::uint32_t layers = 0;
    std::array<std::uint32_t, 2> size_px{};
    /// All colours found, in order of first appearance, with their pixels over all layers; at most 256.
    std::vector<ColourCount> colours;
    std::uint64_t empty_layers = 0;  ///< nothing but background
    std::string content_sha256;  ///< as it was found; empty where a palette is missing or a layer has a stray colour
    std::vector<StackFault> faults;  ///< named ones: causes before what follows from them, then by layer
    std::uint64_t fault_count = 0;   ///< all of them
    std::string printer;             ///< whose rules were checked; empty: usual ones
    std::vector<std::string> notes;  ///< worth knowing, no faults

    [[nodiscard]] bool passed() const { return fault_count == 0; }
};

/// Does not stop at the first fault, and does not name what only follows from another one (counts and digests of layers
/// that cannot be read). A folder or file in which there is no whole stack is a fault too: `manifest`, `unfinished`,
/// `no-layers`, `container`. Throws FileError where `path` is not there or not to be read.
[[nodiscard]] StackReport verify_stack(const std::filesystem::path& path, const VerifyRules& rules = {},
                                       Progress* progress = nullptr);

/// By the rules of the printer that the stack names: `rules_of` is asked with the id in its manifest, with nothing
/// where it has no manifest that can be read.
using RulesOfPrinter = std::function<VerifyRules(const std::string& id)>;
[[nodiscard]] StackReport verify_stack(const std::filesystem::path& path, const RulesOfPrinter& rules_of,
                                       Progress* progress = nullptr);

/// The report for people: one line per fault, "and N more" where they were cut.
[[nodiscard]] std::string report_text(const StackReport& report);

}  // namespace voxtone::io
