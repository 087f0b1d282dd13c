// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/viewing_diffusion.h"

#include <algorithm>
#include <utility>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/numerics/lanes.h"
#include "optics/numerics/prefetch.h"

namespace voxtone::optics {
namespace {

constexpr std::size_t stencils_per_task = 64;

void check_cancelled(const Progress* progress) {
    if (progress) progress->check_cancelled();
}

/// Place in a block of n^3 of the (i, j)-th cell along side f; i runs along the first of the two other axes.
template <int n>
constexpr int on_side(std::size_t f, int i, int j) {
    const int end = f % 2 ? n - 1 : 0;
    switch (f / 2) {
        case 0:
            return (j * n + i) * n + end;
        case 1:
            return (j * n + end) * n + i;
        default:
            return (end * n + j) * n + i;
    }
}

}  // namespace

template <int n>
struct ViewingDiffusion::Level {
    std::span<const BlockStencil<n>> block;
    std::span<const LowSides<n>> low;
    std::span<const float> side;  ///< n * n conductances a side towards the core
};

namespace {

/// A block's values with those around it.
template <int n>
struct Patch {
    static constexpr int m = n + 2;
    float x[m * m * m];
};

/// The ring of values beyond side f.
template <int n, std::size_t f, class CellValue, class CoreValue>
void gather_side(Patch<n>& patch, std::int32_t neighbour, std::int32_t side_of,
                 std::span<const ViewingDiffusion::CoreSide> sides, const CellValue& of_cell,
                 const CoreValue& of_core) {
    constexpr int m = n + 2, all = n * n * n;
    constexpr int u = f / 2 == 0 ? m : 1, v = f / 2 == 2 ? m : m * m,
                  out = f / 2 == 0   ? 1
                        : f / 2 == 1 ? m
                                     : m * m;  // steps in the patch
    float* const to = patch.x + 1 + m + m * m + (f % 2 ? n * out : -out);
    if (neighbour >= 0) {
        const std::size_t first = static_cast<std::size_t>(neighbour) * all;
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i)
                to[j * v + i * u] = of_cell(first + static_cast<std::size_t>(on_side<n>(f ^ 1, i, j)));
    } else {
        const float value = side_of >= 0 ? of_core(sides[static_cast<std::size_t>(side_of)].core) : 0;
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) to[j * v + i * u] = value;
    }
}

/// Values of block t's cells in the middle of (n + 2)^3, those of its neighbours' cells around: what the block borders
/// on, 0 where there is nothing. Edges and corners are left as they are.
template <int n, class CellValue, class CoreValue>
void gather(Patch<n>& patch, std::size_t t, const std::array<std::int32_t, 6>& neighbour,
            const std::array<std::int32_t, 6>& side_of, std::span<const ViewingDiffusion::CoreSide> sides,
            const CellValue& of_cell, const CoreValue& of_core) {
    constexpr int m = n + 2, all = n * n * n;
    for (int k = 0; k < n; ++k)
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i)
                patch.x[((k + 1) * m + j + 1) * m + i + 1] =
                    of_cell(t * all + static_cast<std::size_t>((k * n + j) * n + i));
    gather_side<n, 0>(patch, neighbour[0], side_of[0], sides, of_cell, of_core);
    gather_side<n, 1>(patch, neighbour[1], side_of[1], sides, of_cell, of_core);
    gather_side<n, 2>(patch, neighbour[2], side_of[2], sides, of_cell, of_core);
    gather_side<n, 3>(patch, neighbour[3], side_of[3], sides, of_cell, of_core);
    gather_side<n, 4>(patch, neighbour[4], side_of[4], sides, of_cell, of_core);
    gather_side<n, 5>(patch, neighbour[5], side_of[5], sides, of_cell, of_core);
}

struct At {
    const float* values;
    float operator()(std::size_t i) const { return values[i]; }
};

/// 1 where it is not above 0.
template <class V>
V safe(const V& v) {
    return v > 0 ? v : V{} + 1.0f;
}

