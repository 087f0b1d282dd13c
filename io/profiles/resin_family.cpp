// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/profiles/resin_family.h"

#include <filesystem>

#include <fmt/core.h>

#include "io/files/json_object.h"
#include "io/profiles/resin_file.h"

namespace voxtone::io {

std::string resin_family(const std::string& name_or_file) {
    const auto known = known_resin_set_text(name_or_file);
    if (!known && !std::filesystem::exists(name_or_file)) (void)find_resin_set(name_or_file);  // says which there are
    const JsonObject json =
        known ? JsonObject::parse(*known, fmt::format("resin set {}", name_or_file)) : JsonObject::read(name_or_file);
    if (!json.has("family")) return {};
    std::string family = json.text("family");
    if (family.empty()) json.fail("family", "is empty; name the cartridges' family, or leave the key out");
    return family;
}

}  // namespace voxtone::io
