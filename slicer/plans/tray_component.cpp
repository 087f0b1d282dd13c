// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plans/tray_component.h"

#include <algorithm>
#include <sstream>

#include <fmt/core.h>

#include "base/error.h"
#include "io/disk/named_path.h"
#include "io/files/json_object.h"
#include "slicer/options/option_table.h"
#include "slicer/options/option_values.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

constexpr ComponentKind kinds[] = {ComponentKind::box, ComponentKind::cylinder, ComponentKind::stack,
                                   ComponentKind::gcvf};
constexpr const char *model_key = "model", *job_key = "job", *resin_key = "resin", *mixture_key = "mixture",
                     *diameter_key = "diameter", *height_key = "height";
constexpr double least_component_mm = 1e-3, most_component_mm = 10'000, most_share = 1e9;

double checked_mm(const io::JsonObject& part, std::string_view key, double mm) {
    if (!(mm >= least_component_mm && mm <= most_component_mm)) part.fail(key, "is in mm: each from 0.001 to 10000");
    return mm;
}

/// As a cell of a table has them.
std::vector<double> sizes_in(const io::JsonObject& part, std::string_view key, std::string text) {
    for (char& c : text)
        if (c == 'x' || c == ',') c = ' ';
    std::vector<double> numbers;
    std::istringstream words(text);
    for (std::string word; words >> word;) try {
            numbers.push_back(parse_number<double>(key, word));
        } catch (const UsageError& error) {
            part.fail(key, error.what());
        }
    return numbers;
}

std::array<double, 3> box_of(const io::JsonObject& part, std::string_view key) {
    const std::vector<double> mm = part.is_text(key) ? sizes_in(part, key, part.text(key))
                                                     : part.numbers(key, 0, -most_component_mm, most_component_mm);
    if (mm.size() != 3) part.fail(key, "is three sizes in mm, along x, y and z: [10, 5, 2]");
    for (const double size : mm) (void)checked_mm(part, key, size);
    return {mm[0], mm[1], mm[2]};
}

std::array<double, 3> cylinder_of(const io::JsonObject& part, std::string_view key) {
    double diameter = 0, height = 0;
    if (part.is_text(key)) {
        const std::vector<double> mm = sizes_in(part, key, part.text(key));
        if (mm.size() != 2) part.fail(key, "is two sizes in mm, diameter and height: \"8 2\"");
        diameter = checked_mm(part, key, mm[0]), height = checked_mm(part, key, mm[1]);
    } else {
        if (!part.is_object(key)) part.fail(key, "is {\"diameter\": 8, \"height\": 2}, in mm; it stands upright");
        const io::JsonObject sizes = part.object(key);
        sizes.allow_only({diameter_key, height_key});
        diameter = sizes.number(diameter_key, least_component_mm, most_component_mm),
        height = sizes.number(height_key, least_component_mm, most_component_mm);
    }
    return {diameter, diameter, height};
}

/// "VeroWhite:1+VeroClear:3"
std::vector<ResinShare> shares_in(const io::JsonObject& part, const std::string& text) {
    std::vector<ResinShare> shares;
    std::istringstream parts(text);
    for (std::string one; std::getline(parts, one, '+');) {
        const std::size_t colon = one.rfind(':');
        if (colon == std::string::npos || colon == 0)
            part.fail(mixture_key, "is resins with their shares: \"VeroWhite:1+VeroClear:3\"");
        try {
            shares.push_back({one.substr(0, colon), parse_number<double>(mixture_key, one.substr(colon + 1))});
        } catch (const UsageError& error) {
            part.fail(mixture_key, error.what());
        }
    }
    return shares;
}

std::vector<ResinShare> mixture_of(const io::JsonObject& part) {
    if (part.has(resin_key)) {
        if (part.has(mixture_key)) part.fail(mixture_key, "says what \"resin\" says, too: leave one of them out");
        return {{part.text(resin_key), 1}};
    }
    if (!part.has(mixture_key)) return {};
    std::vector<ResinShare> shares;
    if (part.is_object(mixture_key)) {
        const io::JsonObject mixture = part.object(mixture_key);
        for (const std::string& resin : mixture.keys())
            shares.push_back({resin, mixture.number(resin, -most_share, most_share)});
    } else {
        shares = shares_in(part, part.text(mixture_key));
    }
    double sum = 0;
    for (const ResinShare& one : shares) {
        if (!(one.share >= 0 && one.share <= most_share))
            part.fail(mixture_key, fmt::format("gives {} a share of {:g}; shares are 0 or more", one.resin, one.share));
        sum += one.share;
    }
    if (!(sum > 0)) part.fail(mixture_key, "mixes nothing: give a resin a share above 0, {\"VeroWhite\": 1}");
    std::erase_if(shares, [](const ResinShare& one) { return one.share == 0; });
    return shares;
}