/// A row of n cells of a block along x, and what it borders on.
template <int n>
struct Row {
    static constexpr int m = n + 2;
    using V = FloatLanes<n>;
    int at;  ///< its first cell
    V x, y, z, low_x, low_y, low_z, inverse;
    /// The row (j, k).
    template <class Low>
    Row(const BlockStencil<n>& s, const Low& low, int j, int k)
        : at((k * n + j) * n),
          x(load_lanes<n>(s.x + at)),
          y(load_lanes<n>(s.y + at)),
          z(load_lanes<n>(s.z + at)),
          low_x(V{} + low.x[k * n + j]),
          low_y(load_lanes<n>(j > 0 ? s.y + at - n : low.y + k * n)),
          low_z(load_lanes<n>(k > 0 ? s.z + at - n * n : low.z + j * n)),
          inverse(load_lanes<n>(s.inverse + at)) {
        if constexpr (n == 4)
            low_x = __builtin_shuffle(low_x, x, IntLanes<4>{0, 4, 5, 6});
        else
            low_x[1] = x[0];
    }
    /// What flows in from the neighbours along y and z; `here`: the row's values in a patch.
    [[nodiscard]] V across(const float* here) const {
        return low_y * load_lanes<n>(here - m) + y * load_lanes<n>(here + m) + low_z * load_lanes<n>(here - m * m) +
               z * load_lanes<n>(here + m * m);
    }
    [[nodiscard]] V along(const float* here) const {
        return low_x * load_lanes<n>(here - 1) + x * load_lanes<n>(here + 1);
    }
    /// A x, where there is an equation.
    [[nodiscard]] V apply(const float* here) const {
        const V value = load_lanes<n>(here) / safe(inverse) - (across(here) + along(here));
        return inverse > 0 ? value : V{};
    }
};

template <int n>
float* row_of(Patch<n>& patch, int j, int k) {
    constexpr int m = n + 2;
    return patch.x + ((k + 1) * m + j + 1) * m + 1;
}

/// cell_contact of four cells and those a step further.
FloatLanes<4> contacts(float k, const float* D, int step) {
    const FloatLanes<4> D1 = load_lanes<4>(D), D2 = load_lanes<4>(D + step);
    return k * D1 * D2 / safe(D1 + D2);
}

template <int n, class Low>
void find_diagonal(BlockStencil<n>& block, const Low& low, const float* loss) {
    for (int k = 0; k < n; ++k)
        for (int j = 0; j < n; ++j) {
            const Row<n> row(block, low, j, k);
            const FloatLanes<n> sum =
                load_lanes<n>(loss + row.at) + row.low_x + row.x + row.low_y + row.y + row.low_z + row.z;
            put(sum > 0 ? 1.0f / safe(sum) : FloatLanes<n>{}, block.inverse + row.at);
        }
}

}  // namespace

