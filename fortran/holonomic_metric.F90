! Metric determinant and Fixman potential: hol_metric with arrays of any layout.
module holonomic_metric
   use, intrinsic :: iso_c_binding, only: c_ptr
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use holonomic_c, only: hol_metric_view, HOL_ERR_VALUE
   use holonomic_place, only: list_of, mode_of, number_at, place
   use holonomic_status, only: failure, settle
   use holonomic_outcomes, only: chain_set_outcomes
   implicit none
   private
   public :: chain_set_metric

   type, extends(chain_set_outcomes) :: chain_set_metric
   contains
      procedure, private :: metric_rows_32, metric_rows_64, metric_parts_32, metric_parts_64
      generic :: metric => metric_rows_32, metric_rows_64, metric_parts_32, metric_parts_64
   end type

contains

#define ROWS 32
#define METRIC metric_rows_32
#include "metric.inc"
#define ROWS 64
#define METRIC metric_rows_64
#include "metric.inc"
#define PARTS 32
#define METRIC metric_parts_32
#include "metric.inc"
#define PARTS 64
#define METRIC metric_parts_64
#include "metric.inc"

end module
