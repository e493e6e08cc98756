// Which atoms are joined by rigid bonds, and how the chains are cut into units of work.
#ifndef HOLONOMIC_CHAINS_HPP
#define HOLONOMIC_CHAINS_HPP

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "core/kernels/call.hpp"

namespace holonomic {

// A sort of molecule: masses and bond lengths along the chain. Chains of one kind share its tables.
struct Kind {
    std::int64_t n_bonds;
    std::int64_t w_offset;       // into w_tables, or -1: all w_uniform
    std::int64_t length_offset;  // into length_tables, or -1: all length_uniform
    double w_uniform, length_uniform;
    std::int64_t fixed_bonds;  // bonds between two fixed atoms, which remove no degree of freedom
};

// Chains of one kind that follow each other in the caller's arrays or in the index lists.
struct Group {
    std::int64_t kind;
    std::int64_t n_chains;
    std::int64_t first_chain, first_bond;
    std::int64_t first_atom;    // of the first chain; the others follow. Or
    std::int64_t atoms_offset;  // into atom_lists, or -1
};

// How a call goes through the chains; made at the first use after a change. Which chains share a unit, or a block of
// lanes in it, changes no result.
struct Plan {
    struct Reference {
        std::int64_t group, index;
    };
    struct Piece {
        std::int64_t group;         // `count` chains of this group from `first` on, or
        std::int64_t first, count;  // if group == -1: loose[first] .. loose[first+count-1]
    };
    std::vector<Piece> pieces;
    std::vector<Reference> loose;                   // chains that fill no block of their own kind, by length
    std::int64_t longest_in_lane = 0, longest = 0;  // bonds
    std::int64_t n_bonds = 0;                       // of active chains
};

// At most so many loose chains are worked on as one piece.
constexpr std::int64_t loose_piece = 64;

// Replaces a bond vector by its minimum image (box.cpp).
void minimum_image(const Box &box, double *d);

class Chains {
public:
    Chains(std::int64_t n_atoms, const double *masses);

    void add(std::int64_t n_bonds, const std::int64_t *atoms, const double *lengths);
    void add_block(std::int64_t n_chains, std::int64_t n_bonds, std::int64_t first_atom, const double *lengths);
    void set_active(const unsigned char *active);
    void set_box(const double *h);

    std::int64_t n_atoms() const { return n_atoms_; }
    std::int64_t n_chains() const { return n_chains_; }
    std::int64_t n_bonds() const { return n_bonds_; }
    void offsets(std::int64_t *out) const;
    void atoms(std::int64_t chain, std::int64_t *out) const;
    std::int64_t degrees_of_freedom(int dimensions) const;
    std::int64_t memory() const;
    bool is_active(std::int64_t chain) const;

    Lane lane(std::int64_t chain) const;                                   // chain in 0 .. n_chains-1
    const Plan &plan() const;                                              // thread-safe
    Unit unit(const Plan &plan, std::int64_t piece, Lane *lanes) const;    // lanes [loose_piece]
    std::int64_t piece_bonds(const Plan &plan, std::int64_t piece) const;  // of a chain of the piece; 0 if loose ones

    int base = 0;
    int n_threads = 1;
    double tolerance = 0;
    int max_iterations = 50;
    Box box{};

private:
    double w(std::int64_t atom) const { return w_.empty() ? w_uniform_ : w_[static_cast<std::size_t>(atom)]; }
    template <class AtomOf>
    std::int64_t find_kind(std::int64_t n_bonds, AtomOf atom_of, const double *lengths);
    template <class AtomOf>
    bool same_kind(const Kind &kind, std::int64_t n_bonds, AtomOf atom_of, const double *lengths) const;
    void mark(std::int64_t atom, std::int64_t chain, std::int64_t position);
    void unmark(std::int64_t atom);
    void append(std::int64_t kind, std::int64_t n_chains, std::int64_t first_atom, std::int64_t atoms_offset);
    void changed() { plan_.store(nullptr); }
    const Group &group_of(std::int64_t chain) const;
    Lane lane_of(const Group &group, std::int64_t index) const;
    void make_plan() const;

    std::int64_t n_atoms_, n_chains_ = 0, n_bonds_ = 0;
    double w_uniform_ = 0;
    std::vector<double> w_;            // [n_atoms], empty if all are w_uniform_
    std::vector<std::uint64_t> used_;  // a bit per atom
    std::vector<Kind> kinds_;
    std::unordered_multimap<std::uint64_t, std::int64_t> kind_by_hash_;
    std::vector<double> w_tables_, length_tables_;
    std::vector<std::int64_t> atom_lists_;
    std::vector<Group> groups_;
    std::vector<unsigned char> active_;  // [n_chains] or empty: all

    mutable std::mutex plan_mutex_;
    mutable std::atomic<const Plan *> plan_{nullptr};
    mutable std::unique_ptr<Plan> plan_owner_;
};

}  // namespace holonomic
#endif
