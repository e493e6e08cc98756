/** Numbers and tables as text, for the report. */
#ifndef BENCH_MARKDOWN_HPP
#define BENCH_MARKDOWN_HPP

#include <string>
#include <vector>

namespace bench {

/// Three digits, no exponent below a million; empty for NaN.
std::string number(double x);
/// "4.1e-16"
std::string error_text(double x);
/// "1000 x 100"
std::string size_text(long long chains, long long bonds);

class MarkdownTable {
public:
    explicit MarkdownTable(const std::vector<std::string> &head);
    void add(const std::vector<std::string> &cells);
    std::string text() const { return text_; }
    bool empty() const { return rows_ == 0; }

private:
    std::string text_;
    std::size_t rows_ = 0;
};

}  // namespace bench

#endif