ViewingDiffusion::ViewingDiffusion(const ViewingGrid& grid) : grid_(grid) {
    for (std::size_t a = 0; a < 3; ++a) {
        // c = A / (h / 2 / D1 + h / 2 / D2) = (2 A / h) D1 D2 / (D1 + D2)
        const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
        const auto edge = grid.edge_mm();
        k_[a] = static_cast<float>(2 * edge[b] * edge[c] / edge[a]);
    }
    const std::size_t n = grid.transport_blocks.size();
    neighbour_.resize(n);
    side_of_.resize(n);
    std::vector<MultigridPlan::Contact> pairs;
    for (std::size_t t = 0; t < n; ++t) {
        const GridBlock& block = grid.transport_block(t);
        parity_[static_cast<std::size_t>((block.at[0] + block.at[1] + block.at[2]) & 1)].push_back(
            static_cast<std::uint32_t>(t));
        for (std::size_t f = 0; f < 6; ++f) {
            neighbour_[t][f] = side_of_[t][f] = -1;
            if (block.neighbour[f] < 0) continue;
            const GridBlock& other = grid.blocks[static_cast<std::size_t>(block.neighbour[f])];
            if (other.kind == BlockKind::transport) {
                neighbour_[t][f] = static_cast<std::int32_t>(other.first_cell / 64);
                if (f % 2 == 1) pairs.push_back({static_cast<std::uint32_t>(t), other.first_cell / 64});
            } else {
                side_of_[t][f] = static_cast<std::int32_t>(sides_.size());
                sides_.push_back({static_cast<std::uint32_t>(t), other.core_node, static_cast<std::uint8_t>(f)});
            }
        }
    }
    const auto blocks = static_cast<std::uint32_t>(n);
    for (const CoreSide& side : sides_) pairs.push_back({side.block, blocks + side.core});
    for (const std::uint32_t b : grid.core_block)
        for (std::size_t a = 0; a < 3; ++a) {
            const std::int32_t other = grid_.blocks[b].neighbour[2 * a + 1];
            if (other < 0 || grid_.blocks[static_cast<std::size_t>(other)].kind != BlockKind::core) continue;
            contacts_.push_back({grid_.blocks[b].core_node, grid_.blocks[static_cast<std::size_t>(other)].core_node,
                                 static_cast<std::uint8_t>(a)});
            pairs.push_back({blocks + contacts_.back().a, blocks + contacts_.back().b});
        }
    std::vector<std::array<float, 3>> centre;
    centre.reserve(n + grid.core_block.size());
    const auto middle = [&](std::uint32_t b) {
        const auto& at = grid_.blocks[b].at;
        return std::array<float, 3>{static_cast<float>(at[0]) + 0.5f, static_cast<float>(at[1]) + 0.5f,
                                    static_cast<float>(at[2]) + 0.5f};
    };
    for (const std::uint32_t b : grid.transport_blocks) centre.push_back(middle(b));
    for (const std::uint32_t b : grid.core_block) centre.push_back(middle(b));
    plan_ = std::make_unique<MultigridPlan>(std::move(centre), pairs);
    middle_.resize(n);
    fine_low_.resize(n);
    middle_low_.resize(n);
    x1_.resize(8 * n);
    b1_.resize(8 * n);
    fine_side_.resize(16 * sides_.size());
    middle_side_.resize(4 * sides_.size());
    middle_loss_.resize(8 * n);
    const std::size_t cores = grid.core_block.size();
    core_conductance_.resize(contacts_.size());
    core_x1_.resize(cores);
    core_b1_.resize(cores);
    x2_.resize(n + cores);
    b2_.resize(n + cores);
}

void ViewingDiffusion::prepare(std::span<const float> D_of_medium, std::span<const float> D_of_core,
                               std::span<const float> cell_loss, std::span<const float> core_loss,
                               std::span<BlockStencil<4>> blocks, const Progress* progress) {
    VOXTONE_EXPECT(blocks.size() == neighbour_.size());
    make_fine(D_of_medium, D_of_core, cell_loss, blocks);
    check_cancelled(progress);
    fine_ = blocks;
    make_middle(cell_loss);
    close_middle();
    check_cancelled(progress);
    make_coarse(D_of_core, core_loss);
}

