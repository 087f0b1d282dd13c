// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/laminate_setting.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/warning.h"
#include "io/profiles/resin_file.h"
#include "optics/profiles/saunderson.h"
#include "scattering/design/laminate_materials.h"

namespace voxtone::scattering {
namespace {

constexpr double usual_eta = 1.5;               // of measured materials, whose index no file says
constexpr double noisy = 0.05, cut_off = 0.05;  // shares of the light that are worth a warning

bool is_file(const std::string& material) { return std::filesystem::path(material).extension() == ".json"; }

std::string channels_in_full(const optics::Channels& channels) {
    if (!channels.is_spectral()) return optics::channels_text(channels);
    return fmt::format("{} nm", fmt::join(channels.wavelengths_nm, ", "));
}

void expect_same(const optics::Channels& channels, const std::string& file, const optics::Channels& expected,
                 const std::string& of) {
    if (channels == expected) return;
    throw InputError(fmt::format(
        "{}: its channels are {}, those of {} are {}; all profiles of a laminate are of the same channels: measure "
        "or convert one of them",
        file, channels_in_full(channels), of, channels_in_full(expected)));
}

void warn_of(const std::string& what, double negative, double beyond, Progress& progress) {
    if (negative > noisy)
        progress.warn(named_warning(
            "noisy-profile",
            fmt::format("{}: {:.0f} % of the light is below zero: the tail is noise; measure with longer exposures",
                        what, 100 * negative)));
    if (beyond > cut_off)
        progress.warn(named_warning(
            "cut-profile",
            fmt::format(
                "{}: about {:.0f} % of the light lies beyond the last sample and is left out; measure farther out",
                what, 100 * beyond)));
}

void warn_of(const std::string& what, const optics::MeasuredSummary& summary, Progress& progress) {
    warn_of(what + ", reflection", summary.negative_R, summary.beyond_R, progress);
    warn_of(what + ", transmission", summary.negative_T, summary.beyond_T, progress);
    if (summary.clamped > noisy)
        progress.warn(
            named_warning("noisy-profile",
                          fmt::format("{}: coefficients were changed by up to {:.2f} to lie within what a layer can do",
                                      what, summary.clamped)));
}

io::ProfileFile read_material(const std::string& file) {
    io::ProfileFile profile = io::read_profile(file);
    if (profile.is_target())
        throw InputError(fmt::format(
            "{}: holds no T and no thickness: it says what is wanted, not what a material does; a material is "
            "measured in reflection and transmission",
            file));
    return profile;
}

LaminateSettingOptions checked(LaminateSettingOptions options) {
    if (options.materials.empty())
        throw UsageError("--materials: names no material; give roles of the resin set or profile files");
    std::vector<std::string> sorted = options.materials;
    std::sort(sorted.begin(), sorted.end());
    if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end())
        throw UsageError(fmt::format("--materials: {} is named twice", *twice));
    if (!(options.reach_mm >= 0.1 && options.reach_mm <= 1000))
        throw UsageError(fmt::format("--reach: {:g} mm; it lies between 0.1 and 1000 mm", options.reach_mm));
    if (options.coefficients < 4 || options.coefficients > 1024)
        throw UsageError(fmt::format("--coefficients: {}; it lies between 4 and 1024", options.coefficients));
    return options;
}

LaminateSurface surface_of(const std::string& word) {
    if (const auto surface = value_of<LaminateSurface>(word)) return *surface;
    throw UsageError(fmt::format("--surface: '{}' is none of {}", word, fmt::join(names_of<LaminateSurface>(), ", ")));
}

LaminateBacking backing_of(const std::string& word) {
    if (const auto backing = value_of<LaminateBacking>(word)) return *backing;
    if (is_file(word)) return LaminateBacking::profile;
    throw UsageError(fmt::format("--backing: '{}' is none of {} and no profile file (.json)", word,
                                 fmt::join(names_of<LaminateBacking>(), ", ")));
}

ChannelProfiles backing_profile(const std::string& file, const optics::Channels& channels,
                                const optics::HankelGrid& grid) {
    const io::ProfileFile profile = io::read_profile(file);
    expect_same(profile.channels, file, channels, "the materials");
    ChannelProfiles reflection;
    optics::MeasuredSummary ignored;
    for (const auto& channel : profile.by_channel) {
        reflection.push_back(optics::measured_reflection(channel.R, grid, ignored));
        for (double& value : reflection.back()) value = std::clamp(value, 0.0, 1.0);
    }
    return reflection;
}

}  // namespace

