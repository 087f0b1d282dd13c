// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/viewing_diffusion.h"

#include <algorithm>

#include "voxtone/base/contracts.h"
#include "voxtone/base/parallel.h"

namespace voxtone::optics {
namespace {

constexpr std::size_t grain = 64;  // blocks

/// Place in a block of n^3 of the (i, j)-th cell along side f; i runs along the first of the two other axes.
template <int n>
constexpr int on_side(std::size_t f, int i, int j) {
    const int end = f % 2 ? n - 1 : 0;
    switch (f / 2) {
        case 0: return (j * n + i) * n + end;
        case 1: return (j * n + end) * n + i;
        default: return (end * n + j) * n + i;
    }
}

}  // namespace

template <int n>
struct ViewingDiffusion::Level {
    static constexpr int cells = n * n * n;
    std::span<const CellStencil> stencil;
    std::span<const float> side;  ///< n * n conductances a side towards the core
};

namespace {

/// A block with the values and conductances of its neighbours' cells.
template <int n>
struct Patch {
    static constexpr int m = n + 2;
    float x[m * m * m];
    float cx[n * n * (n + 1)], cy[n * n * (n + 1)], cz[n * n * (n + 1)];
};

}  // namespace

/// Gathers values around block t and the conductances of its faces.
template <int n, class Stencils, class Sides>
static void gather(Patch<n>& patch, std::size_t t, Stencils stencil, Sides side, std::span<const float> x,
                   std::span<const float> core_x, const std::array<std::int32_t, 6>& neighbour,
                   const std::array<std::int32_t, 6>& side_of, std::span<const ViewingDiffusion::CoreSide> sides) {
    constexpr int m = n + 2, all = n * n * n;
    const float* const own = x.data() + t * all;
    const CellStencil* const s = stencil.data() + t * all;
    for (int k = 0; k < n; ++k)
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const int from = (k * n + j) * n + i;
                patch.x[((k + 1) * m + j + 1) * m + i + 1] = own[from];
                patch.cx[(k * n + j) * (n + 1) + i + 1] = s[from].x;
                patch.cy[(k * (n + 1) + j + 1) * n + i] = s[from].y;
                patch.cz[((k + 1) * n + j) * n + i] = s[from].z;
            }
    for (std::size_t f = 0; f < 6; ++f) {
        const int end = f % 2 ? n + 1 : 0;
        const float* values = nullptr;
        const CellStencil* stencils = nullptr;
        const float* conductance = nullptr;
        float core = 0;
        if (neighbour[f] >= 0) {
            values = x.data() + static_cast<std::size_t>(neighbour[f]) * all;
            stencils = stencil.data() + static_cast<std::size_t>(neighbour[f]) * all;
        } else if (side_of[f] >= 0) {
            const auto at = static_cast<std::size_t>(side_of[f]);
            conductance = side.data() + at * n * n;
            core = core_x[sides[at].core];
        }
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const int beyond = on_side<n>(f ^ 1, i, j);
                const float value = values ? values[beyond] : core;
                switch (f / 2) {
                    case 0:
                        patch.x[((j + 1) * m + i + 1) * m + end] = value;
                        if (f == 0) patch.cx[(j * n + i) * (n + 1)] = stencils ? stencils[beyond].x : conductance ? conductance[j * n + i] : 0;
                        break;
                    case 1:
                        patch.x[((j + 1) * m + end) * m + i + 1] = value;
                        if (f == 2) patch.cy[j * (n + 1) * n + i] = stencils ? stencils[beyond].y : conductance ? conductance[j * n + i] : 0;
                        break;
                    default:
                        patch.x[(end * m + j + 1) * m + i + 1] = value;
                        if (f == 4) patch.cz[j * n + i] = stencils ? stencils[beyond].z : conductance ? conductance[j * n + i] : 0;
                        break;
                }
            }
    }
}