/// Equations of the cells.
void ViewingDiffusion::make_fine(std::span<const float> D_of_medium, std::span<const float> D_of_core,
                                 std::span<const float> cell_loss, std::span<BlockStencil<4>> blocks) {
    const auto D_at = [&](std::size_t cell) { return D_of_medium[grid_.medium[cell]]; };
    const auto core_D = [&](std::uint32_t core) { return D_of_core[grid_.core_medium[core]]; };
    parallel_for(0, neighbour_.size(), stencils_per_task, [&](std::size_t t) {
        constexpr int m = 6;
        Patch<4> D;
        gather<4>(D, t, neighbour_[t], side_of_[t], sides_, D_at, [](std::uint32_t) { return 0.0f; });
        BlockStencil<4>& block = blocks[t];
        LowSides<4>& low = fine_low_[t];
        for (int k = 0; k < 4; ++k)
            for (int j = 0; j < 4; ++j) {
                const float* const here = row_of(D, j, k);
                const int row = (k * 4 + j) * 4;
                put(contacts(k_[0], here, 1), block.x + row);
                put(contacts(k_[1], here, m), block.y + row);
                put(contacts(k_[2], here, m * m), block.z + row);
                low.x[k * 4 + j] = cell_contact(0, here[-1], here[0]);
                if (j == 0) put(contacts(k_[1], here - m, m), low.y + k * 4);
                if (k == 0) put(contacts(k_[2], here - m * m, m * m), low.z + j * 4);
            }
        for (std::size_t f = 0; f < 6; ++f) {
            const std::int32_t s = side_of_[t][f];
            if (s < 0) continue;
            float* const side = fine_side_.data() + 16 * static_cast<std::size_t>(s);
            const float beyond = core_D(sides_[static_cast<std::size_t>(s)].core);
            float* const own[3] = {block.x, block.y, block.z};
            float* const lower[3] = {low.x, low.y, low.z};
            for (int j = 0; j < 4; ++j)
                for (int i = 0; i < 4; ++i) {
                    const int place = on_side<4>(f, i, j);
                    side[4 * j + i] = side_contact(f / 2, D_at(64 * t + static_cast<std::size_t>(place)), beyond);
                    if (f % 2)
                        own[f / 2][place] = side[4 * j + i];
                    else
                        lower[f / 2][4 * j + i] = side[4 * j + i];
                }
        }
        find_diagonal<4>(block, low, cell_loss.data() + 64 * t);
    });
}

/// Eight nodes a block: sums of conductances times the ratio of the distances, towards +x, +y, +z and the core.
void ViewingDiffusion::make_middle(std::span<const float> cell_loss) {
    parallel_for(0, neighbour_.size(), stencils_per_task, [&](std::size_t t) {
        const BlockStencil<4>& cells = fine_[t];
        BlockStencil<2>& to = middle_[t];
        for (int k = 0; k < 2; ++k)
            for (int j = 0; j < 2; ++j)
                for (int i = 0; i < 2; ++i) {
                    float x = 0, y = 0, z = 0, loss = 0;
                    for (int c = 0; c < 2; ++c)
                        for (int b = 0; b < 2; ++b)
                            for (int a = 0; a < 2; ++a) {
                                const int at = ((2 * k + c) * 4 + 2 * j + b) * 4 + 2 * i + a;
                                loss += cell_loss[64 * t + static_cast<std::size_t>(at)];
                                if (a == 1) x += cells.x[at];
                                if (b == 1) y += cells.y[at];
                                if (c == 1) z += cells.z[at];
                            }
                    const auto ratio = [&](std::size_t axis, bool last) {
                        return last && side_of_[t][2 * axis + 1] >= 0 ? 2.5f / 3 : 0.5f;
                    };
                    const int at = (k * 2 + j) * 2 + i;
                    to.x[at] = x * ratio(0, i == 1);
                    to.y[at] = y * ratio(1, j == 1);
                    to.z[at] = z * ratio(2, k == 1);
                    middle_loss_[8 * t + static_cast<std::size_t>(at)] = loss;
                }
    });
    for (std::size_t s = 0; s < sides_.size(); ++s)
        for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 2; ++i) {
                float sum = 0;
                for (int b = 0; b < 2; ++b)
                    for (int a = 0; a < 2; ++a)
                        sum += fine_side_[16 * s + static_cast<std::size_t>(4 * (2 * j + b) + 2 * i + a)];
                middle_side_[4 * s + static_cast<std::size_t>(2 * j + i)] = sum * (2.5f / 3);
            }
}

