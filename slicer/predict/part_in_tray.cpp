// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/predict/part_in_tray.h"

#include <filesystem>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "io/files/json_object.h"
#include "io/layers/stack_folder.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

constexpr const char *parts_folder = "parts", *tray_file = "tray.json";

LayerWindow window_of(const io::JsonObject& part) {
    constexpr double most = 1 << 24;
    const std::vector<std::vector<double>> at = part.number_lists("at_px", 0, 0, most);
    const std::vector<double> size = part.numbers("size_px", 3, 1, most);
    if (at.empty() || at.front().size() != 3) part.fail("at_px", "must have a place of three numbers");
    LayerWindow window;
    for (std::size_t a = 0; a < 3; ++a) {
        window.corner[a] = static_cast<int>(at.front()[a]);
        window.size[a] = static_cast<int>(size[a]);
    }
    return window;
}

std::string lamp_of(const io::JsonObject& part) {
    return part.has("illuminant") ? part.text("illuminant") : std::string();
}

}  // namespace

std::optional<PartInTray> find_part_in_tray(const std::string& folder) {
    std::error_code none;
    const fs::path path = fs::path(folder).lexically_normal() / "", part = path.parent_path(),
                   parts = part.parent_path(), tray = parts.parent_path();
    if (parts.filename() != parts_folder || fs::exists(part / io::manifest_name, none)) return std::nullopt;
    const fs::path file = tray / tray_file;
    if (!fs::exists(file, none)) return std::nullopt;
    const std::string name = part.filename().string();
    for (const io::JsonObject& one : io::JsonObject::read(file).objects("parts")) {
        const bool has_report = one.has("report") && one.is_text("report");
        const std::string of_report = has_report ? fs::path(one.text("report")).parent_path().filename().string() : "";
        if (one.text("name") == name || of_report == name)
            return PartInTray{tray.empty() ? "." : tray.string(), window_of(one), lamp_of(one)};
    }
    throw InputError(fmt::format("{}: {} does not say that such a part is on the tray; name the tray's folder", folder,
                                 file.string()));
}

std::string lamp_of_parts(const std::string& folder) {
    std::error_code none;
    const fs::path file = fs::path(folder) / tray_file;
    if (!fs::exists(file, none)) return {};
    std::optional<std::pair<std::string, std::string>> first;  // lamp, part
    for (const io::JsonObject& part : io::JsonObject::read(file).objects("parts")) {
        if (part.has("component")) continue;
        const std::string lamp = lamp_of(part), name = part.text("name");
        if (!first) first = {lamp, name};
        if (lamp == first->first) continue;
        const auto words = [](const std::string& of) { return of.empty() ? std::string("the tray's lamp") : of; };
        throw InputError(
            fmt::format("{}: {} was made to be seen under {} and {} under {}, and no lamp shows both so: name one with "
                        "--illuminant, or a part of the tray (parts/{})",
                        folder, first->second, words(first->first), name, words(lamp), name));
    }
    return first ? first->first : std::string();
}

}  // namespace voxtone::slicer
