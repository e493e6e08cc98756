#include "core/rigid/bodies.hpp"

#include <algorithm>
#include <cstring>

#include "core/index.hpp"
#include "core/rigid/blocks.hpp"
#include "core/rigid/system.hpp"

namespace holonomic::rigid {

namespace {

// FNV-1a over words.
class Hash {
public:
    void take(double x) {
        std::uint64_t word;
        std::memcpy(&word, &x, sizeof word);
        value_ = (value_ ^ word) * UINT64_C(1099511628211);
        value_ ^= value_ >> 29;
    }
    std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = UINT64_C(14695981039346656037);
};

std::uint64_t hash_of(const std::vector<double> &words) {
    Hash hash;
    for (const double word : words) hash.take(word);
    return hash.value();
}

bool same_words(const double *a, const double *b, std::size_t n) {
    return n == 0 || std::memcmp(a, b, n * sizeof(double)) == 0;
}

std::vector<double> signature_of(const Given &given) {
    std::vector<double> words;
    words.reserve(8 + given.sizes.size() + given.coordinates.size() + given.masses.size() + 3 * given.bonds.size());
    const auto count = [&](std::size_t n) { words.push_back(static_cast<double>(n)); };
    count(given.sizes.size());
    count(given.atoms.size());
    count(given.bonds.size());
    words.push_back(given.n_movable);
    words.push_back(given.by_lengths);
    words.push_back(given.has_images);
    for (const std::int32_t size : given.sizes) words.push_back(size);
    words.insert(words.end(), given.coordinates.begin(), given.coordinates.end());
    words.insert(words.end(), given.masses.begin(), given.masses.end());
    for (const Bond &bond : given.bonds) {
        words.push_back(bond.i);
        words.push_back(bond.j);
        words.push_back(bond.length);
    }
    if (given.affine.empty()) return words;
    for (const AffinePart &affine : given.affine) {
        words.push_back(affine.relations.n_atoms);
        count(affine.relations.c.size());
        words.insert(words.end(), affine.relations.c.begin(), affine.relations.c.end());
        words.push_back(affine.extent);
        count(affine.fixed.size());
        words.insert(words.end(), affine.fixed.begin(), affine.fixed.end());
        words.insert(words.end(), affine.relations.of_fixed.begin(), affine.relations.of_fixed.end());
    }
    count(given.hidden.size());
    for (const Bond &bond : given.hidden) words.insert(words.end(), {double(bond.i), double(bond.j), bond.length});
    for (const NearestStep &link : given.links) words.insert(words.end(), {double(link.atom), double(link.before)});
    return words;
}

}  // namespace

std::int32_t Bodies::find_body(std::int32_t n, const double *masses, const double *coordinates,
                               const AffinePart *affine) {
    const Relations none, &relations = affine ? affine->relations : none;
    const bool is_rigid = !affine || affine->is_rigid();
    Hash hash;
    for (std::int32_t a = 0; a < n; ++a) hash.take(masses[a]);
    for (std::int32_t a = 0; a < 3 * n; ++a) hash.take(coordinates[a]);
    hash.take(relations.n_atoms);
    for (const double c : relations.c) hash.take(c);
    for (const double c : relations.of_fixed) hash.take(c);
    const auto range = body_of_hash_.equal_range(hash.value());
    for (auto found = range.first; found != range.second; ++found) {
        const Body &body = body_kinds_[at(found->second)];
        if (body.n_atoms == n && same_words(body.masses.data(), masses, at(n)) &&
            same_words(body.coordinates.data(), coordinates, 3 * at(n)) && body.is_rigid == is_rigid &&
            body.relations.c.size() == relations.c.size() &&
            same_words(body.relations.c.data(), relations.c.data(), relations.c.size()) &&
            body.relations.of_fixed.size() == relations.of_fixed.size() &&
            same_words(body.relations.of_fixed.data(), relations.of_fixed.data(), relations.of_fixed.size()) &&
            (is_rigid || body.extent == affine->extent))
            return found->second;
    }
    const std::int32_t number = static_cast<std::int32_t>(body_kinds_.size());
    body_kinds_.push_back(is_rigid ? make_body(n, masses, coordinates)
                                   : make_affine(masses, relations, affine->extent));
    body_of_hash_.emplace(hash.value(), number);
    return number;
}

std::int32_t Bodies::find_kind(const Given &given) {
    std::vector<double> words = signature_of(given);
    if (!molecules_.empty()) {  // most are like the one before
        const std::int32_t last = molecules_.back().kind;
        const std::vector<double> &its = kinds_[at(last)].signature;
        if (its.size() == words.size() && same_words(its.data(), words.data(), words.size())) return last;
    }
    const std::uint64_t hash = hash_of(words);
    const auto range = kind_of_hash_.equal_range(hash);
    for (auto found = range.first; found != range.second; ++found) {
        const std::vector<double> &its = kinds_[at(found->second)].signature;
        if (its.size() == words.size() && same_words(its.data(), words.data(), words.size())) return found->second;
    }
    MoleculeKind kind;
    kind.signature = std::move(words);
    kind.n_atoms = static_cast<std::int32_t>(given.atoms.size());
    kind.n_movable = given.n_movable;
    kind.mass = given.masses;
    kind.bonds = given.bonds;
    kind.by_lengths = given.by_lengths;
    kind.has_images = given.has_images;
    kind.hidden = given.hidden;
    kind.links = given.links;
    for (std::size_t b = 0; b < given.sizes.size(); ++b) {
        try {
            const std::int32_t body = find_body(given.sizes[b], given.masses.data() + kind.n_held,
                                                given.coordinates.data() + 3 * std::ptrdiff_t{kind.n_held},
                                                given.affine.empty() ? nullptr : &given.affine[b]);
            kind.parts.push_back(
                {body, kind.n_held, 0, given.affine.empty() ? std::vector<std::int32_t>() : given.affine[b].fixed});
        } catch (const BodyFault &fault) {
            const std::int32_t atom = fault.atom < 0 ? -1 : kind.n_held + fault.atom;
            throw Refusal{Refusal::of_body, {fault.cause, atom}, {}, static_cast<std::int64_t>(b)};
        }
        kind.n_held += given.sizes[b];
    }
    try {
        complete(kind, body_kinds_);
    } catch (const Unsolvable &unsolvable) {
        throw Refusal{Refusal::of_bonds, {}, unsolvable, 0};
    }
    const std::int32_t number = static_cast<std::int32_t>(kinds_.size());
    scratch_bytes_ = std::max(scratch_bytes_, System::bytes(kind));
    if (kind.is_lone_body) block_bytes_ = std::max(block_bytes_, bytes_of_block(kind));
    longest_ = std::max(longest_, kind.longest);
    kinds_.push_back(std::move(kind));
    kind_of_hash_.emplace(hash, number);
    return number;
}

void Bodies::add(const Given &given) {
    const std::int32_t number = find_kind(given);
    const MoleculeKind &its = kinds_[at(number)];
    const bool consecutive =
        std::adjacent_find(given.atoms.begin(), given.atoms.end(),
                           [](std::int64_t a, std::int64_t b) { return b != a + 1; }) == given.atoms.end();
    molecules_.push_back(
        {number, consecutive, static_cast<std::int64_t>(atoms_.size()), static_cast<std::int64_t>(bonds_.size())});
    atoms_.insert(atoms_.end(), given.atoms.begin(), given.atoms.end());
    bonds_.insert(bonds_.end(), given.bond_numbers.begin(), given.bond_numbers.end());
    for (std::int32_t a = 0; a < its.n_held; ++a)
        if (given.masses[at(a)] == 0) sites_.insert(given.atoms[at(a)]);
    fixed_.insert(fixed_.end(), given.atoms.begin() + its.n_movable, given.atoms.end());
    if (!active_.empty()) active_.push_back(1);
    work_ += its.n_rows + its.n_atoms;
}

Given Bodies::given(std::int64_t molecule) const {
    const MoleculeKind &its = kind(molecule);
    Given given;
    const std::int64_t *const list = atoms(molecule), *const numbers = bonds(molecule);
    given.atoms.assign(list, list + its.n_atoms);
    given.bonds = its.bonds;
    given.bond_numbers.assign(numbers, numbers + its.bonds.size());
    given.n_movable = its.n_movable;
    given.by_lengths = its.by_lengths;
    given.has_images = its.has_images;
    given.hidden = its.hidden;
    given.links = its.links;
    given.masses = its.mass;
    for (const Part &part : its.parts) {
        const Body &kind = body(part);
        given.sizes.push_back(kind.n_atoms);
        given.coordinates.insert(given.coordinates.end(), kind.coordinates.begin(), kind.coordinates.end());
        given.affine.push_back({kind.relations, kind.is_rigid ? 0 : kind.extent, part.fixed});
    }
    if (std::all_of(given.affine.begin(), given.affine.end(),
                    [](const AffinePart &affine) { return affine.is_rigid(); }))
        given.affine.clear();
    return given;
}

Bodies::Mark Bodies::mark() const {
    return {molecules_.size(), body_kinds_.size(), kinds_.size(),  atoms_.size(), bonds_.size(), fixed_.size(),
            active_.size(),    longest_,           scratch_bytes_, block_bytes_,  work_};
}

void Bodies::roll_back(const Mark &before) {
    for (std::size_t i = before.atoms; i < atoms_.size(); ++i) sites_.erase(atoms_[i]);
    const auto forget = [](std::unordered_multimap<std::uint64_t, std::int32_t> &numbers, std::size_t n) {
        for (auto entry = numbers.begin(); entry != numbers.end();)
            entry = at(entry->second) < n ? std::next(entry) : numbers.erase(entry);
    };
    forget(body_of_hash_, before.body_kinds);
    forget(kind_of_hash_, before.kinds);
    body_kinds_.erase(body_kinds_.begin() + static_cast<std::ptrdiff_t>(before.body_kinds), body_kinds_.end());
    kinds_.erase(kinds_.begin() + static_cast<std::ptrdiff_t>(before.kinds), kinds_.end());
    molecules_.erase(molecules_.begin() + static_cast<std::ptrdiff_t>(before.molecules), molecules_.end());
    atoms_.resize(before.atoms);
    bonds_.resize(before.bonds);
    fixed_.resize(before.fixed);
    active_.resize(before.active);
    longest_ = before.longest;
    scratch_bytes_ = before.scratch_bytes;
    block_bytes_ = before.block_bytes;
    work_ = before.work;
}

void Bodies::set_active(const unsigned char *active) {
    if (active)
        active_.assign(active, active + n_molecules());
    else
        active_.clear();
}

std::int64_t Bodies::constraints(int dimensions) const {
    std::vector<std::int64_t> of_kind(kinds_.size(), -1);
    std::int64_t sum = 0;
    for (std::int64_t m = 0; m < n_molecules(); ++m) {
        if (!is_active(m)) continue;
        std::int64_t &taken = of_kind[at(molecules_[at(m)].kind)];
        if (taken < 0) taken = constraints(m, dimensions);
        sum += taken;
    }
    return sum;
}

std::int64_t Bodies::constraints(std::int64_t molecule, int dimensions) const {
    const MoleculeKind &its = kind(molecule);
    std::int64_t taken = static_cast<std::int64_t>(its.hidden.size());
    for (const Bond &bond : its.bonds) taken += bond.row >= 0;
    for (const Part &part : its.parts) {
        const Body &kind = body(part);
        const int left = !kind.is_rigid ? dimensions * (1 + kind.rank) : dimensions == 2 ? 3 : kind.rank == 1 ? 5 : 6;
        taken += dimensions * kind.n_massive - left;
    }
    return taken;
}

std::int64_t Bodies::bytes() const {
    std::int64_t sum =
        static_cast<std::int64_t>(sizeof *this + molecules_.capacity() * sizeof(MoleculeOfKind) + active_.capacity() +
                                  (atoms_.capacity() + bonds_.capacity() + fixed_.capacity()) * sizeof(std::int64_t)) +
        static_cast<std::int64_t>(32 * sites_.size());
    for (const MoleculeKind &its : kinds_) sum += its.bytes();
    for (const Body &kind : body_kinds_) sum += kind.bytes();
    return sum;
}

}  // namespace holonomic::rigid
