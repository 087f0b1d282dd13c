// SPDX-License-Identifier: GPL-3.0-or-later
//
// The sweep beside a twin that is written as the equations stand: one direction after the other, in double precision.
#include "optics/transport/transport_sweep.h"

#include <hwy/targets.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "optics/grid/block_contrast.h"
#include "optics/grid/refinement.h"
#include "optics/grid/viewing_grid_builder.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};
constexpr std::array<int, 3> viewing_cell{2, 1, 3}, whole_cell{1, 1, 1};
constexpr double theta = 0.85, theta_of_parts = 1;

/// A grid with all kinds of blocks, and anything for light.
struct Case {
    ResinSet set = vero_opaque();
    ResinVolume volume;
    ViewingGrid grid;
    std::vector<TransportMedium> media, media_of_parts;
    std::vector<Moments> light, light_of_parts;
    std::vector<Octet> in;
    std::vector<std::array<float, 2>> core_in;
    RandomStream random{7, 1};

    explicit Case(Refinement where) {
        // White, 5 mm deep so that there is a core, with inks on one half of its top, and a step at one side.
        volume = make_resin_volume({36, 16, 200}, j750, [&](int x, int y, int z) -> int {
            if (x > 30 - z % 5 && z > 170) return air;
            if (z < 188 || x < 14) return 5;
            return RandomStream(5, std::uint64_t((z * 16 + y) * 36 + x)).uniform() < 0.5 ? 1 + (x + y) % 4 : 5;
        });
        const Scene scene{&volume, &set, Backing::black, Sides::mirrored};
        const BlockLattice lattice(volume.size(), viewing_cell);
        const Surface top = find_surface(scene, viewing_cell, SurfacePart::top);
        grid = make_viewing_grid(scene, viewing_cell, {0.2}, {}, {{}, lattice.blocks, {}}, &top);
        refine(grid, volume, blocks_to_refine(grid, volume, where), viewing_cell);
        const auto medium = [&] {
            const float sigma_t = 1 + 40 * value();
            return TransportMedium{sigma_t, sigma_t * (0.3f + 0.7f * value()), 0.6f * value() - 0.3f};
        };
        for (std::size_t m = 0; m < grid.mixtures.size(); ++m) media.push_back(medium());
        for (std::size_t m = 0; m < grid.fine.contents.size(); ++m) {
            media_of_parts.push_back(medium());
            if (m % 3 > 0) media_of_parts.back().apart = value();
        }
        const auto moments = [&] {
            return Moments{value(), 0.3f * value() - 0.15f, 0.3f * value() - 0.15f, 0.3f * value() - 0.15f};
        };
        for (std::size_t i = 0; i < grid.cells(); ++i) light.push_back(moments());
        for (std::size_t i = 0; i < grid.fine.medium.size(); ++i) light_of_parts.push_back(moments());
        in.resize(4 * grid.open_faces.size());
        for (Octet& octet : in)
            for (float& v : octet.v) v = value();
        core_in.resize(grid.core_faces.size());
        for (auto& face : core_in) face = {value(), 0.1f * value()};
    }
    float value() { return static_cast<float>(random.uniform()); }
};

struct Result {
    std::vector<Moments> sum, sum_of_parts;
    std::vector<Octet> out;
    std::vector<float> core_out;
    explicit Result(const Case& c)
        : sum(c.grid.cells()),
          sum_of_parts(c.grid.fine.medium.size()),
          out(c.in.size()),
          core_out(4 * c.core_in.size()) {}
};

