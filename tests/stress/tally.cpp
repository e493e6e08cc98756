#include "tally.hpp"

#include <algorithm>
#include <cstdio>

#include "markdown_table.hpp"

namespace stress
{

void tally::add(const hostile_chain &c, const verdict &v)
{
    ++chains;
    bonds += c.n_bonds;
    exceeded += v.exceeded();
    for (std::size_t bit = 0; bit < with_feature.size(); ++bit) {
        if (!(c.features >> bit & 1u)) continue;
        ++with_feature[bit];
        exceeded_with_feature[bit] += v.exceeded();
    }
    for (std::size_t q = 0; q < quantity.size(); ++q) {
        of_quantity &here = quantity[q];
        if (v.ratio[q] < 0) continue;
        ++here.checked;
        here.exceeded += v.ratio[q] > 1;
        if (v.ratio[q] > here.worst) {
            here.worst = v.ratio[q];
            here.seed = c.seed;
        }
    }
}

void tally::add(const tally &other)
{
    chains += other.chains;
    bonds += other.bonds;
    singular += other.singular;
    exceeded += other.exceeded;
    largest_condition = std::max(largest_condition, other.largest_condition);
    for (std::size_t bit = 0; bit < with_feature.size(); ++bit) {
        with_feature[bit] += other.with_feature[bit];
        exceeded_with_feature[bit] += other.exceeded_with_feature[bit];
    }
    for (std::size_t q = 0; q < quantity.size(); ++q) {
        quantity[q].checked += other.quantity[q].checked;
        quantity[q].exceeded += other.quantity[q].exceeded;
        if (other.quantity[q].worst > quantity[q].worst) {
            quantity[q].worst = other.quantity[q].worst;
            quantity[q].seed = other.quantity[q].seed;
        }
    }
}

long double tally::worst() const
{
    long double largest = 0;
    for (int q = 0; q < N_QUANTITIES; ++q)
        if (!for_information(q)) largest = std::max(largest, quantity[static_cast<std::size_t>(q)].worst);
    return largest;
}

namespace
{

void write_markdown(const std::vector<std::string> &sets, const std::vector<tally> &of_set)
{
    const markdown_table table(sets);
    if (!table.out) return;
    table.row("chains", [&](std::size_t s) { return std::to_string(of_set[s].chains); });
    table.row("above a bound", [&](std::size_t s) { return std::to_string(of_set[s].exceeded); });
    table.row("lambda above K alone",
              [&](std::size_t s) { return std::to_string(of_set[s].quantity[LAMBDA_NEAR].exceeded); });
    for (std::size_t q = 0; q < N_QUANTITIES; ++q)
        if ((!for_information(static_cast<int>(q)) || q == LAMBDA_NEAR) && of_set[0].quantity[q].checked > 0)
            table.row(quantity_name(static_cast<int>(q)),
                      [&](std::size_t s) { return table.number(of_set[s].quantity[q].worst); });
}

}  // namespace

void print(const std::vector<std::string> &sets, const std::vector<tally> &of_set)
{
    std::printf("\n%-14s %10s", "worst err/bound", "checked");
    for (const std::string &set : sets) std::printf(" %9s", set.c_str());
    std::printf(" %9s %8s\n", "exceeded", "chain");
    for (std::size_t q = 0; q < N_QUANTITIES; ++q) {
        tally::of_quantity all;
        for (const tally &t : of_set) {
            const tally::of_quantity &here = t.quantity[q];
            all.checked += here.checked;
            all.exceeded += here.exceeded;
            if (here.worst > all.worst) all.worst = here.worst, all.seed = here.seed;
        }
        if (all.checked == 0) continue;
        std::printf("%-15s %10lld", quantity_name(static_cast<int>(q)), static_cast<long long>(all.checked));
        for (const tally &t : of_set) std::printf(" %9.3Lg", t.quantity[q].worst);
        std::printf(" %9lld %8llu%s\n", static_cast<long long>(all.exceeded), static_cast<unsigned long long>(all.seed),
                    for_information(static_cast<int>(q)) ? "  (for information)" : "");
    }
    write_markdown(sets, of_set);
    tally all;
    for (const tally &t : of_set) all.add(t);
    std::printf("\n%-20s %10s %10s\n", "chains with", "checked", "exceeded");
    for (int bit = 0; bit < n_features; ++bit)
        std::printf("%-20s %10lld %10lld\n", feature_name(bit),
                    static_cast<long long>(all.with_feature[static_cast<std::size_t>(bit)]),
                    static_cast<long long>(all.exceeded_with_feature[static_cast<std::size_t>(bit)]));
    std::printf("\n");
    for (std::size_t s = 0; s < sets.size(); ++s)
        std::printf(
            "stress: %lld chains with %s, %lld bonds, condition numbers up to %.1Le, %lld singular, %lld exceed "
            "a bound\n",
            static_cast<long long>(of_set[s].chains), sets[s].c_str(), static_cast<long long>(of_set[s].bonds),
            of_set[s].largest_condition, static_cast<long long>(of_set[s].singular),
            static_cast<long long>(of_set[s].exceeded));
    std::printf("stress: %lld chains, %lld exceed a bound\n", static_cast<long long>(all.chains),
                static_cast<long long>(all.exceeded));
}

}  // namespace stress
