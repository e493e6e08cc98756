#include "molecules.hpp"

#include <cmath>

namespace holonomic {

namespace {

// Frozen atoms have the inverse mass 1e-30 there, so that LINCS need not divide by zero.
double mass_of(real inverse_mass) { return inverse_mass > real(1e-29) ? 1 / double(inverse_mass) : 0; }

std::vector<double> masses_of(gmx::ArrayRef<const real> inverse_masses, size_t n_atoms) {
    std::vector<double> masses(n_atoms, 0);
    for (size_t i = 0; i < std::min<size_t>(n_atoms, inverse_masses.size()); i++)
        masses[i] = mass_of(inverse_masses[i]);
    return masses;
}

bool same_are_fixed(const std::vector<double> &a, const std::vector<double> &b) {
    if (a.size() != b.size()) return false;
    for (size_t i = 0; i < a.size(); i++)
        if ((a[i] > 0) != (b[i] > 0)) return false;
    return true;
}

void check(int status, const char *hint) {
    if (status != HOL_OK) end_run(hint);
}

}  // namespace

void end_run(const std::string &hint) {
    gmx_fatal(0, __FILE__, __LINE__, "Constraints by holonomic: %s%s%s", hol_error_message(), hint.empty() ? "" : "\n",
              hint.c_str());
}

void Molecules::set(const InteractionDefinitions &definitions, int n_atoms, gmx::ArrayRef<const real> inverse_masses,
                    double lambda, bool dynamics) {
    std::vector<int64_t> new_pairs;
    new_pairs.reserve(pairs.size());
    length_a.clear();
    length_b.clear();
    any_perturbed = any_flexible = false;
    for (int kind : {F_CONSTR, F_CONSTRNC}) {
        const std::vector<int> &list = definitions.il[kind].iatoms;
        for (size_t k = 0; k + 2 < list.size(); k += 3) {
            const auto &constraint = definitions.iparams[list[k]].constr;
            const bool is_flexible = constraint.dA == 0 && constraint.dB == 0;
            if (is_flexible && !dynamics) continue;  // minimisation finds them
            any_flexible |= is_flexible;
            any_perturbed |= constraint.dA != constraint.dB;
            new_pairs.push_back(list[k + 1] + 1);
            new_pairs.push_back(list[k + 2] + 1);
            length_a.push_back(constraint.dA);
            length_b.push_back(constraint.dB);
        }
    }
    std::vector<double> new_masses = masses_of(inverse_masses, n_atoms);
    lambda_of_lengths = lambda_of_masses = lambda;
    const bool same = handle && new_pairs == pairs && same_are_fixed(new_masses, masses);
    const bool other_masses = new_masses != masses;
    pairs.swap(new_pairs);
    masses.swap(new_masses);
    const bool other_lengths = set_lengths();
    if (!same) return make();
    if (other_lengths)
        check(hol_chains_set_lengths(handle.get(), lengths.data()), "These lengths are of the constraints' list.");
    if (other_masses) check(hol_chains_set_masses(handle.get(), masses.data()), "");
}

void Molecules::make() {
    handle.reset();
    if (pairs.empty()) return;
    // Where no atom can move there is nothing to do; the library refuses masses that are all 0.
    bool all_fixed = true;
    for (int64_t atom : pairs) all_fixed &= masses[atom - 1] == 0;
    if (all_fixed) return;
    hol_chains *made = nullptr;
    check(hol_chains_create(static_cast<int64_t>(masses.size()), masses.data(), &made), "");
    handle.reset(made);
    check(hol_chains_set_index_base(made, 1), "");
    check(hol_chains_add_bonds(made, static_cast<int64_t>(lengths.size()), pairs.data(), lengths.data()),
          "Atoms are counted as in the topology. The list is what `constraints` of the run's parameters and [ constraints ] "
          "of\nthe topology make of it.");
    check(hol_chains_set_threads(made, std::max(1, gmx_omp_nthreads_get(ModuleMultiThread::Lincs))), "");
}

bool Molecules::set_lengths() {
    const std::vector<double> before = lengths;
    lengths.resize(length_a.size());
    for (size_t k = 0; k < lengths.size(); k++) {
        lengths[k] = length_a[k] + lambda_of_lengths * (length_b[k] - length_a[k]);
        // Known when positions are: any length until then.
        if (lengths[k] == 0) lengths[k] = before.size() == lengths.size() ? before[k] : 0.1;
    }
    return lengths != before;
}

void Molecules::set_lambda(double lambda) {
    if (!any_perturbed || lambda == lambda_of_lengths) return;
    lambda_of_lengths = lambda;
    if (set_lengths() && handle)
        check(hol_chains_set_lengths(handle.get(), lengths.data()), "These lengths are those of lambda.");
}

void Molecules::set_masses(gmx::ArrayRef<const real> inverse_masses, double lambda) {
    masses = masses_of(inverse_masses, masses.size());
    lambda_of_masses = lambda;
    if (handle) check(hol_chains_set_masses(handle.get(), masses.data()), "These masses are those of lambda.");
}

void Molecules::set_flexible(const hol_view &x) {
    if (!any_flexible || !handle) return;
    std::vector<double> off(lengths.size());
    check(hol_residuals_view(handle.get(), &x, nullptr, off.data(), nullptr), "");
    for (size_t k = 0; k < lengths.size(); k++)
        if (flexible(k)) lengths[k] *= std::sqrt(1 + off[k]);
    check(hol_chains_set_lengths(handle.get(), lengths.data()), "Some of these are flexible constraints.");
}

void Molecules::set_box(const t_pbc *pbc) {
    if (!handle) return;
    if (pbc == nullptr || pbc->pbcType == PbcType::No) {
        check(hol_chains_set_box(handle.get(), nullptr), "");
        return;
    }
    double box[3][3] = {};
    const int n_periodic = pbc->pbcType == PbcType::XY ? 2 : 3;
    for (int a = 0; a < n_periodic; a++)
        for (int b = 0; b < 3; b++) box[a][b] = pbc->box[a][b];
    check(hol_chains_set_box(handle.get(), &box[0][0]), "");
}

void Molecules::set_labels(const gmx_domdec_t *domains) {
    std::vector<int64_t> labels(masses.size(), 0);
    for (int64_t atom : pairs) labels[atom - 1] = ddglatnr(domains, static_cast<int>(atom) - 1);
    hol_chains_set_labels(handle.get(), labels.data(), nullptr);
}

}  // namespace holonomic