Result swept(const Case& c, std::size_t fronts = 1) {
    Result result(c);
    const std::array<double, 3> edge = c.grid.edge_mm();
    std::array<double, 3> edge_of_parts = edge;
    for (std::size_t a = 0; c.grid.fine.any() && a < 3; ++a) edge_of_parts[a] /= c.grid.fine.split[a];
    const std::vector<SweepMedium> media = sweep_media(c.grid.directions, edge, float(theta), c.media),
                                   media_of_parts = sweep_media(c.grid.directions, edge_of_parts, float(theta_of_parts),
                                                                c.media_of_parts);
    for (const bool down : {false, true}) {
        const SweepRows rows = sweep_rows(c.grid, down, fronts);
        // A sweep owes nothing to what its sums were.
        constexpr float garbage = std::numeric_limits<float>::quiet_NaN();
        std::vector<Moments> sum(result.sum.size(), {garbage, garbage, garbage, garbage}),
            sum_of_parts(result.sum_of_parts.size(), sum[0]);
        const SweepJob job{.grid = c.grid,
                           .cells = {.media = media, .light = c.light, .sum = sum, .theta = float(theta)},
                           .parts = {.media = media_of_parts,
                                     .light = c.light_of_parts,
                                     .sum = sum_of_parts,
                                     .theta = float(theta_of_parts)},
                           .in = c.in,
                           .out = result.out,
                           .core_in = c.core_in,
                           .core_out = result.core_out,
                           .rows = rows};
        sweep_half(job, down);
        for (std::size_t i = 0; i < sum.size(); ++i) result.sum[i] += sum[i];
        for (std::size_t i = 0; i < sum_of_parts.size(); ++i) result.sum_of_parts[i] += sum_of_parts[i];
    }
    return result;
}

/// One direction: radiance on the faces of the smallest cells there are, each at the face that light leaves through.
class Twin {
public:
    Twin(const Case& c, Result& result, int octant, std::size_t d) : c_(c), result_(result), octant_(octant), d_(d) {
        const DirectionSet& set = c.grid.directions;
        split_ = c.grid.fine.any() ? c.grid.fine.split : whole_cell;
        for (std::size_t a = 0; a < 3; ++a) {
            cosine_[a] = double(set.cosine[a].v[d]);
            back_[a] = octant >> a & 1;
            n_[a] = 4 * c.grid.lattice[a] * split_[a];
        }
        for (std::size_t a = 0; a < 3; ++a)
            left_[a].assign(std::size_t(n_[0]) * std::size_t(n_[1]) * std::size_t(n_[2]), 0.0);
        weight_ = double(set.weight.v[d]);
    }
    void run() {
        std::array<int, 3> k{};
        const auto& lattice = c_.grid.lattice;
        // Upstream cells first: whole cells in the order of the lattice, their parts within.
        for (k[2] = 0; k[2] < 4 * lattice[2]; ++k[2])
            for (k[1] = 0; k[1] < 4 * lattice[1]; ++k[1])
                for (k[0] = 0; k[0] < 4 * lattice[0]; ++k[0]) {
                    std::array<int, 3> at{};
                    for (std::size_t a = 0; a < 3; ++a) at[a] = back_[a] ? 4 * lattice[a] - 1 - k[a] : k[a];
                    if (const std::int64_t cell = c_.grid.cell_of(at); cell >= 0) cross(at, std::size_t(cell));
                }
    }

private:
    void cross(const std::array<int, 3>& at, std::size_t cell) {
        const std::uint32_t first = c_.grid.fine.any() ? c_.grid.fine.first[cell / 64] : not_fine;
        std::array<std::int64_t, 6> face;
        face.fill(-1);
        c_.grid.each_face(std::uint32_t(cell),
                          [&](std::uint32_t f) { face[std::size_t(c_.grid.faces[f].facing)] = f; });
        if (first == not_fine) {
            std::array<int, 3> low{};
            for (std::size_t a = 0; a < 3; ++a) low[a] = at[a] * split_[a];
            cross_leaf(low, split_, face, c_.media[c_.grid.medium[cell]], c_.light[cell], result_.sum[cell], theta);
            return;
        }
        const std::array<int, 3> in_block{at[0] % 4, at[1] % 4, at[2] % 4};
        std::array<int, 3> k{};
        for (k[2] = 0; k[2] < split_[2]; ++k[2])
            for (k[1] = 0; k[1] < split_[1]; ++k[1])
                for (k[0] = 0; k[0] < split_[0]; ++k[0]) {
                    std::array<int, 3> part{}, low{};
                    std::array<std::int64_t, 6> own = face;
                    for (std::size_t a = 0; a < 3; ++a) {
                        part[a] = back_[a] ? split_[a] - 1 - k[a] : k[a];
                        low[a] = at[a] * split_[a] + part[a];
                        if (part[a] != 0) own[2 * a] = -1;
                        if (part[a] != split_[a] - 1) own[2 * a + 1] = -1;
                    }
                    const std::size_t i = first + c_.grid.fine.part(in_block, part);
                    cross_leaf(low, whole_cell, own, c_.media_of_parts[c_.grid.fine.medium[i]], c_.light_of_parts[i],
                               result_.sum_of_parts[i], theta_of_parts);
                }
    }
    [[nodiscard]] std::size_t index(const std::array<int, 3>& at) const {
        return (std::size_t(at[2]) * std::size_t(n_[1]) + std::size_t(at[1])) * std::size_t(n_[0]) + std::size_t(at[0]);
    }
    /// body(smallest cell) over one side of a box.
    template <class Body>
    static void each_on_side(std::array<int, 3> low, std::array<int, 3> size, std::size_t axis, int at, Body&& body) {
        low[axis] = at;
        size[axis] = 1;
        for (int z = 0; z < size[2]; ++z)
            for (int y = 0; y < size[1]; ++y)
                for (int x = 0; x < size[0]; ++x) body(std::array<int, 3>{low[0] + x, low[1] + y, low[2] + z});
    }

