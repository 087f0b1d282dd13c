// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which files beside themselves models name: read in a thread of its own, one model at a time, so that a batch goes on
// meanwhile; behind the walls that models are read behind, and without decoding a picture.
#pragma once

#include <filesystem>
#include <functional>
#include <future>
#include <optional>
#include <vector>

#include "io/models/side_file.h"

namespace voxtone::farm {

class SideNames {
public:
    using Read = std::function<std::vector<io::SideFile>(const std::filesystem::path& model)>;

    /// `read`: called by another thread. What it throws counts as a model that names nothing.
    explicit SideNames(Read read) : read_(std::move(read)) {}

    /// Nothing while it is read, or another is; as arrivals.h asks for it, again and again.
    [[nodiscard]] std::optional<std::vector<io::SideFile>> of(const std::filesystem::path& model);

private:
    Read read_;
    std::filesystem::path model_;
    std::future<std::vector<io::SideFile>> names_;
};

}  // namespace voxtone::farm