std::string_view phrase_of(ComponentKind kind) {
    switch (kind) {
        case ComponentKind::box:
            return "a box";
        case ComponentKind::cylinder:
            return "a cylinder";
        case ComponentKind::body:
            return "a body of one resin";
        case ComponentKind::stack:
            return "a stack";
        case ComponentKind::gcvf:
            return "a GCVF";
    }
    return "";
}

[[noreturn]] void refuse_two(const io::JsonObject& part, std::string_view key, std::string_view other) {
    part.fail(key, fmt::format("stands beside \"{}\", and a part is one thing: make it two parts", other));
}

/// Options of a job say how a model becomes voxels, and what is on its surface.
void refuse_what_models_have(const io::JsonObject& part, const TrayComponent& component) {
    for (const std::string& key : part.keys()) {
        if (!find_option(key)) continue;
        part.fail(key, fmt::format("is for a model; {} {}: leave it out", phrase_of(component.kind),
                                   component.is_shape() ? "is plain voxels of its size"
                                                        : "is sliced already, and its voxels are taken as they are"));
    }
}

/// A model whose colours are not asked for.
TrayComponent body_of(const io::JsonObject& part, const fs::path& folder) {
    for (const char* key : {job_key, "label", "decal"})
        if (part.has(key))
            part.fail(key, "is of what is coloured, and a body of one resin is not: leave it out, or the resin");
    TrayComponent body;
    body.kind = ComponentKind::body;
    body.path = fs::absolute(io::named_path(folder, part.text(model_key))).lexically_normal().string();
    body.mixture = mixture_of(part);
    return body;
}

}  // namespace

std::string TrayComponent::usual_name() const {
    if (is_shape()) return std::string(name_of(kind));
    return kind == ComponentKind::gcvf || kind == ComponentKind::body ? fs::path(path).stem().string()
                                                                      : fs::path(path).filename().string();
}

std::vector<std::string> component_keys() {
    std::vector<std::string> keys{resin_key, mixture_key};
    for (const ComponentKind kind : kinds) keys.emplace_back(name_of(kind));
    return keys;
}

std::optional<TrayComponent> component_of(const io::JsonObject& part, const fs::path& folder, bool cuts) {
    std::optional<TrayComponent> component;
    for (const ComponentKind kind : kinds) {
        const std::string_view key = name_of(kind);
        if (!part.has(key)) continue;
        for (const char* other : {model_key, job_key})
            if (part.has(other)) refuse_two(part, key, other);
        if (component) refuse_two(part, key, name_of(component->kind));
        component.emplace();
        component->kind = kind;
        if (kind == ComponentKind::box) component->size_mm = box_of(part, key);
        if (kind == ComponentKind::cylinder) component->size_mm = cylinder_of(part, key);
        if (component->is_shape()) continue;
        const std::string file = part.text(key);
        if (file.empty()) part.fail(key, "names nothing");
        component->path = fs::absolute(io::named_path(folder, file)).lexically_normal().string();
        if (component->path.ends_with('/')) component->path.pop_back();
    }
    const bool shape = component && component->is_shape();
    for (const char* key : {resin_key, mixture_key})
        if (part.has(key) && !shape && (component || !part.has(model_key)))
            part.fail(
                key, "says of what a \"box\", a \"cylinder\" or a \"model\" is; what else there is has its own resins");
    if (!component && (part.has(resin_key) || part.has(mixture_key))) return body_of(part, folder);
    if (!component) return std::nullopt;
    refuse_what_models_have(part, *component);
    if (!shape) return component;
    component->mixture = mixture_of(part);
    if (component->mixture.empty() && !cuts)
        part.fail(name_of(component->kind),
                  "is of no resin: say which (\"resin\": \"VeroWhite\", or \"mixture\"), or that it cuts");
    return component;
}

}  // namespace voxtone::slicer
