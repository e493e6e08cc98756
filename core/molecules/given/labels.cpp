#include "core/molecules/given/labels.hpp"
#include "core/index.hpp"

#include <cstdio>

namespace holonomic {

namespace {

std::vector<std::int64_t> copied(std::int64_t n, const std::int64_t *numbers) {
    return numbers ? std::vector<std::int64_t>(numbers, numbers + n) : std::vector<std::int64_t>();
}

Name labelled(long long number, std::int64_t label) {
    Name name;
    std::snprintf(name.text, sizeof name.text, "%lld (label %lld)", number, static_cast<long long>(label));
    return name;
}

Name plain(long long number) {
    Name name;
    std::snprintf(name.text, sizeof name.text, "%lld", number);
    return name;
}

}  // namespace

void Labels::set(std::int64_t n_atoms, const std::int64_t *atoms, std::int64_t n_molecules,
                 const std::int64_t *molecules) {
    std::vector<std::int64_t> of_atoms = copied(n_atoms, atoms), of_molecules = copied(n_molecules, molecules);
    atoms_.swap(of_atoms);
    molecules_.swap(of_molecules);
}

Name Labels::of_atom(std::int64_t atom, int base) const {
    const long long number = static_cast<long long>(atom + base);
    return at(atom) < atoms_.size() ? labelled(number, atoms_[at(atom)]) : plain(number);
}

Name Labels::of_molecule(std::int64_t molecule, std::int64_t atom, int base) const {
    const long long number = static_cast<long long>(molecule + base);
    if (at(molecule) < molecules_.size()) return labelled(number, molecules_[at(molecule)]);
    if (atoms_.empty()) return plain(number);
    Name name;  // that of an atom has 60 characters at most: two numbers and what joins them
    std::snprintf(name.text, sizeof name.text, "%lld (with atom %.60s)", number, of_atom(atom, base).text);
    return name;
}

std::int64_t Labels::number_of_atom(std::int64_t atom, int base) const {
    return at(atom) < atoms_.size() ? atoms_[at(atom)] : atom + base;
}

std::int64_t Labels::number_of_molecule(std::int64_t molecule, int base) const {
    return at(molecule) < molecules_.size() ? molecules_[at(molecule)] : molecule + base;
}

std::int64_t Labels::bytes() const {
    return static_cast<std::int64_t>((atoms_.capacity() + molecules_.capacity()) * sizeof(std::int64_t));
}

}  // namespace holonomic
