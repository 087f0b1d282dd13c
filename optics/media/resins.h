// SPDX-License-Identifier: GPL-3.0-or-later
//
// Resins as light sees them: absorption and scattering per channel, phase function and refractive index, which are the
// set's, but for a resin that names its own.
//
//   sigma_t = sigma_a + sigma_s   [mm^-1],   alpha = sigma_s / sigma_t   (single-scattering albedo)
//
// An ideal mixture averages sigma_a and sigma_s linearly by volume fraction (Iser, Rittig, Wilkie 2025, Eq. 7). A
// halftone of voxels departs from it where one voxel is optically thick by itself.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "optics/colour/channels.h"
#include "optics/media/colour_residual.h"

namespace voxtone::optics {

/// Scattering and absorption of one medium in one channel, mm^-1.
struct Medium {
    double sigma_a = 0;
    double sigma_s = 0;
    [[nodiscard]] double sigma_t() const { return sigma_a + sigma_s; }
    /// 1 for a medium that does neither scatter nor absorb: nothing is lost there.
    [[nodiscard]] double albedo() const { return sigma_t() > 0 ? sigma_s / sigma_t() : 1.0; }
};

struct Resin {
    std::string name;                    ///< the maker's name, "VeroCyan"
    std::string role;                    ///< short and unique in a set: C, M, Y, K, W, T (clear), or any other word
    std::vector<double> sigma_t_per_mm;  ///< per channel, >= 0
    std::vector<double> albedo;          ///< per channel, in [0, 1]
    // What light does not see, for those who pay; nothing where nobody said.
    std::optional<double> density_g_per_ml = std::nullopt;  ///< > 0
    std::optional<double> price_per_kg = std::nullopt;      ///< >= 0, in the set's currency
    // Of its own, where it differs from the set; nothing: the set's.
    std::optional<double> eta = std::nullopt;  ///< refractive index, >= 1
    std::optional<double> g = std::nullopt;    ///< mean cosine of the scattering angle, in (-1, 1): ResinSet::relate()
    double similarity = 1;  ///< (1 - g) / (1 - g of the set), where it names its own: ResinSet::relate() keeps it

    /// As it is to a model of one phase function, the set's: sigma_s (1 - g) is kept (similarity: van de Hulst 1980,
    /// Multiple Light Scattering, chapter 14), so that light goes as far. Its own where it names no g.
    [[nodiscard]] Medium medium(std::size_t channel) const;
    /// As its numbers say, for light paths, which turn by the resin's own g.
    [[nodiscard]] Medium own_medium(std::size_t channel) const;
};

/// How an instrument looks at a flat patch. Specular light is left out, or is part of `FlatMeasurement::surface`.
enum class MeasuringGeometry { directional_45_0, diffuse_8 };

/// What the instrument adds to the resins' own light where a set was fitted to measured patches:
/// reading = gain (surface + rho). 45/0 without anything added where nobody said.
struct FlatMeasurement {
    MeasuringGeometry geometry = MeasuringGeometry::directional_45_0;
    double surface = 0;  ///< neutral light from the surface, a share of a perfect diffuser's, >= 0
    double gain = 1;     ///< > 0: the instrument's white over the model's
    friend bool operator==(const FlatMeasurement&, const FlatMeasurement&) = default;
};

struct ResinSet {
    std::string name;
    std::string source;
    Channels channels;
    double g = 0.4;    ///< mean cosine of the scattering angle (Henyey-Greenstein), in (-1, 1)
    double eta = 1.5;  ///< refractive index, >= 1
    std::vector<Resin> resins;
    std::string currency = {};  ///< of the prices: "EUR"

    /// How far droplets of a halftone run together, in [0, 1]: a voxel's optical sizes (effective_medium.h) are
    /// (1 - dot_spread) times those of a sharp one. 0: sharp voxels; 1: an ideal mixture, Eq. 7.
    /// Light paths: droplet_spread.h.
    double dot_spread = 0;
    FlatMeasurement measured = {};
    ColourResidual residual = {};  ///< what physics leaves of measured mixtures; shares as in `resins`

    /// Index of the resin with this role, or -1. Letter case counts only between roles that differ in nothing else.
    [[nodiscard]] int find(std::string_view role) const;
    /// The set with these roles only, in this order. Throws InputError naming the roles there are.
    [[nodiscard]] ResinSet subset(std::span<const std::string> roles) const;
    [[nodiscard]] double eta_of(const Resin& resin) const { return resin.eta.value_or(eta); }
    [[nodiscard]] double g_of(const Resin& resin) const { return resin.g.value_or(g); }
    /// Some resin's differs from the set's.
    [[nodiscard]] bool has_own_eta() const;
    [[nodiscard]] bool has_own_g() const;
    /// After a g was changed, of the set or of a resin.
    void relate();
    /// Eq. 7: the ideal mixture; `fractions` (one per resin) sum to 1.
    [[nodiscard]] Medium mix(std::span<const double> fractions, std::size_t channel) const;
    /// Throws InputError that names the resin, the value and the rule it breaks.
    void validate() const;
};

/// Vero Opaque: Elek et al. 2017, supplement, Table 1 (measured; g = 0.4; RGB). Roles C, M, Y, K, W.
[[nodiscard]] ResinSet vero_opaque();

}  // namespace voxtone::optics
