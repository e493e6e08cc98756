// A library that calls a function of its own, to be linked in two ways.
extern "C" __attribute__((visibility("default"))) int inner(int x) { return x + 1; }
extern "C" __attribute__((visibility("default"))) int outer(int x) { return inner(x) * inner(-x); }
