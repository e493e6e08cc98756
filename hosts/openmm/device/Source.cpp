#include "Source.h"

#include <set>
#include <sstream>

namespace OpenMM {

// What is the same for all kinds. In mixed precision positions are the sum of two floats; residuals and displacements
// are in doubles, the matrix and its factors, to which iterations are indifferent, in floats.
const char commonSource[] = R"(
#ifdef USE_MIXED_PRECISION
#define POSITIONS GLOBAL const real4* RESTRICT posq, GLOBAL const real4* RESTRICT posqCorrection
#define THE_POSITIONS posq, posqCorrection
#define POSITION(a) make_mixed3(posq[a].x + (mixed) posqCorrection[a].x, posq[a].y + (mixed) posqCorrection[a].y, \
                                posq[a].z + (mixed) posqCorrection[a].z)
#else
#define POSITIONS GLOBAL const real4* RESTRICT posq
#define THE_POSITIONS posq
#define POSITION(a) trimTo3(posq[a])
#endif
#if defined(USE_MIXED_PRECISION) || defined(USE_DOUBLE_PRECISION)
#define ROUNDING ((mixed) 2.2e-16)
#else
#define ROUNDING 1.2e-7f
#endif
#define ROUNDED(v) make_real3((v).x, (v).y, (v).z)
#define MAX_ITERATIONS 25
)";

namespace {

// A loop over groups: the platform may start fewer threads than were asked for. `failures` keeps for each molecule the
// call that it failed in first, from 1 on; nothing depends on which thread comes first.
const char loop[] = R"(
KERNEL void solve@(int firstSlot, int lastSlot, GLOBAL const int2* RESTRICT groups, GLOBAL const int* RESTRICT atoms,
        GLOBAL const mixed* RESTRICT parameters, GLOBAL int* RESTRICT failures, GLOBAL int* RESTRICT anyFailure,
        int call, GLOBAL mixed4* RESTRICT state, POSITIONS) {
    for (int slot = firstSlot + GLOBAL_ID; slot < lastSlot; slot += GLOBAL_SIZE) {
        const int2 group = groups[slot / WIDTH];
        GLOBAL const int* RESTRICT molecule = atoms + group.y + slot % WIDTH;
        if (molecule[0] < 0)
            continue;
        int solved = 0;
        switch (group.x) {
)";
const char loopEnd[] = R"(
        }
        if (!solved && failures[slot] == 0) {
            failures[slot] = call;
            anyFailure[0] = 1;
        }
    }
}
)";

class Writer {
public:
    explicit Writer(const Kind &of) : kind(of), later(of.bonds.size()) {
        for (const auto &entry : kind.entries) later[entry.first].push_back(entry.second);
    }
    std::string positions(int number);
    std::string velocities(int number);

private:
    int nBonds() const { return static_cast<int>(kind.bonds.size()); }
    std::string m(int row, int column) const {
        if (symmetric && row > column) std::swap(row, column);
        return "m" + std::to_string(row) + "_" + std::to_string(column);
    }
    void begin(const char *name, int number, const char *state);
    void entry(int row, int column);
    void factorize(bool withRightSide);
    void forward(int k);
    void backward();
    void move();
    void store(const char *state, const char *last);

    const Kind &kind;
    std::vector<std::vector<int>> later;  // bonds that are eliminated after each and have an entry with it
    bool symmetric = false;
    std::set<std::string> written;
    std::ostringstream out;
};

void Writer::begin(const char *name, int number, const char *state) {
    out << "DEVICE int solve" << name << number
        << "(GLOBAL const int* RESTRICT atoms, GLOBAL const mixed* RESTRICT parameters, GLOBAL mixed4* RESTRICT "
        << state << ", POSITIONS) {\n";
    for (int i = 0; i < kind.nAtoms; ++i) {
        out << "const int a" << i << " = atoms[" << i << "*WIDTH];\n";
        out << "const mixed4 t" << i << " = " << state << "[a" << i << "]; mixed3 u" << i << " = trimTo3(t" << i
            << "); const mixed3 x" << i << " = POSITION(a" << i << ");\n";
    }
    for (int k = 0; k < nBonds(); ++k)
        out << "const mixed3 s" << k << " = x" << kind.bonds[k].first << " - x" << kind.bonds[k].second
            << "; const real3 h" << k << " = ROUNDED(s" << k << ");\n";
}

// Entry (k, l) is d_k . s_l times the inverse masses of the atoms that the two bonds share, negative where one begins
// and the other ends. It is written where it is needed first, so that few are alive at a time.
void Writer::entry(int row, int column) {
    if (!written.insert(m(row, column)).second) return;
    const auto &one = kind.bonds[row], &other = kind.bonds[column];
    std::string shared;
    for (int atom : std::set<int>{one.first, one.second})
        if (atom == other.first || atom == other.second)
            shared += ((one.first == atom) == (other.first == atom) ? "+w" : "-w") + std::to_string(atom);
    out << "real " << m(row, column) << " = ";
    if (shared.empty())
        out << "0;\n";
    else
        out << "(real) (" << shared << ")*dot(d" << row << ", h" << column << ");\n";
}

void Writer::factorize(bool withRightSide) {
    for (int k = 0; k < nBonds(); ++k) {
        entry(k, k);
        for (int row : later[k]) {
            entry(row, k);
            entry(k, row);
            for (int column : later[k]) entry(row, column);
        }
        out << "const real i" << k << " = 1/" << m(k, k) << ";\n";
        for (int column : later[k]) {
            out << "{ const real t = i" << k << "*" << m(k, column) << ";";
            for (int row : later[k])
                if (!symmetric || row <= column) out << " " << m(row, column) << " -= " << m(row, k) << "*t;";
            out << " }\n";
        }
        if (withRightSide) forward(k);
    }
}

