// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_EXCHANGE_HPP
#define HOLONOMIC_LAMMPS_PLAN_EXCHANGE_HPP

#include <mpi.h>

#include <vector>

namespace holonomic_lammps {

/** One rank that this one shares molecules with, and the atoms or slots concerned, in the order of the messages. */
struct Peer {
    int rank;
    std::vector<int> indices;
};

/** Carries numbers of atoms from their owners to the homes of their molecules, and back. */
class Exchange {
public:
    std::vector<Peer> homes;  /**< indices: own atoms whose molecule lives there */
    std::vector<Peer> owners; /**< indices: slots here whose atoms they own */

    /** For each atom that lives elsewhere read(atom, numbers); at its home write(slot, numbers). */
    template <int width, class Read, class Write>
    void to_homes(MPI_Comm world, Read read, Write write) {
        carry<width>(world, homes, owners, read, write);
    }

    /** For each slot whose atom is another rank's read(slot, numbers); there write(atom, numbers). */
    template <int width, class Read, class Write>
    void to_owners(MPI_Comm world, Read read, Write write) {
        carry<width>(world, owners, homes, read, write);
    }

private:
    template <int width, class Read, class Write>
    void carry(MPI_Comm world, const std::vector<Peer> &to, const std::vector<Peer> &from, Read read, Write write) {
        constexpr int tag = 1717;
        sent_.resize(width * count(to));
        received_.resize(width * count(from));
        requests_.resize(to.size() + from.size());
        MPI_Request *request = requests_.data();
        double *in = received_.data();
        for (const Peer &peer : from) {
            const int n = width * static_cast<int>(peer.indices.size());
            MPI_Irecv(in, n, MPI_DOUBLE, peer.rank, tag, world, request++);
            in += n;
        }
        double *out = sent_.data();
        for (const Peer &peer : to) {
            double *begin = out;
            for (int index : peer.indices) {
                read(index, out);
                out += width;
            }
            MPI_Isend(begin, static_cast<int>(out - begin), MPI_DOUBLE, peer.rank, tag, world, request++);
        }
        MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
        const double *numbers = received_.data();
        for (const Peer &peer : from)
            for (int index : peer.indices) {
                write(index, numbers);
                numbers += width;
            }
    }

    static std::size_t count(const std::vector<Peer> &peers) {
        std::size_t sum = 0;
        for (const Peer &peer : peers) sum += peer.indices.size();
        return sum;
    }

    std::vector<double> sent_, received_;
    std::vector<MPI_Request> requests_;
};

}  // namespace holonomic_lammps

#endif