    void cross_leaf(const std::array<int, 3>& low, const std::array<int, 3>& size,
                    const std::array<std::int64_t, 6>& face, const TransportMedium& medium, const Moments& light,
                    Moments& sum, double weight) {
        const auto edge = c_.grid.edge_mm();
        const double J[3]{double(light.x), double(light.y), double(light.z)};
        double along = 0, all = 0, arriving = 0;
        std::array<double, 3> enters{}, omega{}, ways{};
        for (std::size_t a = 0; a < 3; ++a) {
            const double h = edge[a] * size[a] / split_[a], k = (1 + weight) * cosine_[a] / h;
            omega[a] = back_[a] ? -cosine_[a] : cosine_[a];
            along += omega[a] * J[a];
            enters[a] = entering(low, size, face, a);
            all += k;
            arriving += k * enters[a];
            ways[a] = h / cosine_[a];
        }
        const double sigma = double(medium.sigma_t),
                     q = double(medium.sigma_s) * (double(light.phi) + 3 * double(medium.linear) * along),
                     fit = lump_fit(sigma - double(medium.sigma_s), ways, weight, double(medium.apart)),
                     psi = (fit * q + arriving) / (fit * sigma + all), seen = fit * psi + (1 - fit) * q / sigma;
        sum.phi += float(weight_ * seen);
        sum.x += float(weight_ * omega[0] * seen);
        sum.y += float(weight_ * omega[1] * seen);
        sum.z += float(weight_ * omega[2] * seen);
        for (std::size_t a = 0; a < 3; ++a) leave(low, size, face, a, (1 + weight) * psi - weight * enters[a]);
    }

