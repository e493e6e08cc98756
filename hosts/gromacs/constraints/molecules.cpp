#include "molecules.hpp"

#include <algorithm>
#include <cmath>
#include <regex>

namespace holonomic {

namespace {

// Frozen atoms have the inverse mass 1e-30 there, so that LINCS need not divide by zero.
double mass_of(real inverse_mass) { return inverse_mass > real(1e-29) ? 1 / double(inverse_mass) : 0; }

std::vector<Bond> constraints_of(const InteractionDefinitions &definitions, bool dynamics) {
    std::vector<Bond> list;
    for (int kind : {F_CONSTR, F_CONSTRNC}) {
        const std::vector<int> &numbers = definitions.il[kind].iatoms;
        for (size_t k = 0; k + 2 < numbers.size(); k += 3) {
            const auto &constraint = definitions.iparams[numbers[k]].constr;
            const bool is_flexible = constraint.dA == 0 && constraint.dB == 0;
            if (is_flexible && !dynamics) continue;  // minimisation finds these lengths
            list.push_back({numbers[k + 1], numbers[k + 2], constraint.dA, constraint.dB});
        }
    }
    return list;
}

}  // namespace

void Molecules::set(const InteractionDefinitions &definitions, int n_atoms, gmx::ArrayRef<const real> inverse_masses,
                    double lambda, bool dynamics) {
    std::vector<double> new_masses(n_atoms, 0);
    for (int i = 0; i < std::min<int>(n_atoms, static_cast<int>(inverse_masses.size())); i++)
        new_masses[i] = mass_of(inverse_masses[i]);
    std::vector<Bond> new_list = constraints_of(definitions, dynamics);
    if (!topology.empty()) leave_own(new_list, n_atoms);
    if (handle && topology.empty() && new_list == list && new_masses == all_masses) return set_lambda(lambda);
    list.swap(new_list);
    all_masses.swap(new_masses);
    lambda_of_lengths = lambda_of_masses = lambda;
    make();
    if (!topology.empty()) find_shares();
}

void Molecules::leave_own(std::vector<Bond> &bonds, int n_atoms) const {
    const auto number_of = [](int atom) { return ddglatnr(domain, atom) - 1; };
    const int missing = holonomic::leave_own(bonds, n_atoms, n_home, topology, number_of);
    if (missing < 0) return;
    gmx_fatal(
        0, __FILE__, __LINE__,
        "Constraints by holonomic: the molecule of atom %d lies on several ranks, and this one has not been given all "
        "of its constraints: they reach further than lincs-order + 1 bonds from its atoms. Use one rank and threads: "
        "mdrun -ntmpi 1 -ntomp N, or one process of an MPI build; or, for a molecule that is small, a lincs-order of "
        "as many bonds as it is long.",
        number_of(missing) + 1);
}

void Molecules::find_shares() {
    shares.clear();
    for (const Bond &bond : arrangement.bonds)
        shares.push_back(0.5 * ((arrangement.atoms[bond.first] < n_home) + (arrangement.atoms[bond.second] < n_home)));
}

void Molecules::make() {
    const std::vector<Kind> old_kinds = std::move(arrangement.kinds);
    const std::vector<double> old_masses = std::move(masses);
    const std::vector<Bond> old_bonds = std::move(arrangement.bonds);
    arrangement = arrange(list, all_masses);
    masses.clear();
    any_perturbed = any_flexible = false;
    bool any_moves = false;
    for (int atom : arrangement.atoms) {
        masses.push_back(all_masses[atom]);
        any_moves |= masses.back() > 0;
    }
    for (const Bond &bond : arrangement.bonds) {
        any_perturbed |= bond.a != bond.b;
        any_flexible |= bond.a == 0 && bond.b == 0;
    }
    set_lengths();
    // Atoms that went from one domain to another may leave all as it was here, but for where it stands.
    if (handle && arrangement.kinds == old_kinds && masses == old_masses && arrangement.bonds == old_bonds)
        return check(hol_chains_set_lengths(handle.get(), lengths.data()));
    const bool is_first = !handle;
    handle.reset();  // before memory is taken for the next
    if (!any_moves) return;
    hol_chains *made = nullptr;
    check(hol_chains_create(static_cast<int64_t>(masses.size()), masses.data(), &made));
    handle.reset(made);
    if (!add(made)) {
        set_labels();
        add(made);
        end_run();
    }
    threads = std::max(1, gmx_omp_nthreads_get(ModuleMultiThread::Lincs));
    check(hol_chains_set_threads(made, threads));
    // A hundredth of what single precision can hold: displacements are rounded to that.
    if (!GMX_DOUBLE) check(hol_chains_set_tolerance(made, 1e-8));
    // Once they have run, a molecule that went astray must not keep the others from being solved.
    if (!is_first) check(hol_chains_set_checks(made, HOL_NEVER));
}

bool Molecules::add(hol_chains *chains) const {
    std::vector<int64_t> pairs;
    for (const Kind &kind : arrangement.kinds) {
        pairs.clear();
        for (int64_t k = kind.first_bond; k < kind.first_bond + kind.n_bonds; k++) {
            pairs.push_back(arrangement.bonds[k].first - kind.first_atom);
            pairs.push_back(arrangement.bonds[k].second - kind.first_atom);
        }
        if (hol_chains_add_molecules(chains, kind.count, kind.n_atoms, kind.first_atom, kind.n_bonds, pairs.data(),
                                     &lengths[kind.first_bond]) != HOL_OK)
            return false;
    }
    return true;
}

bool Molecules::set_lengths() {
    const std::vector<double> before = std::move(lengths);
    lengths.resize(arrangement.bonds.size());
    for (size_t k = 0; k < lengths.size(); k++) {
        const Bond &bond = arrangement.bonds[k];
        lengths[k] = bond.a + lambda_of_lengths * (bond.b - bond.a);
        // A flexible one is known when positions are: any length until then.
        if (flexible(k)) lengths[k] = before.size() == lengths.size() ? before[k] : 0.1;
    }
    find_shortest();
    return lengths != before;
}

void Molecules::find_shortest() {
    const auto least = std::min_element(lengths.begin(), lengths.end());
    shortest_length = least == lengths.end() ? 0 : *least;
}

void Molecules::set_lambda(double lambda) {
    if (!any_perturbed || lambda == lambda_of_lengths) return;
    lambda_of_lengths = lambda;
    if (set_lengths() && handle) check(hol_chains_set_lengths(handle.get(), lengths.data()));
}

void Molecules::set_masses(gmx::ArrayRef<const real> inverse_masses, double lambda) {
    for (size_t k = 0; k < masses.size(); k++) masses[k] = mass_of(inverse_masses[arrangement.atoms[k]]);
    lambda_of_masses = lambda;
    if (handle) check(hol_chains_set_masses(handle.get(), masses.data()));
}

void Molecules::set_flexible(const double *x) {
    if (!any_flexible || !handle) return;
    for (size_t k = 0; k < lengths.size(); k++) {
        if (!flexible(k)) continue;
        const double *const i = x + 3 * arrangement.bonds[k].first, *const j = x + 3 * arrangement.bonds[k].second;
        lengths[k] =
            std::sqrt((j[0] - i[0]) * (j[0] - i[0]) + (j[1] - i[1]) * (j[1] - i[1]) + (j[2] - i[2]) * (j[2] - i[2]));
    }
    find_shortest();
    check(hol_chains_set_lengths(handle.get(), lengths.data()));
}

int Molecules::number(int place) const { return ddglatnr(domain, arrangement.atoms[place]); }

void Molecules::set_labels() const {
    std::vector<int64_t> labels;
    for (size_t k = 0; k < n_atoms(); k++) labels.push_back(number(static_cast<int>(k)));
    hol_chains_set_labels(handle.get(), labels.data(), nullptr);
}

// "atom 3 (label 17)" is the atom 17 of the topology.
std::string Molecules::words() {
    static const std::regex labelled("[0-9]+ \\(label ([0-9]+)\\)");
    return std::regex_replace(hol_error_message(), labelled, "$1");
}

void Molecules::end_run() const {
    gmx_fatal(0, __FILE__, __LINE__,
              "Constraints by holonomic: %s\nAtoms are counted as in the topology, over all molecules.",
              words().c_str());
}

}  // namespace holonomic