ViewingDiffusion::ViewingDiffusion(const ViewingGrid& viewing) : grid_(viewing) {
    const OpticalGrid& grid = viewing.grid;
    for (std::size_t a = 0; a < 3; ++a) {
        // c = A / (h / 2 / D1 + h / 2 / D2) = (2 A / h) D1 D2 / (D1 + D2)
        const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
        const auto edge = grid.edge_mm(BlockKind::skin);
        k_[a] = static_cast<float>(2 * edge[b] * edge[c] / edge[a]);
    }
    const std::size_t n = grid.transport_blocks.size();
    std::vector<std::int32_t> place(grid.blocks.size(), -1);
    for (std::size_t t = 0; t < n; ++t) place[grid.transport_blocks[t]] = static_cast<std::int32_t>(t);
    neighbour_.resize(n);
    side_of_.resize(n);
    std::vector<DiffusionPlan::Contact> pairs;
    for (std::size_t t = 0; t < n; ++t) {
        const GridBlock& block = grid.blocks[grid.transport_blocks[t]];
        parity_[static_cast<std::size_t>((block.at[0] + block.at[1] + block.at[2]) & 1)].push_back(static_cast<std::uint32_t>(t));
        for (std::size_t f = 0; f < 6; ++f) {
            neighbour_[t][f] = side_of_[t][f] = -1;
            if (block.neighbour[f] < 0) continue;
            const auto other = static_cast<std::size_t>(block.neighbour[f]);
            if (place[other] >= 0) {
                neighbour_[t][f] = place[other];
                if (f % 2 == 1) pairs.push_back({static_cast<std::uint32_t>(t), static_cast<std::uint32_t>(place[other])});
            } else {
                side_of_[t][f] = static_cast<std::int32_t>(sides_.size());
                sides_.push_back({static_cast<std::uint32_t>(t), grid.blocks[other].first_node, static_cast<std::uint8_t>(f)});
            }
        }
    }
    const auto blocks = static_cast<std::uint32_t>(n);
    for (const CoreSide& side : sides_) pairs.push_back({side.block, blocks + side.core});
    for (const std::uint32_t b : viewing.core_block)
        for (std::size_t a = 0; a < 3; ++a) {
            const std::int32_t other = grid.blocks[b].neighbour[2 * a + 1];
            if (other < 0 || grid.blocks[static_cast<std::size_t>(other)].kind != BlockKind::core) continue;
            contacts_.push_back({grid.blocks[b].first_node, grid.blocks[static_cast<std::size_t>(other)].first_node, static_cast<std::uint8_t>(a)});
            pairs.push_back({blocks + contacts_.back().a, blocks + contacts_.back().b});
        }
    std::vector<std::array<float, 3>> centre;
    centre.reserve(n + viewing.core_block.size());
    const auto middle = [&](std::uint32_t b) {
        const auto& at = grid.blocks[b].at;
        return std::array<float, 3>{static_cast<float>(at[0]) + 0.5f, static_cast<float>(at[1]) + 0.5f, static_cast<float>(at[2]) + 0.5f};
    };
    for (const std::uint32_t b : grid.transport_blocks) centre.push_back(middle(b));
    for (const std::uint32_t b : viewing.core_block) centre.push_back(middle(b));
    plan_ = std::make_unique<DiffusionPlan>(std::move(centre), pairs);
    middle_.resize(8 * n);
    x1_.resize(8 * n);
    b1_.resize(8 * n);
    fine_side_.resize(16 * sides_.size());
    middle_side_.resize(4 * sides_.size());
    const std::size_t cores = viewing.core_block.size();
    core_conductance_.resize(contacts_.size());
    core_x1_.resize(cores);
    core_b1_.resize(cores);
    x2_.resize(n + cores);
    b2_.resize(n + cores);
}