    [[nodiscard]] std::size_t slot(std::size_t place, std::size_t axis) const {
        return 4 * (place & ~std::size_t{into_core}) + std::size_t(tangential_signs(octant_, int(axis)));
    }
    [[nodiscard]] double entering(const std::array<int, 3>& low, const std::array<int, 3>& size,
                                  const std::array<std::int64_t, 6>& face, std::size_t a) const {
        if (const std::int64_t f = face[2 * a + (back_[a] ? 1 : 0)]; f >= 0) {
            const std::size_t place = c_.grid.place_of_face[std::size_t(f)];
            if ((place & into_core) == 0) return double(c_.in[slot(place, a)].v[d_]);
            const auto& [phi, J] = c_.core_in[place & ~std::size_t{into_core}];
            return double(phi) - 3 * double(J) * cosine_[a];
        }
        double sum = 0;
        int count = 0;
        each_on_side(low, size, a, back_[a] ? low[a] + size[a] : low[a] - 1, [&](const std::array<int, 3>& at) {
            sum += left_[a][index(at)];
            ++count;
        });
        return sum / count;
    }
    void leave(const std::array<int, 3>& low, const std::array<int, 3>& size, const std::array<std::int64_t, 6>& face,
               std::size_t a, double psi) {
        if (const std::int64_t f = face[2 * a + (back_[a] ? 0 : 1)]; f >= 0) {
            const std::size_t place = c_.grid.place_of_face[std::size_t(f)];
            const double parts = double(split_[(a + 1) % 3] * split_[(a + 2) % 3]),
                         share = double(size[(a + 1) % 3] * size[(a + 2) % 3]) / parts;
            if (place & into_core)
                result_.core_out[slot(place, a)] += float(share * weight_ * cosine_[a] * psi);
            else
                result_.out[slot(place, a)].v[d_] += float(share * psi);
        }
        each_on_side(low, size, a, back_[a] ? low[a] : low[a] + size[a] - 1,
                     [&](const std::array<int, 3>& at) { left_[a][index(at)] = psi; });
    }

    const Case& c_;
    Result& result_;
    int octant_;
    std::size_t d_;
    std::array<int, 3> split_{}, n_{};
    std::array<double, 3> cosine_{};
    std::array<bool, 3> back_{};
    double weight_ = 0;
    std::array<std::vector<double>, 3> left_;
};

Result by_twin(const Case& c) {
    Result result(c);
    for (int octant = 0; octant < 8; ++octant)
        for (std::size_t d = 0; d < 8; ++d) Twin(c, result, octant, d).run();
    return result;
}

double largest_difference(const std::vector<Moments>& a, const std::vector<Moments>& b) {
    float most = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        most = std::max({most, std::abs(a[i].phi - b[i].phi), std::abs(a[i].x - b[i].x), std::abs(a[i].y - b[i].y),
                         std::abs(a[i].z - b[i].z)});
    return double(most);
}

}  // namespace

TEST_CASE("A sweep is what its equations say, through coarse cells, voxels, and from one to the other", "[slow]") {
    for (const Refinement where : {Refinement::none, Refinement::contrast, Refinement::all}) {
        const Case c(where);
        REQUIRE(c.grid.core_faces.size() > 50);
        REQUIRE(c.grid.open_faces.size() > 100);
        const Result vectors = swept(c), twin = by_twin(c);
        INFO("refinement " << int(where));
        CHECK(largest_difference(vectors.sum, twin.sum) < 2e-5);
        CHECK(largest_difference(vectors.sum_of_parts, twin.sum_of_parts) < 2e-5);
        double light = 0, flux = 0, seen = 0;
        for (std::size_t i = 0; i < twin.out.size(); ++i)
            for (std::size_t d = 0; d < 8; ++d) {
                light = std::max(light, double(std::abs(vectors.out[i].v[d] - twin.out[i].v[d])));
                seen = std::max(seen, double(twin.out[i].v[d]));
            }
        for (std::size_t i = 0; i < twin.core_out.size(); ++i)
            flux = std::max(flux, double(std::abs(vectors.core_out[i] - twin.core_out[i])));
        CHECK(seen > 0.5);
        CHECK(light < 2e-5);
        CHECK(flux < 2e-5);
    }
}

