#include "Arrays.h"

namespace OpenMM {

namespace {

template <class Number>
std::vector<double> downloaded(const ArrayInterface &array) {
    std::vector<Number> numbers(4 * static_cast<std::size_t>(array.getSize()));
    array.download(numbers.data(), true);
    return std::vector<double>(numbers.begin(), numbers.end());
}

template <class Number>
void uploaded(ArrayInterface &array, const std::vector<double> &values) {
    const std::vector<Number> numbers(values.begin(), values.end());
    array.upload(numbers.data(), true);
}

bool ofDoubles(const ArrayInterface &array) { return array.getElementSize() == 4 * sizeof(double); }

}  // namespace

std::vector<double> read(const ArrayInterface &array) {
    return ofDoubles(array) ? downloaded<double>(array) : downloaded<float>(array);
}

void write(ArrayInterface &array, const std::vector<double> &values) {
    ofDoubles(array) ? uploaded<double>(array, values) : uploaded<float>(array, values);
}

}  // namespace OpenMM
