// SPDX-License-Identifier: GPL-3.0-or-later
//
// A surface that is there already under layers of resin: paper, a tile, a sheet of metal. Of it is known what it
// reflects bare, in air; under resin it reflects otherwise:
//
//   matt    pigment or fibre without a face: rho(45 -> 0) of a diffuser, and the same in contact
//   smooth  a diffuser of albedo b under a smooth face of the resins' index, rho = t_45 t_0 / eta^2 b / (1 - r b) (r:
//           diffuse reflectance of the face from within; Saunderson 1942), turned round; in contact the face is gone
//   mirror  a share of the light, at any angle: of metal, in air and in contact alike
//
// In contact: the layer wets it. Else a film of air without thickness lies between them.
//
// What it cannot see: pores that resin fills (wet paper is darker), grain, gloss of a smooth surface under a film of
// air, which counts as diffuse.
#pragma once

namespace voxtone::optics {

class OrdinatePlan;
struct Admittance;

enum class BareFinish { matt, smooth, mirror };

struct KnownSurface {
    BareFinish finish = BareFinish::matt;
    bool gap = false;  ///< of air, between it and the lowest layer's smooth lower side
    friend bool operator==(const KnownSurface&, const KnownSurface&) = default;
};

/// The albedo under a smooth face that has rho(45 -> 0), in [0, 1]. `plan` looks along 45 and 0 degrees.
[[nodiscard]] double albedo_under_face(const OrdinatePlan& plan, double rho);

/// The law of the surface. `rho`: what it reflects bare; values outside of [0, 1] are noise and count as the bound.
[[nodiscard]] Admittance admittance_of(const OrdinatePlan& plan, const KnownSurface& surface, double rho);

}  // namespace voxtone::optics
