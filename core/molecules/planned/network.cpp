#include "core/molecules/planned/network.hpp"

#include <algorithm>
#include <utility>

namespace holonomic {

namespace {

constexpr std::int32_t bonds_of_share = 2048, nodes_of_share = 512;

bool is_node(const EliminationPlan &s, std::int32_t index) {
    const std::int32_t c = index - s.n_tree;
    return s.meet_start[c + 1] - s.meet_start[c] != 2 || s.child_start[index + 1] > s.child_start[index];
}

class NetworkMaker {
public:
    NetworkMaker(const EliminationPlan &s, NetworkArrays &a) : s_(s), a_(a) {}

    void make() {
        find_nodes();
        find_strands();
        sort_strands();
        sort_nodes();
        lay_out_strands();
        lay_out_rest();
        list_unknowns();
        list_children();
        close();
    }

private:
    // Bonds of the core and the indices behind each of them, from one node to another.
    struct Strand {
        std::int32_t first, n_bonds, node[2];  // in walked_
    };
    struct Step {
        std::int32_t bond, index;
    };

    void find_nodes() {
        node_.assign(at(s_.n_atoms), -1);
        for (std::int32_t index = s_.n_tree; index < s_.n_atoms; ++index)
            if (is_node(s_, index)) {
                node_[at(index)] = size_of(index_of_node_);
                index_of_node_.push_back(index);
            }
    }
    void find_strands() {
        std::vector<unsigned char> seen(at(s_.n_core), 0);
        for (const std::int32_t start : index_of_node_)
            for (std::int32_t m = s_.meet_start[start - s_.n_tree]; m < s_.meet_start[start - s_.n_tree + 1]; ++m) {
                std::int32_t p = s_.meet[m], index = start;
                if (seen[at(p)]) continue;
                Strand strand = {static_cast<std::int32_t>(walked_.size()), 0, {node_[at(start)], -1}};
                for (;;) {
                    seen[at(p)] = 1;
                    index = s_.from[p] + s_.to[p] - index;
                    walked_.push_back({s_.n_tree + p, index});
                    ++strand.n_bonds;
                    if (node_[at(index)] >= 0) break;
                    const std::int32_t *const meet = s_.meet + s_.meet_start[index - s_.n_tree];
                    p = meet[0] == p ? meet[1] : meet[0];
                }
                strand.node[1] = node_[at(index)];
                strand_.push_back(strand);
            }
    }
    // Equally long ones stand together, in the order in which they were found.
    void sort_strands() {
        std::stable_sort(strand_.begin(), strand_.end(),
                         [](const Strand &x, const Strand &y) { return x.n_bonds > y.n_bonds; });
    }

    // The nodes of a share by how many own unknowns they have.
    void sort_nodes() {
        Numbers n_own(index_of_node_.size(), 0), indices(index_of_node_);
        for (const Strand &strand : strand_)
            for (int e = 0; e < (strand.n_bonds == 1 ? 1 : 2); ++e) ++n_own[at(strand.node[e])];
        Numbers order, number(indices.size());
        for (std::int32_t first = 0, n = size_of(indices); first < n; first += nodes_of_share) {
            const std::int32_t end = std::min(n, first + nodes_of_share);
            a_.nodes_start.push_back(static_cast<std::int32_t>(a_.nodes.size()));
            for (std::int32_t own = *std::max_element(&n_own[at(first)], n_own.data() + end), fewer; own >= 0;
                 own = fewer) {
                NetworkPlan::Nodes alike = {0, own, size_of(order), 0};
                fewer = -1;
                for (std::int32_t i = first; i < end; ++i) {
                    const std::int32_t n_own_of_it = n_own[at(i)];
                    if (n_own_of_it < own) fewer = std::max(fewer, n_own_of_it);
                    if (n_own_of_it != own) continue;
                    order.push_back(i);
                    ++alike.count;
                    a_.nodes_of.push_back(static_cast<std::int32_t>(a_.nodes.size()));
                }
                a_.nodes.push_back(alike);
            }
        }
        a_.nodes_start.push_back(static_cast<std::int32_t>(a_.nodes.size()));
        for (std::size_t i = 0; i < indices.size(); ++i) {
            index_of_node_[i] = indices[at(order[i])];
            number[at(order[i])] = node_[at(index_of_node_[i])] = static_cast<std::int32_t>(i);
        }
        for (Strand &strand : strand_)
            for (std::int32_t &node : strand.node) node = number[at(node)];
    }

