#include "molecule_tally.hpp"

#include <algorithm>
#include <cstdio>

namespace stress
{

bool molecule_tally::add(const hostile_molecule &m, const molecule_facts &facts, const molecule_verdict &v)
{
    of_class &here = classes[m.shape];
    bool exceeds = false;
    ++here.molecules;
    here.bonds += m.n_bonds();
    here.singular += !facts.regular;
    here.not_promised += facts.regular && !facts.promised;
    if (facts.regular) here.largest_condition = std::max(here.largest_condition, facts.condition);
    for (std::size_t q = 0; q < here.quantity.size(); ++q) {
        of_quantity &of = here.quantity[q];
        if (v.ratio[q] < 0) continue;
        ++of.checked;
        of.exceeded += v.ratio[q] > 1;
        exceeds = exceeds || (v.ratio[q] > 1 && !is_information(static_cast<int>(q)));
        if (v.ratio[q] > of.worst) {
            of.worst = v.ratio[q];
            of.seed = m.seed;
        }
    }
    here.exceeded += exceeds;
    return exceeds;
}

void molecule_tally::add(const molecule_tally &other)
{
    for (std::size_t c = 0; c < classes.size(); ++c) {
        of_class &here = classes[c];
        const of_class &there = other.classes[c];
        here.molecules += there.molecules;
        here.bonds += there.bonds;
        here.singular += there.singular;
        here.not_promised += there.not_promised;
        here.exceeded += there.exceeded;
        here.largest_condition = std::max(here.largest_condition, there.largest_condition);
        for (std::size_t q = 0; q < here.quantity.size(); ++q) {
            here.quantity[q].checked += there.quantity[q].checked;
            here.quantity[q].exceeded += there.quantity[q].exceeded;
            if (there.quantity[q].worst > here.quantity[q].worst) {
                here.quantity[q].worst = there.quantity[q].worst;
                here.quantity[q].seed = there.quantity[q].seed;
            }
        }
    }
}

bool molecule_tally::within(long double excess, double share) const
{
    for (const of_class &here : classes) {
        if (static_cast<double>(here.exceeded) > share * static_cast<double>(here.molecules)) return false;
        for (std::size_t q = 0; q < here.quantity.size(); ++q)
            if (!is_information(static_cast<int>(q)) && here.quantity[q].worst > excess) return false;
    }
    return true;
}

void molecule_tally::print() const
{
    for (std::size_t c = 0; c < classes.size(); ++c) {
        const of_class &here = classes[c];
        std::printf(
            "\n%s: %lld, %lld bonds, condition numbers up to %.1Le, %lld singular, %lld promised nothing, "
            "%lld exceed a bound\n",
            class_name(static_cast<int>(c)), static_cast<long long>(here.molecules), static_cast<long long>(here.bonds),
            here.largest_condition, static_cast<long long>(here.singular), static_cast<long long>(here.not_promised),
            static_cast<long long>(here.exceeded));
        std::printf("%-14s %10s %16s %9s %10s\n", "quantity", "checked", "worst err/bound", "exceeded", "molecule");
        for (std::size_t q = 0; q < here.quantity.size(); ++q) {
            const of_quantity &of = here.quantity[q];
            if (of.checked == 0) continue;
            std::printf("%-14s %10lld %16.3Lg %9lld %10llu%s\n", molecule_quantity_name(static_cast<int>(q)),
                        static_cast<long long>(of.checked), of.worst, static_cast<long long>(of.exceeded),
                        static_cast<unsigned long long>(of.seed),
                        is_information(static_cast<int>(q)) ? "  (for information)" : "");
        }
    }
}

}  // namespace stress