LaminateSetting::LaminateSetting(const LaminateSettingOptions& given)
    : grid_(checked(given).reach_mm, given.coefficients),
      names_(given.materials),
      surface_(surface_of(given.surface)),
      backing_(backing_of(given.backing)),
      backing_file_(backing_ == LaminateBacking::profile ? given.backing : "") {
    const auto files = std::count_if(names_.begin(), names_.end(), is_file);
    if (files == 0) {
        set_ = io::find_resin_set(given.resins).subset(names_);
        channels_ = set_->channels;
    } else if (static_cast<std::size_t>(files) < names_.size()) {
        throw UsageError(fmt::format(
            "--materials: {} holds profile files and roles of resins; a laminate is made of one kind: its light "
            "is either measured or computed",
            fmt::join(names_, ", ")));
    } else {
        for (const std::string& name : names_) {
            files_.push_back(read_material(name));
            expect_same(files_.back().channels, name, files_[0].channels, names_[0]);
        }
        channels_ = files_[0].channels;
    }

    if (surface_ == LaminateSurface::automatic) surface_ = set_ ? LaminateSurface::air : LaminateSurface::matched;
    put_between(set_ ? set_->eta : usual_eta);
}

void LaminateSetting::put_between(double eta) {
    if (surface_ == LaminateSurface::air) {
        ends_.eta_top = eta;
        turned_back_ = optics::internal_diffuse_reflectance(eta);
    }
    const auto everywhere = [&](double share) {
        return ChannelProfiles(channels_.size(), std::vector<double>(grid_.size(), share));
    };
    switch (backing_) {
        case LaminateBacking::black:
            break;
        case LaminateBacking::white:
            backing_reflection_ = everywhere(1);
            ends_.sheet = 1;
            break;
        case LaminateBacking::air:
            backing_reflection_ = everywhere(optics::internal_diffuse_reflectance(eta));
            ends_.eta_bottom = eta;
            break;
        case LaminateBacking::profile:
            backing_reflection_ = backing_profile(backing_file_, channels_, grid_);
            break;
    }
}

std::string LaminateSetting::backing_name() const {
    return backing_ == LaminateBacking::profile ? backing_file_ : std::string(name_of(backing_));
}

std::vector<LaminateMaterial> LaminateSetting::materials(double known_mm, double most_mm,
                                                         const optics::LayerPathOptions& tracing,
                                                         Progress& progress) const {
    if (!(known_mm >= 0 && known_mm <= 100))
        throw UsageError(fmt::format(
            "--known: {:g} mm; resins are known at a thickness above 0, 100 mm at most (0: what fits)", known_mm));
    std::vector<LaminateMaterial> all;
    progress.begin_stage("Profiles", names_.size(), "materials");
    for (std::size_t m = 0; m < names_.size(); ++m) {
        if (set_) {
            optics::LayerPathOptions own = tracing;
            own.seed += 100000 * (m + 1);
            std::vector<double> known;
            for (std::size_t c = 0; c < channels_.size(); ++c)
                known.push_back(known_mm > 0 ? known_mm
                                             : fitting_known_mm(set_->resins[m].medium(c), set_->g, most_mm));
            all.push_back(resin_material(*set_, m, known, grid_, own, &progress));
        } else {
            MeasuredMaterial made = measured_material(names_[m], files_[m].by_channel, grid_);
            for (std::size_t c = 0; c < made.summary.size(); ++c)
                warn_of(fmt::format("{}, {}", names_[m], channel_name(c)), made.summary[c], progress);
            all.push_back(std::move(made.material));
        }
        progress.advance();
    }
    progress.end_stage();
    return all;
}

ChannelProfiles LaminateSetting::target(const io::ProfileFile& profile, const std::string& file,
                                        Progress& progress) const {
    expect_same(profile.channels, file, channels_, "the materials");
    ChannelProfiles target;
    for (std::size_t c = 0; c < profile.by_channel.size(); ++c) {
        optics::MeasuredSummary summary;
        try {
            target.push_back(optics::measured_reflection(profile.by_channel[c].R, grid_, summary));
        } catch (const InputError& error) {
            throw InputError(fmt::format("{}, {}: {}", file, channel_name(c), error.what()));
        }
        warn_of(fmt::format("{}, {}", file, channel_name(c)), summary, progress);
    }
    return target;
}

std::vector<optics::ResinLayer> LaminateSetting::resin_layers(std::span<const LaminateLayer> layers) const {
    std::vector<optics::ResinLayer> of_resin;
    for (const LaminateLayer& layer : layers) of_resin.push_back({layer.material, layer.thickness_mm});
    return of_resin;
}

std::string LaminateSetting::channel_name(std::size_t channel) const {
    return optics::channel_name(channels_, channel);
}

std::vector<std::string> LaminateSetting::channel_names() const {
    std::vector<std::string> names;
    for (std::size_t c = 0; c < channels_.size(); ++c) names.push_back(channel_name(c));
    return names;
}

void check_paths(std::uint32_t paths) {
    if (paths < 2) throw UsageError(fmt::format("--paths: {}; at least 2 are needed", paths));
}

}  // namespace voxtone::scattering