    void lay_out_strands() {
        const std::int32_t n = static_cast<std::int32_t>(strand_.size());
        std::int32_t site = 0, bonds = 0;
        for (std::int32_t first = 0, width = 0; first < n; first += width) {
            const std::int32_t length = strand_[at(first)].n_bonds;
            for (width = 1; width < NetworkPlan::most_in_bundle && first + width < n; ++width)
                if (strand_[at(first + width)].n_bonds != length) break;
            if (bonds == 0) a_.bundle_start.push_back(static_cast<std::int32_t>(a_.bundle.size()));
            bonds += width * length;
            if (bonds >= bonds_of_share) bonds = 0;
            a_.bundle.push_back({width, length, size_of(a_.bond_of), site, first});
            site += width * (length - 1);
            for (std::int32_t k = 0; k < length; ++k)
                for (std::int32_t j = 0; j < width; ++j) {
                    const Step &step = walked_[at(strand_[at(first + j)].first + k)];
                    a_.bond_of.push_back(s_.bond_of[step.bond]);
                    if (k + 1 < length) a_.atom_of.push_back(s_.atom_of[step.index]);
                }
        }
        a_.bundle_start.push_back(static_cast<std::int32_t>(a_.bundle.size()));
    }
    void lay_out_rest() {
        NetworkPlan &p = a_.plan;
        p.first_tree_bond = size_of(a_.bond_of);
        p.first_node = size_of(a_.atom_of);
        p.first_tree = p.first_node + size_of(index_of_node_);
        for (const std::int32_t index : index_of_node_) a_.atom_of.push_back(s_.atom_of[index]);
        a_.from.resize(at(s_.n_bonds));
        a_.to.resize(at(s_.n_bonds));
        for (const NetworkPlan::Bundle &b : a_.bundle)
            for (std::int32_t j = 0; j < b.width; ++j)
                for (std::int32_t k = 0; k < b.length; ++k) {
                    const Strand &strand = strand_[at(b.first_strand + j)];
                    const std::size_t bond_index = at(b.first_index + k * b.width + j);
                    a_.from[bond_index] = k == 0 ? p.first_node + strand.node[0] : b.first_site + (k - 1) * b.width + j;
                    a_.to[bond_index] =
                        k + 1 == b.length ? p.first_node + strand.node[1] : b.first_site + k * b.width + j;
                }
        for (std::int32_t index = 0; index < s_.n_tree; ++index) {
            a_.atom_of.push_back(s_.atom_of[index]);
            a_.bond_of.push_back(s_.bond_of[index]);
            a_.from[at(p.first_tree_bond + index)] = site_of(s_.parent[index]);
            a_.to[at(p.first_tree_bond + index)] = p.first_tree + index;
        }
        a_.atom_of.insert(a_.atom_of.end(), NetworkPlan::fetched_ahead, a_.atom_of[0]);
    }
    std::int32_t site_of(std::int32_t index) const {
        return index < s_.n_tree ? a_.plan.first_tree + index : a_.plan.first_node + node_[at(index)];
    }