void ViewingDiffusion::prepare(std::span<const float> D_of_medium, std::span<const float> D_of_core, std::span<const float> cell_loss,
                               std::span<const float> core_loss, std::span<CellStencil> cells) {
    const OpticalGrid& grid = grid_.grid;
    const std::size_t n = grid.transport_blocks.size();
    VOXTONE_EXPECT(cells.size() == 64 * n);
    const auto D_at = [&](std::size_t cell) { return D_of_medium[grid.medium[cell]]; };
    const auto core_D = [&](std::uint32_t core) { return D_of_core[grid.blocks[grid_.core_block[core]].medium]; };
    parallel_for(0, sides_.size(), 256, [&](std::size_t s) {
        const CoreSide& side = sides_[s];
        for (int j = 0; j < 4; ++j)
            for (int i = 0; i < 4; ++i)
                fine_side_[16 * s + static_cast<std::size_t>(4 * j + i)] =
                    side_contact(side.facing / 2u, D_at(64 * std::size_t{side.block} + static_cast<std::size_t>(on_side<4>(side.facing, i, j))), core_D(side.core));
    });
    const auto contact = [&](std::size_t t, std::size_t axis, int place, int step, bool last) -> float {
        const std::size_t cell = 64 * t + static_cast<std::size_t>(place);
        const float D = D_at(cell);
        if (!(D > 0)) return 0;
        if (!last) return cell_contact(axis, D, D_at(cell + static_cast<std::size_t>(step)));
        if (const std::int32_t other = neighbour_[t][2 * axis + 1]; other >= 0)
            return cell_contact(axis, D, D_at(64 * static_cast<std::size_t>(other) + static_cast<std::size_t>(place - 3 * step)));
        if (const std::int32_t side = side_of_[t][2 * axis + 1]; side >= 0)
            return side_contact(axis, D, core_D(sides_[static_cast<std::size_t>(side)].core));
        return 0;
    };
    parallel_for(0, n, grain, [&](std::size_t t) {
        CellStencil* const block = cells.data() + 64 * t;
        for (int place = 0; place < 64; ++place) {
            block[place].x = contact(t, 0, place, 1, place % 4 == 3);
            block[place].y = contact(t, 1, place, 4, place / 4 % 4 == 3);
            block[place].z = contact(t, 2, place, 16, place / 16 == 3);
        }
    });
    // 1 / diagonal needs the conductances of the neighbours' faces.
    middle_loss_.assign(8 * n, 0.0f);
    const auto diagonals = [&]<int m>(std::span<CellStencil> stencil, std::span<const float> side, std::span<const float> loss, std::integral_constant<int, m>) {
        constexpr int all = m * m * m;
        parallel_for(0, n, grain, [&](std::size_t t) {
            Patch<m> patch;
            gather<m>(patch, t, std::span<const CellStencil>(stencil), side, loss, core_loss, neighbour_[t], side_of_[t], sides_);
            for (int k = 0; k < m; ++k)
                for (int j = 0; j < m; ++j)
                    for (int i = 0; i < m; ++i) {
                        const auto at = static_cast<std::size_t>((k * m + j) * m + i);
                        const float sum = loss[t * all + at] + patch.cx[(k * m + j) * (m + 1) + i] + patch.cx[(k * m + j) * (m + 1) + i + 1] +
                                          patch.cy[(k * (m + 1) + j) * m + i] + patch.cy[(k * (m + 1) + j + 1) * m + i] +
                                          patch.cz[(k * m + j) * m + i] + patch.cz[((k + 1) * m + j) * m + i];
                        stencil[t * all + at].inverse = sum > 0 ? 1 / sum : 0;
                    }
        });
    };
    diagonals(cells, fine_side_, cell_loss, std::integral_constant<int, 4>{});
    fine_ = cells;
    // Eight a block: sums of conductances times the ratio of the distances.
    parallel_for(0, n, grain, [&](std::size_t t) {
        for (int k = 0; k < 2; ++k)
            for (int j = 0; j < 2; ++j)
                for (int i = 0; i < 2; ++i) {
                    CellStencil sum;
                    float loss = 0;
                    for (int c = 0; c < 2; ++c)
                        for (int b = 0; b < 2; ++b)
                            for (int a = 0; a < 2; ++a) {
                                const auto at = 64 * t + static_cast<std::size_t>(((2 * k + c) * 4 + 2 * j + b) * 4 + 2 * i + a);
                                loss += cell_loss[at];
                                if (a == 1) sum.x += cells[at].x;
                                if (b == 1) sum.y += cells[at].y;
                                if (c == 1) sum.z += cells[at].z;
                            }
                    const auto ratio = [&](std::size_t axis, bool last) { return last && side_of_[t][2 * axis + 1] >= 0 ? 2.5f / 3 : 0.5f; };
                    const auto to = 8 * t + static_cast<std::size_t>((k * 2 + j) * 2 + i);
                    middle_[to] = {sum.x * ratio(0, i == 1), sum.y * ratio(1, j == 1), sum.z * ratio(2, k == 1), 0};
                    middle_loss_[to] = loss;
                }
    });
    for (std::size_t s = 0; s < sides_.size(); ++s)
        for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 2; ++i) {
                float sum = 0;
                for (int b = 0; b < 2; ++b)
                    for (int a = 0; a < 2; ++a) sum += fine_side_[16 * s + static_cast<std::size_t>(4 * (2 * j + b) + 2 * i + a)];
                middle_side_[4 * s + static_cast<std::size_t>(2 * j + i)] = sum * (2.5f / 3);
            }
    diagonals(middle_, middle_side_, middle_loss_, std::integral_constant<int, 2>{});
    // Blocks.
    std::vector<float> conductance, loss(n + core_loss.size());
    for (std::size_t t = 0; t < n; ++t) {
        for (std::size_t i = 0; i < 8; ++i) loss[t] += middle_loss_[8 * t + i];
        for (std::size_t f = 1; f < 6; f += 2) {
            if (neighbour_[t][f] < 0) continue;
            float sum = 0;
            for (int j = 0; j < 2; ++j)
                for (int i = 0; i < 2; ++i) {
                    const CellStencil& s = middle_[8 * t + static_cast<std::size_t>(on_side<2>(f, i, j))];
                    sum += f == 1 ? s.x : f == 3 ? s.y : s.z;
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
    blocks_ = std::make_unique<Diffusion>(*plan_, conductance, loss);
}

template <int n>
void ViewingDiffusion::relax(const Level<n>& level, std::span<const float> b, std::span<float> x, std::span<const float> core_x, bool back) const {
    constexpr int m = n + 2, all = n * n * n;
    for (const std::size_t turn : {std::size_t{0}, std::size_t{1}}) {
        const auto& list = parity_[back ? 1 - turn : turn];
        parallel_for(0, list.size(), grain, [&](std::size_t i_list) {
            const std::size_t t = list[i_list];
            Patch<n> patch;
            gather<n>(patch, t, level.stencil, level.side, x, core_x, neighbour_[t], side_of_[t], sides_);
            const CellStencil* const s = level.stencil.data() + t * all;
            const float* const right = b.data() + t * all;
            const auto one = [&](int i, int j, int k) {
                const int at = (k * n + j) * n + i;
                float* const here = patch.x + ((k + 1) * m + j + 1) * m + i + 1;
                const float across = right[at] + patch.cy[(k * (n + 1) + j) * n + i] * here[-m] + patch.cy[(k * (n + 1) + j + 1) * n + i] * here[m] +
                                     patch.cz[at] * here[-m * m] + patch.cz[at + n * n] * here[m * m];
                const float* const cx = patch.cx + (k * n + j) * (n + 1) + i;
                *here = (across + cx[0] * here[-1] + cx[1] * here[1]) * s[at].inverse;
            };
            if (back) {
                for (int k = n; k-- > 0;)
                    for (int j = n; j-- > 0;)
                        for (int i = n; i-- > 0;) one(i, j, k);
            } else {
                for (int k = 0; k < n; ++k)
                    for (int j = 0; j < n; ++j)
                        for (int i = 0; i < n; ++i) one(i, j, k);
            }
            float* const out = x.data() + t * all;
            for (int k = 0; k < n; ++k)
                for (int j = 0; j < n; ++j)
                    for (int i = 0; i < n; ++i) out[(k * n + j) * n + i] = patch.x[((k + 1) * m + j + 1) * m + i + 1];
        });
    }
}

/// Calls body(core node, flow out of it) for every contact of a core node.
template <int n, class Body>
void ViewingDiffusion::for_core_flows(const Level<n>& level, std::span<const float> x, std::span<const float> core_x, Body&& body) const {
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
                       (x[std::size_t{side.block} * all + static_cast<std::size_t>(on_side<n>(side.facing, u, v))] - core_x[side.core]);
        body(side.core, -sum);
    }
}

/// Residuals, summed over 2 x 2 x 2 cells.
template <int n>
void ViewingDiffusion::restrict_to(const Level<n>& level, std::span<const float> b, std::span<const float> x, std::span<const float> core_x,
                                   std::span<const float> core_b, std::span<float> coarse_b, std::span<float> coarse_core_b) const {
    constexpr int m = n + 2, all = n * n * n, half = n / 2;
    parallel_for(0, neighbour_.size(), grain, [&](std::size_t t) {
        Patch<n> patch;
        gather<n>(patch, t, level.stencil, level.side, x, core_x, neighbour_[t], side_of_[t], sides_);
        const CellStencil* const s = level.stencil.data() + t * all;
        float sum[half * half * half] = {};
        for (int k = 0; k < n; ++k)
            for (int j = 0; j < n; ++j)
                for (int i = 0; i < n; ++i) {
                    const int at = (k * n + j) * n + i;
                    if (!(s[at].inverse > 0)) continue;
                    const float* const here = patch.x + ((k + 1) * m + j + 1) * m + i + 1;
                    const float* const cx = patch.cx + (k * n + j) * (n + 1) + i;
                    const float r = b[t * all + static_cast<std::size_t>(at)] + patch.cy[(k * (n + 1) + j) * n + i] * here[-m] +
                                    patch.cy[(k * (n + 1) + j + 1) * n + i] * here[m] + patch.cz[at] * here[-m * m] +
                                    patch.cz[at + n * n] * here[m * m] + cx[0] * here[-1] + cx[1] * here[1] - *here / s[at].inverse;
                    sum[((k / 2) * half + j / 2) * half + i / 2] += r;
                }
        for (int i = 0; i < half * half * half; ++i) coarse_b[t * half * half * half + static_cast<std::size_t>(i)] = sum[i];
    });
    for (std::size_t i = 0; i < core_b.size(); ++i) coarse_core_b[i] = core_b[i] - core_loss_[i] * core_x[i];
    for_core_flows(level, x, core_x, [&](std::uint32_t core, float flow) { coarse_core_b[core] -= flow; });
}

void ViewingDiffusion::cycle(Vector b, Vector x) {
    const Level<4> fine{fine_, fine_side_};
    const Level<2> middle{middle_, middle_side_};
    const std::size_t n = neighbour_.size(), cores = b.core.size();
    std::fill(x.cells.begin(), x.cells.end(), 0.0f);
    std::fill(x.core.begin(), x.core.end(), 0.0f);
    relax(fine, b.cells, x.cells, x.core, false);
    restrict_to(fine, b.cells, x.cells, x.core, b.core, b1_, core_b1_);
    std::fill(x1_.begin(), x1_.end(), 0.0f);
    std::fill(core_x1_.begin(), core_x1_.end(), 0.0f);
    relax(middle, std::span<const float>(b1_), x1_, core_x1_, false);
    restrict_to(middle, std::span<const float>(b1_), x1_, core_x1_, core_b1_, std::span(b2_).first(n), std::span(b2_).subspan(n));
    blocks_->precondition(b2_, x2_);
    for (std::size_t i = 0; i < cores; ++i) core_x1_[i] = x2_[n + i];
    for (std::size_t i = 0; i < 8 * n; ++i)
        if (middle_[i].inverse > 0) x1_[i] += x2_[i / 8];
    relax(middle, std::span<const float>(b1_), x1_, core_x1_, true);
    std::copy(core_x1_.begin(), core_x1_.end(), x.core.begin());
    parallel_for(0, n, grain, [&](std::size_t t) {
        for (std::size_t place = 0; place < 64; ++place) {
            const std::size_t at = 64 * t + place;
            if (fine_[at].inverse > 0) x.cells[at] += x1_[8 * t + (place / 32 * 2 + place / 8 % 2) * 2 + place / 2 % 2];
        }
    });
    relax(fine, b.cells, x.cells, x.core, true);
}

void ViewingDiffusion::apply(Vector x, Vector out) const {
    constexpr int n = 4, m = n + 2, all = n * n * n;
    const Level<4> fine{fine_, fine_side_};
    parallel_for(0, neighbour_.size(), grain, [&](std::size_t t) {
        Patch<n> patch;
        gather<n>(patch, t, fine.stencil, fine.side, x.cells, x.core, neighbour_[t], side_of_[t], sides_);
        const CellStencil* const s = fine.stencil.data() + t * all;
        float* const to = out.cells.data() + t * all;
        for (int k = 0; k < n; ++k)
            for (int j = 0; j < n; ++j)
                for (int i = 0; i < n; ++i) {
                    const int at = (k * n + j) * n + i;
                    const float* const here = patch.x + ((k + 1) * m + j + 1) * m + i + 1;
                    const float* const cx = patch.cx + (k * n + j) * (n + 1) + i;
                    const float inverse = s[at].inverse;
                    to[at] = !(inverse > 0) ? 0.0f
                                            : *here / inverse - (patch.cy[(k * (n + 1) + j) * n + i] * here[-m] + patch.cy[(k * (n + 1) + j + 1) * n + i] * here[m] +
                                                                 patch.cz[at] * here[-m * m] + patch.cz[at + n * n] * here[m * m] + cx[0] * here[-1] + cx[1] * here[1]);
                }
    });
    for (std::size_t i = 0; i < x.core.size(); ++i) out.core[i] = core_loss_[i] * x.core[i];
    for_core_flows(fine, x.cells, x.core, [&](std::uint32_t core, float flow) { out.core[core] += flow; });
}

namespace {

/// Sums of fixed ranges, then the ranges in order: the same bits for any number of threads.
double dot(const ViewingDiffusion::Vector& a, const ViewingDiffusion::Vector& b) {
    constexpr std::size_t range = 1 << 14;
    const auto n = a.cells.size();
    std::vector<double> part((n + range - 1) / range, 0.0);
    parallel_for(0, part.size(), 1, [&](std::size_t r) {
        double sum = 0;
        for (std::size_t i = r * range; i < std::min(n, (r + 1) * range); ++i) sum += static_cast<double>(a.cells[i] * b.cells[i]);
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

int ViewingDiffusion::solve(Vector x, Vector residual, Vector p, Vector z, double tolerance, int most_steps) {
    double start = 0, rho = 0;
    int step = 0;
    for (; step < most_steps; ++step) {
        cycle(residual, z);
        const double rho_new = dot(residual, z);
        if (step == 0) start = rho_new;
        if (!(rho_new > tolerance * tolerance * start)) break;
        if (step == 0) {
            std::copy(z.cells.begin(), z.cells.end(), p.cells.begin());
            std::copy(z.core.begin(), z.core.end(), p.core.begin());
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
    return of(neighbour_) + of(side_of_) + of(parity_[0]) + of(parity_[1]) + of(sides_) + of(contacts_) + of(middle_) + of(fine_side_) +
           of(middle_side_) + of(core_conductance_) + of(core_loss_) + of(middle_loss_) + of(x1_) + of(b1_) + of(core_x1_) + of(core_b1_) +
           of(x2_) + of(b2_) + plan_->memory_bytes() + (blocks_ ? blocks_->memory_bytes() : 0);
}

}  // namespace voxtone::optics
