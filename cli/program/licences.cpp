// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/licences.h"

#include <span>

#include <fmt/core.h>

#include "base/embedded_file.h"
#include "io/files/json_object.h"

namespace voxtone::embedded {
std::span<const EmbeddedFile> licences();
}

namespace voxtone::cli {

std::string licences_text() {
    const auto table = io::JsonObject::parse(embedded::licences().front().text, "data/licences.json");
    const io::JsonObject own = table.object("own");
    std::string text = fmt::format(
        "{} is free software under {}: use, change and share it under its terms, without any warranty.\n"
        "Its helper programs and modules are linked with:\n\n",
        own.text("name"), own.text("licence"));
    for (const io::JsonObject& library : table.objects("libraries"))
        text += fmt::format("{:<24} {:<48} {}\n", library.text("name"), library.text("licence"), library.text("for"));
    return text + "\nAs Debian packages their texts are in /usr/share/doc/PACKAGE/copyright.\n";
}

}  // namespace voxtone::cli