    // Unknowns by their nodes.
    void list_unknowns() {
        const std::int32_t n = static_cast<std::int32_t>(strand_.size()), nodes = size_of(index_of_node_);
        std::int32_t n_unknowns = 0;
        for (std::size_t i = 0, share = 0; i < a_.nodes.size(); ++i) {
            if (static_cast<std::int32_t>(i) == a_.nodes_start[share]) {
                a_.unknown_start.push_back(n_unknowns);
                ++share;
            }
            a_.nodes[i].first_unknown = n_unknowns;
            n_unknowns += a_.nodes[i].count * a_.nodes[i].n_own;
        }
        a_.unknown_start.push_back(n_unknowns);
        a_.foreign_start.assign(at(nodes) + 1, 0);
        for (const Strand &strand : strand_)
            if (strand.n_bonds == 1) ++a_.foreign_start[at(strand.node[1]) + 1];
        for (std::size_t i = 0; i < at(nodes); ++i) a_.foreign_start[i + 1] += a_.foreign_start[i];
        for (Numbers *list : {&a_.bond_index_of, &a_.node_of, &a_.partner}) list->resize(at(n_unknowns));
        a_.sign.resize(at(n_unknowns));
        a_.other_node.assign(at(n_unknowns), -1);
        a_.foreign.resize(at(a_.foreign_start.back()));
        a_.strand_node.resize(2 * at(n));
        a_.strand_unknown.resize(2 * at(n));
        Numbers own(at(nodes), 0), next_foreign(a_.foreign_start);
        for (const NetworkPlan::Bundle &b : a_.bundle)
            for (std::int32_t i = b.first_strand; i < b.first_strand + b.width; ++i)
                for (int e = 0; e < 2; ++e) {
                    const std::int32_t node = strand_[at(i)].node[e];
                    a_.strand_node[2 * at(i) + at(e)] = node;
                    std::int32_t &u = a_.strand_unknown[2 * at(i) + at(e)];
                    if (b.length == 1 && e == 1) {
                        u = a_.strand_unknown[2 * at(i)];
                        a_.other_node[at(u)] = node;
                        a_.foreign[at(next_foreign[at(node)]++)] = u;
                        continue;
                    }
                    const NetworkPlan::Nodes &like = a_.nodes[at(a_.nodes_of[at(node)])];
                    u = like.first_unknown + own[at(node)]++ * like.count + node - like.first_node;
                    a_.node_of[at(u)] = node;
                    a_.sign[at(u)] = e == 0 ? 1 : -1;
                    a_.bond_index_of[at(u)] =
                        b.first_index + i - b.first_strand + (e == 0 ? 0 : b.length - 1) * b.width;
                }
        for (std::int32_t i = 0; i < n; ++i)
            for (int e = 0; e < 2; ++e)
                a_.partner[at(a_.strand_unknown[2 * at(i) + at(e)])] = a_.strand_unknown[2 * at(i) + at(1 - e)];
    }
    void list_children() {
        const auto list = [&](std::int32_t index) {
            a_.child_start.push_back(size_of(a_.child));
            a_.child.insert(a_.child.end(), s_.child + s_.child_start[index], s_.child + s_.child_start[index + 1]);
        };
        for (const std::int32_t index : index_of_node_) list(index);
        for (std::int32_t index = 0; index < s_.n_tree; ++index) list(index);
        a_.child_start.push_back(size_of(a_.child));
    }

    void close() {
        NetworkPlan &p = a_.plan;
        p.n_atoms = s_.n_atoms;
        p.n_bonds = s_.n_bonds;
        p.n_strands = static_cast<std::int32_t>(strand_.size());
        p.n_nodes = size_of(index_of_node_);
        p.n_unknowns = size_of(a_.bond_index_of);
        p.n_tree = s_.n_tree;
        p.has_foreign = !a_.foreign.empty();
        p.bundle = a_.bundle.data();
        p.bundle_start = a_.bundle_start.data();
        p.n_shares = size_of(a_.bundle_start) - 1;
        p.nodes = a_.nodes.data();
        p.nodes_start = a_.nodes_start.data();
        p.unknown_start = a_.unknown_start.data();
        p.n_node_shares = size_of(a_.nodes_start) - 1;
        p.atom_of = a_.atom_of.data();
        p.bond_of = a_.bond_of.data();
        p.from = a_.from.data();
        p.to = a_.to.data();
        p.strand_node = a_.strand_node.data();
        p.strand_unknown = a_.strand_unknown.data();
        p.nodes_of = a_.nodes_of.data();
        p.bond_index_of = a_.bond_index_of.data();
        p.node_of = a_.node_of.data();
        p.partner = a_.partner.data();
        p.sign = a_.sign.data();
        p.foreign_start = a_.foreign_start.data();
        p.foreign = a_.foreign.data();
        p.other_node = a_.other_node.data();
        p.child_start = a_.child_start.data();
        p.child = a_.child.data();
    }

    const EliminationPlan &s_;
    NetworkArrays &a_;
    Numbers node_, index_of_node_;  // of an index; of a node
    std::vector<Step> walked_;
    std::vector<Strand> strand_;
};

}  // namespace

void make_network(const EliminationPlan &s, std::int64_t most_bytes, NetworkArrays &arrays) {
    NetworkMaker(s, arrays).make();
    arrays.plan.fronts = make_fronts(arrays.plan, s.fixed, most_bytes, arrays.fronts);
}

std::size_t bytes_of(const NetworkArrays &a) {
    std::size_t bytes = bytes_of(a.fronts) + a.bundle.capacity() * sizeof(a.bundle[0]) +
                        a.nodes.capacity() * sizeof(a.nodes[0]) + a.sign.capacity() * sizeof(double);
    for (const Numbers *list : {&a.bundle_start, &a.nodes_start, &a.unknown_start, &a.nodes_of, &a.atom_of, &a.bond_of,
                                &a.from, &a.to, &a.strand_node, &a.strand_unknown, &a.bond_index_of, &a.node_of,
                                &a.partner, &a.foreign_start, &a.foreign, &a.other_node, &a.child_start, &a.child})
        bytes += list->capacity() * sizeof(std::int32_t);
    return bytes;
}

}  // namespace holonomic
