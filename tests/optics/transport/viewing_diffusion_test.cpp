// SPDX-License-Identifier: GPL-3.0-or-later
//
// The diffusion solver alone: its equations are symmetric, what it solves is solved, and multigrid keeps the steps few
// whatever the media are and however many cells there are.
#include "optics/transport/viewing_diffusion.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "optics/grid/viewing_grid_builder.h"
#include "optics/transport/sweep_scratch.h"
#include "optics/transport/viewing_field.h"
#include "tests/places.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};
constexpr std::array<int, 3> viewing_cell{2, 1, 3};

struct Values {
    std::vector<float> cells, core;
    [[nodiscard]] ViewingDiffusion::Vector span() { return {cells, core}; }
};

/// A slab of white, mirrored at its sides, under a halftone of resins with very different diffusion constants.
struct Problem {
    ResinSet set = vero_opaque();
    ResinVolume volume;
    ViewingGrid grid;
    std::vector<float> D, core_D, cell_loss, core_loss;
    std::vector<BlockStencil<4>> stencils;

    /// `contrast`: largest / smallest D; `loss`: of a cell / its conductance to a neighbour, absorption that is.
    Problem(int blocks, double contrast, double loss) {
        volume = make_resin_volume({8 * blocks, 4 * blocks, 240}, j750, [&](int x, int y, int z) -> int {
            if (z < 220) return 5;
            return RandomStream(5, std::uint64_t((z * 997 + y) * 991 + x)).uniform() < 0.5 ? 1 + (x / 5 + y / 3) % 4
                                                                                           : 5;
        });
        const Scene scene{&volume, &set, Backing::black, Sides::mirrored};
        const BlockLattice lattice(volume.size(), viewing_cell);
        const Surface top = find_surface(scene, viewing_cell, SurfacePart::top);
        grid = make_viewing_grid(scene, viewing_cell, {0.2}, {}, {{}, lattice.blocks, {}}, &top);
        RandomStream random(9, 2);
        D.assign(grid.mixtures.size(), 0.0f);
        for (std::size_t m = 1; m < D.size(); ++m) D[m] = float(0.3 * std::pow(contrast, -random.uniform()));
        core_D.assign(set.resins.size() + 1, 0.3f);
        const double edge = 0.083;
        cell_loss.assign(grid.cells(), float(loss * 0.3 * edge));
        core_loss.assign(grid.core_block.size(), float(64 * loss * 0.3 * edge));
        // Light leaves through the top.
        for (const std::uint32_t f : grid.open_faces)
            if (grid.faces[f].kind == FaceKind::light) cell_loss[grid.faces[f].cell] += float(0.2 * edge * edge);
        stencils.resize(grid.transport_blocks.size());
    }
    [[nodiscard]] Values zeros() const {
        return {std::vector<float>(grid.cells()), std::vector<float>(grid.core_block.size())};
    }
    [[nodiscard]] Values anything(std::uint64_t seed) const {
        Values values = zeros();
        RandomStream random(seed, 3);
        for (float& v : values.cells) v = float(random.uniform());
        for (float& v : values.core) v = float(random.uniform());
        for (std::size_t i = 0; i < values.cells.size(); ++i)
            if (grid.medium[i] == 0) values.cells[i] = 0;
        return values;
    }
};

double dot(const Values& a, const Values& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.cells.size(); ++i) sum += double(a.cells[i]) * double(b.cells[i]);
    for (std::size_t i = 0; i < a.core.size(); ++i) sum += double(a.core[i]) * double(b.core[i]);
    return sum;
}

struct Solved {
    int steps = 0;
    double residual = 0;  ///< / that of 0
    Values x;
};

Solved solve(Problem& problem, double tolerance, std::size_t threads = 0) {
    const ThreadLimit limit(threads);
    ViewingDiffusion diffusion(problem.grid);
    diffusion.prepare(problem.D, problem.core_D, problem.cell_loss, problem.core_loss, problem.stencils);
    Values b = problem.anything(1), p = problem.zeros(), z = problem.zeros();
    Solved solved{0, 0, problem.zeros()};
    Values residual = b;
    solved.steps = diffusion.solve(solved.x.span(), residual.span(), p.span(), z.span(), tolerance, 100);
    Values Ax = problem.zeros();
    diffusion.apply(solved.x.span(), Ax.span());
    for (std::size_t i = 0; i < Ax.cells.size(); ++i) Ax.cells[i] -= b.cells[i];
    for (std::size_t i = 0; i < Ax.core.size(); ++i) Ax.core[i] -= b.core[i];
    solved.residual = std::sqrt(dot(Ax, Ax) / dot(b, b));
    return solved;
}

