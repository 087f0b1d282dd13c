// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the jobs of a batch are called. A name is that of a folder and of files beside others', on any file system that
// a printer's computer may have.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "slicer/options/slice_options.h"

namespace voxtone::slicer {

/// A template of names: {name} is what the plan calls the job, or the model's name without its ending; {n} counts the
/// plan's jobs from 1, {n:03} with zeros before it; {size} and any other key of an option is its value.
class NameTemplate {
public:
    /// Throws UsageError for what is no template.
    explicit NameTemplate(std::string text);

    [[nodiscard]] std::string fill(std::string_view name, std::size_t n, const SliceOptions& options) const;

private:
    std::string text_;
};

/// Why this cannot be a job's name; empty: it can.
[[nodiscard]] std::string name_fault(std::string_view name);

}  // namespace voxtone::slicer
