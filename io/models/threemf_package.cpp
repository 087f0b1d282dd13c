// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/threemf_package.h"

#include <algorithm>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "base/printable.h"
#include "base/warning.h"
#include "io/files/xml_reader.h"
#include "io/models/model_text.h"

namespace voxtone::io {

namespace {

/// With slashes, from a root, without "." and ".." that lead nowhere.
std::string plain_path(std::string_view path) {
    std::vector<std::string> steps;
    std::string step;
    const auto close = [&] {
        if (step == "..") {
            if (!steps.empty()) steps.pop_back();
        } else if (!step.empty() && step != ".") {
            steps.push_back(step);
        }
        step.clear();
    };
    for (const char c : path)
        if (c == '/' || c == '\\')
            close();
        else
            step += c;
    close();
    std::string plain;
    for (const std::string& part : steps) plain += "/" + part;
    return plain;
}

std::string folder_of(const std::string& path) { return path.substr(0, path.rfind('/') + 1); }

bool is_model_part(std::string_view path) { return lower_case(path).ends_with(".model"); }

/// What systems add to archives on their own.
bool is_of_a_system(std::string_view path) {
    return path.starts_with("/__MACOSX/") || path.ends_with("/.DS_Store") || path.ends_with("/Thumbs.db");
}

/// %XX of a path; a broken one stays as it is.
std::string without_percents(std::string_view path) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string text;
    for (std::size_t i = 0; i < path.size(); ++i) {
        const bool whole = path[i] == '%' && i + 2 < path.size();
        const std::size_t high = whole ? digits.find(lower_case(path.substr(i + 1, 1))) : digits.npos;
        const std::size_t low = whole ? digits.find(lower_case(path.substr(i + 2, 1))) : digits.npos;
        if (high == digits.npos || low == digits.npos) {
            text += path[i];
        } else {
            text += static_cast<char>(16 * high + low);
            i += 2;
        }
    }
    return text;
}

/// Target of the package's relationship to its model.
std::string target_in(std::string_view relationships, const std::string& what) {
    XmlReader xml(relationships, what);
    std::string_view package;  // namespace of relationships
    for (XmlReader::Event event; (event = xml.next()) != XmlReader::Event::finished;) {
        if (event == XmlReader::Event::start && xml.depth() == 1) package = xml.namespace_uri();
        if (event == XmlReader::Event::start && xml.name() == "Relationship" && xml.namespace_uri() == package &&
            xml.attribute("Type").ends_with("/3dmodel"))
            return std::string(xml.attribute("Target"));
    }
    return {};
}

}  // namespace

ThreemfPackage::ThreemfPackage(std::span<const std::byte> bytes, const std::string& name,
                               std::uint64_t most_unpacked_bytes)
    : name_(name), archive_(bytes, name, {.total_bytes = most_unpacked_bytes}) {
    for (std::size_t i = 0; i < archive_.names().size(); ++i) {
        const std::string& entry = archive_.names()[i];
        const std::string path = plain_path(entry);
        if (!entry.ends_with('/') && !path.empty() && !is_of_a_system(path)) parts_.emplace(path, i);
    }
    leave_folder();
    for (const auto& [path, index] : parts_) any_case_.emplace(lower_case(path), path);
}

/// Where the package lies in one folder of the archive, as where a folder was packed and not what is in it.
void ThreemfPackage::leave_folder() {
    std::set<std::string> by_relationships, by_models;
    for (const auto& [path, index] : parts_) {
        const std::string name = lower_case(path);
        if (name.ends_with("/_rels/.rels"))
            by_relationships.insert(path.substr(0, path.size() - std::string_view("/_rels/.rels").size()));
        if (const std::size_t at = name.find("/3d/"); at != name.npos && is_model_part(name))
            by_models.insert(path.substr(0, at));
    }
    const std::set<std::string>& folders = by_relationships.empty() ? by_models : by_relationships;
    if (folders.size() != 1 || folders.begin()->empty()) return;
    const std::string folder = *folders.begin();
    std::map<std::string, std::size_t> inner;
    for (const auto& [path, index] : parts_)
        if (path.starts_with(folder + "/")) inner.emplace(path.substr(folder.size()), index);
    parts_ = std::move(inner);
    warnings_.push_back(named_warning(
        "damaged", fmt::format("{} holds its parts in a folder '{}', where they are not meant to be; it is read.",
                               name_, printable(folder.substr(1)))));
}

std::optional<std::string> ThreemfPackage::find_exactly(const std::string& path) const {
    if (parts_.contains(path)) return path;
    const auto other_case = any_case_.find(lower_case(path));
    if (other_case == any_case_.end()) return std::nullopt;
    return other_case->second;
}

std::optional<std::string> ThreemfPackage::find(const std::string& path, const std::string& from) const {
    const bool is_absolute = path.starts_with('/') || path.starts_with('\\');
    for (const std::string& written : {path, without_percents(path)}) {
        if (!is_absolute)
            if (auto found = find_exactly(plain_path(folder_of(from) + written))) return found;
        if (auto found = find_exactly(plain_path(written))) return found;
    }
    return std::nullopt;
}

std::vector<std::byte> ThreemfPackage::read(const std::string& found) const { return archive_.read(parts_.at(found)); }

std::string ThreemfPackage::root_part() {
    std::string told = "/3D/3dmodel.model";
    if (const auto relationships = find("/_rels/.rels")) {
        const std::string text = model_text(read(*relationships));
        if (const std::string target = target_in(text, name_ + ":_rels/.rels"); !target.empty()) told = target;
    }
    if (auto found = find(told)) return *found;
    std::vector<std::string> models;
    for (const auto& [path, index] : parts_)
        if (is_model_part(path)) models.push_back(path);
    if (models.size() == 1) {
        warnings_.push_back(named_warning(
            "damaged", fmt::format("{} names the part '{}' as its model, which is not in it; its only model, "
                                   "'{}', was taken.",
                                   name_, printable(told), printable(models[0]))));
        return models[0];
    }
    if (models.empty())
        throw InputError(
            fmt::format("{} is a ZIP archive and no 3MF file: it has no part '{}' nor any other model; in "
                        "it {}. Unpack it and give the model that is in it",
                        name_, printable(told), parts_there()));
    throw InputError(fmt::format("{} has no part '{}', which it names as its model; in it {}. Export it again", name_,
                                 printable(told), parts_there()));
}

bool ThreemfPackage::has_ending(std::string_view ending) const {
    return std::ranges::any_of(any_case_, [&](const auto& path) { return path.first.ends_with(ending); });
}

std::string ThreemfPackage::parts_there() const {
    constexpr std::size_t most = 6;
    if (parts_.empty()) return "is nothing";
    std::string text = parts_.size() == 1 ? "is " : "are ";
    std::size_t told = 0;
    for (const auto& [path, index] : parts_) {
        if (told == most) break;
        text += fmt::format("{}'{}'", told++ > 0 ? ", " : "", printable(path));
    }
    if (parts_.size() > most) text += fmt::format(" and {} more", parts_.size() - most);
    return text;
}

}  // namespace voxtone::io
