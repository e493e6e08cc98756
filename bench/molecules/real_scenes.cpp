// Molecules as they stand in files that Debian's lammps-examples and gromacs-data bring. Nothing of them is kept here.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numeric>

#include "molecules.hpp"
#include "topology_files.hpp"

namespace bench {
namespace {

struct Source {
    const char *name, *file;
    bool charges, hydrogens_alone;
};

const std::string lammps = "/usr/share/lammps/examples/", gromacs = "/usr/share/gromacs/top/";

const Source sources[] = {
    {"spc216", "spc216.gro", false, false},
    {"spce_heat", "HEAT/data.spce", true, false},
    {"deca_ala", "PACKAGES/imd/data.deca-ala-solv", true, false},
    {"deca_ala_xh", "PACKAGES/imd/data.deca-ala-solv", true, true},
    {"peptide", "PACKAGES/colvars/data.peptide", true, false},
    {"peptide_xh", "PACKAGES/colvars/data.peptide", true, true},
    {"toluene", "PACKAGES/drude/toluene/data.toluene", true, false},
    {"butane", "PACKAGES/drude/butane/data.butane", true, false},
    {"surfactant", "PACKAGES/cgsdk/peg-verlet/data.pegc12e8.gz", false, false},
    {"monolayer", "PACKAGES/cgsdk/sds-monolayer/data.sds.gz", true, false},
};

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Sets of atoms that bonds join.
class Components {
public:
    explicit Components(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
    int root(int i) {
        while (parent_[at(i)] != i) i = parent_[at(i)] = parent_[at(parent_[at(i)])];
        return i;
    }
    void join(int i, int j) { parent_[at(root(j))] = root(i); }

private:
    std::vector<int> parent_;
};

class Reader {
public:
    Reader(TopologyFile file, bool hydrogens_alone) : file_(std::move(file)), start_(file_.mass.size()) {
        // Drude particles, lighter than hydrogen, are on springs. 3 separates hydrogens from all else.
        auto keep = [&](const TopologyFile::Bond &b) {
            const double light = std::min(file_.mass[at(b.i)], file_.mass[at(b.j)]);
            return light > 1 && (!hydrogens_alone || light < 3);
        };
        std::vector<TopologyFile::Bond> kept;
        std::copy_if(file_.bonds.begin(), file_.bonds.end(), std::back_inserter(kept), keep);
        file_.bonds = kept;
        close_water();
        Components parts(file_.mass.size());
        for (const auto &b : file_.bonds) parts.join(b.i, b.j);
        atoms_.resize(file_.mass.size());
        bonds_.resize(file_.mass.size());
        for (std::size_t i = 0; i < file_.mass.size(); ++i)
            atoms_[at(parts.root(static_cast<int>(i)))].push_back(static_cast<int>(i));
        for (const auto &b : file_.bonds) bonds_[at(parts.root(b.i))].push_back(b);
        mean_lengths();
    }

    void fill(Molecules &m) {
        std::map<std::vector<double>, std::size_t> known;
        for (std::size_t root = 0; root < atoms_.size(); ++root) {
            if (bonds_[root].empty()) continue;
            const Kind kind = kind_of(root);
            std::vector<double> signature = kind.mass;
            signature.insert(signature.end(), kind.length.begin(), kind.length.end());
            signature.insert(signature.end(), kind.first.begin(), kind.first.end());
            signature.insert(signature.end(), kind.second.begin(), kind.second.end());
            const auto found = known.emplace(signature, m.kinds.size());
            if (found.second) m.kinds.push_back(kind);
            m.add(found.first->second);
            place(root, m);
        }
    }

private:
    double distance(const TopologyFile::Bond &b) const {
        double square = 0;
        for (std::size_t x = 0; x < 3; ++x) square += std::pow(image(file_.r[at(b.j)][x] - file_.r[at(b.i)][x], x), 2);
        return std::sqrt(square);
    }
    double image(double d, std::size_t x) const {
        return file_.box[x] > 0 ? d - file_.box[x] * std::nearbyint(d / file_.box[x]) : d;
    }

    /// Water is rigid: the third distance.
    void close_water() {
        std::vector<std::vector<int>> hydrogens(file_.mass.size());
        for (const auto &b : file_.bonds)
            for (bool turned : {false, true}) {
                const int centre = turned ? b.j : b.i, other = turned ? b.i : b.j;
                if (std::lround(file_.mass[at(centre)]) == 16 && file_.mass[at(other)] < 3)
                    hydrogens[at(centre)].push_back(other);
            }
        for (const std::vector<int> &pair : hydrogens)
            if (pair.size() == 2) file_.bonds.push_back({std::min(pair[0], pair[1]), std::max(pair[0], pair[1]), 0});
    }

    void mean_lengths() {
        std::map<int, int> count;
        for (const auto &b : file_.bonds) {
            length_[b.type] += distance(b);
            ++count[b.type];
        }
        for (auto &length : length_) length.second /= count[length.first];
    }

    Kind kind_of(std::size_t root) {
        KindMaker maker;
        maker.kind.chemical = true;
        for (int atom : atoms_[root]) start_[at(atom)] = maker.atom(file_.mass[at(atom)]);
        for (const auto &b : bonds_[root]) maker.bond(start_[at(b.i)], start_[at(b.j)], length_[b.type]);
        return maker.done();
    }

    /// Positions of the molecule that was added last, made whole.
    void place(std::size_t root, Molecules &m) {
        const std::size_t first = m.places.back().atom, n = atoms_[root].size();
        m.r.resize(3 * (first + n));
        std::vector<bool> there(n);
        auto put = [&](int atom, const std::array<double, 3> &r) {
            std::copy(r.begin(), r.end(), &m.r[3 * (first + at(start_[at(atom)]))]);
            there[at(start_[at(atom)])] = true;
        };
        put(atoms_[root][0], file_.r[at(atoms_[root][0])]);
        for (bool more = true; more;) {
            more = false;
            for (const auto &b : bonds_[root])
                for (bool turned : {false, true}) {
                    const int from = turned ? b.j : b.i, to = turned ? b.i : b.j;
                    if (!there[at(start_[at(from)])] || there[at(start_[at(to)])]) continue;
                    std::array<double, 3> r;
                    for (std::size_t x = 0; x < 3; ++x)
                        r[x] = m.r[3 * (first + at(start_[at(from)])) + x] +
                               image(file_.r[at(to)][x] - file_.r[at(from)][x], x);
                    put(to, r);
                    more = true;
                }
        }
    }

    TopologyFile file_;
    std::vector<int> start_;  ///< each atom's number within its molecule
    std::vector<std::vector<int>> atoms_;
    std::vector<std::vector<TopologyFile::Bond>> bonds_;
    std::map<int, double> length_;
};

}  // namespace

const std::vector<std::string> &real_scenes() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> list;
        for (const Source &source : sources) list.push_back(source.name);
        return list;
    }();
    return names;
}

bool read_molecules(const std::string &name, Molecules &m) {
    const auto source =
        std::find_if(std::begin(sources), std::end(sources), [&](const Source &s) { return s.name == name; });
    const bool water = name == "spc216";
    m.source = (water ? gromacs : lammps) + source->file;
    if (!std::ifstream(m.source)) return false;
    m.name = name;
    Reader(water ? read_water_gro(m.source) : read_lammps_data(m.source, source->charges), source->hydrogens_alone)
        .fill(m);
    random_stream s = random_seed(1);
    set_in_motion(m, s);
    return true;
}

}  // namespace bench
