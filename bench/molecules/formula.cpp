// Molecules of atoms from a line of text, and proteins from the lines of their residues.
#include <cctype>
#include <cmath>
#include <map>
#include <stdexcept>

#include "kind.hpp"

namespace bench {
namespace {

double mass_of(char element) {
    static const std::map<char, double> masses = {
        {'H', 1.008}, {'C', 12.011}, {'N', 14.007}, {'O', 15.999}, {'S', 32.06}};
    const auto found = masses.find(element);
    if (found == masses.end()) throw std::invalid_argument(std::string("no element ") + element);
    return found->second;
}

/// Usual lengths in nm: covalent radii.
double radius_of(char element) {
    switch (element) {
        case 'H':
            return 0.032;
        case 'C':
            return 0.077;
        case 'S':
            return 0.104;
        default:
            return 0.070;
    }
}

}  // namespace

Kind formula_kind(const std::string &formula) {
    KindMaker m;
    m.kind.chemical = true;
    std::vector<int> parent, open;
    std::vector<char> element;
    std::map<char, int> ring;
    int last = -1;
    auto length = [&](int i, int j) {
        return radius_of(element[static_cast<std::size_t>(i)]) + radius_of(element[static_cast<std::size_t>(j)]);
    };
    for (char c : formula) {
        if (c == '(') {
            open.push_back(last);
        } else if (c == ')') {
            last = open.back();
            open.pop_back();
        } else if (std::isdigit(static_cast<unsigned char>(c)) && ring.count(c)) {
            m.bond(ring[c], last, length(ring[c], last));
            std::vector<int> atoms = {last};
            while (atoms.back() != ring[c]) atoms.push_back(parent[static_cast<std::size_t>(atoms.back())]);
            m.kind.polygons.emplace_back(atoms.rbegin(), atoms.rend());
            ring.erase(c);
        } else if (std::isdigit(static_cast<unsigned char>(c))) {
            ring[c] = last;
        } else {
            const int here = m.atom(mass_of(c));
            parent.push_back(last);
            element.push_back(c);
            if (last >= 0) m.bond(last, here, length(last, here));
            last = here;
        }
    }
    return m.done();
}

Kind protein_kind(std::int64_t n_bonds) {
    // The backbone's nitrogen and what hangs on its second carbon; proline's ring goes through both.
    static const char *const sides[] = {"H",
                                        "C(H)(H)H",
                                        "C(H)(H)OH",
                                        "C(H)(H)C(O)O",
                                        "C(H)(C(H)(H)H)C(H)(H)H",
                                        "C(H)(H)C(H)(C(H)(H)H)C(H)(H)H",
                                        "C(H)(H)C(H)(H)C(H)(H)C(H)(H)N(H)(H)H",
                                        "C(H)(H)C(H)(H)SC(H)(H)H",
                                        "C(H)(H)C1C(H)C(H)C(H)C(H)C1H",
                                        "C(H)(H)C1N(H)C(H)NC1H"};
    random_stream s = random_seed(5);
    std::string formula = "H";
    std::int64_t bonds = 0;
    while (bonds < n_bonds) {
        const std::int64_t which = random_integer(&s, 0, 10);
        const std::string residue =
            which == 10 ? "N1C(H)(C(H)(H)C(H)(H)C1(H)H)C(O)" : std::string("N(H)C(H)(") + sides[which] + ")C(O)";
        for (char c : residue) bonds += std::isalpha(static_cast<unsigned char>(c)) != 0;
        formula += residue;
    }
    return formula_kind(formula + "O");
}

}  // namespace bench