/// Their conductances towards -x, -y, -z, from the neighbours, and their diagonal.
void ViewingDiffusion::close_middle() {
    parallel_for(0, neighbour_.size(), stencils_per_task, [&](std::size_t t) {
        LowSides<2>& low = middle_low_[t];
        const auto take = [&](std::size_t f, float* to, auto of_block) {
            for (int j = 0; j < 2; ++j)
                for (int i = 0; i < 2; ++i)
                    to[2 * j + i] =
                        neighbour_[t][f] >= 0
                            ? of_block(middle_[static_cast<std::size_t>(neighbour_[t][f])])[on_side<2>(f ^ 1, i, j)]
                        : side_of_[t][f] >= 0 ? middle_side_[4 * static_cast<std::size_t>(side_of_[t][f]) +
                                                             static_cast<std::size_t>(2 * j + i)]
                                              : 0;
        };
        take(0, low.x, [](const BlockStencil<2>& b) { return b.x; });
        take(2, low.y, [](const BlockStencil<2>& b) { return b.y; });
        take(4, low.z, [](const BlockStencil<2>& b) { return b.z; });
        find_diagonal<2>(middle_[t], low, middle_loss_.data() + 8 * t);
    });
}

/// One node a block, and those of the core.
void ViewingDiffusion::make_coarse(std::span<const float> D_of_core, std::span<const float> core_loss) {
    const std::size_t n = neighbour_.size();
    const auto core_D = [&](std::uint32_t core) { return D_of_core[grid_.core_medium[core]]; };
    std::vector<float> conductance, loss(n + core_loss.size());
    for (std::size_t t = 0; t < n; ++t) {
        for (std::size_t i = 0; i < 8; ++i) loss[t] += middle_loss_[8 * t + i];
        for (std::size_t f = 1; f < 6; f += 2) {
            if (neighbour_[t][f] < 0) continue;
            float sum = 0;
            for (int j = 0; j < 2; ++j)
                for (int i = 0; i < 2; ++i) {
                    const int at = on_side<2>(f, i, j);
                    sum += f == 1 ? middle_[t].x[at] : f == 3 ? middle_[t].y[at] : middle_[t].z[at];
                }
            conductance.push_back(0.5f * sum);
        }
    }
    for (std::size_t s = 0; s < sides_.size(); ++s) {
        float sum = 0;
        for (std::size_t i = 0; i < 4; ++i) sum += middle_side_[4 * s + i];
        conductance.push_back(0.75f * sum);
    }
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        core_conductance_[i] = core_contact(contacts_[i].axis, core_D(contacts_[i].a), core_D(contacts_[i].b));
        conductance.push_back(core_conductance_[i]);
    }
    core_loss_.assign(core_loss.begin(), core_loss.end());
    std::copy(core_loss.begin(), core_loss.end(), loss.begin() + static_cast<std::ptrdiff_t>(n));
    blocks_ = std::make_unique<Multigrid>(*plan_, conductance, loss);
}

template <int n>
void ViewingDiffusion::relax(const Level<n>& level, std::span<const float> b, std::span<float> x,
                             std::span<const float> core_x, bool back) const {
    constexpr int all = n * n * n;
    using OneRow = Row<n>;
    const At values{x.data()}, core_values{core_x.data()};
    for (const std::size_t turn : {std::size_t{0}, std::size_t{1}}) {
        const auto& list = parity_[back ? 1 - turn : turn];
        parallel_for(0, list.size(), stencils_per_task, [&](std::size_t i_list) {
            const std::size_t t = list[i_list];
            if (i_list + 1 < list.size()) {
                const std::size_t next = list[i_list + 1];  // those of one parity do not lie side by side
                prefetch(level.block[next]);
                prefetch(level.low[next]);
                prefetch(b.data() + next * all, all * sizeof(float));
                prefetch(x.data() + next * all, all * sizeof(float));
                for (std::size_t f = 2; f < 6; ++f)
                    if (neighbour_[next][f] >= 0)
                        prefetch(x.data() + static_cast<std::size_t>(neighbour_[next][f]) * all, all * sizeof(float));
            }
            Patch<n> patch;
            gather<n>(patch, t, neighbour_[t], side_of_[t], sides_, values, core_values);
            const float* const right = b.data() + t * all;
            const auto one = [&](int j, int k) {
                const OneRow row(level.block[t], level.low[t], j, k);
                float* const here = row_of(patch, j, k);
                // The way along the row, where each cell waits for the one before, is one multiplication and one
                // addition long.
                const FloatLanes<n> known =
                    (load_lanes<n>(right + row.at) + row.across(here) +
                     (back ? row.low_x * load_lanes<n>(here - 1) : row.x * load_lanes<n>(here + 1))) *
                    row.inverse;
                const FloatLanes<n> pass = (back ? row.x : row.low_x) * row.inverse;
                FloatLanes<n> now;
                float last = back ? here[n] : here[-1];
                if (back)
                    for (int i = n; i-- > 0;) now[i] = last = known[i] + pass[i] * last;
                else
                    for (int i = 0; i < n; ++i) now[i] = last = known[i] + pass[i] * last;
                put(now, here);
            };
            if (back) {
                for (int k = n; k-- > 0;)
                    for (int j = n; j-- > 0;) one(j, k);
            } else {
                for (int k = 0; k < n; ++k)
                    for (int j = 0; j < n; ++j) one(j, k);
            }
            float* const out = x.data() + t * all;
            for (int k = 0; k < n; ++k)
                for (int j = 0; j < n; ++j)
                    for (int i = 0; i < n; ++i) out[(k * n + j) * n + i] = row_of(patch, j, k)[i];
        });
    }
}

