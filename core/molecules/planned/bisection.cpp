// By levels: pairs of vertices that share heavy edges are merged until few are left, these are divided, and when pairs
// are taken apart again vertices change sides as long as that cuts fewer edges (B. Hendrickson, R. Leland,
// Supercomputing '95; C. Fiduccia, R. Mattheyses, DAC '82).
#include "core/molecules/planned/bisection.hpp"

#include <algorithm>
#include <utility>

namespace holonomic {

namespace {

using Sides = std::vector<unsigned char>;
constexpr std::int32_t coarsest = 40;  // vertices
constexpr int most_passes = 2, most_in_vain = 40, seeds = 3;

std::int64_t whole(const WeightedGraph &g) {
    std::int64_t sum = 0;
    for (const std::int32_t w : g.weight) sum += w;
    return sum;
}

// Calls each(neighbour, weight).
template <class Each>
void for_edges(const WeightedGraph &g, std::int32_t i, const Each &each) {
    for (std::int32_t e = g.start[at(i)]; e < g.start[at(i) + 1]; ++e) each(g.edge[at(e)].to, g.edge[at(e)].weight);
}

// Which vertex of a coarser graph each one becomes. They choose in a scattered order, so that no pattern of their
// numbers tells in the shapes of what is merged.
Numbers merged(const WeightedGraph &g, std::int32_t &n_coarse) {
    const std::int32_t n = g.size();
    const std::int64_t most = std::max<std::int64_t>(2, 3 * whole(g) / (2 * coarsest));
    Numbers order(at(n)), mate(at(n), -1), to(at(n));
    std::uint32_t random = 1;
    for (std::int32_t i = 0; i < n; ++i) {
        random = random * 1664525u + 1013904223u;
        const std::int32_t j =
            static_cast<std::int32_t>((std::uint64_t{random} * static_cast<std::uint32_t>(i + 1)) >> 32);
        order[at(i)] = order[at(j)];
        order[at(j)] = i;
    }
    n_coarse = 0;
    for (const std::int32_t i : order) {
        if (mate[at(i)] >= 0) continue;
        std::int32_t best = i, best_weight = 0;
        for_edges(g, i, [&](std::int32_t j, std::int32_t w) {
            if (mate[at(j)] >= 0 || j == i || g.weight[at(i)] + g.weight[at(j)] > most) return;
            if (w > best_weight || (w == best_weight && g.weight[at(j)] < g.weight[at(best)]))
                best = j, best_weight = w;
        });
        mate[at(i)] = best;
        mate[at(best)] = i;
        to[at(i)] = to[at(best)] = n_coarse++;
    }
    return to;
}

WeightedGraph coarser(const WeightedGraph &g, const Numbers &to, std::int32_t n) {
    WeightedGraph c;
    c.weight.assign(at(n), 0);
    c.start.assign(1, 0);
    Numbers first(at(n), -1), second(at(n), -1), place(at(n), -1);
    for (std::int32_t i = 0; i < g.size(); ++i) {
        c.weight[at(to[at(i)])] += g.weight[at(i)];
        (first[at(to[at(i)])] < 0 ? first : second)[at(to[at(i)])] = i;
    }
    for (std::int32_t k = 0; k < n; ++k) {
        const std::int32_t begin = c.start.back();
        for (const std::int32_t i : {first[at(k)], second[at(k)]}) {
            if (i < 0) continue;
            for_edges(g, i, [&](std::int32_t j, std::int32_t w) {
                const std::int32_t l = to[at(j)];
                if (l == k) return;
                if (place[at(l)] < begin) {
                    place[at(l)] = static_cast<std::int32_t>(c.edge.size());
                    c.edge.push_back({l, 0});
                }
                c.edge[at(place[at(l)])].weight += w;
            });
        }
        c.start.push_back(static_cast<std::int32_t>(c.edge.size()));
    }
    return c;
}

// The vertices of one side by what their move gains, the last that was entered first.
class Gains {
public:
    Gains(std::int32_t n, std::int32_t most)
        : most_(most), top_(0), first_(at(2 * most + 1), -1), next_(at(n)), before_(at(n)) {}
    void enter(std::int32_t i, std::int32_t gain) {
        const std::int32_t g = gain + most_, head = first_[at(g)];
        next_[at(i)] = head;
        before_[at(i)] = ~g;
        if (head >= 0) before_[at(head)] = i;
        first_[at(g)] = i;
        top_ = std::max(top_, g);
    }
    void leave(std::int32_t i) {
        const std::int32_t b = before_[at(i)], n = next_[at(i)];
        (b < 0 ? first_[at(~b)] : next_[at(b)]) = n;
        if (n >= 0) before_[at(n)] = b;
    }
    // The one that gains most, or -1.
    std::int32_t best() {
        while (top_ > 0 && first_[at(top_)] < 0) --top_;
        return first_[at(top_)];
    }
    void clear() { std::fill(first_.begin(), first_.end(), -1); }

private:
    const std::int32_t most_;
    std::int32_t top_;
    Numbers first_, next_, before_;
};

// Moves vertices from side to side.
class Refinement {
public:
    Refinement(const WeightedGraph &g, Sides &side)
        : g_(g), side_(side), degree_(at(g.size())), gain_(at(g.size())), state_(at(g.size())) {
        const std::int64_t all = whole(g);
        std::int32_t most_gain = 0;
        most_ = all * 11 / 20;
        for (std::int32_t i = 0; i < g.size(); ++i) {
            weight_[side[at(i)]] += g.weight[at(i)];
            most_ = std::max(most_, (all + g.weight[at(i)]) / 2);
            std::int32_t away = 0, degree = 0;
            for_edges(g, i, [&](std::int32_t j, std::int32_t w) {
                degree += w;
                away += side[at(i)] != side[at(j)] ? w : 0;
            });
            degree_[at(i)] = degree;
            gain_[at(i)] = 2 * away - degree;
            most_gain = std::max(most_gain, degree);
            cut_ += away;
        }
        cut_ /= 2;
        for (int s = 0; s < 2; ++s) gains_.emplace_back(g.size(), most_gain);
    }
    void refine() {
        for (int pass = 0; pass < most_passes && improve(); ++pass)
            ;
    }
    // What is too much on a side counts more than any cut.
    std::pair<std::int64_t, std::int64_t> badness() const {
        return {std::max<std::int64_t>(0, std::max(weight_[0], weight_[1]) - most_), cut_};
    }

private:
    enum Visit : unsigned char { outside, entered, moved };

