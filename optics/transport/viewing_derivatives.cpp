// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/viewing_derivatives.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace voxtone::optics {
namespace {

/// Light on a face, by tangential signs: what leaves through it and what enters.
struct FaceLight {
    std::array<Octet, 4> out, in;
};

/// The directions of a face's axis and of the two others.
struct FaceDirections {
    const Octet &weight, &normal, &u, &v;
    template <class Body>
    static void each(Body&& body) {
        for (std::size_t s = 0; s < 4; ++s)
            for (std::size_t d = 0; d < 8; ++d) body(s, d);
    }
    /// Along the first and the second of the two other axes.
    [[nodiscard]] float along_u(std::size_t s, std::size_t d) const { return s & 1 ? -u.v[d] : u.v[d]; }
    [[nodiscard]] float along_v(std::size_t s, std::size_t d) const { return s & 2 ? -v.v[d] : v.v[d]; }

    /// Takes phi + 3 Omega . J away.
    void take_moments(FaceLight& light) const {
        float phi = 0, Jn = 0, Ju = 0, Jv = 0;
        each([&](std::size_t s, std::size_t d) {
            const float w = weight.v[d], both = w * (light.out[s].v[d] + light.in[s].v[d]);
            phi += both;
            Jn += w * normal.v[d] * (light.out[s].v[d] - light.in[s].v[d]);
            Ju += along_u(s, d) * both;
            Jv += along_v(s, d) * both;
        });
        each([&](std::size_t s, std::size_t d) {
            const float both = phi + 3 * (Ju * along_u(s, d) + Jv * along_v(s, d)), across = 3 * Jn * normal.v[d];
            light.out[s].v[d] -= both + across;
            light.in[s].v[d] -= both - across;
        });
    }
    /// What light has at the middle of a cell beyond phi and J, given what it has on the face; `fade` on the way
    /// between.
    [[nodiscard]] FaceLight rest(const Octet* out, const Octet* in, const Octet& fade) const {
        FaceLight light;
        std::copy_n(out, 4, light.out.begin());
        std::copy_n(in, 4, light.in.begin());
        take_moments(light);
        each([&](std::size_t s, std::size_t d) {
            light.out[s].v[d] *= fade.v[d];
            light.in[s].v[d] *= fade.v[d];
        });
        take_moments(light);
        return light;
    }
};

}  // namespace

void derivatives_by_moments(const DerivativeScene& scene, std::span<const ViewingField::BlockCode> forward,
                            std::span<const Moments> adjoint, std::span<float> by_sigma_t,
                            std::span<float> by_sigma_s) {
    const ViewingGrid& grid = scene.grid;
    const float V = scene.scaled_volume;
    parallel_ranges(0, adjoint.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
        for (std::size_t cell = begin; cell < end; ++cell) {
            by_sigma_t[cell] = by_sigma_s[cell] = 0;
            if (grid.medium[cell] == 0) continue;
            const Moments a = forward[cell / 64].moments(cell % 64, phi_code.step, 0);
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
    const DirectionSet& set = grid.directions;
    const auto edge = grid.edge_mm();
    const float V = scene.scaled_volume;
    parallel_for(0, grid.transport_blocks.size(), 32, [&](std::size_t t) {
        const GridBlock& block = grid.transport_block(t);
        std::array<float, 64> sum{}, faces{};
        for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f) {
            const OuterFace& face = grid.faces[f];
            if (face.kind == FaceKind::core || face.kind == FaceKind::mirror) continue;
            const std::size_t axis = static_cast<std::size_t>(face.facing) / 2;
            const FaceDirections directions{set.weight, set.cosine[axis], set.cosine[axis == 0 ? 1 : 0],
                                            set.cosine[axis == 2 ? 1 : 2]};
            const float depth = 0.5f * static_cast<float>(edge[axis]) * scene.media[grid.medium[face.cell]].sigma_t;
            Octet fade;
            for (std::size_t d = 0; d < 8; ++d) fade.v[d] = std::exp(-depth / directions.normal.v[d]);
            const std::size_t at = 4 * std::size_t{scene.grid.place_of_face[f]};
            const FaceLight a = directions.rest(&forward.out[at], &forward.in[at], fade),
                            b = directions.rest(&adjoint.out[at], &adjoint.in[at], fade);
            FaceDirections::each([&](std::size_t s, std::size_t d) {
                sum[face.cell % 64] +=
                    set.weight.v[d] * (a.out[s].v[d] * b.in[s ^ 3].v[d] + a.in[s].v[d] * b.out[s ^ 3].v[d]);
            });
            faces[face.cell % 64] += 1;
        }
        for (std::size_t place = 0; place < 64; ++place)
            if (faces[place] > 0) by_sigma_t[64 * t + place] -= V * sum[place] / faces[place];
    });
}

}  // namespace voxtone::optics