/// Calls body(core node, flow out of it) for every contact of a core node.
template <int n, class Body>
void ViewingDiffusion::for_core_flows(const Level<n>& level, std::span<const float> x, std::span<const float> core_x,
                                      Body&& body) const {
    constexpr int all = n * n * n;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const CoreContact& c = contacts_[i];
        const float flow = core_conductance_[i] * (core_x[c.a] - core_x[c.b]);
        body(c.a, flow);
        body(c.b, -flow);
    }
    for (std::size_t i = 0; i < sides_.size(); ++i) {
        const CoreSide& side = sides_[i];
        float sum = 0;
        for (int v = 0; v < n; ++v)
            for (int u = 0; u < n; ++u)
                sum += level.side[i * n * n + static_cast<std::size_t>(v * n + u)] *
                       (x[std::size_t{side.block} * all + static_cast<std::size_t>(on_side<n>(side.facing, u, v))] -
                        core_x[side.core]);
        body(side.core, -sum);
    }
}

/// Residuals, summed over 2 x 2 x 2 cells.
template <int n>
void ViewingDiffusion::restrict_to(const Level<n>& level, std::span<const float> b, std::span<const float> x,
                                   std::span<const float> core_x, std::span<const float> core_b,
                                   std::span<float> coarse_b, std::span<float> coarse_core_b) const {
    constexpr int all = n * n * n, half = n / 2;
    const At values{x.data()}, core_values{core_x.data()};
    parallel_for(0, neighbour_.size(), stencils_per_task, [&](std::size_t t) {
        Patch<n> patch;
        gather<n>(patch, t, neighbour_[t], side_of_[t], sides_, values, core_values);
        const float* const right = b.data() + t * all;
        float sum[half * half * half] = {};
        for (int k = 0; k < n; ++k)
            for (int j = 0; j < n; ++j) {
                const Row<n> row(level.block[t], level.low[t], j, k);
                const float* const here = row_of(patch, j, k);
                const FloatLanes<n> r =
                    (row.inverse > 0 ? load_lanes<n>(right + row.at) : FloatLanes<n>{}) - row.apply(here);
                for (int i = 0; i < n; ++i) sum[((k / 2) * half + j / 2) * half + i / 2] += r[i];
            }
        for (int i = 0; i < half * half * half; ++i)
            coarse_b[t * half * half * half + static_cast<std::size_t>(i)] = sum[i];
    });
    for (std::size_t i = 0; i < core_b.size(); ++i) coarse_core_b[i] = core_b[i] - core_loss_[i] * core_x[i];
    for_core_flows(level, x, core_x, [&](std::uint32_t core, float flow) { coarse_core_b[core] -= flow; });
}

