#include "case_file.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>

#include "exact_metric.hpp"
#include "oracle_file.h"

namespace stress
{

namespace
{

struct file_closer {
    void operator()(FILE *f) const
    {
        std::fclose(f);
    }
};
using file = std::unique_ptr<FILE, file_closer>;

/** A result; zero is written as the format wants it. */
void result(FILE *out, long double x)
{
    if (x == 0)
        std::fputs(" 0.0", out);
    else
        std::fprintf(out, " %.20Le", x);
}

void write_inputs(FILE *out, const hostile_chain &c)
{
    std::fprintf(out, "atoms_in\n");
    for (std::size_t i = 0; i < c.mass.size(); ++i) {
        std::fprintf(out, "%zu %.16e %.16e", i, c.w[i], c.w[i] > 0 ? c.mass[i] : -1.0);
        for (const std::vector<double> *x : {&c.r, &c.v, &c.f})
            std::fprintf(out, " %.16e %.16e %.16e", (*x)[3 * i], (*x)[3 * i + 1], (*x)[3 * i + 2]);
        std::fputc('\n', out);
    }
    std::fprintf(out, "bonds_in\n");
    for (std::size_t k = 0; k < c.length.size(); ++k) std::fprintf(out, "%zu %.16e\n", k + 1, c.length[k]);
}

void write_results(FILE *out, const solution &s, const exact_metric &m)
{
    std::fprintf(out, "lndet");
    result(out, m.log_det);
    std::fprintf(out, "\nfixman_energy");
    result(out, m.log_det / 2);
    std::fprintf(out, "\nvirial");
    for (int i : {0, 1, 2, 4, 5, 8}) result(out, s.virial[i]);
    std::fprintf(out, "\ncond %.5Le\nbonds_out\n", m.condition);
    for (std::int64_t k = 0; k < s.n_bonds; ++k) {
        std::fprintf(out, "%lld", static_cast<long long>(k) + 1);
        result(out, s.lambda[k]);
        result(out, s.lambda_scale[k]);
        std::fputc('\n', out);
    }
    std::fprintf(out, "atoms_out\n");
    for (std::int64_t i = 0; i <= s.n_bonds; ++i) {
        const std::size_t j = static_cast<std::size_t>(i);
        std::fprintf(out, "%lld", static_cast<long long>(i));
        for (int x = 0; x < 3; ++x) result(out, s.g[3 * i + x]);
        result(out, s.g_scale[i]);
        for (std::size_t x = 0; x < 3; ++x) result(out, m.force[3 * j + x]);
        result(out, m.force_scale[j]);
        std::fputc('\n', out);
    }
    const std::int64_t n = s.n_bonds, middle = (n + 1) / 2, next = n > 1 ? 2 : 1, far = n < 20 ? n : 20;
    const std::int64_t entries[][2] = {{1, 1}, {1, next}, {middle, middle}, {1, far}, {n, n}};
    std::fprintf(out, "zinv 5\n");
    for (const auto &e : entries) {
        std::fprintf(out, "%lld %lld", static_cast<long long>(e[0]), static_cast<long long>(e[1]));
        result(out, m.entry(e[0] - 1, e[1] - 1));
        std::fputc('\n', out);
    }
    std::fprintf(out, "end\n");
}

std::mutex index_in_use;

}  // namespace

bool write_case(const std::string &directory, const std::string &name, const std::string &comment,
                const chain_group &group, const hostile_chain &c)
{
    const solution_problem p = c.problem();
    const exact_metric m = metric_of(p);
    solution s;
    if (!m.regular || solution_forces(&p, &s)) return false;
    const file out(std::fopen((directory + "/" + name + ".txt").c_str(), "w"));
    if (out) {
        std::fprintf(out.get(), "# %s\n# seed %llu: %s\n# dt %.17g\n# group %llu %llu %lld\ncase %s\nnbonds %lld\n",
                     comment.c_str(), static_cast<unsigned long long>(c.seed), c.words().c_str(), c.dt,
                     static_cast<unsigned long long>(group.first), static_cast<unsigned long long>(group.size),
                     static_cast<long long>(group.longest), name.c_str(), static_cast<long long>(c.n_bonds));
        write_inputs(out.get(), c);
        write_results(out.get(), s, m);
    }
    solution_free(&s);
    const std::lock_guard<std::mutex> lock(index_in_use);
    const file index(std::fopen((directory + "/INDEX").c_str(), "a"));
    return out && index && std::fprintf(index.get(), "%s.txt\n", name.c_str()) > 0;
}

hostile_chain read_case(const std::string &path, chain_group &group)
{
    oracle_case o;
    char message[4400];
    if (oracle_read(path.c_str(), &o, message, sizeof message)) {
        std::fprintf(stderr, "stress: %s\n", message);
        std::exit(2);
    }
    hostile_chain c;
    c.n_bonds = o.n_bonds;
    const std::size_t n = static_cast<std::size_t>(o.n_bonds), atoms = n + 1;
    c.w.assign(o.w, o.w + atoms);
    c.mass.assign(o.mass, o.mass + atoms);
    for (double &m : c.mass)
        if (m < 0) m = 0;
    c.r.assign(o.r, o.r + 3 * atoms);
    c.v.assign(o.v, o.v + 3 * atoms);
    c.f.assign(o.f, o.f + 3 * atoms);
    complete(c, 1e-3);
    c.length.assign(o.length, o.length + n);
    oracle_free(&o);
    const file in(std::fopen(path.c_str(), "r"));
    char line[256];
    unsigned long long seed = 0, first = 0, size = 0;
    long long longest = 0;
    while (in && std::fgets(line, sizeof line, in.get()) && line[0] == '#') {
        std::sscanf(line, "# dt %lf", &c.dt);
        std::sscanf(line, "# seed %llu", &seed);
        std::sscanf(line, "# group %llu %llu %lld", &first, &size, &longest);
    }
    c.seed = seed;
    group = {first, size, longest};
    return c;
}

}  // namespace stress
