/**
 * @file markdown_table.hpp
 * A table with a column for each set of kernels, to the end of the file that STRESS_MARKDOWN (environment) names.
 */
#ifndef STRESS_MARKDOWN_TABLE_HPP
#define STRESS_MARKDOWN_TABLE_HPP

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace stress
{

struct markdown_table {
    std::FILE *out;  ///< nullptr: none is wanted
    std::size_t n_sets;

    explicit markdown_table(const std::vector<std::string> &sets) : out(nullptr), n_sets(sets.size())
    {
        if (const char *const path = std::getenv("STRESS_MARKDOWN")) out = std::fopen(path, "a");
        if (!out) return;
        row("", [&](std::size_t s) { return sets[s]; });
        row("---", [](std::size_t) { return "---"; });
    }
    ~markdown_table()
    {
        if (!out) return;
        std::fputc('\n', out);
        std::fclose(out);
    }
    markdown_table(const markdown_table &) = delete;
    markdown_table &operator=(const markdown_table &) = delete;

    template <class Cell>
    void row(const std::string &name, const Cell &cell) const
    {
        std::fprintf(out, "| %s |", name.c_str());
        for (std::size_t s = 0; s < n_sets; ++s) std::fprintf(out, " %s |", std::string(cell(s)).c_str());
        std::fputc('\n', out);
    }
    static std::string number(long double x)
    {
        char text[40];
        std::snprintf(text, sizeof text, "%.2Lg", x);
        return x < 0 ? "" : text;
    }
};

}  // namespace stress

#endif
