// SPDX-License-Identifier: GPL-3.0-or-later
//
// Measured patches: of a calibration target, thin squares of one mixture of resins upon a thick base of one resin; of a
// chart of mixtures, as a rule thick; of laminates, layers of one resin each upon nothing.
//
// Values are 45/0 directional reflectance relative to a perfect diffuser, rho(45 -> 0) = pi L_o / E
// (optics/layered/directional.h), one per channel: R, G, B, wavelengths, or X/Xn, Y/Yn, Z/Zn
// (optics::colorimetric_channels). Iser, Rittig, Wilkie 2025, Secs. 3.1 and 3.5.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "optics/layered/known_surface.h"
#include "optics/layered/slab_transmission.h"
#include "optics/media/resins.h"

namespace voxtone::calibration {

/// A share of one resin, by its role.
struct ResinShare {
    std::string role;
    double fraction = 1;  ///< of the volume, in (0, 1]
    friend bool operator==(const ResinShare&, const ResinShare&) = default;
};

/// What a square is made of; the fractions sum to 1. One entry: a pure resin.
using PatchMixture = std::vector<ResinShare>;

/// A layer of one resin.
struct PatchLayer {
    std::string role;
    double thickness_mm = 0;
    friend bool operator==(const PatchLayer&, const PatchLayer&) = default;
};

/// What patches lie on where it is no resin: a surface that was there before.
struct PatchSurface {
    std::string name;
    optics::KnownSurface kind;
    std::vector<double> rho, error;  ///< bare, per channel; as those of a patch
};

struct Patch {
    PatchMixture top;     ///< empty: bare, only while a table is read or written
    std::string backing;  ///< role of the base's resin, or name of `on`; empty: the patch has no end, or is a laminate
    double thickness_mm = 0;          ///< of the square; 0: thick, without end
    double base_mm = 0;               ///< thickness of the base under it; 0: not known, taken as without end
    std::vector<double> rho;          ///< per channel; of a slab lit from behind what comes through it
    std::vector<double> error;        ///< standard error per channel; empty: not known
    std::string where;                ///< file and line, for messages
    int row = 0, column = 0;          ///< on a printed chart, from 1 at the upper left; 0: not known
    std::array<double, 2> cell_mm{};  ///< of a checker of the two resins of `top`; 0: they are mixed voxel by voxel
    std::optional<optics::LightThrough> lit = {};  ///< of a slab in air, on nothing, that is lit from behind
    std::vector<PatchLayer> under = {};            ///< of a laminate: the layers below `top`, from above
    std::shared_ptr<const PatchSurface> on = {};   ///< in place of a base
    [[nodiscard]] bool is_checker() const { return cell_mm[0] > 0; }
    /// Of known thickness, in air upon nothing.
    [[nodiscard]] bool is_laminate() const { return thickness_mm > 0 && backing.empty() && !lit; }
};

struct PatchTable {
    std::string source;  ///< file or instrument
    optics::Channels channels;
    std::vector<Patch> patches;
    /// Mixtures measured as colours or spectra: thick unless told, values signed, and repeats of one mixture are rows
    /// of their own. Otherwise a target, of which no square is there twice.
    bool is_chart = false;
    std::vector<std::string> notes = {};  ///< what was assumed or recognised when it was read, one sentence each
    /// All are, or none (laminate_file.h).
    [[nodiscard]] bool is_of_laminates() const { return !patches.empty() && patches.front().is_laminate(); }
};

}  // namespace voxtone::calibration