void Writer::forward(int k) {
    out << "{ const real t = i" << k << "*g" << k << ";";
    for (int row : later[k]) out << " g" << row << " -= " << m(row, k) << "*t;";
    out << " }\n";
}

void Writer::backward() {
    for (int k = nBonds() - 1; k >= 0; --k) {
        out << "g" << k << " = i" << k << "*(g" << k;
        for (int column : later[k]) out << " - " << m(k, column) << "*g" << column;
        out << ");\n";
    }
}

void Writer::move() {
    for (int k = 0; k < nBonds(); ++k) {
        const auto &bond = kind.bonds[k];
        out << "{ const mixed3 p = (mixed) g" << k << "*s" << k << "; u" << bond.first << " += w" << bond.first
            << "*p; u" << bond.second << " -= w" << bond.second << "*p; }\n";
    }
}

void Writer::store(const char *state, const char *last) {
    for (int i = 0; i < kind.nAtoms; ++i)
        out << state << "[a" << i << "] = make_mixed4(u" << i << ".x, u" << i << ".y, u" << i << ".z, t" << i << last
            << ");\n";
}

// Newton's iteration for the multipliers of the bonds s before the step. What is to vanish is (1 - d.d/a^2) / 2. It
// ends at the rounding, or near it where a step gains nothing more.
std::string Writer::positions(int number) {
    symmetric = false;
    begin("Positions", number, "posDelta");
    out << "parameters += atoms[" << kind.nAtoms << "*WIDTH];\n";
    for (int i = 0; i < kind.nAtoms; ++i) out << "const mixed w" << i << " = parameters[" << i << "];\n";
    for (int k = 0; k < nBonds(); ++k) out << "const mixed c" << k << " = parameters[" << kind.nAtoms + k << "];\n";
    out << "const mixed rounding = " << nBonds() << "*ROUNDING*ROUNDING;\nmixed before = 0;\n"
        << "for (int iteration = 0; iteration < MAX_ITERATIONS; ++iteration) {\nmixed error = 0;\n";
    for (int k = 0; k < nBonds(); ++k) {
        const auto &bond = kind.bonds[k];
        out << "real g" << k << "; real3 d" << k << "; { const mixed3 d = s" << k << " + (u" << bond.first << " - u"
            << bond.second << "); const mixed e = 0.5f - 0.5f*c" << k << "*dot(d, d); error += e*e; g" << k << " = e; d"
            << k << " = ROUNDED(c" << k << "*d); }\n";
    }
    out << "if (error <= rounding || (error <= 1000*rounding && 4*error >= before && iteration > 0)) {\n";
    store("posDelta", ".w");
    out << "return 1;\n}\nbefore = error;\n";
    factorize(true);
    backward();
    move();
    out << "}\nreturn 0;\n}\n";
    return out.str();
}

// A solution and refinements of it, until they gain nothing more: one in single and double precision.
std::string Writer::velocities(int number) {
    symmetric = true;
    begin("Velocities", number, "velm");
    for (int i = 0; i < kind.nAtoms; ++i) out << "const mixed w" << i << " = t" << i << ".w;\n";
    for (int k = 0; k < nBonds(); ++k) out << "const real3 d" << k << " = h" << k << ";\n";
    factorize(false);
    out << "mixed rounding = 0, before = 0;\n"
        << "for (int pass = 0; pass < MAX_ITERATIONS; ++pass) {\nmixed error = 0;\n";
    for (int k = 0; k < nBonds(); ++k) {
        const auto &bond = kind.bonds[k];
        out << "real g" << k << "; { const mixed e = -dot(s" << k << ", u" << bond.first << " - u" << bond.second
            << "); error += e*e; g" << k << " = e; }\n";
    }
    out << "if (pass == 0) {\n";
    for (int k = 0; k < nBonds(); ++k)
        for (int atom : {kind.bonds[k].first, kind.bonds[k].second})
            out << "rounding += dot(s" << k << ", s" << k << ")*dot(u" << atom << ", u" << atom << ");\n";
    out << "rounding *= ROUNDING*ROUNDING;\n}\n"
        << "if (error <= rounding/16 || (error <= 1000*rounding && 4*error >= before && pass > 0)) {\n";
    store("velm", ".w");
    out << "return 1;\n}\nbefore = error;\n";
    for (int k = 0; k < nBonds(); ++k) forward(k);
    backward();
    move();
    out << "}\nreturn 0;\n}\n";
    return out.str();
}

std::string kernel(const char *name, std::size_t first, std::size_t last) {
    std::string text = loop;
    text.replace(text.find('@'), 1, name);
    for (std::size_t k = first; k < last; ++k) {
        const std::string number = std::to_string(k);
        text += "case " + number + ": solved = solve" + name + number +
                "(molecule, parameters, state, THE_POSITIONS); break;\n";
    }
    return text + loopEnd;
}

}  // namespace

std::string kernelSource(const std::vector<MoleculesOfKind> &kinds, std::size_t first, std::size_t last) {
    std::string text = commonSource + std::string("#define WIDTH ") + std::to_string(groupWidth) + "\n";
    for (std::size_t k = first; k < last; ++k)
        text += Writer(kinds[k].kind).positions(static_cast<int>(k)) +
                Writer(kinds[k].kind).velocities(static_cast<int>(k));
    return text + kernel("Positions", first, last) + kernel("Velocities", first, last);
}

}  // namespace OpenMM