    void enter(std::int32_t i) {
        gains_[side_[at(i)]].enter(i, gain_[at(i)]);
        state_[at(i)] = entered;
    }
    void move(std::int32_t i, bool enters) {
        unsigned char &side = side_[at(i)];
        weight_[side] -= g_.weight[at(i)];
        side ^= 1;
        weight_[side] += g_.weight[at(i)];
        cut_ -= gain_[at(i)];
        gain_[at(i)] = -gain_[at(i)];
        for_edges(g_, i, [&](std::int32_t j, std::int32_t w) {
            if (enters && state_[at(j)] == entered) gains_[side_[at(j)]].leave(j);
            gain_[at(j)] += side_[at(j)] == side ? -2 * w : 2 * w;
            if (enters && state_[at(j)] != moved) enter(j);
        });
    }
    // The side from which a vertex is best moved, or -1.
    int next_side() {
        const std::int32_t best[2] = {gains_[0].best(), gains_[1].best()};
        bool fits[2];
        for (int s = 0; s < 2; ++s)
            fits[s] = best[s] >= 0 && (weight_[1 - s] + g_.weight[at(best[s])] <= most_ || weight_[1 - s] < weight_[s]);
        if (!fits[0] || !fits[1]) return fits[0] ? 0 : fits[1] ? 1 : -1;
        const std::int32_t a = gain_[at(best[0])], b = gain_[at(best[1])];
        return a > b || (a == b && weight_[0] > weight_[1]) ? 0 : 1;
    }
    bool improve() {
        for (Gains &gains : gains_) gains.clear();
        std::fill(state_.begin(), state_.end(), outside);
        const auto before = badness();
        for (std::int32_t i = 0; i < g_.size(); ++i)
            if (gain_[at(i)] > -degree_[at(i)] || before.first > 0) enter(i);
        auto least = before;
        std::size_t kept = 0;
        moved_.clear();
        for (int side; moved_.size() < kept + most_in_vain && (side = next_side()) >= 0;) {
            const std::int32_t i = gains_[at(side)].best();
            gains_[at(side)].leave(i);
            state_[at(i)] = moved;
            move(i, true);
            moved_.push_back(i);
            if (badness() < least) {
                least = badness();
                kept = moved_.size();
            }
        }
        while (moved_.size() > kept) {
            move(moved_.back(), false);
            moved_.pop_back();
        }
        return least < before;
    }

    const WeightedGraph &g_;
    Sides &side_;
    Numbers degree_, gain_, moved_;  // degree_: with weights
    std::vector<unsigned char> state_;
    std::vector<Gains> gains_;
    std::int64_t weight_[2] = {0, 0}, cut_ = 0, most_ = 0;
};

// Grown from one vertex, level by level, to half of the whole.
Sides grown(const WeightedGraph &g, std::int32_t seed) {
    Sides side(at(g.size()), 1);
    Numbers reached{seed};
    std::int64_t left = whole(g) / 2;
    std::int32_t next = 0;
    side[at(seed)] = 0;
    for (std::size_t k = 0; left > 0; ++k) {
        if (k == reached.size()) {  // another part of the graph
            while (next < g.size() && side[at(next)] == 0) ++next;
            if (next == g.size()) break;
            side[at(next)] = 0;
            reached.push_back(next);
        }
        left -= g.weight[at(reached[k])];
        for_edges(g, reached[k], [&](std::int32_t j, std::int32_t) {
            if (side[at(j)] == 0) return;
            side[at(j)] = 0;
            reached.push_back(j);
        });
        if (left <= 0)
            for (std::size_t l = k + 1; l < reached.size(); ++l) side[at(reached[l])] = 1;
    }
    return side;
}

Sides divided(const WeightedGraph &g) {
    Sides best;
    std::pair<std::int64_t, std::int64_t> least;
    for (int s = 0; s < seeds; ++s) {
        Sides side = grown(g, static_cast<std::int32_t>(std::int64_t{s} * g.size() / seeds));
        Refinement refinement(g, side);
        refinement.refine();
        if (best.empty() || refinement.badness() < least) {
            least = refinement.badness();
            best = std::move(side);
        }
    }
    return best;
}

}  // namespace

std::vector<unsigned char> bisect(const WeightedGraph &g) {
    if (g.size() <= coarsest) return divided(g);
    std::int32_t n_coarse = 0;
    const Numbers to = merged(g, n_coarse);
    if (n_coarse > g.size() * 19 / 20) return divided(g);
    const Sides coarse = bisect(coarser(g, to, n_coarse));
    Sides side(at(g.size()));
    for (std::int32_t i = 0; i < g.size(); ++i) side[at(i)] = coarse[at(to[at(i)])];
    Refinement(g, side).refine();
    return side;
}

}  // namespace holonomic
