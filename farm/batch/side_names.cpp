// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/side_names.h"

#include <chrono>

#include "base/error.h"

namespace voxtone::farm {

std::optional<std::vector<io::SideFile>> SideNames::of(const std::filesystem::path& model) {
    if (names_.valid()) {
        if (names_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
        std::vector<io::SideFile> names = names_.get();
        if (model == model_) return names;
    }
    model_ = model;
    names_ = std::async(std::launch::async, [read = read_, model]() -> std::vector<io::SideFile> {
        try {
            return read(model);
        } catch (const Error&) {
            return {};  // its job will say what is wrong
        }
    });
    return std::nullopt;
}

}  // namespace voxtone::farm
