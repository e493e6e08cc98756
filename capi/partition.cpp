#include "core/partition/partition.hpp"

#include "boundary.hpp"

int hol_partition_function(int64_t n_bonds, const double *masses, double *log_he, double *log_rigid,
                           double *log_volume) {
    return holonomic::guarded<holonomic::LongDoubleEnvironment>(__func__, [&] {
        if (!log_he && !log_rigid && !log_volume)
            throw holonomic::make_error(holonomic::Status::null, "log_he, log_rigid and log_volume are all NULL");
        const holonomic::PartitionAsked asked{log_he || log_rigid, log_volume != nullptr};
        const holonomic::Partition result = holonomic::partition_function(n_bonds, masses, asked);
        if (log_he) *log_he = result.he;
        if (log_rigid) *log_rigid = result.rigid;
        if (log_volume) *log_volume = result.volume;
    });
}