/// The number that stands before these words in the comments of a header.
int told(const std::string& header, const std::string& words) {
    std::ifstream file(test::source_dir() + "/optics/transport/" + header);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const std::size_t at = text.find(words);
    REQUIRE((at != std::string::npos && at > 0));
    return std::stoi(text.substr(text.find_last_not_of("0123456789", at - 1) + 1));
}

}  // namespace

TEST_CASE("The equations of diffusion are symmetric and lose what is lost") {
    Problem problem(3, 100, 0.01);
    ViewingDiffusion diffusion(problem.grid);
    diffusion.prepare(problem.D, problem.core_D, problem.cell_loss, problem.core_loss, problem.stencils);
    REQUIRE(problem.grid.core_block.size() > 10);
    Values u = problem.anything(1), v = problem.anything(2), Au = problem.zeros(), Av = problem.zeros();
    diffusion.apply(u.span(), Au.span());
    diffusion.apply(v.span(), Av.span());
    CHECK(dot(u, Av) == Approx(dot(v, Au)).epsilon(1e-5));
    CHECK(dot(u, Au) > 0);
    // Where phi is the same everywhere nothing flows.
    Values one = problem.anything(3);
    for (float& value : one.cells) value = value > 0 ? 1.0f : 0.0f;
    for (float& value : one.core) value = 1;
    diffusion.apply(one.span(), Au.span());
    double lost = 0, all = 0;
    for (std::size_t i = 0; i < Au.cells.size(); ++i) {
        if (problem.grid.medium[i] == 0) continue;
        lost = std::max(lost, double(std::abs(Au.cells[i] - problem.cell_loss[i])));
        all = std::max(all, double(problem.cell_loss[i]));
    }
    for (std::size_t i = 0; i < Au.core.size(); ++i)
        lost = std::max(lost, double(std::abs(Au.core[i] - problem.core_loss[i])));
    CHECK(lost < 1e-3 * all);
}

TEST_CASE("Diffusion is solved in few steps, whatever the media are and however many the cells") {
    for (const double contrast : {1.0, 10.0, 100.0})
        for (const double loss : {1e-4, 1e-1}) {
            Problem few(2, contrast, loss), many(8, contrast, loss);
            const Solved small = solve(few, 1e-4), large = solve(many, 1e-4);
            INFO("contrast " << contrast << ", loss " << loss << ": " << small.steps << " and " << large.steps
                             << " steps, residual " << large.residual);
            // Of floats: where little is lost x is a thousand times what flows, and rounded so.
            const double rounded = loss < 1e-3 ? 3e-3 : 4e-4;
            CHECK(small.residual < rounded);
            CHECK(large.residual < rounded);
            CHECK(small.steps <= 10);
            CHECK(large.steps <= 12);
        }
}

TEST_CASE("The solution of diffusion is the same bits for any number of threads") {
    Problem problem(5, 30, 0.01);
    const Solved one = solve(problem, 1e-4, 1), four = solve(problem, 1e-4, 4);
    CHECK(one.steps == four.steps);
    CHECK((one.x.cells == four.x.cells && one.x.core == four.x.core));
}

TEST_CASE("Headers tell the memory of a viewing cell as it is") {
    constexpr std::size_t vectors = 4;  // x, residual, p, z
    CHECK(told("viewing_diffusion.h", " bytes a cell, lent") ==
          int(sizeof(BlockStencil<4>) / 64 + vectors * sizeof(float)));
    SweepScratch scratch;
    scratch.resize(64);
    CHECK(told("sweep_scratch.h", " bytes a cell") == int(scratch.memory_bytes() / 64));
    CHECK(told("viewing_sequence.h", " bytes a viewing cell") == int(sizeof(ViewingField::BlockCode) / 64));
    CHECK(told("viewing_sequence.h", " an open") == int(sizeof(ViewingField::FaceCode)));
}