TEST_CASE("A small body amid others takes up what light that comes in evenly leaves on its way through") {
    for (const std::array<double, 3>& ways : {std::array{0.1, 0.1, 0.1}, std::array{0.05, 0.2, 0.07}})
        for (const double sigma : {0.5, 8.0, 40.0, 100.0}) {
            // Places in the box, and how far behind each its light came in.
            constexpr int n = 60;
            double mean = 0;
            for (int i = 0; i < n * n * n; ++i)
                mean += std::exp(-sigma * std::min({(i % n + 0.5) / n * ways[0], (i / n % n + 0.5) / n * ways[1],
                                                    (i / (n * n) + 0.5) / n * ways[2]})) /
                        (n * n * n);
            CAPTURE(ways, sigma);
            CHECK(mean_in_box(sigma, ways) == Approx(mean).epsilon(0.002));
            const double l = 1 / (1 / ways[0] + 1 / ways[1] + 1 / ways[2]),
                         wide = -std::expm1(-sigma * l) / (sigma * l);
            CHECK(mean_in_box(sigma, ways) < wide);
            for (const double weight : {1.0, 0.85})
                for (const double apart : {0.0, 0.25, 1.0}) {
                    // 1 in through all sides; what goes out is what was not taken up.
                    const double psi = (1 + weight) / (1 + weight + lump_fit(sigma, ways, weight, apart) * sigma * l);
                    CHECK((1 + weight) * psi - weight ==
                          Approx(1 - sigma * l * ((1 - apart) * wide + apart * mean)).margin(0.002));
                }
        }
    // Between two planes there is but one way; what is as good as black is lit on its sides alone.
    CHECK(mean_in_box(20, {0.05, 1e9, 1e9}) == Approx(-std::expm1(-1.0)).epsilon(1e-6));
    CHECK(mean_in_box(1e4, {0.05, 0.2, 0.1}) == Approx((20 + 5 + 10) / 1e4).epsilon(0.01));
}

namespace {

template <class Value>
bool same_bits(const std::vector<Value>& a, const std::vector<Value>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Value)) == 0);
}

}  // namespace

TEST_CASE("Rows that are crossed at once make the bits of rows crossed one after the other", "[transport-sweep]") {
    const ThreadLimit threads(6);
    for (const Refinement where : {Refinement::none, Refinement::contrast, Refinement::all}) {
        const Case c(where);
        const Result one = swept(c);
        for (const std::size_t fronts : {2, 3, 5, 100})
            for (int again = 0; again < 5; ++again) {
                const Result many = swept(c, fronts);
                CHECK(same_bits(many.sum, one.sum));
                CHECK(same_bits(many.sum_of_parts, one.sum_of_parts));
                CHECK(same_bits(many.out, one.out));
                CHECK(same_bits(many.core_out, one.core_out));
            }
    }
}

TEST_CASE("Every instruction set sweeps to the same bits", "[transport-sweep]") {
    const Case c(Refinement::contrast);
    hwy::SetSupportedTargetsForTest(0);
    const Result usual = swept(c);
    int sets = 0;
    for (std::int64_t targets = hwy::SupportedTargets(); targets != 0; targets &= targets - 1, ++sets) {
        hwy::SetSupportedTargetsForTest(targets & -targets);
        const Result other = swept(c);
        CHECK(same_bits(other.sum, usual.sum));
        CHECK(same_bits(other.sum_of_parts, usual.sum_of_parts));
        CHECK(same_bits(other.out, usual.out));
        CHECK(same_bits(other.core_out, usual.core_out));
    }
    hwy::SetSupportedTargetsForTest(0);
    REQUIRE(sets > 1);
}

TEST_CASE("A sweep offers as many tasks at once as its planes have rows", "[transport-sweep]") {
    const Case c(Refinement::none);
    const ViewingGrid& grid = c.grid;
    const SweepRows serial = sweep_rows(grid, false, 1), wave = sweep_rows(grid, false, 100);
    const std::size_t rows = grid.transport_rows.size() - 1;
    CHECK(serial.serial.size() == 2 * rows);
    CHECK(serial.fronts == 1);
    // Its own two ways: rows one way are followed by those the other way.
    CHECK(serial.at_once() < 2);
    CHECK(wave.at_once() > 2);
    CHECK(wave.at_once() > serial.at_once());
}
