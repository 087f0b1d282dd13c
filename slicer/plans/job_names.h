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

/// What the job of a model is called whose own name this is: that name, where a job can have it. Else each byte that
/// cannot stand in one is written as %E9, what is too long ends with a digest, and what the batch itself needs with an
/// underscore: no file in a folder is in the way of the others because of its name.
[[nodiscard]] std::string name_after(std::string_view model);

}  // namespace voxtone::slicer
