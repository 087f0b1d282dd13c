// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/profiles/resin_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/core.h>
#include <Eigen/Core>

#include "base/embedded_file.h"
#include "base/error.h"
#include "base/printable.h"
#include "io/files/json_keys.h"
#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "io/profiles/json_channels.h"
#include "io/profiles/resin_correction.h"

namespace voxtone::embedded {
std::span<const EmbeddedFile> resins();
}

namespace voxtone::io {
namespace {

std::optional<double> number_if(const JsonObject& json, const char* key, double least, double most) {
    if (!json.has(key)) return std::nullopt;
    return json.number(key, least, most);
}

void write_set_channels(JsonWriter& json, const optics::Channels& channels) {
    if (channels.is_own()) return write_own_channels(json, channels);
    json.begin_object().add("kind", channels.is_rgb() ? "rgb" : "wavelength");
    if (channels.is_spectral()) json.add("nm", channels.wavelengths_nm);
    json.end_object();
}

optics::ResinSet resins_from_json(const JsonObject& json, const std::string& source) {
    json.allow_only({"format", "version", "name", "source", "note", "channels", "g", "eta", "resins", "currency",
                     "dot_spread", "measured", "residual", "family"});
    if (json.text("format") != "voxtone-resins") json.fail("format", "is not \"voxtone-resins\": this is no resin set");
    if (json.integer("version", 0, 1000000) != 1) json.fail("version", "is not 1, the only version this program knows");
    optics::ResinSet set;
    set.name = json.text("name");
    if (json.has("source")) set.source = json.text("source");
    const auto channels = json.object("channels");
    const auto kind = channels.text("kind");
    if (kind == "rgb") {
        channels.allow_only({"kind"});
    } else if (kind == "wavelength") {
        channels.allow_only({"kind", "nm"});
        set.channels.wavelengths_nm = channels.numbers("nm", 0, 1, 1e5);
        if (set.channels.wavelengths_nm.empty()) channels.fail("nm", "is empty, expected at least one wavelength");
    } else if (kind == "own") {
        set.channels = json_own_channels(channels);
    } else {
        channels.fail("kind", fmt::format("is {}, expected \"rgb\", \"wavelength\" or \"own\"", json_quoted(kind)));
    }
    set.g = json.number("g", -1, 1);
    set.eta = json.number("eta", 1, 10);
    if (json.has("currency")) set.currency = json.text("currency");
    if (json.has("currency") && set.currency.empty())
        json.fail("currency", "is empty; name one, such as \"EUR\", or leave it out");
    for (const auto& entry : json.objects("resins")) {
        entry.allow_only({"name", "role", "sigma_t_per_mm", "albedo", "density_g_per_ml", "price_per_kg", "eta", "g"});
        set.resins.push_back(
            {entry.text("name"), entry.text("role"), entry.numbers("sigma_t_per_mm", set.channels.size(), 0, 1e9),
             entry.numbers("albedo", set.channels.size(), 0, 1), number_if(entry, "density_g_per_ml", 0.1, 25),
             number_if(entry, "price_per_kg", 0, 1e9), number_if(entry, "eta", 1, 10), number_if(entry, "g", -1, 1)});
        if (set.resins.back().price_per_kg && set.currency.empty())
            entry.fail("price_per_kg", "has no currency: give the set a \"currency\", such as \"EUR\"");
        if (set.resins.back().price_per_kg && !set.resins.back().density_g_per_ml)
            entry.fail("price_per_kg",
                       "is by weight and the resin's weight is not known: give \"density_g_per_ml\" too");
    }
    read_correction(json, set);
    if (std::abs(set.g) < 1) set.relate();
    try {
        set.validate();
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}: {}", source, error.what()));
    }
    return set;
}

}  // namespace

optics::ResinSet parse_resin_set(std::string_view text, std::string source) {
    return resins_from_json(JsonObject::parse(text, source), source);
}

