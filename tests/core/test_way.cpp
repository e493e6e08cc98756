// Which way molecules of each kind take: the table of docs/architecture.md, which has these lines and no others.
#include <fstream>
#include <string>

#include "plan_checks.hpp"

using namespace plan_checks;
using holonomic::Way;

namespace
{

const char *name_of(Way way)
{
    switch (way) {
        case Way::triangle:
            return "triangle";
        case Way::star:
            return "star";
        case Way::ring:
            return "ring";
        case Way::tree:
            return "tree";
        case Way::sparse_ldl:
            return "sparse_ldl";
        case Way::large_tree:
            return "large_tree";
        case Way::armed_tree:
            return "armed_tree";
        case Way::paths:
            return "paths";
        case Way::network:
            return "network";
        case Way::extended:
            return "extended";
    }
    return "none";
}

Bonds ring(int n)
{
    Bonds bonds;
    for (int i = 0; i < n; ++i) bonds.push_back({i, (i + 1) % n});
    return bonds;
}

Bonds star(int n)
{
    Bonds bonds;
    for (int i = 1; i <= n; ++i) bonds.push_back({0, i});
    return bonds;
}

/** A backbone, with side chains of `side` bonds at each of its atoms. */
Bonds brush(int backbone, int side)
{
    Bonds bonds;
    for (int i = 1; i < backbone; ++i) bonds.push_back({i - 1, i});
    int next = backbone;
    for (int i = 0; i < backbone; ++i)
        for (int k = 0; k < side; ++k, ++next) bonds.push_back({k == 0 ? i : next - 1, next});
    return bonds;
}

/** Each atom of a level has two children. */
Bonds dendrimer(int n_atoms)
{
    Bonds bonds;
    for (int i = 1; i < n_atoms; ++i) bonds.push_back({(i - 1) / 2, i});
    return bonds;
}

/** Strands of so many bonds between the nodes of a square lattice that closes. */
Bonds lattice(int side, int strand)
{
    Bonds bonds;
    int next = side * side;
    const auto add = [&](int from, int to) {
        for (int k = 0; k < strand; ++k) {
            const int end = k + 1 == strand ? to : next++;
            bonds.push_back({from, end});
            from = end;
        }
    };
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
            add(i * side + j, (i + 1) % side * side + j);
            add(i * side + j, i * side + (j + 1) % side);
        }
    return bonds;
}

/** A backbone of residues, each with a ring of six at a side atom. */
Bonds residues(int n)
{
    Bonds bonds;
    int last = -1;
    for (int i = 0; i < n; ++i) {
        const int first = 9 * i;
        if (last >= 0) bonds.push_back({last, first});
        bonds.push_back({first, first + 1});
        bonds.push_back({first + 1, first + 2});
        bonds.push_back({first + 1, first + 3});
        for (int k = 0; k < 6; ++k) bonds.push_back({first + 3 + k, first + 3 + (k + 1) % 6});
        last = first + 2;
    }
    return bonds;
}

int atoms_of(const Bonds &bonds)
{
    int most = 0;
    for (const auto &b : bonds) most = std::max(most, std::max(b.first, b.second));
    return most + 1;
}

Bonds with(Bonds bonds, const Bonds &more)
{
    bonds.insert(bonds.end(), more.begin(), more.end());
    return bonds;
}

std::string text_of_page()
{
    std::ifstream file(ARCHITECTURE_PAGE);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

int lines = 0;

void expect(const std::string &page, const char *molecule, const Bonds &bonds)
{
    current = molecule;
    const auto s = plan_of_bonds(bonds, atoms_of(bonds));
    const std::string line = std::string("| ") + molecule + " | " + name_of(s->way.forces) + " | " +
                             name_of(s->way.given) + " | " + name_of(s->way.positions) + " | " +
                             name_of(s->way.metric) + " | " + (s->alone ? "alone" : "in lanes") + " |\n";
    std::printf("%s", line.c_str());
    require(page.find(line) != std::string::npos, "docs/architecture.md has not this line");
    ++lines;
}

/** Lines of the table of the page. */
int lines_of(const std::string &page)
{
    const std::string head = "| molecule | forces, velocities | right-hand sides given | positions | metric | |\n";
    std::size_t next = page.find(head);
    require(next != std::string::npos, "docs/architecture.md has no table of ways");
    int n = -1;  // the rule below the head
    for (next += head.size(); page[next] == '|'; next = page.find('\n', next) + 1) ++n;
    return n;
}

}  // namespace

int main()
{
    const std::string page = text_of_page();
    expect(page, "water, three distances", ring(3));
    expect(page, "CH3, three bonds at one atom", star(3));
    expect(page, "CH4, four bonds at one atom", star(4));
    expect(page, "butane with its hydrogens",
           with(brush(4, 0), {{0, 4}, {0, 5}, {0, 6}, {1, 7}, {1, 8}, {2, 9}, {2, 10}, {3, 11}, {3, 12}, {3, 13}}));
    expect(page, "star of 100 bonds", star(100));
    expect(page, "ring of 50 bonds", ring(50));
    expect(page, "ring of six with a tail", with(ring(6), {{0, 6}, {6, 7}}));
    expect(page, "two rings joined by a bond", with(ring(6), {{0, 6}, {6, 7}, {7, 8}, {8, 6}}));
    expect(page, "dendrimer of 1022 bonds", dendrimer(1023));
    expect(page, "dendrimer of 8190 bonds", dendrimer(8191));
    expect(page, "dendrimer of 131,070 bonds", dendrimer(131071));
    expect(page, "ring of 5000 bonds", ring(5000));
    expect(page, "polyethylene with hydrogens, 6000 bonds", with(brush(2000, 1), [] {
               Bonds second;
               for (int i = 0; i < 2000; ++i) second.push_back({i, 4000 + i});
               return second;
           }()));
    expect(page, "bottle brush, 200 side chains of 50 bonds", brush(200, 50));
    expect(page, "star of 20 arms of 200 bonds", [] {
        Bonds bonds;
        for (int arm = 0; arm < 20; ++arm)
            for (int k = 0; k < 200; ++k) bonds.push_back({k == 0 ? 0 : 200 * arm + k, 200 * arm + k + 1});
        return bonds;
    }());
    expect(page, "protein of 200 residues with rings", residues(200));
    expect(page, "gel, 200 strands of 10 bonds", lattice(10, 10));
    expect(page, "lattice of single bonds", lattice(40, 1));
    expect(page, "hub of 4000 bonds", star(4000));
    require(lines == lines_of(page), "docs/architecture.md has lines that are not tried");
    return 0;
}
