// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is in files, for programs and for people.
#pragma once

#include <span>
#include <string>

#include "slicer/part/model_contents.h"

namespace voxtone::slicer {

/// One object in one line (data/schema/contents.schema.json).
[[nodiscard]] std::string contents_json(std::span<const ModelContents> files);
/// Some lines a file.
[[nodiscard]] std::string contents_text(std::span<const ModelContents> files);

}  // namespace voxtone::slicer