void ViewingDiffusion::cycle(Vector b, Vector x, const Progress* progress) {
    const Level<4> fine{fine_, fine_low_, fine_side_};
    const Level<2> middle{middle_, middle_low_, middle_side_};
    const std::size_t n = neighbour_.size(), cores = b.core.size();
    std::fill(x.cells.begin(), x.cells.end(), 0.0f);
    std::fill(x.core.begin(), x.core.end(), 0.0f);
    relax(fine, b.cells, x.cells, x.core, false);
    check_cancelled(progress);
    restrict_to(fine, b.cells, x.cells, x.core, b.core, b1_, core_b1_);
    std::fill(x1_.begin(), x1_.end(), 0.0f);
    std::fill(core_x1_.begin(), core_x1_.end(), 0.0f);
    relax(middle, std::span<const float>(b1_), x1_, core_x1_, false);
    restrict_to(middle, std::span<const float>(b1_), x1_, core_x1_, core_b1_, std::span(b2_).first(n),
                std::span(b2_).subspan(n));
    check_cancelled(progress);
    blocks_->cycle(b2_, x2_, progress);
    for (std::size_t i = 0; i < cores; ++i) core_x1_[i] = x2_[n + i];
    parallel_for(0, n, stencils_per_task, [&](std::size_t t) {
        for (std::size_t i = 0; i < 8; ++i) x1_[8 * t + i] += middle_[t].inverse[i] > 0 ? x2_[t] : 0;
    });
    relax(middle, std::span<const float>(b1_), x1_, core_x1_, true);
    check_cancelled(progress);
    std::copy(core_x1_.begin(), core_x1_.end(), x.core.begin());
    parallel_for(0, n, stencils_per_task, [&](std::size_t t) {
        for (std::size_t row = 0; row < 16; ++row) {
            const float* const from = x1_.data() + 8 * t + (row / 8 * 2 + row / 2 % 2) * 2;
            const FloatLanes<4> more{from[0], from[0], from[1], from[1]};
            float* const to = x.cells.data() + 64 * t + 4 * row;
            put(load_lanes<4>(to) + (load_lanes<4>(fine_[t].inverse + 4 * row) > 0 ? more : FloatLanes<4>{}), to);
        }
    });
    relax(fine, b.cells, x.cells, x.core, true);
}

void ViewingDiffusion::apply(Vector x, Vector out) const {
    constexpr int n = 4, all = n * n * n;
    const Level<4> fine{fine_, fine_low_, fine_side_};
    parallel_for(0, neighbour_.size(), stencils_per_task, [&](std::size_t t) {
        Patch<n> patch;
        gather<n>(patch, t, neighbour_[t], side_of_[t], sides_, At{x.cells.data()}, At{x.core.data()});
        float* const to = out.cells.data() + t * all;
        for (int k = 0; k < n; ++k)
            for (int j = 0; j < n; ++j) {
                const Row<n> row(fine.block[t], fine.low[t], j, k);
                const float* const here = row_of(patch, j, k);
                put(row.apply(here), to + row.at);
            }
    });
    for (std::size_t i = 0; i < x.core.size(); ++i) out.core[i] = core_loss_[i] * x.core[i];
    for_core_flows(fine, x.cells, x.core, [&](std::uint32_t core, float flow) { out.core[core] += flow; });
}

