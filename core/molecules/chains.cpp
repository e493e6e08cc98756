#include "core/molecules/chains.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#include "core/error.hpp"

namespace holonomic {

namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

long long number(std::int64_t i, int base) { return static_cast<long long>(i + base); }

// A caller's number counted from 0; -1 if it is below the base, however far (the least number minus 1 would overflow).
std::int64_t from_zero(std::int64_t i, int base) { return i < base ? -1 : i - base; }

Error out_of_range(const char *what, std::int64_t value, std::int64_t least) {
    return make_error(Status::value, "%s is %lld; it must be at least %lld", what, static_cast<long long>(value),
                      static_cast<long long>(least));
}

std::uint64_t mix(std::uint64_t hash, double value) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
    return hash ^ (hash >> 29);
}

// Lengths are compared by their squares, which must neither vanish nor overflow.
void check_lengths(std::int64_t n_bonds, const double *lengths, int base) {
    for (std::int64_t k = 0; k < n_bonds; ++k) {
        if (lengths[k] >= 1e-150 && lengths[k] <= 1e150) continue;
        const char *const range =
            lengths[k] > 0 && std::isfinite(lengths[k]) ? "between 1e-150 and 1e150" : "positive and finite";
        Error error = make_error(Status::value, "the length of bond %lld is %g; it must be %s", number(k, base),
                                 lengths[k], range);
        error.bond = k;
        error.base = base;
        throw error;
    }
}

}  // namespace

Chains::Chains(std::int64_t n_atoms, const double *masses) : n_atoms_(n_atoms) {
    if (n_atoms < 0) throw out_of_range("n_atoms", n_atoms, 0);
    if (n_atoms > std::numeric_limits<std::int64_t>::max() / 64)
        throw make_error(Status::value, "n_atoms is %lld: too large", static_cast<long long>(n_atoms));
    bool uniform = true;
    for (std::int64_t i = 0; i < n_atoms; ++i) {
        const double w = masses[i] == 0 ? 0 : 1 / masses[i];
        if (!(masses[i] >= 0) || !std::isfinite(w)) {
            Error error = make_error(Status::value,
                                     "the mass of atom %lld (counted from 0) is %g; it must be positive, or 0 for an "
                                     "atom that is held fixed",
                                     number(i, 0), masses[i]);
            error.atom = i;
            throw error;
        }
        uniform = uniform && masses[i] == masses[0];
    }
    if (uniform && n_atoms > 0) {
        w_uniform_ = masses[0] == 0 ? 0 : 1 / masses[0];
    } else {
        w_.resize(at(n_atoms));
        for (std::int64_t i = 0; i < n_atoms; ++i) w_[at(i)] = masses[i] == 0 ? 0 : 1 / masses[i];
    }
    used_.assign(at((n_atoms + 63) / 64), 0);
}

void Chains::mark(std::int64_t atom, std::int64_t chain, std::int64_t position) {
    std::uint64_t &word = used_[at(atom / 64)];
    const std::uint64_t bit = std::uint64_t{1} << (atom % 64);
    if (word & bit) {
        Error error = make_error(Status::shared_atom,
                                 "atom %lld, number %lld of chain %lld, is in use already: chains that share an atom "
                                 "(rings, branches) are not supported yet",
                                 number(atom, base), number(position, base), number(chain, base));
        error.atom = atom;
        error.chain = chain;
        error.base = base;
        throw error;
    }
    word |= bit;
}

void Chains::unmark(std::int64_t atom) { used_[at(atom / 64)] &= ~(std::uint64_t{1} << (atom % 64)); }

template <class AtomOf>
bool Chains::same_kind(const Kind &kind, std::int64_t n_bonds, AtomOf atom_of, const double *lengths) const {
    if (kind.n_bonds != n_bonds) return false;
    for (std::int64_t k = 0; k < n_bonds; ++k)
        if (lengths[k] != (kind.length_offset < 0 ? kind.length_uniform : length_tables_[at(kind.length_offset + k)]))
            return false;
    for (std::int64_t k = 0; k <= n_bonds; ++k)
        if (w(atom_of(k)) != (kind.w_offset < 0 ? kind.w_uniform : w_tables_[at(kind.w_offset + k)])) return false;
    return true;
}

