#include "molecule_tally.hpp"

#include <algorithm>
#include <cstdio>

#include "markdown_table.hpp"

namespace stress
{

bool molecule_tally::add(std::size_t its_class, std::int64_t n_bonds, std::uint64_t seed, const molecule_facts &facts,
                         const molecule_verdict &v)
{
    of_class &here = classes[its_class];
    bool exceeds = false;
    ++here.molecules;
    here.bonds += n_bonds;
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
            of.seed = seed;
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

namespace
{

void write_markdown(const char *(*class_name)(int), std::size_t n_classes, const std::vector<std::string> &sets,
                    const std::vector<molecule_tally> &of_set)
{
    const markdown_table table(sets);
    for (std::size_t c = 0; c < n_classes && table.out; ++c) {
        table.row(class_name(static_cast<int>(c)),
                  [&](std::size_t s) { return std::to_string(of_set[s].classes[c].molecules); });
        table.row("above a bound", [&](std::size_t s) { return std::to_string(of_set[s].classes[c].exceeded); });
        table.row("largest error", [&](std::size_t s) {
            std::size_t most = 0;
            const auto &quantity = of_set[s].classes[c].quantity;
            for (std::size_t q = 1; q < M_QUANTITIES; ++q)
                if (!is_information(static_cast<int>(q)) && quantity[q].worst > quantity[most].worst) most = q;
            return table.number(quantity[most].worst) + ", " + molecule_quantity_name(static_cast<int>(most));
        });
    }
}

}  // namespace

void print(const char *(*class_name)(int), std::size_t n_classes, const std::vector<std::string> &sets,
           const std::vector<molecule_tally> &of_set)
{
    for (std::size_t c = 0; c < n_classes; ++c) {
        std::printf("\n%s\n%-15s %10s", class_name(static_cast<int>(c)), "worst err/bound", "checked");
        for (const std::string &set : sets) std::printf(" %9s", set.c_str());
        std::printf(" %9s %8s\n", "exceeded", "molecule");
        for (std::size_t q = 0; q < M_QUANTITIES; ++q) {
            molecule_tally::of_quantity all;
            for (const molecule_tally &t : of_set) {
                const molecule_tally::of_quantity &here = t.classes[c].quantity[q];
                all.checked += here.checked;
                all.exceeded += here.exceeded;
                if (here.worst > all.worst) all.worst = here.worst, all.seed = here.seed;
            }
            if (all.checked == 0) continue;
            std::printf("%-15s %10lld", molecule_quantity_name(static_cast<int>(q)),
                        static_cast<long long>(all.checked));
            for (const molecule_tally &t : of_set) std::printf(" %9.3Lg", t.classes[c].quantity[q].worst);
            std::printf(" %9lld %8llu%s\n", static_cast<long long>(all.exceeded),
                        static_cast<unsigned long long>(all.seed),
                        is_information(static_cast<int>(q)) ? "  (for information)" : "");
        }
    }
    write_markdown(class_name, n_classes, sets, of_set);
    std::printf("\n");
    for (std::size_t s = 0; s < sets.size(); ++s)
        for (std::size_t c = 0; c < n_classes; ++c) {
            const molecule_tally::of_class &here = of_set[s].classes[c];
            std::printf(
                "stress: %lld %s with %s, %lld bonds, condition numbers up to %.1Le, %lld singular, %lld "
                "promised nothing, %lld exceed a bound\n",
                static_cast<long long>(here.molecules), class_name(static_cast<int>(c)), sets[s].c_str(),
                static_cast<long long>(here.bonds), here.largest_condition, static_cast<long long>(here.singular),
                static_cast<long long>(here.not_promised), static_cast<long long>(here.exceeded));
        }
}

}  // namespace stress
