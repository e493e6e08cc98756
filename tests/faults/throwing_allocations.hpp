/**
 * @file throwing_allocations.hpp
 * operator new of the whole process, made to throw on demand.
 */
#ifndef FAULTS_THROWING_ALLOCATIONS_HPP
#define FAULTS_THROWING_ALLOCATIONS_HPP

enum kind { BAD_ALLOC, BAD_LENGTH, RUNTIME_ERROR, SYSTEM_ERROR, DERIVED, AN_INT, A_POINTER, KINDS };

extern const char *const kind_names[KINDS];

extern kind thrown;  ///< what is thrown next
extern long left;    ///< allocations that succeed until one throws; -1: all do, or one has thrown

#endif
