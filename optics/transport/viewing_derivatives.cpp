// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/viewing_derivatives.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "optics/numerics/lanes.h"

namespace voxtone::optics {
namespace {

using Eight = FloatLanes<8>;  // directions side by side

void load(Eight& to, const Octet& from) { std::memcpy(&to, &from, sizeof to); }

float sum(const Eight& v) { return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7])); }

/// Light on a face, by tangential signs: what leaves through it and what enters.
struct FaceLight {
    std::array<Eight, 4> out, in;
};

/// The directions of a face's axis and of the two others.
struct FaceDirections {
    Eight weight, normal, u, v;
    FaceDirections(const DirectionSet& set, std::size_t axis) {
        load(weight, set.weight);
        load(normal, set.cosine[axis]);
        load(u, set.cosine[axis == 0 ? 1 : 0]);
        load(v, set.cosine[axis == 2 ? 1 : 2]);
    }
    /// Of tangential signs: along the first and the second of the two other axes.
    static float sign_u(std::size_t s) { return s & 1 ? -1.0f : 1.0f; }
    static float sign_v(std::size_t s) { return s & 2 ? -1.0f : 1.0f; }

    /// Takes phi + 3 Omega . J away.
    void take_moments(FaceLight& light) const {
        Eight phis{}, normals{}, us{}, vs{};
        for (std::size_t s = 0; s < 4; ++s) {
            const Eight both = weight * (light.out[s] + light.in[s]);
            phis += both;
            normals += weight * normal * (light.out[s] - light.in[s]);
            us += sign_u(s) * u * both;
            vs += sign_v(s) * v * both;
        }
        const float phi = sum(phis), Ju = 3 * sum(us), Jv = 3 * sum(vs);
        const Eight across = 3 * sum(normals) * normal;
        for (std::size_t s = 0; s < 4; ++s) {
            const Eight both = phi + (sign_u(s) * Ju * u + sign_v(s) * Jv * v);
            light.out[s] -= both + across;
            light.in[s] -= both - across;
        }
    }
    /// What light has at the middle of a cell beyond phi and J, given what it has on the face; `fade` on the way
    /// between.
    void find_rest(const Octet* out, const Octet* in, const Eight& fade, FaceLight& light) const {
        for (std::size_t s = 0; s < 4; ++s) {
            load(light.out[s], out[s]);
            load(light.in[s], in[s]);
        }
        take_moments(light);
        for (std::size_t s = 0; s < 4; ++s) {
            light.out[s] *= fade;
            light.in[s] *= fade;
        }
        take_moments(light);
    }
    /// The mean of a b over all directions, one of them reversed.
    [[nodiscard]] float product(const FaceLight& a, const FaceLight& b) const {
        Eight products{};
        for (std::size_t s = 0; s < 4; ++s) products += weight * (a.out[s] * b.in[s ^ 3] + a.in[s] * b.out[s ^ 3]);
        return sum(products);
    }
};

}  // namespace

void derivatives_by_moments(const DerivativeScene& scene, std::span<const ViewingField::BlockCode> forward,
                            std::span<const Moments> adjoint, std::span<float> by_sigma_t,
                            std::span<float> by_sigma_s) {
    const ViewingGrid& grid = scene.grid;
    const float V = scene.volume;
    parallel_ranges(0, adjoint.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
        for (std::size_t cell = begin; cell < end; ++cell) {
            by_sigma_t[cell] = by_sigma_s[cell] = 0;
            if (grid.medium[cell] == 0) continue;
            const Moments a = forward[cell / 64].moments(cell % 64);
            const Moments& b = adjoint[cell];
            const float phi2 = a.phi * b.phi, J2 = a.x * b.x + a.y * b.y + a.z * b.z;
            by_sigma_t[cell] = -V * (phi2 - 3 * J2);
            by_sigma_s[cell] = V * (phi2 - 3 * scene.media[grid.medium[cell]].linear * J2);
        }
    });
}

void add_derivatives_at_faces(const DerivativeScene& scene, const LightOnFaces& forward, const LightOnFaces& adjoint,
                              std::span<float> by_sigma_t) {
    const ViewingGrid& grid = scene.grid;
    const std::array<FaceDirections, 3> by_axis{{{grid.directions, 0}, {grid.directions, 1}, {grid.directions, 2}}};
    const auto edge = grid.edge_mm();
    const float V = scene.volume;
    parallel_for(0, grid.transport_blocks.size(), 32, [&](std::size_t t) {
        const GridBlock& block = grid.transport_block(t);
        std::array<float, 64> sums{}, faces{};
        for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f) {
            const OuterFace& face = grid.faces[f];
            if (face.kind == FaceKind::core || face.kind == FaceKind::mirror) continue;
            const std::size_t axis = static_cast<std::size_t>(face.facing) / 2;
            const FaceDirections& directions = by_axis[axis];
            const float depth = 0.5f * static_cast<float>(edge[axis]) * scene.media[grid.medium[face.cell]].sigma_t;
            Eight fade;
            for (std::size_t d = 0; d < 8; ++d) fade[d] = std::exp(-depth / directions.normal[d]);
            const std::size_t at = 4 * std::size_t{grid.place_of_face[f]};
            FaceLight a, b;
            directions.find_rest(&forward.out[at], &forward.in[at], fade, a);
            directions.find_rest(&adjoint.out[at], &adjoint.in[at], fade, b);
            sums[face.cell % 64] += directions.product(a, b);
            faces[face.cell % 64] += 1;
        }
        for (std::size_t place = 0; place < 64; ++place)
            if (faces[place] > 0) by_sigma_t[64 * t + place] -= V * sums[place] / faces[place];
    });
}

}  // namespace voxtone::optics