optics::ResinSet read_resin_set(const std::filesystem::path& file) {
    return resins_from_json(JsonObject::read(file), file.string());
}

std::string resin_set_text(const optics::ResinSet& set) {
    set.validate();
    JsonWriter json;
    json.begin_object().add("format", "voxtone-resins").add("version", 1).add("name", set.name);
    json.line().add("source", set.source);
    json.line().key("channels");
    write_set_channels(json, set.channels);
    json.add("g", set.g).add("eta", set.eta);
    if (!set.currency.empty()) json.add("currency", set.currency);
    json.line().key("resins").begin_list();
    for (const optics::Resin& resin : set.resins) {
        json.line().begin_object().add("name", resin.name).add("role", resin.role);
        json.add("sigma_t_per_mm", resin.sigma_t_per_mm).add("albedo", resin.albedo);
        if (resin.density_g_per_ml) json.add("density_g_per_ml", *resin.density_g_per_ml);
        if (resin.price_per_kg) json.add("price_per_kg", *resin.price_per_kg);
        if (resin.eta) json.add("eta", *resin.eta);
        if (resin.g) json.add("g", *resin.g);
        json.end_object();
    }
    json.end_list();
    write_correction(json, set);
    json.end_object();
    return json.text() + "\n";
}

optics::ResinSet rounded_set(optics::ResinSet set) {
    constexpr int digits = 6, most_decimals = 9;
    const auto read_again = [](const std::string& text, double& value) {
        std::from_chars(text.data(), text.data() + text.size(), value);
    };
    const auto round_all = [&](auto&& values) {
        for (double& value : values) read_again(fmt::format("{:.{}g}", value, digits), value);
    };
    const auto round_albedo = [&](double& albedo) {
        const double nearest = std::min(albedo, 1 - albedo);
        if (!(nearest > 0)) return;
        const int decimals = std::min(digits - 1 - static_cast<int>(std::floor(std::log10(nearest))), most_decimals);
        read_again(fmt::format("{:.{}f}", albedo, decimals), albedo);
    };
    for (double* value : {&set.dot_spread, &set.measured.surface, &set.measured.gain}) round_all(std::span(value, 1));
    for (optics::Resin& resin : set.resins) {
        round_all(resin.sigma_t_per_mm);
        for (double& albedo : resin.albedo) round_albedo(albedo);
    }
    for (auto& weights : set.channels.xyz) round_all(weights);
    if (set.residual.empty()) return set;
    std::vector<double> lengths = set.residual.lengths();
    Eigen::MatrixX3d weights = set.residual.weights();
    round_all(lengths);
    round_all(std::span(weights.data(), static_cast<std::size_t>(weights.size())));
    set.residual = {std::move(lengths), set.residual.centres(), std::move(weights)};
    return set;
}

std::vector<std::string> known_resin_sets() {
    std::vector<std::string> names;
    for (const auto& file : embedded::resins()) names.emplace_back(file.name);
    return names;
}

std::optional<std::string_view> known_resin_set_text(std::string_view name) {
    for (const auto& file : embedded::resins())
        if (file.name == name) return file.text;
    return std::nullopt;
}

optics::ResinSet find_resin_set(const std::string& name_or_file) {
    if (const auto text = known_resin_set_text(name_or_file))
        return parse_resin_set(*text, fmt::format("resin set {}", name_or_file));
    if (std::filesystem::exists(name_or_file)) return read_resin_set(name_or_file);
    std::string names;
    for (const auto& name : known_resin_sets()) names += (names.empty() ? "" : ", ") + name;
    const std::string nearest = nearest_name(name_or_file, known_resin_sets());
    throw InputError(
        fmt::format("There is no resin set \"{}\" and no file of that name{}; sets that come with the program: {}",
                    name_or_file, nearest.empty() ? "" : fmt::format("; did you mean \"{}\"?", nearest), names));
}

}  // namespace voxtone::io
