#include <set>
#include <sstream>
#include <utility>

#include "core/device/source.hpp"
#include "core/index.hpp"

namespace holonomic::device {

namespace {

// A loop over lanes: a program may start fewer work-items than there are.
const char kernel_begin[] = R"(
    for (int lane = GLOBAL_ID; lane < integers[FIRST + 1]; lane += GLOBAL_SIZE) {
        GLOBAL const int* RESTRICT batch = integers + integers[FIRST] + 2*(lane / HOL_WIDTH);
        GLOBAL const int* RESTRICT atoms = integers + batch[1] + lane % HOL_WIDTH;
        if (atoms[0] < 0)
            continue;
        GLOBAL const mixed* RESTRICT w = numbers + atoms[0];
        int solved = 0;
        switch (batch[0]) {
)";
const char kernel_end[] = "        }\n    }\n}\n";

// The statements that solve a molecule of a kind: all of them have names of their own within a case of the switch.
// Bonds are eliminated one after the other, and the last two are solved together, by Cramer's rule: one quotient less
// to wait for, which counts in water and CH3.
class Writer {
public:
    explicit Writer(const KernelKind &of) : kind_(of), later_(of.bonds.size()) {
        for (const auto &entry : kind_.entries) later_[at(entry.first)].push_back(entry.second);
    }
    std::string positions();
    std::string velocities();

private:
    int n_bonds() const { return kind_.n_bonds(); }
    int n_eliminated() const { return n_bonds() < 2 ? n_bonds() : n_bonds() - 2; }
    const std::pair<int, int> &bond(int k) const { return kind_.bonds[at(k)]; }
    std::string m(int row, int column) const {
        if (symmetric_ && row > column) std::swap(row, column);
        return "m" + std::to_string(row) + "_" + std::to_string(column);
    }
    void begin(const char *state);
    void entry(int row, int column);
    void factorize();
    void forward(int k);
    void backward();
    void move();
    std::string last_if(const char *limit) const;
    void end_pass(const char *is_done);
    void end(const char *store);

    const KernelKind &kind_;
    std::vector<std::vector<int>> later_;  // bonds that are eliminated after each and have an entry with it
    bool symmetric_ = false;
    std::set<std::string> written_;
    std::ostringstream out_;
};

void Writer::begin(const char *state) {
    for (int i = 0; i < kind_.n_atoms; ++i) {
        out_ << "const int a" << i << " = atoms[" << i + 1 << "*HOL_WIDTH];\n"
             << "const HOL_STATE t" << i << " = " << state << "(a" << i << "); mixed3 u" << i << " = make_mixed3(t" << i
             << ".x, t" << i << ".y, t" << i << ".z); const mixed3 x" << i << " = HOL_POSITION(a" << i << ");\n";
        out_ << "const mixed w" << i << " = w[" << i << "];\n";
    }
    for (int k = 0; k < n_bonds(); ++k)
        out_ << "mixed3 s" << k << " = x" << bond(k).first << " - x" << bond(k).second << "; s" << k << " = HOL_IMAGE(s"
             << k << "); const real3 h" << k << " = HOL_ROUNDED(s" << k << ");\n";
}

// Entry (k, l) is d_k . s_l times the inverse masses of the atoms that the two bonds share, negative where one begins
// and the other ends. It is written where it is needed first, so that few are alive at a time.
void Writer::entry(int row, int column) {
    if (!written_.insert(m(row, column)).second) return;
    const auto &one = bond(row), &other = bond(column);
    std::string shared;
    for (const int atom : std::set<int>{one.first, one.second})
        if (atom == other.first || atom == other.second)
            shared += ((one.first == atom) == (other.first == atom) ? "+w" : "-w") + std::to_string(atom);
    out_ << "real " << m(row, column) << " = ";
    if (shared.empty())
        out_ << "0;\n";
    else
        out_ << "(real) (" << shared << ")*dot(d" << row << ", h" << column << ");\n";
}

void Writer::factorize() {
    for (int k = 0; k < n_eliminated(); ++k) {
        const std::vector<int> &later = later_[at(k)];
        entry(k, k);
        for (const int row : later) {
            entry(row, k);
            entry(k, row);
            for (const int column : later) entry(row, column);
        }
        out_ << "const real i" << k << " = 1/" << m(k, k) << ";\n";
        for (const int column : later) {
            out_ << "{ const real t = i" << k << "*" << m(k, column) << ";";
            for (const int row : later)
                if (!symmetric_ || row <= column) out_ << " " << m(row, column) << " -= " << m(row, k) << "*t;";
            out_ << " }\n";
        }
        if (!symmetric_) forward(k);
    }
    const int p = n_eliminated(), q = p + 1;
    if (q >= n_bonds()) return;
    for (const int row : {p, q})
        for (const int column : {p, q}) entry(row, column);
    out_ << "const real i" << p << " = 1/(" << m(p, p) << "*" << m(q, q) << " - " << m(p, q) << "*" << m(q, p)
         << ");\n";
}

void Writer::forward(int k) {
    if (later_[at(k)].empty()) return;
    out_ << "{ const real t = i" << k << "*g" << k << ";";
    for (const int row : later_[at(k)]) out_ << " g" << row << " -= " << m(row, k) << "*t;";
    out_ << " }\n";
}

void Writer::backward() {
    const int p = n_eliminated(), q = p + 1;
    if (q < n_bonds())
        out_ << "{ const real t = i" << p << "*(" << m(q, q) << "*g" << p << " - " << m(p, q) << "*g" << q << "); g"
             << q << " = i" << p << "*(" << m(p, p) << "*g" << q << " - " << m(q, p) << "*g" << p << "); g" << p
             << " = t; }\n";
    for (int k = n_eliminated() - 1; k >= 0; --k) {
        out_ << "g" << k << " = i" << k << "*(g" << k;
        for (const int column : later_[at(k)]) out_ << " - " << m(k, column) << "*g" << column;
        out_ << ");\n";
    }
}

void Writer::move() {
    for (int k = 0; k < n_bonds(); ++k)
        out_ << "{ const mixed3 p = (mixed) g" << k << "*s" << k << "; u" << bond(k).first << " += w" << bond(k).first
             << "*p; u" << bond(k).second << " -= w" << bond(k).second << "*p; }\n";
}

void Writer::end_pass(const char *is_done) { out_ << "if (" << is_done << ") {\nsolved = 1;\nbreak;\n}\n}\n"; }

void Writer::end(const char *store) {
    out_ << "if (solved) {\n";
    for (int i = 0; i < kind_.n_atoms; ++i) out_ << store << "(a" << i << ", t" << i << ", u" << i << ");\n";
    out_ << "} else HOL_FAILED(atoms[" << kind_.n_atoms + 1 << "*HOL_WIDTH])\n";
}

// In larger molecules a look costs little beside the elimination, and compilers for processors make slow loops of a
// second way out.
std::string Writer::last_if(const char *limit) const {
    constexpr int most_bonds = 6;
    return "const int last = " + (n_bonds() <= most_bonds ? "HOL_NEXT_IS_LAST(" + std::string(limit) + ")" : "0") +
           ";\n";
}

// Newton's iteration for the multipliers of the bonds s before the step. What is to vanish is (1 - d.d/a^2) / 2. It
// ends at the rounding, or near it where a step gains nothing more; without a look where the multipliers are no larger
// than the errors: then the matrix is far from singular.
std::string Writer::positions() {
    symmetric_ = false;
    begin("HOL_DISPLACEMENT");
    for (int k = 0; k < n_bonds(); ++k) out_ << "const mixed c" << k << " = w[" << kind_.n_atoms + k << "];\n";
    out_ << "const mixed rounding = " << n_bonds() << "*HOL_ROUNDING*HOL_ROUNDING;\nmixed before = 0;\n"
         << "for (int pass = 0; pass < HOL_MOST_PASSES; ++pass) {\nmixed error = 0;\n";
    for (int k = 0; k < n_bonds(); ++k)
        out_ << "real g" << k << "; real3 d" << k << "; { const mixed3 d = s" << k << " + (u" << bond(k).first << " - u"
             << bond(k).second << "); const mixed e = 0.5f - 0.5f*c" << k << "*dot(d, d); error += e*e; g" << k
             << " = (real) e; d" << k << " = HOL_ROUNDED(c" << k << "*d); }\n";
    out_ << "if (error <= rounding || (error <= 1000*rounding && 4*error >= before && pass > 0)) {\n"
         << "solved = 1;\nbreak;\n}\n"
         << last_if("rounding") << "before = error;\n";
    factorize();
    backward();
    out_ << "const real moved = ";
    for (int k = 0; k < n_bonds(); ++k) out_ << (k == 0 ? "g" : " + g") << k << "*g" << k;
    out_ << ";\n";
    move();
    end_pass("last && moved <= 1000*(real) error");
    end("HOL_DISPLACE");
    return out_.str();
}

// A solution and refinements of it, until they gain nothing more: one in single and double precision.
std::string Writer::velocities() {
    symmetric_ = true;
    begin("HOL_VELOCITY");
    for (int k = 0; k < n_bonds(); ++k) out_ << "const real3 d" << k << " = h" << k << ";\n";
    factorize();
    out_ << "mixed rounding = 0, before = 0;\n"
         << "for (int pass = 0; pass < HOL_MOST_PASSES; ++pass) {\nmixed error = 0;\n";
    for (int k = 0; k < n_bonds(); ++k)
        out_ << "real g" << k << "; { const mixed e = -dot(s" << k << ", u" << bond(k).first << " - u" << bond(k).second
             << "); error += e*e; g" << k << " = (real) e; }\n";
    out_ << "if (pass == 0) {\n";
    for (int k = 0; k < n_bonds(); ++k)
        for (const int atom : {bond(k).first, bond(k).second})
            out_ << "rounding += dot(s" << k << ", s" << k << ")*dot(u" << atom << ", u" << atom << ");\n";
    out_ << "rounding *= HOL_ROUNDING*HOL_ROUNDING;\n}\n"
         << "if (error <= rounding/16 || (error <= 1000*rounding && 4*error >= before && pass > 0)) {\n"
         << "solved = 1;\nbreak;\n}\n"
         << last_if("rounding/16") << "before = error;\n";
    for (int k = 0; k < n_eliminated(); ++k) forward(k);
    backward();
    move();
    end_pass("last");
    end("HOL_SET_VELOCITY");
    return out_.str();
}

}  // namespace

std::string item_kernels(int launch, const std::vector<Sorted::OfKind> &kinds, int first, int last) {
    const std::string number = std::to_string(launch);
    std::string text = "#undef FIRST\n#define FIRST " + std::to_string(2 * launch) + "\n";
    for (const bool of_velocities : {false, true}) {
        text += of_velocities ? "KERNEL void hol_velocities_" + number + "(HOL_PLAN, HOL_VELOCITY_ARRAYS) {"
                              : "KERNEL void hol_positions_" + number + "(HOL_PLAN, HOL_POSITION_ARRAYS) {";
        text += kernel_begin;
        for (int k = first; k < last; ++k) {
            Writer writer(kinds[at(k)].kind);
            text += "case " + std::to_string(k) + ": {\n" + (of_velocities ? writer.velocities() : writer.positions()) +
                    "} break;\n";
        }
        text += kernel_end;
    }
    return text + "#undef FIRST\n";
}

}  // namespace holonomic::device