template <class AtomOf>
std::int64_t Chains::find_kind(std::int64_t n_bonds, AtomOf atom_of, const double *lengths) {
    if (!groups_.empty() && same_kind(kinds_[at(groups_.back().kind)], n_bonds, atom_of, lengths))
        return groups_.back().kind;

    Kind kind{n_bonds, -1, -1, w(atom_of(0)), lengths[0], 0};
    bool w_varies = false, length_varies = false;
    std::uint64_t hash = static_cast<std::uint64_t>(n_bonds);
    for (std::int64_t k = 0; k < n_bonds; ++k) {
        hash = mix(hash, lengths[k]);
        length_varies = length_varies || lengths[k] != lengths[0];
        kind.fixed_bonds += w(atom_of(k)) == 0 && w(atom_of(k + 1)) == 0;
    }
    for (std::int64_t k = 0; k <= n_bonds; ++k) {
        hash = mix(hash, w(atom_of(k)));
        w_varies = w_varies || w(atom_of(k)) != kind.w_uniform;
    }
    const auto candidates = kind_by_hash_.equal_range(hash);
    for (auto it = candidates.first; it != candidates.second; ++it)
        if (same_kind(kinds_[at(it->second)], n_bonds, atom_of, lengths)) return it->second;

    const std::size_t n_w = w_tables_.size(), n_length = length_tables_.size();
    try {
        if (w_varies) {
            kind.w_offset = static_cast<std::int64_t>(n_w);
            for (std::int64_t k = 0; k <= n_bonds; ++k) w_tables_.push_back(w(atom_of(k)));
        }
        if (length_varies) {
            kind.length_offset = static_cast<std::int64_t>(n_length);
            length_tables_.insert(length_tables_.end(), lengths, lengths + n_bonds);
        }
        kinds_.push_back(kind);
        try {
            kind_by_hash_.emplace(hash, static_cast<std::int64_t>(kinds_.size()) - 1);
        } catch (...) {
            kinds_.pop_back();
            throw;
        }
    } catch (...) {
        w_tables_.resize(n_w);
        length_tables_.resize(n_length);
        throw;
    }
    return static_cast<std::int64_t>(kinds_.size()) - 1;
}

// Joins the last group where the new chains continue it. Strong guarantee.
void Chains::append(std::int64_t kind, std::int64_t n_chains, std::int64_t first_atom, std::int64_t atoms_offset) {
    const std::int64_t n_bonds = kinds_[at(kind)].n_bonds;
    if (!active_.empty()) active_.resize(at(n_chains_ + n_chains), 1);
    bool joined = false;
    if (!groups_.empty() && groups_.back().kind == kind) {
        Group &last = groups_.back();
        const std::int64_t next = last.n_chains * (n_bonds + 1);
        joined = atoms_offset < 0 ? last.atoms_offset < 0 && last.first_atom + next == first_atom
                                  : last.atoms_offset >= 0 && last.atoms_offset + next == atoms_offset;
        if (joined) last.n_chains += n_chains;
    }
    if (!joined) groups_.push_back({kind, n_chains, n_chains_, n_bonds_, first_atom, atoms_offset});
    n_chains_ += n_chains;
    n_bonds_ += n_chains * n_bonds;
    changed();
}

void Chains::add(std::int64_t n_bonds, const std::int64_t *atoms, const double *lengths) {
    if (n_bonds < 1) throw out_of_range("n_bonds", n_bonds, 1);
    if (n_bonds >= n_atoms_)
        throw make_error(Status::value, "n_bonds is %lld: a chain of so many bonds has more than the %lld atoms",
                         static_cast<long long>(n_bonds), static_cast<long long>(n_atoms_));
    check_lengths(n_bonds, lengths, base);
    bool consecutive = true;
    for (std::int64_t k = 0; k <= n_bonds; ++k) {
        if (atoms[k] < base || atoms[k] - base >= n_atoms_) {
            Error error = make_error(Status::index, "atom %lld, number %lld of chain %lld, is outside %d .. %lld",
                                     static_cast<long long>(atoms[k]), number(k, base), number(n_chains_, base), base,
                                     number(n_atoms_ - 1, base));
            error.atom = from_zero(atoms[k], base);
            error.chain = n_chains_;
            error.base = base;
            throw error;
        }
        consecutive = consecutive && atoms[k] == atoms[0] + k;
    }
    std::int64_t marked = 0;
    const std::size_t n_lists = atom_lists_.size();
    try {
        for (; marked <= n_bonds; ++marked) mark(atoms[marked] - base, n_chains_, marked);
        const std::int64_t kind = find_kind(
            n_bonds, [&](std::int64_t k) { return atoms[k] - base; }, lengths);
        std::int64_t offset = -1;
        if (!consecutive) {
            offset = static_cast<std::int64_t>(n_lists);
            for (std::int64_t k = 0; k <= n_bonds; ++k) atom_lists_.push_back(atoms[k] - base);
        }
        append(kind, 1, atoms[0] - base, offset);  // a kind that is new and stays unused does no harm
    } catch (...) {
        while (marked > 0) unmark(atoms[--marked] - base);
        atom_lists_.resize(n_lists);
        throw;
    }
}