ViewingDiffusion::Flows ViewingDiffusion::flows(std::size_t t, std::span<const float> D_of_medium,
                                                std::span<const float> D_of_core, Vector x) const {
    constexpr int m = 6;
    Patch<4> D, value;
    gather<4>(
        D, t, neighbour_[t], side_of_[t], sides_, [&](std::size_t cell) { return D_of_medium[grid_.medium[cell]]; },
        [](std::uint32_t) { return 0.0f; });
    gather<4>(value, t, neighbour_[t], side_of_[t], sides_, At{x.cells.data()}, At{x.core.data()});
    Flows sum;
    for (int k = 0; k < 4; ++k)
        for (int j = 0; j < 4; ++j) {
            const float *const d = row_of(D, j, k), *const v = row_of(value, j, k);
            const int row = (k * 4 + j) * 4;
            const auto flow = [&](std::size_t axis, int step, int from) {
                return contacts(k_[axis], d + from, step) * (load_lanes<4>(v + from) - load_lanes<4>(v + from + step));
            };
            put(flow(0, 1, -1) + flow(0, 1, 0), sum[0].data() + row);
            put(flow(1, m, -m) + flow(1, m, 0), sum[1].data() + row);
            put(flow(2, m * m, -m * m) + flow(2, m * m, 0), sum[2].data() + row);
        }
    for (std::size_t f = 0; f < 6; ++f) {
        if (side_of_[t][f] < 0) continue;
        const std::uint32_t core = sides_[static_cast<std::size_t>(side_of_[t][f])].core;
        const float beyond = D_of_core[grid_.core_medium[core]], sign = f % 2 ? 1.0f : -1.0f;
        for (int j = 0; j < 4; ++j)
            for (int i = 0; i < 4; ++i) {
                const auto place = static_cast<std::size_t>(on_side<4>(f, i, j)), cell = 64 * t + place;
                sum[f / 2][place] += sign * (side_contact(f / 2, D_of_medium[grid_.medium[cell]], beyond) *
                                             (x.cells[cell] - x.core[core]));
            }
    }
    return sum;
}

namespace {

/// Sums of fixed ranges, then the ranges in order: the same bits for any number of threads.
double dot(const ViewingDiffusion::Vector& a, const ViewingDiffusion::Vector& b) {
    constexpr std::size_t range = 1 << 14;
    const auto n = a.cells.size();
    std::vector<double> part((n + range - 1) / range, 0.0);
    parallel_for(0, part.size(), 1, [&](std::size_t r) {
        double sum = 0;
        for (std::size_t i = r * range; i < std::min(n, (r + 1) * range); ++i)
            sum += static_cast<double>(a.cells[i] * b.cells[i]);
        part[r] = sum;
    });
    double sum = 0;
    for (const double p : part) sum += p;
    for (std::size_t i = 0; i < a.core.size(); ++i) sum += static_cast<double>(a.core[i] * b.core[i]);
    return sum;
}

/// to = a * to + b * from
void combine(const ViewingDiffusion::Vector& to, float a, float b, const ViewingDiffusion::Vector& from) {
    parallel_ranges(0, to.cells.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) to.cells[i] = a * to.cells[i] + b * from.cells[i];
    });
    for (std::size_t i = 0; i < to.core.size(); ++i) to.core[i] = a * to.core[i] + b * from.core[i];
}

}  // namespace

int ViewingDiffusion::solve(Vector x, Vector residual, Vector p, Vector z, double tolerance, int most_steps,
                            const Progress* progress) {
    double start = 0, rho = 0;
    int step = 0;
    for (; step < most_steps; ++step) {
        check_cancelled(progress);
        cycle(residual, z, progress);
        const double rho_new = dot(residual, z);
        if (step == 0) start = rho_new;
        if (!(rho_new > tolerance * tolerance * start)) break;
        if (step == 0) {
            std::swap(p, z);
        } else {
            combine(p, static_cast<float>(rho_new / rho), 1, z);
        }
        rho = rho_new;
        apply(p, z);
        const auto alpha = static_cast<float>(rho / dot(p, z));
        combine(x, 1, alpha, p);
        if (step + 1 == most_steps) return most_steps;  // nobody asks for the residual
        combine(residual, 1, -alpha, z);
    }
    return step;
}

std::size_t ViewingDiffusion::memory_bytes() const {
    const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    return of(neighbour_) + of(side_of_) + of(parity_[0]) + of(parity_[1]) + of(sides_) + of(contacts_) + of(middle_) +
           of(fine_low_) + of(middle_low_) + of(fine_side_) + of(middle_side_) + of(core_conductance_) +
           of(core_loss_) + of(middle_loss_) + of(x1_) + of(b1_) + of(core_x1_) + of(core_b1_) + of(x2_) + of(b2_) +
           plan_->memory_bytes() + (blocks_ ? blocks_->memory_bytes() : 0);
}

}  // namespace voxtone::optics
