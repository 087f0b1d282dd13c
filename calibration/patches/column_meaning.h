// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the name of a column may mean by itself, as people, measuring programs and instruments write it.
//
//   W, C, Cyan, VeroCyan, ...          a resin: roles and names of the sets that come with the program, the usual words
//                                      for inks, and what the user names. Every other name is unknown
//   CMYK_C, CMYKW_W, CMY_C, CMYKOG_O   an ink: what stands before the last _ are all inks of the device, and not its
//                                      name. 3CLR_1, 4CLR_4: an ink by its number
//   L, a*, LAB_L, CIE L, L*(D50)       CIELAB, also with SCI, SCE, M0 to M3, illuminant and observer around it
//   X, XYZ_X, CIE X, X(D65)            tristimulus values
//   400, 400 nm, NM_400, R400, R_400nm, SPECTRAL_NM400, SPECTRAL_PCT_400, SPEC_400, REFL_400     a wavelength
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "calibration/patches/measured_values.h"

namespace voxtone::calibration {

/// How a column was measured, as far as its name says so.
struct MeasuredWay {
    std::string mode;  ///< "SCI", "SCE", "M0" to "M3"
    std::string illuminant, observer;
    friend bool operator==(const MeasuredWay&, const MeasuredWay&) = default;
    friend auto operator<=>(const MeasuredWay&, const MeasuredWay&) = default;
};

struct ColumnMeaning {
    enum class Of {
        unknown,
        role,
        ink,
        numbered_ink,
        device_rgb,
        quantity,
        wavelength,
        thickness,
        backing,
        base,
        row,
        column,
        unused
    } of = Of::unknown;
    std::string role = {};              ///< of a resin or an ink
    Quantity quantity = Quantity::lab;  ///< of `quantity`
    std::size_t channel = 0;            ///< of it, 0 to 2; of a numbered ink its number, from 0
    double nm = 0;                      ///< of a wavelength
    bool plain = false;                 ///< a letter alone, which may be a resin as well
    bool error = false;                 ///< the standard error of it
    MeasuredWay way = {};
};

/// What is known besides the names.
struct ColumnWords {
    std::span<const std::string> resins = {};  ///< roles that the user names, in order
    std::span<const std::string> known = {};   ///< roles that a printer or another set has
    std::string_view device = {};              ///< all inks of the device, "CMYKOG"; empty: not said

    [[nodiscard]] bool names(std::string_view role) const;
};

[[nodiscard]] ColumnMeaning column_meaning(std::string_view name, const ColumnWords& words);

/// Whether a column of this name is a resin without the user's word.
[[nodiscard]] bool is_known_role(std::string_view name);

}  // namespace voxtone::calibration