void Chains::add_block(std::int64_t n_chains, std::int64_t n_bonds, std::int64_t first_atom, const double *lengths) {
    if (n_chains < 1) throw out_of_range("n_chains", n_chains, 1);
    if (n_bonds < 1) throw out_of_range("n_bonds", n_bonds, 1);
    const std::int64_t first = from_zero(first_atom, base);
    if (first < 0 || first >= n_atoms_ || n_bonds >= n_atoms_ || n_chains > (n_atoms_ - first) / (n_bonds + 1)) {
        Error error =
            make_error(Status::index, "%lld chains of %lld bonds from atom %lld on reach outside the atoms %d .. %lld",
                       static_cast<long long>(n_chains), static_cast<long long>(n_bonds),
                       static_cast<long long>(first_atom), base, number(n_atoms_ - 1, base));
        error.atom = first;
        error.base = base;
        throw error;
    }
    check_lengths(n_bonds, lengths, base);
    const std::int64_t n_atoms = n_chains * (n_bonds + 1);
    std::int64_t marked = 0, added = 0;
    const std::size_t n_groups = groups_.size(), n_active = active_.size();
    const Group last = groups_.empty() ? Group{} : groups_.back();
    try {
        for (; marked < n_atoms; ++marked)
            mark(first + marked, n_chains_ + marked / (n_bonds + 1), marked % (n_bonds + 1));
        for (; added < n_chains;) {
            const std::int64_t start = first + added * (n_bonds + 1);
            const std::int64_t kind = find_kind(
                n_bonds, [&](std::int64_t k) { return start + k; }, lengths);
            std::int64_t same = 1;  // with equal masses everywhere, all chains of the block are of this kind
            if (w_.empty()) same = n_chains - added;
            append(kind, same, start, -1);
            added += same;
        }
    } catch (...) {
        groups_.resize(n_groups);
        if (n_groups > 0) groups_.back() = last;
        active_.resize(n_active);
        n_chains_ -= added;
        n_bonds_ -= added * n_bonds;
        while (marked > 0) unmark(first + --marked);
        throw;
    }
}

void Chains::set_active(const unsigned char *active) {
    if (active)
        active_.assign(active, active + n_chains_);
    else
        active_.clear();
    changed();
}

bool Chains::is_active(std::int64_t chain) const { return active_.empty() || active_[at(chain)] != 0; }

void Chains::offsets(std::int64_t *out) const {
    std::int64_t chain = 0;
    for (const Group &group : groups_)
        for (std::int64_t c = 0; c < group.n_chains; ++c)
            out[chain++] = base + group.first_bond + c * kinds_[at(group.kind)].n_bonds;
    out[chain] = base + n_bonds_;
}

const Group &Chains::group_of(std::int64_t chain) const {
    std::size_t low = 0, high = groups_.size();
    while (high - low > 1) {
        const std::size_t middle = (low + high) / 2;
        (groups_[middle].first_chain <= chain ? low : high) = middle;
    }
    return groups_[low];
}

Lane Chains::lane_of(const Group &group, std::int64_t index) const {
    const Kind &kind = kinds_[at(group.kind)];
    const std::int64_t skip = index * (kind.n_bonds + 1);
    Lane lane;
    lane.n_bonds = kind.n_bonds;
    lane.first_atom = group.first_atom + skip;
    lane.atoms = group.atoms_offset < 0 ? nullptr : atom_lists_.data() + group.atoms_offset + skip;
    lane.w = kind.w_offset < 0 ? nullptr : w_tables_.data() + kind.w_offset;
    lane.length = kind.length_offset < 0 ? nullptr : length_tables_.data() + kind.length_offset;
    lane.w_uniform = kind.w_uniform;
    lane.length_uniform = kind.length_uniform;
    lane.first_bond = group.first_bond + index * kind.n_bonds;
    lane.chain = group.first_chain + index;
    return lane;
}

Lane Chains::lane(std::int64_t chain) const {
    const Group &group = group_of(chain);
    return lane_of(group, chain - group.first_chain);
}

void Chains::atoms(std::int64_t chain, std::int64_t *out) const {
    const Lane one = lane(chain);
    for (std::int64_t k = 0; k <= one.n_bonds; ++k) out[k] = base + (one.atoms ? one.atoms[k] : one.first_atom + k);
}

std::int64_t Chains::degrees_of_freedom(int dimensions) const {
    std::int64_t movable = n_atoms_;
    if (w_.empty() && w_uniform_ == 0) movable = 0;
    for (const double w : w_) movable -= w == 0;
    std::int64_t constraints = 0;
    for (const Group &group : groups_) {
        std::int64_t active = group.n_chains;
        if (!active_.empty()) {
            active = 0;
            for (std::int64_t c = 0; c < group.n_chains; ++c) active += active_[at(group.first_chain + c)] != 0;
        }
        const Kind &kind = kinds_[at(group.kind)];
        constraints += active * (kind.n_bonds - kind.fixed_bonds);
    }
    return dimensions * movable - constraints;
}

std::int64_t Chains::memory() const {
    const Plan *plan = plan_.load(std::memory_order_acquire);
    std::size_t bytes =
        sizeof *this + w_.capacity() * sizeof(double) + used_.capacity() * sizeof(std::uint64_t) +
        kinds_.capacity() * sizeof(Kind) + (w_tables_.capacity() + length_tables_.capacity()) * sizeof(double) +
        kind_by_hash_.size() * 40 + kind_by_hash_.bucket_count() * sizeof(void *) +
        atom_lists_.capacity() * sizeof(std::int64_t) + groups_.capacity() * sizeof(Group) + active_.capacity();
    if (plan) bytes += plan->pieces.capacity() * sizeof(Plan::Piece) + plan->loose.capacity() * sizeof(Plan::Reference);
    return static_cast<std::int64_t>(bytes);
}

}  // namespace holonomic
